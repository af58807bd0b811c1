"""What the pages show in C++ and on the command line exists, and the site leaves nothing out."""

import json
import re
import shlex
import subprocess
from importlib.util import find_spec
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest
import saltus
import saltus.kernel as sk
import typer
from matplotlib.figure import Figure
from saltus.cli.app import app
from saltus.examples.gallery import examples
from saltus.examples.work_precision import model_costs

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
EXAMPLES = examples()


def blocks(*languages):
    pattern = rf"^```(?:{'|'.join(languages)})\n(.*?)^```"
    return [
        pytest.param(block, id=f"{page.stem}-{number}")
        for page in PAGES
        for number, block in enumerate(re.findall(pattern, page.read_text(), flags=re.DOTALL | re.MULTILINE))
    ]


def compile_only(block, language, *options):
    command = ["g++", "-fsyntax-only", "-x", language, *options, "-"]
    done = subprocess.run(command, input=block, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("block", blocks("cpp"))
def test_cpp_blocks_compile(block):
    headers = ["-I", ROOT / "build/dev/include", "-I", "/usr/include/eigen3"]
    standard = "-std=c++20"
    if "<SiconosKernel.hpp>" in block:
        siconos = Path("/usr/include/siconos")
        if not siconos.exists():
            pytest.skip("Siconos's headers are not installed")
        standard = "-std=c++17"  # what these headers are written in
        folders = [siconos, *(folder for folder in siconos.iterdir() if folder.is_dir())]
        headers += [part for folder in folders for part in ("-isystem", folder)]
    compile_only(block, "c++", standard, *headers)


@pytest.mark.parametrize("block", blocks("c"))
def test_c_blocks_compile(block):
    compile_only(block, "c")


def commands(block):
    """The commands in lines of a shell, as words."""
    text = re.sub(r"\\\n\s*", " ", block)
    for line in text.splitlines():
        for command in re.split(r"&&", line):
            words = shlex.split(command, comments=True)
            if words:
                yield words


@pytest.mark.parametrize("block", blocks("sh", "bash"))
def test_shell_blocks_name_what_exists(block):
    presets = json.loads((ROOT / "CMakePresets.json").read_text())
    for word, *rest in commands(block):
        if word == "saltus":
            check_saltus(rest)
        elif word == "./saltus":
            assert rest[0] in ("demo", "test", "setup", "run")
        elif word == "cmake" and "--preset" in rest:
            kind = "buildPresets" if "--build" in rest else "configurePresets"
            assert rest[rest.index("--preset") + 1] in [preset["name"] for preset in presets[kind]]
        elif word.endswith("python") and rest[0] == "-m":
            assert find_spec(rest[1])
        elif word.endswith("python"):
            assert (ROOT / rest[0]).exists()
        elif word == "pip":
            extra = re.fullmatch(r"saltus\[(\w+)\]", rest[1])[1]
            assert f"\n{extra} = [" in (ROOT / "pyproject.toml").read_text()
        else:
            assert word in (
                "cmake",
                "g++",
                ".venv/bin/sphinx-build",
                "build/sanitize/tests/saltus_solvers_fuzz",
            )


def check_saltus(words):
    """The command has that name and these options, and files of the project that it names are there."""
    command, group = typer.main.get_command(app), []
    while hasattr(command, "commands") and words and words[0] in command.commands:
        command, words = command.commands[words[0]], words[1:]
        group.append(command)
    assert group, words
    if hasattr(command, "commands"):  # `saltus bench MODEL` stands for `saltus bench models MODEL`
        command = command.commands["models"]
    options = {name for option in command.params for name in option.opts}
    words = words[: words.index("--")] if "--" in words else words
    assert {word for word in words if word.startswith("--")} <= options
    for word in words:
        if word.startswith("examples/"):
            assert (ROOT / word.split(":")[0]).exists()


def test_every_name_of_the_kernel_is_in_the_reference():
    text = (ROOT / "docs/api/python-kernel.md").read_text()
    named = set(re.findall(r"auto(?:class|function):: (?:[\w.]+\.)?(\w+)", text))
    elsewhere = {name for name in sk.__all__ if getattr(sk, name).__module__ in ("saltus.shapes", "typing")}
    elsewhere |= {"Pose", "Shape"}  # types, with the shapes
    assert set(sk.__all__) - elsewhere <= named
    assert set(saltus.__all__) - {"__version__"} <= named


def test_every_page_is_in_the_table_of_contents():
    text = (ROOT / "docs/index.md").read_text()
    pages = {page.relative_to(ROOT / "docs").with_suffix("").as_posix() for page in PAGES[2:]}
    assert {page for page in pages if page not in text.split()} <= {
        "index",
        *(f"api/python-{part}" for part in ("kernel", "io", "numerics", "tools")),
    }


def test_every_example_shows_itself():
    folders = {path.stem for path in (ROOT / "examples").glob("*/*.py") if path.stem == path.parent.name}
    assert folders - set(EXAMPLES) == {"work_precision"}  # a study of the others


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_run_and_draw(name):
    example = EXAMPLES[name]
    shown = example.run()
    assert isinstance(example.picture(shown), Figure)
    plt.close("all")
    assert shown.q.shape[0] == len(shown) > 1
    assert example.CAPTION.endswith(".")
    assert "  " not in example.CAPTION


def test_the_costs_of_models_are_of_the_same_motions():
    ends = [
        sk.TimeStepping(model_costs.of_one(make)(), model_costs.TRAPEZOIDAL, 1e-3).run(0.2).q[-1]
        for make in (
            lambda: model_costs.Springs(*model_costs.START, np.eye(2)),
            lambda: model_costs.SpringsWithMass(*model_costs.START),
            lambda: model_costs.SpringsWithDerivatives(*model_costs.START),
            lambda: sk.LagrangianLinearTIDS(*model_costs.START, np.eye(2), model_costs.STIFFNESS * np.eye(2)),
        )
    ]
    assert np.ptp(ends, axis=0).max() < 1e-13


def test_the_costs_of_models_are_printed(capsys):
    model_costs.main(steps=400)
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 5 + 4 + 4 + 1
    assert all(float(cost) > 0 for line in lines for cost in re.findall(r" ([\d.e+]+)(?:,|$)", line))
