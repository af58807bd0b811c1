"""Python's side of the reference: what autodoc cannot see of classes that are bound from C++."""

from __future__ import annotations

import ast
import re
import sys
from functools import cache
from itertools import pairwise
from typing import TYPE_CHECKING

from docutils import nodes
from docutils.statemachine import StringList
from pages import ROOT
from saltus.kernel import integrators
from sphinx.util.docutils import SphinxDirective

if TYPE_CHECKING:
    from sphinx.addnodes import pending_xref
    from sphinx.application import Sphinx
    from sphinx.environment import BuildEnvironment

STUBS = ROOT / "swig/saltus/_core.pyi"
PUBLIC = (
    "saltus.kernel",
    "saltus.io",
    "saltus.numerics",
    "saltus.shapes",
    "saltus.scene",
    "saltus.compare",
    "saltus.models",
    "saltus.conformance",
    "saltus.typing",
)
VALUES: dict[tuple[str, str], list[str]] = {}
ENTRY = re.compile(r"^(\*{0,2}\w[\w, *]*) : (.*)$")


@cache
def signatures() -> dict[str, tuple[str, str]]:
    """Arguments and result of what the stubs have, by ``Class.method``; of overloads those of the first."""
    found: dict[str, tuple[str, str]] = {}

    def keep(prefix: str, node: ast.FunctionDef) -> None:
        static = any(getattr(decorator, "id", "") == "staticmethod" for decorator in node.decorator_list)
        if prefix and not static:
            node.args.args = node.args.args[1:]
        result = ast.unparse(node.returns) if node.returns else ""
        found.setdefault(f"{prefix}{node.name}", (f"({ast.unparse(node.args)})", result))

    for node in ast.parse(STUBS.read_text()).body:
        if isinstance(node, ast.FunctionDef):
            keep("", node)
        if isinstance(node, ast.ClassDef):
            for member in node.body:
                if isinstance(member, ast.FunctionDef):
                    keep(f"{node.name}.", member)
    return found


def signature(
    app: Sphinx,
    what: str,
    name: str,
    obj: object,
    options: object,
    arguments: str | None,
    result: str | None,
) -> tuple[str | None, str | None] | None:
    """Of what C++ defines, the one in the stubs."""
    if what not in ("class", "method", "function"):
        return None
    *path, last = name.split(".")
    owner = getattr(sys.modules.get(".".join(path[:-1])), path[-1], None) if what == "method" else obj
    bases = [base.__name__ for base in getattr(owner, "__mro__", ()) if base.__module__ == "saltus._core"]
    names = {"class": f"{last}.__init__", "function": last}
    wanted = [f"{base}.{last}" for base in bases] if what == "method" else [names[what]]
    if what != "method" and not str(getattr(obj, "__module__", None) or "").startswith("saltus._core"):
        return None
    for key in wanted:
        if key in signatures():
            found = signatures()[key]
            return found[0], None if what == "class" else found[1]
    return arguments, result


def docstring(app: Sphinx, what: str, name: str, obj: object, options: object, lines: list[str]) -> None:
    """Docstrings as numpydoc and reStructuredText want to have them.

    Arguments stand as ``name : what it is`` here, types in the signature; indented lines are code.
    """
    if lines and re.match(rf"^{name.rsplit('.', 1)[-1]}\(.*\)", lines[0]):  # pybind11's own signature
        del lines[0]
    section, before, found = "", "", []
    for line, after in pairwise([*lines, ""]):
        if after.startswith("---"):
            section = line
        below = found and not found[-1] and line not in ("", "Parameters") and not ENTRY.match(line)
        if section == "Parameters" and below:  # a paragraph after the arguments
            section = "Notes"
            found += [section, "-----"]
        if section == "Parameters" and (entry := ENTRY.match(line)):
            found += [entry[1], f"    {entry[2]}"]
        elif line.startswith("    ") and not section:
            found += [line] if before.startswith("    ") else ["::", "", line]
        else:
            found.append(line if "`" in line else line.replace("|", r"\|"))
        before = line or before
    lines[:] = found
    VALUES[what, name] = found


def value(app: Sphinx, what: str, name: str, obj: object, options: object, lines: list[str]) -> None:
    """Of a value, what napoleon was given: it takes words before a colon for a type."""
    if what in ("property", "attribute", "data"):
        lines[:] = VALUES[what, name]


class Integrators(SphinxDirective):
    """``{integrators}``: the table of integrators, as it is registered."""

    def run(self) -> list[nodes.Node]:
        """A description of each."""
        lines: list[str] = []
        for entry in integrators():
            options = ", ".join(f"{name}={option['default']!r}" for name, option in entry["options"].items())
            lines += [f".. py:function:: {entry['name']}({options})", "   :module: saltus.kernel", ""]
            lines += [f"   {entry['summary']}.", ""]
            for name, option in entry["options"].items():
                choices = f" ({', '.join(option['choices'])})" if option["choices"] else ""
                lines.append(f"   :param {name}: {option['meaning']}{choices}")
            lines.append("")
        container = nodes.container()
        self.state.nested_parse(StringList(lines, "integrators"), self.content_offset, container)
        return list(container.children)


def public_name(
    app: Sphinx, env: BuildEnvironment, node: pending_xref, text: nodes.Node
) -> nodes.Node | None:
    """Annotations name classes by the module that defines them: find the one that is documented."""
    domain = env.domains.python_domain
    last = str(node.get("reftarget")).rsplit(".", 1)[-1]
    for module in PUBLIC:
        name = f"{module}.{last}"
        if node.get("refdomain") == "py" and name in domain.objects:
            return domain.resolve_xref(env, node["refdoc"], app.builder, "obj", name, node, text)
    return None


def setup(app: Sphinx) -> dict[str, bool]:
    """Join the build."""
    app.add_directive("integrators", Integrators)
    app.connect("autodoc-process-signature", signature)
    app.connect("missing-reference", public_name)
    app.connect("autodoc-process-docstring", docstring, priority=400)  # before napoleon
    app.connect("autodoc-process-docstring", value, priority=600)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
