"""What README and documentation show runs as it stands, and what the guides name exists."""

import re
from pathlib import Path

import pytest
import typer
from saltus.cli.app import app

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
BLOCKS = [
    pytest.param(block, id=f"{page.name}-{number}")
    for page in PAGES
    for number, block in enumerate(re.findall(r"```python\n(.*?)```", page.read_text(), flags=re.DOTALL))
    if "hopper" not in block  # tested below
]


@pytest.mark.parametrize("block", BLOCKS)
def test_python_blocks_run(block, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(compile(block, "page", "exec"), {})  # noqa: S102


def test_there_are_blocks():
    assert len(BLOCKS) >= 3


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
