"""The reference of the command line, from the commands themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import typer
from docutils import nodes
from docutils.statemachine import StringList
from saltus.cli.app import app as saltus
from sphinx.util.docutils import SphinxDirective

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sphinx.application import Sphinx


def commands(group: Any, words: str = "saltus") -> Iterator[tuple[str, Any]]:
    """All commands with the words that call them."""
    for name, command in group.commands.items():
        if hasattr(command, "commands"):
            yield from commands(command, f"{words} {name}")
        else:
            yield f"{words} {name}", command


class CommandLine(SphinxDirective):
    """``{command-line}``: a section for each command."""

    def run(self) -> list[nodes.Node]:
        """Usage, purpose, arguments and options."""
        return [self.section(words, c) for words, c in commands(typer.main.get_command(saltus))]

    def section(self, words: str, command: Any) -> nodes.section:
        """One command."""
        context = typer.Context(command, info_name=words)
        usage = " ".join([words, *command.collect_usage_pieces(context)])
        section = nodes.section(ids=[words.replace(" ", "-")], names=[words])
        section += nodes.title(words, words)
        section += nodes.literal_block(usage, usage, language="sh")
        lines = [*(command.help or "").replace("\b\n", "").splitlines(), ""]
        for parameter in command.params:
            if (record := parameter.get_help_record(context)) and parameter.name != "help":
                lines += [f"`{record[0]}`", f": {' '.join(record[1].split()) or '—'}", ""]
        self.state.nested_parse(StringList(lines, words), self.content_offset, section)
        return section


def setup(app: Sphinx) -> dict[str, bool]:
    """Join the build."""
    app.add_directive("command-line", CommandLine)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
