"""Studies: what is to be run, as a Python file declares it."""

from __future__ import annotations

import ast
import hashlib
import itertools
import json
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from numbers import Real
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from saltus import __version__, models, registry
from saltus._core import NonSmoothDynamicalSystemBase

INTEGRATORS = ("HalfExplicitTrapezoidalOSI",)
DECLARED = (
    "PARAMETERS",
    "INTEGRATORS",
    "TIME_STEPS",
    "UNTIL",
    "UNITS",
)  # every run has its own part of these

Value = float | int | bool | str  #: of a parameter


class Samples:
    """Random points, independent of each other: the first ones stay the same if there are to be more.

    Parameters
    ----------
    count : number of points
    seed : of numpy's default generator
    ranges : of each parameter, (low, high) for equal probability between them, or a distribution of
        scipy.stats, ``scipy.stats.norm(0.4, 0.05)``

    Raises
    ------
    ValueError
        If count is not positive, or a range is something else.
    """

    def __init__(self, count: int, *, seed: int, **ranges: Any) -> None:
        if count < 1 or not ranges:
            raise ValueError(f"samples must be at least one, of at least one parameter, got {count}")
        chances = np.random.default_rng(seed).random((count, len(ranges)))
        self._columns = {
            name: _quantiles(name, given, chances[:, k]) for k, (name, given) in enumerate(ranges.items())
        }
        self._count = count

    def __len__(self) -> int:
        return self._count

    def __iter__(self) -> Iterator[dict[str, Any]]:
        for k in range(self._count):
            yield {name: values[k] for name, values in self._columns.items()}


class Run(NamedTuple):
    """One run of a study."""

    identity: str  #: a hash of everything that decides its result
    parameters: dict[str, Any]  #: numbers and words by name
    integrator: str
    time_step: float  #: Δt [s]
    until: float  #: [s]


@dataclass(frozen=True)
class Study:
    """What a file declares: ``build``, TIME_STEPS and UNTIL, or ``MODEL``; and if wanted the rest.

    - ``build(**parameters)`` composes the model; or ``MODEL`` is its name, as `saltus.models.model` takes it
    - ``PARAMETERS``: lists by name, of which all combinations are run; or a list of points, each a mapping
      {name: value}; or `Samples`. Values are numbers and words
    - ``INTEGRATORS``: names with options, ``["HalfExplicitTrapezoidalOSI"]`` if not given
    - ``TIME_STEPS``: a list [s]
    - ``UNTIL``: a number [s], or a function ``UNTIL(**parameters)``
    - ``measure(trajectory)`` returns figures of a run by name, each a number or a list of numbers
    - ``UNITS``: of parameters and figures by name, as words
    """

    path: Path
    source: str
    points: Sequence[Mapping[str, Value]] = field(repr=False)
    integrators: tuple[str, ...]
    time_steps: tuple[float, ...]  #: [s]
    until: float | Callable[..., Any]
    units: Mapping[str, str]
    build: Callable[..., NonSmoothDynamicalSystemBase]
    measure: Callable[..., Mapping[str, Any]] | None
    code: str  #: a hash of what the file computes

    def __len__(self) -> int:
        return len(self.points) * len(self.integrators) * len(self.time_steps)

    def runs(self) -> Iterator[Run]:
        """All runs: integrators and time steps of the first point, then those of the next."""
        for point, integrator, time_step in itertools.product(self.points, self.integrators, self.time_steps):
            parameters = dict(point)
            until = self._until(parameters)
            decides = [__version__, self.code, parameters, integrator, time_step, until]
            text = json.dumps(decides, sort_keys=True)
            yield Run(_hash(text), parameters, integrator, time_step, until)

    def _until(self, parameters: Mapping[str, Value]) -> float:
        until = self.until(**parameters) if callable(self.until) else self.until
        return _positive("UNTIL", until)


def read_study(path: str | os.PathLike[str]) -> Study:
    """Read a study.

    Raises
    ------
    ValueError
        If there is no such file, it cannot be imported, or what it declares is something else than expected.
    """
    file = Path(path)
    if not file.is_file():
        raise ValueError(f"expected the Python file of a study, there is no file '{path}'")
    return make_study(file.read_text(encoding="utf-8"), file.resolve())


def make_study(source: str, path: Path) -> Study:
    """A study from the text of its file. Raises ValueError as `read_study` does."""
    try:
        module = _module(source, path)
    except Exception as error:
        raise ValueError(f"'{path.name}' cannot be imported: {type(error).__name__}: {error}") from error
    try:
        return _of_module(module, source, path)
    except (ValueError, TypeError) as error:
        raise ValueError(f"'{path.name}': {error}") from error


def _of_module(module: ModuleType, source: str, path: Path) -> Study:
    build: Any = getattr(module, "build", None)
    model = getattr(module, "MODEL", None)
    if callable(build) == isinstance(model, str):
        raise ValueError("expected either a function build(**parameters) or MODEL, the name of a model")
    about = models.model(model) if isinstance(model, str) else None
    parameters = getattr(module, "PARAMETERS", {})
    if about is not None and parameters:
        raise ValueError("a MODEL has no parameters, expected build(**parameters) with PARAMETERS")
    integrators = tuple(_list("INTEGRATORS", getattr(module, "INTEGRATORS", INTEGRATORS)))
    for name in integrators:
        if not isinstance(name, str):
            raise ValueError(f"INTEGRATORS must be names, 'MoreauJeanOSI(theta=1)', got {name!r}")
        registry.make_integrator(name)
    steps = getattr(module, "TIME_STEPS", [about.time_step] if about is not None and about.time_step else [])
    until = getattr(module, "UNTIL", None if about is None else about.until)
    if until is None:
        raise ValueError("expected UNTIL, the end of the runs in s")
    measure = getattr(module, "measure", None)
    if measure is not None and not callable(measure):
        raise ValueError(f"measure must be a function of a trajectory, got {measure!r}")
    return Study(
        path,
        source,
        _points(parameters),
        integrators,
        tuple(_positive("TIME_STEPS", step) for step in _list("TIME_STEPS", steps)),
        until,
        {str(name): str(unit) for name, unit in getattr(module, "UNITS", {}).items()},
        about.build if about is not None else build,
        measure,
        _hash("\n".join([_deciding(source), *_files([model, *integrators])])),
    )


def _module(source: str, path: Path) -> ModuleType:
    """The file as a module, which finds others beside it."""
    if str(path.parent) not in sys.path:
        sys.path.insert(0, str(path.parent))
    module = ModuleType(f"study_{path.stem}")
    module.__file__ = str(path)
    sys.modules[module.__name__] = module  # dataclasses look there
    exec(compile(source, str(path), "exec"), module.__dict__)  # noqa: S102
    return module


def _deciding(source: str) -> str:
    """What the file computes: without comments, and without declarations that nothing else in it reads."""
    tree = ast.parse(source)
    read = {
        node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)
    }
    free = set(DECLARED) - read

    def declares(node: ast.stmt) -> bool:
        targets = node.targets if isinstance(node, ast.Assign) else []
        return bool(targets) and all(isinstance(t, ast.Name) and t.id in free for t in targets)

    tree.body = [node for node in tree.body if not declares(node)]
    return ast.unparse(tree)


def _files(names: Sequence[str | None]) -> list[str]:
    """The texts of the Python files that stand in names, "file.py" and "file.py:Class"."""
    files = [Path(name.partition(".py")[0] + ".py") for name in names if name and ".py" in name]
    return [file.read_text(encoding="utf-8") for file in files if file.is_file()]


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:20]


def _points(given: Any) -> list[dict[str, Value]]:
    if isinstance(given, Mapping):
        lists = [[_plain(name, value) for value in _list(name, values)] for name, values in given.items()]
        return [dict(zip(given, values, strict=True)) for values in itertools.product(*lists)]
    if isinstance(given, Samples) or (isinstance(given, Sequence) and not isinstance(given, str)):
        points = list(given)
        if points and all(isinstance(point, Mapping) for point in points):
            return [{str(name): _plain(name, value) for name, value in point.items()} for point in points]
    raise ValueError(
        f"PARAMETERS must be lists by name, a list of points {{name: value}}, or Samples, got {given!r}"
    )


def _list(name: str, given: Any) -> list[Any]:
    if isinstance(given, (str, Mapping)) or not np.iterable(given) or not len(list(given)):
        raise ValueError(f"{name} must be a list of at least one value, got {given!r}")
    return list(given)


def _plain(name: str, value: Any) -> Value:
    """As a file can keep it."""
    plain = value.item() if isinstance(value, np.generic) else value
    if not isinstance(plain, (bool, int, float, str)):
        raise ValueError(f"parameter '{name}' must be a number or a word, got {value!r}")
    return plain


def _positive(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, Real) or not 0 < float(value) < float("inf"):
        raise ValueError(f"{name} must be positive and finite, in s, got {value!r}")
    return float(value)


def _quantiles(name: str, given: Any, chances: Any) -> Any:
    if hasattr(given, "ppf"):
        return given.ppf(chances)
    if isinstance(given, Sequence) and len(given) == 2 and all(isinstance(end, Real) for end in given):
        low, high = given
        return low + (high - low) * chances
    raise ValueError(f"{name} must be (low, high) or a distribution of scipy.stats, got {given!r}")
