"""Pictures, made when the site is built: those of the examples, and those that the code of a page saves."""

from __future__ import annotations

import os
import re
import shutil
from contextlib import redirect_stdout
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
from docutils import nodes
from pages import ROOT
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import get_lexer_for_filename
from saltus.examples.gallery import Example, examples
from sphinx.util.docutils import SphinxDirective

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sphinx.application import Sphinx

BLOCK = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)
DPI = 130
RUNS = "runs"  #: folder of the site, for pages of runs


def folder_of(app: Sphinx, docname: str) -> Path:
    """Where the pictures of a page are made."""
    folder = Path(app.doctreedir) / "pictures" / docname
    folder.mkdir(parents=True, exist_ok=True)
    return folder


@cache  # in a build
def run_code(page: Path, folder: Path) -> None:
    """Run the Python of a page, each block on its own, in a folder where it saves pictures."""
    home = Path.cwd()
    os.chdir(folder)
    try:
        for number, block in enumerate(BLOCK.findall(page.read_text())):
            with redirect_stdout(None):
                exec(compile(block, f"{page.name}, block {number}", "exec"), {"__name__": "__main__"})
            plt.close("all")
    finally:
        os.chdir(home)


@cache
def draw(name: str, file: Path) -> None:
    """Run an example and draw it, and beside the picture write the page of the run."""
    example = examples()[name]
    shown = example.run()
    example.picture(shown).savefig(file, dpi=DPI)
    plt.close("all")
    shown.report(file.with_suffix(".html"), title=title_of(name), caption=example.WATCH)


class _Drawing(SphinxDirective):
    """What draws pictures."""

    def figure(self, picture: Path, caption: list[nodes.Node], alt: str) -> nodes.figure:
        """A picture with a caption."""
        page = Path(self.env.doc2path(self.env.docname))
        uri = Path(os.path.relpath(picture, page.parent)).as_posix()
        return nodes.figure("", nodes.image(uri=uri, alt=alt), nodes.caption("", "", *caption))

    def drawn(self, name: str) -> Path:
        """The picture of an example."""
        file = folder_of(self.env.app, "gallery") / f"{name}.png"
        draw(name, file)
        for source in files_of(name):
            self.env.note_dependency(str(source))
        return file

    def text(self, text: str) -> list[nodes.Node]:
        """A paragraph's nodes."""
        parsed, messages = self.parse_inline(text, lineno=self.lineno)
        return [*parsed, *messages]


class Picture(_Drawing):
    """``{picture} NAME``: of the example NAME, or NAME.png that a code block of the page saves; a caption."""

    required_arguments = 1
    has_content = True

    def run(self) -> list[nodes.Node]:
        """Draw it."""
        name, caption = self.arguments[0], " ".join(self.content)
        if not name.endswith(".png"):
            return [self.figure(self.drawn(name), self.text(caption), caption)]
        folder = folder_of(self.env.app, self.env.docname)
        run_code(Path(self.env.doc2path(self.env.docname)), folder)
        if not (folder / name).exists():
            raise self.error(f"no code block of this page saves {name}")
        return [self.figure(folder / name, self.text(caption), caption)]


class Gallery(_Drawing):
    """``{gallery}``: a section for each example."""

    def run(self) -> list[nodes.Node]:
        """Run and draw all of them; small pictures lead to the sections."""
        small = nodes.container(classes=["small-pictures"])
        for name in examples():
            image = self.figure(self.drawn(name), [], title_of(name))[0]
            link = nodes.reference("", "", image, nodes.Text(title_of(name)), refuri=f"#{label_of(name)}")
            small += nodes.paragraph("", "", link)
        return [small, *(self.section(name, example) for name, example in examples().items())]

    def section(self, name: str, example: Example) -> nodes.section:
        """Title, what it is, picture, and where to read it."""
        title, label = title_of(name), label_of(name)
        section = nodes.section(ids=[label], names=[label])
        section += nodes.title(title, title)
        std = self.env.domains.standard_domain
        std.labels[label] = (self.env.docname, label, title)
        std.anonlabels[label] = (self.env.docname, label)
        lead = (example.__doc__ or "").split("\n\n")[0].replace("\n", " ")
        section += nodes.paragraph("", "", nodes.Text(lead))
        section += self.figure(self.drawn(name), [nodes.Text(example.CAPTION)], title)
        page = nodes.reference("", "its motion in the browser", refuri=f"{RUNS}/{name}.html")
        section += nodes.paragraph("", "Watch ", page, nodes.Text(f". {example.WATCH}"))
        command = f"python -m {example.__name__}"
        section += nodes.literal_block(command, command, language="sh")
        sources = nodes.paragraph("", "Read it: ")
        for file in files_of(name):
            sources += [nodes.reference("", file.name, refuri=f"{page_of(file)}.html"), nodes.Text("  ")]
        section += sources
        return section


def title_of(name: str) -> str:
    """Heading of an example."""
    return name.replace("_", " ").capitalize()


def label_of(name: str) -> str:
    """Where its section is."""
    return f"example-{name.replace('_', '-')}"


def files_of(name: str) -> list[Path]:
    """The documents of an example, its own module first."""
    folder = ROOT / "examples" / name
    files = [file for file in folder.iterdir() if file.suffix in (".py", ".cpp", ".hpp")]
    return sorted(
        (file for file in files if file.name != "__init__.py"),
        key=lambda file: (file.name != f"{name}.py", file.name),
    )


def page_of(file: Path) -> str:
    """The page that shows a file of an example."""
    return file.relative_to(ROOT).as_posix().replace(".", "-")


def source_pages(app: Sphinx) -> Iterator[tuple[str, dict[str, str], str]]:
    """Files of examples, to be read on the site."""
    for name in examples():
        for file in files_of(name):
            lexer = get_lexer_for_filename(file.name)
            code = highlight(file.read_text(), lexer, HtmlFormatter(cssclass="highlight"))
            heading = file.relative_to(ROOT).as_posix()
            body = f"<h1>{heading}</h1><div class='highlight-{lexer.aliases[0]}'>{code}</div>"
            yield page_of(file), {"title": heading, "body": body}, "page.html"


def copy_runs(app: Sphinx, error: Exception | None) -> None:
    """Pages of runs join the site as they are."""
    if error is None:
        target = Path(app.outdir) / RUNS
        target.mkdir(exist_ok=True)
        for page in folder_of(app, "gallery").glob("*.html"):
            shutil.copy(page, target)


def setup(app: Sphinx) -> dict[str, bool]:
    """Join the build."""
    app.add_directive("picture", Picture)
    app.add_directive("gallery", Gallery)
    app.connect("html-collect-pages", source_pages)
    app.connect("build-finished", copy_runs)
    return {"parallel_read_safe": False, "parallel_write_safe": True}
