"""The documentation site: ``sphinx-build -W --keep-going -b html docs out/docs``."""

import sys
from pathlib import Path

sys.dont_write_bytecode = True  # the build writes into its own folder alone
sys.path.insert(0, str(Path(__file__).parent / "site"))

import saltus
from cpp_api import doxygen_is_here

project = "Saltus"
author = "the developers of Saltus"
version = release = saltus.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx-mathjax-offline",
    "sphinx_copybutton",
    "pages",
    "pictures",
    "python_api",
    "command_line",
    "cpp_api",
]
exclude_patterns = ["site"]
nitpicky = True
# Classes of other packages, and names of ours that only annotations know.
nitpick_ignore_regex = [
    (
        r"py:.*",
        r"(ArrayLike|Axes|Figure|ModuleType|(os|pathlib|types|collections|numpy|scipy|matplotlib)\..*)",
    ),
    (
        r"py:.*",
        r"(Sets|When|Rows|ContactImpulses|NonSmoothDynamicalSystemBase|ContactSlot|Shape)",
    ),
    (r"py:.*", r"saltus\.(_core|registry|functions|io\.records)\..*"),
    (r"cpp:identifier", r".*"),
]

myst_enable_extensions = ["dollarmath", "deflist"]
myst_fence_as_directive = ["math"]
myst_heading_anchors = 4

default_role = "code"
autodoc_docstring_signature = False
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
napoleon_google_docstring = False
napoleon_use_rtype = False
if doxygen_is_here:
    extensions.append("breathe")

html_theme = "furo"
html_title = f"Saltus {version}"
html_static_path = ["site/static"]
html_css_files = ["site.css"]
html_copy_source = False
copybutton_prompt_text = "$ "
copybutton_only_copy_prompt_lines = True
