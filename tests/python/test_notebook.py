"""What notebooks show of models, runs and results, and a line of text about each."""

import re
from html.parser import HTMLParser

import numpy as np
import pytest
import saltus.kernel as sk
import saltus.numerics as sn
from saltus.examples.disc_pile import disc_pile
from saltus.examples.dry_friction import dry_friction
from test_models import Circle, Pendulum, ball


class Cells(HTMLParser):
    """Rows of all tables as text; opened elements are closed again."""

    def __init__(self, text):
        super().__init__()
        self.rows, self.open, self.title = [], [], ""
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        assert tag in ("div", "b", "table", "tr", "td", "th"), tag
        self.open.append(tag)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open[-1] == "b":
            self.title += data
        else:
            self.rows[-1][-1] += data


def shown(thing):
    cells = Cells(thing._repr_html_())
    return cells.title, cells.rows


def facts(rows):
    return {row[0]: row[1] for row in rows if len(row) == 2}


def linked():
    """A point on a circle with a wall, and a free pendulum."""
    point = sk.LagrangianLinearTIDS([1.0, 0.0], [0.0, 0.0], np.eye(2))
    pendulum = Pendulum([0.25], [0.5])
    system = sk.NonSmoothDynamicalSystem([point, pendulum], parameters={"μ": 0.3, "<b>": "</td>"})
    system.link(sk.Interaction(Circle(), sk.EqualityConditionNSL(1), "rod"), point)
    wall = sk.LagrangianLinearTIR([[1.0, 0.0], [0.0, 1.0]])
    system.link(
        sk.Interaction(wall, sk.NewtonImpactFrictionNSL(0.5, 0.0, 0.3, 2), "<script>alert(1)</script>"), point
    )
    both = sk.LagrangianLinearTIR([[1.0, 0.0, -1.0]], [3.0])
    system.link(sk.Interaction(both, sk.NewtonImpactNSL(0.25), "pair"), point, pendulum)
    return system


def test_a_model_is_shown_with_its_systems_and_contacts():
    system = linked()
    assert repr(system) == "<NonSmoothDynamicalSystem: 2 systems, 3 freedoms, 3 contacts>"
    title, rows = shown(system)
    assert title == "NonSmoothDynamicalSystem"
    assert facts(rows)["parameters"] == "μ = 0.3, <b> = </td>"
    assert rows[-7:] == [
        ["system", "class", "freedoms", "coordinates"],
        ["0", "LagrangianLinearTIDS", "2", "2"],
        ["1", "Pendulum", "1", "1"],
        ["contact or constraint", "law", "systems"],
        ["rod", "EqualityConditionNSL(1)", "0, ground"],
        [
            "<script>alert(1)</script>",
            "NewtonImpactFrictionNSL(restitution=0.5, tangential_restitution=0, friction=0.3)",
            "0, ground",
        ],
        ["pair", "NewtonImpactNSL(restitution=0.25)", "0, 1"],
    ]


def test_names_are_harmless():
    for thing in (linked(), sk.TimeStepping(linked(), "HalfExplicitTrapezoidalOSI", 1e-3).run(0.01)):
        text = thing._repr_html_()
        assert "<script" not in text
        assert "&lt;script&gt;" in text


def test_systems_interactions_and_laws():
    ds = sk.NewtonEulerDS([0, 0, 1, 1, 0, 0, 0], [1, 2, 3, 0, 0, 0], 2.0, [0.1, 0.2, 0.3])
    assert repr(ds) == "<NewtonEulerDS: 6 freedoms, 7 coordinates>"
    assert shown(ds)[1][2:] == [["q0", "0, 0, 1, 1, 0, 0, 0"], ["v0", "1, 2, 3, 0, 0, 0"]]
    assert repr(Pendulum([0.1], [0.0])) == "<Pendulum: 1 freedom>"
    wall = sk.Interaction(sk.LagrangianLinearTIR([[1.0]]), sk.NewtonImpactNSL(0.5), "wall")
    assert repr(wall) == "<Interaction 'wall': NewtonImpactNSL(restitution=0.5)>"
    assert shown(wall)[1] == [["name", "wall"], ["law", "NewtonImpactNSL(restitution=0.5)"], ["rows", "1"]]
    assert wall.law.description == {"name": "NewtonImpactNSL", "restitution": 0.5}
    assert sk.EqualityConditionNSL(2).description == {"name": "EqualityConditionNSL"}


def test_a_class_that_is_not_initialised_can_be_shown():
    class Careless(sk.LagrangianDS):
        def __init__(self):
            assert repr(self) == "<Careless, not initialised>"
            super().__init__([0.0], [0.0], [[1.0]])

    assert repr(Careless()) == "<Careless: 1 freedom>"


def test_a_run_is_shown_without_reading_it():
    simulation = sk.TimeStepping(disc_pile.build(), disc_pile.SCHEME, 1e-3, record_every=5)
    trajectory = simulation.run(0.02)
    assert repr(simulation) == "<TimeStepping HalfExplicitTrapezoidalOSI: t = 0.02 s, 20 steps of 0.001 s>"
    title, rows = shown(trajectory)
    assert title == "Trajectory"
    known = facts(rows)
    assert (known["rows"], known["t [s]"]) == ("5", "0 … 0.02")
    assert (known["coordinates"], known["Δt [s]"], known["every … step"]) == ("48", "0.001", "5")
    assert "activity = sticky" in known["options"]
    assert ["0 on floor", "2", "NewtonImpactFrictionNSL", "0", "0", "0.4"] in rows
    assert rows[-1] == ["and 156 more"]
    assert len(rows) < 30
    read = []
    columns = trajectory.columns()
    trajectory._columns = type(
        "Watched", (dict,), {"__getitem__": lambda self, name: read.append(name) or columns[name]}
    )()
    trajectory._repr_html_()
    assert set(read) == {"t"}


def test_a_contact_is_shown_with_its_extremes_and_states():
    trajectory = sk.TimeStepping(dry_friction.block(0.2), "HalfExplicitTrapezoidalOSI", 1e-3).run(3.0)
    plane = trajectory["plane"]
    assert repr(plane) == "<ContactRecord 'plane': NewtonImpactFrictionNSL, 3001 rows>"
    title, rows = shown(plane)
    assert title == "ContactRecord of plane"
    assert facts(rows)["largest force [N]"] == f"{2.0 * 9.81 * np.cos(0.2):g}"
    assert facts(rows)["friction"] == "0.3"
    assert rows[-3:] == [["state", "rows"], ["stick", "862"], ["slip", "2139"]]


def test_first_order_models_and_runs():
    ds = sk.FirstOrderLinearTIDS([1.0, 2.0], [[-1.0, 0.0], [0.0, -1.0]])
    assert repr(ds) == "<FirstOrderLinearTIDS: 2 states>"
    assert shown(ds)[1] == [["states", "2"], ["x0", "1, 2"]]
    system = sk.FirstOrderSystem([ds])
    relation = sk.FirstOrderLinearTIR([[1.0, 0.0]], [[1.0], [0.0]], [[1.0]])
    system.link(relation, sk.ComplementarityConditionNSL(1), ds, name="a < b")
    assert repr(system) == "<FirstOrderSystem: 2 states, 1 interaction>"
    assert shown(system)[1][-2:] == [["interaction", "entries of y"], ["a < b", "1"]]
    simulation = sk.FirstOrderTimeStepping(system, sk.EulerMoreauOSI(theta=0.5), 0.1)
    title, rows = shown(simulation.run(1.0))
    assert repr(simulation) == "<FirstOrderTimeStepping EulerMoreauOSI: t = 1 s, 10 steps of 0.1 s>"
    assert title == "FirstOrderTrajectory"
    assert facts(rows)["options"] == "theta = 0.5, gamma = 1, gamma_for_relation = no"
    assert rows[-1] == ["a < b", "1"]


def test_problems_and_their_solutions():
    given = sn.FrictionProblem(np.eye(4), [-1.0, 0.0, -1.0, 0.5], 0.3, 2)
    title, rows = shown(given)
    assert (title, facts(rows)["laws"]) == ("FrictionProblem", "Coulomb = 2")
    known = facts(shown(given.solve())[1])
    assert (known["status"], known["the only one"]) == ("solved", "yes")
    assert [float(x) for x in known["solution"].split(",")] == pytest.approx([1.0, 0.0, 1.0, -0.3])
    found = sn.solve([[2.0]], [-1.0], [sn.NonNegative()])
    known = facts(shown(found)[1])
    assert (known["P [N s]"], known["ξ [m/s]"], known["residual [m/s]"]) == ("0.5", "0", "0")
    long = sn.lcp(np.eye(1000), -np.ones(1000))
    assert facts(shown(long)[1])["solution"].endswith("1, … (1000 in all)")


def test_a_check_shows_what_is_wrong_first():
    class Wrong(Circle):
        def jacobian(self, q, out):
            out[0] = 2.0 * q

    point = sk.LagrangianLinearTIDS([0.6, 0.8], [0.8, -0.6], np.eye(2))
    system = sk.NonSmoothDynamicalSystem([point])
    system.link(sk.Interaction(Wrong(), sk.EqualityConditionNSL(1), "rod"), point)
    _, rows = shown(system.check())
    assert rows[0] == ["ok", "no"]
    assert [row[:2] for row in rows[2:4]] == [["BAD", "rod"], ["BAD", "rod"]]
    assert rows[4][0] == "ok"
    assert "BAD  rod" in repr(system.check())


def test_colours_are_those_of_the_page():
    """No fixed colour of text or ground: both are the theme's."""
    text = ball()._repr_html_()
    styles = re.findall(r'style="([^"]*)"', text)
    assert len(styles) > 10
    colors = {
        value.strip() for style in styles for value in re.findall(r"(?:color|background): ([^;]*)", style)
    }
    assert colors == {"inherit", "transparent"}
    assert all("background: transparent" in style for style in styles)
