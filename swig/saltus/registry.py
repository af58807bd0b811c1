"""Integrators and contact solvers by name: those of the library, of plugins, and of Python classes.

A name is one of the table, ``"library:Class"`` of a shared library, or ``"file.py:Class"`` or
``"package.module:Class"`` of a Python class; the last three join the table when they are first named.
Options of an integrator can follow its name: ``"MoreauJeanOSI(theta=0.5)"``.
"""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import re
import sys
from numbers import Real
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, TypeVar

from saltus import _core
from saltus._core import ContactSolver, OneStepIntegrator, Tableau, integrators, solvers

if TYPE_CHECKING:
    from saltus.typing import OptionEntry, OptionValue

Integrator = TypeVar("Integrator", bound=type[OneStepIntegrator])
Solver = TypeVar("Solver", bound=type[ContactSolver])

_registered: dict[str, type] = {}  # the Python classes in the tables

_OPTION = re.compile(
    r"""(?P<name>\w+)\s*=\s*(["']?)(?:(?P<word>[A-Za-z][\w-]*)|(?P<number>[-+.\d][-+.\w]*))\2"""
)


class IntegratorFactory:
    """Makes an integrator of the registry; its options are keywords, or stand in the order listed."""

    def __init__(self, name: str, summary: str, options: dict[str, OptionEntry]) -> None:
        self.name = name
        self._options = tuple(options)
        lines = [f"{key} = {about['default']!r}: {about['meaning']}" for key, about in options.items()]
        self.__doc__ = f"{summary}\n\nOptions\n-------\n" + ("\n".join(lines) or "none")

    def __call__(self, *values: OptionValue, **options: OptionValue) -> OneStepIntegrator:
        """Make the integrator. Raises ValueError if there is no such option or choice."""
        if len(values) > len(self._options):
            raise TypeError(f"{self.name} takes {len(self._options)} options, got {len(values)}")
        given = dict(zip(self._options, values, strict=False))
        for key, value in options.items():
            if key in given:
                raise TypeError(f"{self.name}: {key} is given twice")
            given[key] = value
        for key, value in given.items():
            if isinstance(value, bool) or not isinstance(value, (Real, str, Tableau)):
                kind = type(value).__name__
                raise TypeError(f"{self.name}: {key} must be a number, a word or a Tableau, got {kind}")
            if isinstance(value, Real):  # of numpy as well
                given[key] = float(value)
        return _core.make_integrator(self.name, given)

    def __repr__(self) -> str:
        return f"<integrator {self.name}>"


def integrator(name: str) -> IntegratorFactory:
    """The factory of an integrator, whatever it comes from.

    Raises
    ------
    ValueError
        If there is none of that name, or what the name says cannot be loaded.
    """
    known = _load(name, OneStepIntegrator) or (_core.load_integrator(name) if ":" in name else name)
    for entry in integrators():
        if entry["name"] == known:
            return IntegratorFactory(known, entry["summary"], entry["options"])
    raise ValueError(f"no integrator named '{name}', there are {', '.join(e['name'] for e in integrators())}")


def make_integrator(spec: str) -> OneStepIntegrator:
    """An integrator from a name, as `integrator` takes it, and options: ``"MoreauJeanOSI(theta=0.5)"``.

    Raises
    ------
    ValueError
        If there is none of that name, no such option or choice, or the options are not ``name=value, ...``
        with numbers and words.
    """
    name, options = parse(spec)
    return integrator(name)(**options)


def properties(spec: str) -> dict[str, Any]:
    """What holds for an integrator with its options, `spec` as in `make_integrator`: see `integrators`.

    Raises ValueError as `make_integrator` does.
    """
    scheme = make_integrator(spec)
    return _core.integrator_properties(scheme.name, scheme.options)


def label(scheme: OneStepIntegrator) -> str:
    """Its name, and in brackets the options that are not the standard ones."""
    standard = next((e["options"] for e in integrators() if e["name"] == scheme.name), {})
    options = [
        f"{key}={value.name if isinstance(value, Tableau) else value}"
        for key, value in scheme.options.items()
        if key not in standard or value != standard[key]["default"]
    ]
    return scheme.name + (f"({', '.join(options)})" if options else "")


def parse(spec: str) -> tuple[str, dict[str, OptionValue]]:
    """Name and options of "NAME(option=value, ...)". Raises ValueError if it is something else."""
    name, bracket, rest = spec.strip().partition("(")
    if not bracket:
        return name, {}
    options = _options(rest.removesuffix(")")) if rest.endswith(")") else None
    if options is None:
        raise ValueError(f"expected an integrator as NAME or NAME(option=value, ...), got '{spec}'")
    return name, options


def split_specs(text: str) -> list[str]:
    """The parts of "A, B(x=1, y=2)" between commas that stand in no brackets."""
    parts, depth = [""], 0
    for letter in text:
        depth += (letter == "(") - (letter == ")")
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts if part.strip()]


def _options(text: str) -> dict[str, OptionValue] | None:
    """The options in "name=value, ...", numbers and words, each once; None if it is something else."""
    options: dict[str, OptionValue] = {}
    for part in text.split(",") if text.strip() else ():
        found = _OPTION.fullmatch(part.strip())
        if found is None or found["name"] in options:
            return None
        try:
            options[found["name"]] = found["word"] or float(found["number"])
        except ValueError:
            return None
    return options


def solver(name: str) -> str:
    """Name in the table of a contact solver, whatever it comes from. Raises ValueError as `integrator`."""
    if not isinstance(name, str):
        raise TypeError(f"solver must be a name, got {type(name).__name__}")
    known = _load(name, ContactSolver) or (_core.load_contact_solver(name) if ":" in name else name)
    if known in solvers():
        return known
    raise ValueError(f"no contact solver named '{name}', there are {', '.join(solvers())}")


def register_integrator(cls: Integrator) -> Integrator:
    """Let an integrator written in Python join the table under the name of its class; a decorator.

    The first line of its docstring is the summary, the keywords of ``__init__`` with their defaults are its
    options, and an attribute `properties`, a dict, says what holds for it: see `integrators`.
    `saltus.conformance` checks that.

    Raises
    ------
    TypeError
        If it is no class of that kind, or an argument of ``__init__`` has no default.
    ValueError
        If the name is taken, or `properties` has an unknown key.
    """
    _require_class(cls, OneStepIntegrator)
    options: dict[str, float | str] = {}
    for parameter in inspect.signature(cls).parameters.values() if "__init__" in vars(cls) else ():
        if not isinstance(parameter.default, (int, float, str)):
            raise TypeError(f"{cls.__name__}: {parameter.name} must default to a number or a word")
        options[parameter.name] = (
            parameter.default if isinstance(parameter.default, str) else float(parameter.default)
        )
    _core.register_class(cls.__name__, _summary(cls), getattr(cls, "properties", {}), options, cls)
    _registered[cls.__name__] = cls
    return cls


def register_solver(cls: Solver) -> Solver:
    """Let a contact solver written in Python join the table under the name of its class; a decorator.

    Raises TypeError if it is no class of that kind, ValueError if the name is taken.
    """
    _require_class(cls, ContactSolver)
    _core.register_solver_class(cls.__name__, _summary(cls), cls)
    _registered[cls.__name__] = cls
    return cls


def _require_class(cls: object, base: type) -> None:
    if not inspect.isclass(cls) or not issubclass(cls, base) or cls is base:
        raise TypeError(f"expected a class derived from {base.__name__}, got {cls!r}")


def _summary(cls: type) -> str:
    return (inspect.getdoc(cls) or "").partition("\n")[0]


def _load(name: str, base: type) -> str | None:
    """Register the class that 'file.py:Class' or 'module:Class' names; None if it names no Python module."""
    source, _, class_name = name.rpartition(":")
    module = load_module(source)
    if module is None:
        return None
    cls: Any = getattr(module, class_name, None)
    if cls is None:
        raise ValueError(f"'{source}' has no class '{class_name}'")
    try:
        _require_class(cls, base)
    except TypeError as error:
        raise ValueError(f"'{name}': {error}") from error
    if _registered.get(cls.__name__) is not cls:
        register_integrator(cls) if base is OneStepIntegrator else register_solver(cls)
    return str(cls.__name__)


def load_module(source: str) -> ModuleType | None:
    """The module that a file "….py" or "package.module" is, loaded once; None if it names no Python module.

    Raises ValueError if there is no such file, or it cannot be imported.
    """
    if source.endswith(".py"):
        path = Path(source).resolve()
        if not path.is_file():
            raise ValueError(f"there is no file '{source}'")
        for module in list(sys.modules.values()):  # loading it twice would make its classes twice
            if getattr(module, "__file__", None) == str(path):
                return module
        spec = importlib.util.spec_from_file_location(path.stem, path)
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        # Under its path: two files of one name are two modules.
        sys.modules[str(path)] = module
        try:
            spec.loader.exec_module(module)
        except Exception as error:
            del sys.modules[str(path)]
            raise ValueError(f"'{source}' cannot be imported: {type(error).__name__}: {error}") from error
        return module
    if all(part.isidentifier() for part in source.split(".")) and _importable(source):
        return importlib.import_module(source)
    return None


def _importable(name: str) -> bool:
    try:
        return importlib.util.find_spec(name) is not None
    except ModuleNotFoundError:
        return False
