"""Pages as the repository shows them become pages of the site.

README and CONTRIBUTING stand at the root of the repository and are taken in by ``{include}``; links between
Markdown files lead to pages, those to an example to its place in the gallery, those to other files are
downloads.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sphinx.application import Sphinx

DOCS = Path(__file__).resolve().parents[1]
ROOT = DOCS.parent
AT_THE_ROOT = {
    ROOT / "README.md": DOCS / "index.md",
    ROOT / "CONTRIBUTING.md": DOCS / "contributing.md",
    ROOT / "examples": DOCS / "gallery.md",
}
INCLUDE = re.compile(r"^```\{include\} (\S+)\n```$", re.MULTILINE)
LINK = re.compile(r"\[([^\[\]\n]*)\]\(([^)\s#:]+)(#[\w-]+)?\)")


def on_the_site(text: str, folder: Path, page: Path) -> str:
    """Markdown of a file in a folder, with links as they must be on a page.

    A link whose words are the name of a page gets its title instead.
    """

    def link(found: re.Match[str]) -> str:
        words, target, anchor = found[1], (folder / found[2]).resolve(), found[3] or ""
        if not target.exists():
            return found[0]
        if target.parent.parent == ROOT / "examples" and target.stem == target.parent.name:
            return f"[{words}](#example-{target.stem.replace('_', '-')})"
        target = AT_THE_ROOT.get(target, target)
        words = "" if words.endswith(".md") else words
        return f"[{words}]({Path(os.path.relpath(target, page.parent)).as_posix()}{anchor})"

    return LINK.sub(link, text)


def read(app: Sphinx, docname: str, source: list[str]) -> None:
    """Take in included files, and turn the links."""
    page = Path(app.env.doc2path(docname))
    if page.suffix != ".md":
        return

    def taken_in(found: re.Match[str]) -> str:
        file = (page.parent / found[1]).resolve()
        app.env.note_dependency(str(file))
        return on_the_site(file.read_text(), file.parent, page)

    source[0] = INCLUDE.sub(taken_in, on_the_site(source[0], page.parent, page))


def setup(app: Sphinx) -> dict[str, bool]:
    """Join the build."""
    app.connect("source-read", read)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
