"""Comparisons as JUnit XML: a test case for every limit of every run, so that CI servers name what broke."""

from __future__ import annotations

from collections.abc import Callable
from xml.etree import ElementTree as Xml

from saltus.compare import Comparison, Row

#: what a limit measures; the limits of a run, in their order
MEASURED: dict[str, Callable[[Row], float | None]] = {
    "max-error": lambda row: max((x for x in (row.error_q, row.error_v) if x is not None), default=None),
    "max-energy-drift": lambda row: row.energy_drift,
    "max-impulse-error": lambda row: row.impulse_error,
    "max-penetration": lambda row: row.penetration,
    "max-slowdown": lambda row: row.slowdown,
}


def to_junit(found: Comparison) -> str:
    """Test cases "INTEGRATOR, Δt = … s: LIMIT" of the class "saltus.MODEL"; a broken limit is a failure.

    Every run has a case "until", whether it reaches its end, also without any limit. The order has one for
    each integrator. The baseline has none.
    """
    broken = {(b.integrator, b.time_step, b.limit): b.message for b in found.breaches}
    suite = Xml.Element("testsuite", name=f"saltus compare {found.model}")
    for row in found.rows:
        if row.baseline:
            continue
        measured: dict[str, float | None] = {"until": row.end}
        measured |= {name: measure(row) for name, measure in MEASURED.items() if name in found.limits}
        for limit, value in measured.items():
            case = _case(found, suite, f"{row.integrator}, Δt = {row.time_step:g} s: {limit}", _seconds(row))
            _judge(case, broken.get((row.integrator, row.time_step, limit)), value)
    if "min-order" in found.limits:
        for integrator in dict.fromkeys(row.integrator for row in found.rows if not row.baseline):
            case = _case(found, suite, f"{integrator}: min-order", 0.0)
            _judge(case, broken.get((integrator, None, "min-order")), found.orders[integrator])
    suite.set("tests", str(len(suite)))
    suite.set("failures", str(sum(case.find("failure") is not None for case in suite)))
    suite.set("errors", "0")
    suite.set("skipped", "0")
    suite.set("time", f"{sum(float(case.get('time', 0)) for case in suite):.6f}")
    root = Xml.Element("testsuites")
    root.append(suite)
    Xml.indent(root)
    return Xml.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def _seconds(row: Row) -> float:
    return 0.0 if row.us_per_step is None else 1e-6 * row.us_per_step * row.steps


def _case(found: Comparison, suite: Xml.Element, name: str, seconds: float) -> Xml.Element:
    attributes = {"classname": f"saltus.{found.model}", "name": name, "time": f"{seconds:.6f}"}
    return Xml.SubElement(suite, "testcase", attributes)


def _judge(case: Xml.Element, message: str | None, value: float | None) -> None:
    if message is not None:
        Xml.SubElement(case, "failure", message=message, type="limit").text = message
    Xml.SubElement(case, "system-out").text = "cannot be told" if value is None else f"{value:.6g}"
