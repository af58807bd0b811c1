"""How models, runs and results look in a notebook: small tables of escaped text, in light and dark themes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from saltus._core import (
        CheckItem,
        ContactSolution,
        FirstOrderNonLinearDS,
        Interaction,
        LagrangianDS,
        NonSmoothLaw,
        ProblemSolution,
    )
    from saltus.first_order import FirstOrderSystem
    from saltus.io import ContactRecord, FirstOrderTrajectory, Layout, Trajectory
    from saltus.kernel import CheckReport, NonSmoothDynamicalSystem
    from saltus.numerics import Problem

MOST_ROWS = 12  #: of a table; the others are counted
MOST_LETTERS = 120  #: of a cell
MOST_NUMBERS = 12  #: of an array in a cell
# Colours are those of the page, lines are grey: both can be read on any background.
TABLE = "border-collapse: collapse; margin: 0.3em 0 0.6em 0; color: inherit; background: transparent"
CELL = (
    "text-align: left; padding: 0.15em 1.2em 0.15em 0; color: inherit; background: transparent; "
    "border: none; border-bottom: 1px solid rgba(128, 128, 128, 0.35)"
)
FAINT = "opacity: 0.7; font-weight: normal"


def card(title: str, facts: Mapping[str, Any], *tables: str) -> str:
    """HTML of an object: its title, facts by name, and tables made by `table`. All text is escaped."""
    rows = "".join(
        f'<tr style="background: transparent"><th style="{CELL}; {FAINT}">{escape(name)}</th>'
        f'<td style="{CELL}">{_cell(value)}</td></tr>'
        for name, value in facts.items()
    )
    return f'<div><b>{escape(title)}</b><table style="{TABLE}">{rows}</table>{"".join(tables)}</div>'


def table(head: Sequence[str], rows: Iterable[Sequence[Any]], count: int) -> str:
    """HTML of a table whose rows are counted: the first 12, and how many more there are."""
    if not count:
        return ""
    line = '<tr style="background: transparent">'
    first = "".join(f'<th style="{CELL}; {FAINT}">{escape(name)}</th>' for name in head)
    body = "".join(
        line + "".join(f'<td style="{CELL}">{_cell(value)}</td>' for value in row) + "</tr>"
        for row, _ in zip(rows, range(MOST_ROWS), strict=False)
    )
    more = count - MOST_ROWS
    rest = f'{line}<td colspan="{len(head)}" style="{CELL}; {FAINT}">and {more} more</td></tr>'
    return f'<table style="{TABLE}">{line}{first}</tr>{body}{rest if more > 0 else ""}</table>'


def _cell(value: Any) -> str:
    text = _text(value)
    return escape(text if len(text) <= MOST_LETTERS else text[: MOST_LETTERS - 1] + "…")


def _text(value: Any) -> str:
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, np.ndarray):
        shown = ", ".join(f"{x:g}" for x in value[:MOST_NUMBERS] + 0.0)  # no -0
        return shown + (f", … ({len(value)} in all)" if len(value) > MOST_NUMBERS else "")
    if isinstance(value, Mapping):
        return ", ".join(f"{name} = {_text(part)}" for name, part in value.items()) or "–"
    return str(value)


def type_name(thing: object) -> str:
    """Of its class."""
    return type(thing).__name__


def counted(number: int, what: str) -> str:
    """``1 contact``, ``2 contacts``."""
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


def dynamical_system(ds: LagrangianDS) -> str:
    """HTML of a mechanical system."""
    return card(
        type_name(ds), {"freedoms": ds.dimension, "coordinates": ds.coordinates, "q0": ds.q0, "v0": ds.v0}
    )


def dynamical_system_text(ds: LagrangianDS) -> str:
    """A line about it; classes in Python may not have called super().__init__() yet."""
    try:
        return f"<{type_name(ds)}: {_freedoms(ds)}>"
    except TypeError:
        return f"<{type_name(ds)}, not initialised>"


def _freedoms(of: LagrangianDS | NonSmoothDynamicalSystem) -> str:
    freedoms = counted(of.dimension, "freedom")
    return freedoms if of.coordinates == of.dimension else f"{freedoms}, {of.coordinates} coordinates"


def first_order_ds(ds: FirstOrderNonLinearDS) -> str:
    """HTML of a first-order system."""
    return card(type_name(ds), {"states": ds.dimension, "x0": ds.x0})


def first_order_ds_text(ds: FirstOrderNonLinearDS) -> str:
    """A line about it; classes in Python may not have called super().__init__() yet."""
    try:
        return f"<{type_name(ds)}: {counted(ds.dimension, 'state')}>"
    except TypeError:
        return f"<{type_name(ds)}, not initialised>"


def law_text(law: NonSmoothLaw) -> str:
    """Its class and parameters, or how many rows it has if there are none."""
    parameters = dict(law.description)
    name = parameters.pop("name")
    named = [f"{key}={_text(value)}" for key, value in parameters.items()]
    return f"{name}({', '.join(named) or law.size})"


def interaction_text(linked: Interaction) -> str:
    """A line about an interaction."""
    return f"<{type_name(linked)} {linked.name!r}: {linked.law!r}>"


def interaction(linked: Interaction) -> str:
    """HTML of an interaction."""
    return card(type_name(linked), {"name": linked.name, "law": linked.law, "rows": linked.law.size})


def model(system: NonSmoothDynamicalSystem) -> str:
    """HTML of a model: its systems, and its contacts with their laws and what they are between."""
    facts: dict[str, Any] = {
        "freedoms": system.dimension,
        "coordinates": system.coordinates,
        "t0 [s]": system.t0,
    }
    if system.parameters:
        facts["parameters"] = system.parameters
    systems = [
        (k, type_name(ds), ds.dimension, ds.coordinates) for k, ds in enumerate(system.systems[:MOST_ROWS])
    ]
    names = [contact[0] for contact in system.contacts()]
    contacts = [
        (name, linked.law, ", ".join(map(str, ends)) if len(ends) > 1 else f"{ends[0]}, ground")
        for name, (linked, ends) in zip(names[:MOST_ROWS], system.links[:MOST_ROWS], strict=True)
    ]
    return card(
        type_name(system),
        facts,
        table(("system", "class", "freedoms", "coordinates"), systems, len(system.systems)),
        table(("contact or constraint", "law", "systems"), contacts, len(names)),
    )


def model_text(system: NonSmoothDynamicalSystem) -> str:
    """A line about it."""
    parts = [
        counted(len(system.systems), "system"),
        _freedoms(system),
        counted(len(system.contacts()), "contact"),
    ]
    return f"<{type_name(system)}: {', '.join(parts)}>"


def first_order_model(system: FirstOrderSystem) -> str:
    """HTML of a first-order model: its systems and interactions."""
    facts: dict[str, Any] = {"states": system.dimension, "t0 [s]": system.t0}
    if system.parameters:
        facts["parameters"] = system.parameters
    return card(
        type_name(system),
        facts,
        table(("system", "states"), enumerate(system.dimensions), len(system.dimensions)),
        table(("interaction", "entries of y"), system.interactions, len(system.interactions)),
    )


def first_order_model_text(system: FirstOrderSystem) -> str:
    """A line about it."""
    parts = [counted(system.dimension, "state"), counted(len(system.interactions), "interaction")]
    return f"<{type_name(system)}: {', '.join(parts)}>"


def check_report(report: CheckReport) -> str:
    """HTML of what a check found."""
    rows = [
        (
            verdict_of(item),
            item.subject,
            item.quantity,
            f"{item.deviation:.1e}",
            f"{item.tolerance:.0e}",
            item.note,
        )
        for item in report.items
    ]
    rows.sort(key=lambda row: row[0] == "ok")  # what is to be seen first
    head = ("", "of", "compared", "deviation", "at most", "")
    return card(type_name(report), {"ok": report.ok}, table(head, rows, len(rows)))


def verdict_of(item: CheckItem) -> str:
    """What a line of a check amounts to: ok, BAD, or see, where a deviation is no error."""
    if item.deviation <= item.tolerance:
        return "ok"
    return "see" if item.advisory else "BAD"


def problem(given: Problem) -> str:
    """HTML of a problem for its own sake."""
    kinds = Counter(type_name(law) for law in given.sets)
    return card(type_name(given), {"unknowns": given.q.size, "laws": kinds, "q": given.q})


def run(trajectory: Trajectory) -> str:
    """HTML of a run: how it came about, how long it is, and its contacts with their laws."""
    facts = {**_span(trajectory), "coordinates": sum(trajectory.layout.coordinates), **_origin(trajectory)}
    return card(type_name(trajectory), facts, _contacts(trajectory.layout))


def first_order_run(trajectory: FirstOrderTrajectory) -> str:
    """HTML of a run of a first-order model."""
    layout = trajectory.layout
    facts = {**_span(trajectory), "states": sum(layout.systems), **_origin(trajectory)}
    interactions = table(("interaction", "entries of y"), layout.interactions, len(layout.interactions))
    return card(type_name(trajectory), facts, interactions)


def _span(trajectory: Trajectory | FirstOrderTrajectory) -> dict[str, Any]:
    rows = len(trajectory)
    time = f"{trajectory.t[0]:g} … {trajectory.t[-1]:g}" if rows else None
    return {"rows": rows, "t [s]": time}


def _origin(trajectory: Trajectory | FirstOrderTrajectory) -> dict[str, Any]:
    origin = trajectory.provenance
    facts = {
        "integrator": origin.integrator,
        "options": origin.options,
        "Δt [s]": origin.time_step,
        "contact solver": origin.solver,
        "parameters": origin.parameters,
        "recorded": f"{origin.created[:19]}, Saltus {origin.version}",
    }
    if origin.record_every != 1:
        facts["every … step"] = origin.record_every
    return {name: value for name, value in facts.items() if value != {}}


def _contacts(layout: Layout) -> str:
    rows = [
        (name, slot.rows, *asdict(slot.law).values())
        for name, slot in list(layout.contacts.items())[:MOST_ROWS]
    ]
    return table(("contact or constraint", "rows", "law", "ε_N", "ε_T", "μ"), rows, len(layout.contacts))


def contact(record: ContactRecord) -> str:
    """HTML of what happened in a contact: extremes, and in how many rows it was in which state."""
    from saltus.io.contact_states import ContactState  # whose records are shown by this module

    codes, counts = np.unique(record.states, return_counts=True)
    names = {state.value: state.name.lower() for state in ContactState}
    facts = {
        **{name: value for name, value in asdict(record.law).items() if value is not None},
        "smallest gap [m]": float(record.gap.min(initial=np.inf)),
        "largest force [N]": float(np.abs(record.force).max(initial=0.0)),
        "largest impulse [N s]": float(np.abs(record.impulse).max(initial=0.0)),
    }
    rows = [(names[code], count) for code, count in zip(codes.tolist(), counts.tolist(), strict=True)]
    return card(f"{type_name(record)} of {record.name}", facts, table(("state", "rows"), rows, len(rows)))


def solution(found: ProblemSolution) -> str:
    """HTML of a solution of a problem for its own sake."""
    facts = {
        "status": found.status,
        "solver": found.solver,
        "iterations": found.iterations,
        "residual": found.residual,
        "the only one": "not known" if found.unique is None else found.unique,
        "solution": found.solution,
    }
    return card(type_name(found), facts)


def contact_solution(found: ContactSolution) -> str:
    """HTML of a solution of a contact problem."""
    facts = {
        "status": found.status,
        "solver": found.solver,
        "iterations": found.iterations,
        "residual [m/s]": found.residual,
        "of terms up to [m/s]": found.scale,
        "P [N s]": found.P,
        "ξ [m/s]": found.xi,
    }
    return card(type_name(found), facts)
