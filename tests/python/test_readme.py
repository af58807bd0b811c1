"""What README and documentation show runs as it stands, and what the guides name exists."""

import math
import re
import shlex
from pathlib import Path

import matplotlib.pyplot as plt
import pytest
import saltus.kernel as sk
import typer
from saltus.cli.app import app
from saltus.conformance.measure import stability_limit
from typer.testing import CliRunner

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
BLOCKS = [
    pytest.param(block, id=f"{page.name}-{number}")
    for page in PAGES
    for number, block in enumerate(re.findall(r"```python\n(.*?)```", page.read_text(), flags=re.DOTALL))
    if "hopper" not in block  # tested below
]
CONSOLES = [
    pytest.param(block, id=f"{page.stem}-{number}")
    for page in PAGES
    for number, block in enumerate(re.findall(r"```console\n(.*?)```", page.read_text(), flags=re.DOTALL))
]


# Now: while tests run, schemes of their own join the table, and those need no page.
SCHEMES = {entry["name"]: entry["properties"] for entry in sk.integrators()}


@pytest.mark.parametrize("block", BLOCKS)
def test_python_blocks_run(block, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(compile(block, "page", "exec"), {})  # noqa: S102
    plt.close("all")


def test_there_are_blocks():
    assert len(BLOCKS) >= 3
    assert len(CONSOLES) >= 6


def number(word):
    try:
        return float(word)
    except ValueError:
        return None


def says(line, quoted):
    """Is it the line that is quoted? Numbers within 2 %, times whatever they are; … stands for any word."""
    words, expected = line.split(), quoted.split()
    if len(words) != len(expected):
        return False
    for word, meant in zip(words, expected, strict=True):
        found, value = number(word), number(meant)
        if value is None or found is None:
            if meant not in (word, "…"):
                return False
        elif "µs" not in quoted and not math.isclose(found, value, rel_tol=0.02, abs_tol=1e-12):
            return False
    return True


@pytest.mark.parametrize("block", CONSOLES)
def test_commands_print_what_the_pages_quote(block, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    command, *lines = block.splitlines()
    result = CliRunner().invoke(app, shlex.split(command.removeprefix("$ saltus ")))
    assert result.exit_code == 0, result.output
    printed = result.stdout.splitlines()
    assert [line for line in lines if not any(says(line_, line) for line_ in printed)] == []


def test_the_table_of_schemes_is_that_of_the_registry():
    text = (ROOT / "docs/schemes/README.md").read_text()
    rows = {cells[0]: cells[1:] for cells in map(cells_of, text.splitlines()) if cells}
    assert set(rows) == set(SCHEMES)
    for name, row in rows.items():
        claims = SCHEMES[name]
        orders = [claims["order_free"], claims["order_bilateral"], claims["order_sliding"]]
        shown = [*map(str, orders[:2]), str(orders[2]) if claims["friction"] else "–"]
        words = ["no", "yes"]
        assert row[:5] == [*shown, words[claims["friction"]], words[claims["forces_at_rest"]]], name
        if claims["error_controlled"]:
            assert row[5] == "–", name
            continue
        limit = stability_limit(getattr(sk, name)).measured
        assert row[5] == "none up to 4" if limit == 4 else float(row[5]) == pytest.approx(limit, rel=1e-3), (
            name
        )


def cells_of(line):
    """Name of the scheme, and the other cells of its row in the table; nothing of another line."""
    found = re.match(r"\| \[(\w+OSI)\]\([\w-]+\.md\) \|(.*)\|$", line)
    return [found[1], *(cell.strip() for cell in found[2].split("|"))] if found else []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    for target in re.findall(r"\]\(([^)#:]+)\)", page.read_text()):
        assert (page.parent / target).exists(), target


def test_commands_of_the_guide_exist():
    text = (ROOT / "docs/compare.md").read_text()
    commands = typer.main.get_command(app).commands
    used = re.findall(r"saltus (models|compare|converge)\b", text)
    assert set(used) == {"models", "compare", "converge"}
    known = {name for word in used for option in commands[word].params for name in option.opts}
    assert {option for option in re.findall(r"--[a-z][a-z-]+", text)} <= known


def test_the_fixture_of_the_guide(pytester):
    text = (ROOT / "docs/compare.md").read_text()
    [block] = re.findall(r"```python\n(from hopper.*?)```", text, flags=re.DOTALL)
    pytester.makepyfile(hopper="from saltus.examples.bouncing_ball.bouncing_ball import build", test_it=block)
    pytester.runpytest_subprocess("test_it.py").assert_outcomes(failed=1)  # this ball penetrates more
    pytester.makepyfile(test_it=block.replace("1e-4", "1e-2"))
    pytester.runpytest_subprocess("test_it.py").assert_outcomes(passed=1)
