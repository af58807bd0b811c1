"""C++'s side of the reference: Doxygen reads the headers, Breathe shows what pages name.

Without Doxygen the rest of the site is built, and says so.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

from docutils import nodes
from pages import ROOT
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.config import Config

doxygen_is_here = shutil.which("doxygen") is not None
WITHOUT = "Doxygen is not installed: the classes of C++ are missing from this site (apt-get install doxygen)."
DERIVED = re.compile(r"<derivedcompoundref.*?</derivedcompoundref>")
SETTINGS = """
INPUT = numerics kernel io compare
FILE_PATTERNS = *.hpp
RECURSIVE = YES
STRIP_FROM_PATH = .
GENERATE_XML = YES
GENERATE_HTML = NO
GENERATE_LATEX = NO
XML_PROGRAMLISTING = NO
EXTRACT_ALL = YES
INHERIT_DOCS = NO
MACRO_EXPANSION = YES
QUIET = YES
WARN_AS_ERROR = FAIL_ON_WARNINGS
WARN_IF_UNDOCUMENTED = NO
WARN_IF_INCOMPLETE_DOC = NO
MARKDOWN_SUPPORT = YES
AUTOLINK_SUPPORT = NO
"""


class Missing(SphinxDirective):
    """Stands for Breathe's directives where there is no Doxygen."""

    required_arguments = 1
    has_content = True
    option_spec = {"members": lambda text: text}

    def run(self) -> list[nodes.Node]:
        """Nothing."""
        return []


class Note(SphinxDirective):
    """``{doxygen-note}``: says so where there is no Doxygen."""

    def run(self) -> list[nodes.Node]:
        """A note, or nothing."""
        return [] if doxygen_is_here else [nodes.note("", nodes.paragraph(WITHOUT, WITHOUT))]


def read_headers(app: Sphinx, config: Config) -> None:
    """Let Doxygen write XML."""
    if not doxygen_is_here:
        logging.getLogger(__name__).info(WITHOUT)
        return
    folder = Path(app.doctreedir) / "doxygen"
    folder.mkdir(parents=True, exist_ok=True)
    settings = f"{SETTINGS}OUTPUT_DIRECTORY = {folder}\n"
    done = subprocess.run(
        ["doxygen", "-"], input=settings, cwd=ROOT, capture_output=True, text=True, check=False
    )
    for line in done.stderr.splitlines():
        logging.getLogger(__name__).warning(line)
    for file in (folder / "xml").glob("class*.xml"):  # derived classes that no page names have no link
        file.write_text(DERIVED.sub("", file.read_text()))
    config.breathe_projects = {"saltus": str(folder / "xml")}
    config.breathe_default_project = "saltus"


def setup(app: Sphinx) -> dict[str, bool]:
    """Join the build."""
    app.add_directive("doxygen-note", Note)
    if not doxygen_is_here:
        for name in ("doxygenclass", "doxygenstruct", "doxygenfunction", "doxygendefine"):
            app.add_directive(name, Missing)
    app.connect("config-inited", read_headers, priority=100)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
