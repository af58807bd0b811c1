"""What a step costs by how a model is written: methods or compiled functions, linear, sparse, recorded.

``python -m saltus.examples.work_precision.model_costs`` prints the figures of docs/fast-models.md: the time
of a step [µs], the least of five runs, of which nothing is recorded where nothing else is said.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial
from math import cos, sin
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import saltus
import saltus.kernel as sk
from saltus.examples.elastic_bar import elastic_bar
from saltus.examples.slider_crank.slider_crank import build as slider_crank

if TYPE_CHECKING:
    from saltus.typing import FloatArray

REPEATS = 5
TRAPEZOIDAL, MOREAU, HEM5 = (
    "HalfExplicitTrapezoidalOSI",
    "MoreauJeanOSI",
    "HalfExplicitRungeKuttaOSI(tableau=HEM5)",
)
START = ([1.0, 0.0], [0.0, 1.0])  # of the models below, q0 and v0
STIFFNESS = 50.0  # [N/m]


class Pendulums(sk.LagrangianDS):
    """A double pendulum of unit masses and lengths."""

    def mass(self, q: FloatArray, out: FloatArray) -> None:
        """M(q)."""
        c = cos(q[0] - q[1])
        out[0, 0], out[0, 1], out[1, 0], out[1, 1] = 2.0, c, c, 1.0

    def forces(self, t: float, q: FloatArray, v: FloatArray, out: FloatArray) -> None:
        """Centrifugal forces and gravity."""
        s = sin(q[0] - q[1])
        out[0] = -s * v[1] ** 2 - 19.62 * sin(q[0])
        out[1] = s * v[0] ** 2 - 9.81 * sin(q[1])


def compiled_pendulums() -> sk.LagrangianDS:
    """The same with compiled functions."""

    @saltus.compiled
    def mass(q: FloatArray, out: FloatArray) -> None:
        c = np.cos(q[0] - q[1])
        out[0, 0], out[0, 1], out[1, 0], out[1, 1] = 2.0, c, c, 1.0

    @saltus.compiled
    def forces(t: float, q: FloatArray, v: FloatArray, out: FloatArray) -> None:
        s = np.sin(q[0] - q[1])
        out[0] = -s * v[1] ** 2 - 19.62 * np.sin(q[0])
        out[1] = s * v[0] ** 2 - 9.81 * np.sin(q[1])

    return sk.LagrangianDS(*START, mass, forces=forces)


class Springs(sk.LagrangianDS):
    """Two unit masses on springs; the mass is given or a method of a derived class."""

    def forces(self, t: float, q: FloatArray, v: FloatArray, out: FloatArray) -> None:
        """Of the springs."""
        out[0], out[1] = -STIFFNESS * q[0], -STIFFNESS * q[1]


class SpringsWithMass(Springs):
    """The same with the mass as a method."""

    def mass(self, q: FloatArray, out: FloatArray) -> None:
        """M."""
        out[0, 0] = out[1, 1] = 1.0


class SpringsWithDerivatives(SpringsWithMass):
    """The same with the derivatives of the forces."""

    def force_jacobians(self, t: float, q: FloatArray, v: FloatArray, out: FloatArray) -> None:
        """∂h/∂q and ∂h/∂v."""
        out[0, 0, 0] = out[0, 1, 1] = -STIFFNESS


def dense_bar(elements: int) -> sk.NonSmoothDynamicalSystem:
    """The elastic bar with its matrices as arrays."""
    p, nodes = elastic_bar.Parameters(), elements + 1
    length = p.L / elements
    mass = elastic_bar.assemble(elements, p.rho * p.S * length / 3, p.rho * p.S * length / 6)
    stiffness = elastic_bar.assemble(elements, p.E * p.S / length, -p.E * p.S / length)
    bar = sk.LagrangianLinearTIDS(np.zeros(nodes), np.full(nodes, -p.v0), mass.toarray(), stiffness.toarray())
    system = sk.NonSmoothDynamicalSystem([bar])
    first_node = sk.LagrangianLinearTIR(np.eye(1, nodes), [p.gap])
    system.link(sk.Interaction(first_node, sk.NewtonImpactNSL(0.0)), bar)
    return system


def cost(
    build: Callable[[], sk.NonSmoothDynamicalSystem], scheme: str, dt: float, steps: int, **options: Any
) -> float:
    """Time of a step [µs], the least of several runs."""
    found = []
    for _ in range(REPEATS):
        simulation = sk.TimeStepping(build(), scheme, dt, **{"record_every": 10**9, **options})
        start = time.perf_counter()
        simulation.run(dt * steps)
        found.append((time.perf_counter() - start) / steps * 1e6)
    return min(found)


def of_one(make: Callable[[], sk.LagrangianDS]) -> Callable[[], sk.NonSmoothDynamicalSystem]:
    """What composes a model of one system."""
    return lambda: sk.NonSmoothDynamicalSystem([make()])


def ladder(steps: int) -> Iterator[tuple[str, dict[str, float]]]:
    """Methods of a class and compiled functions; of the slider crank, classes and C++."""
    ways = {
        "Python class": of_one(lambda: Pendulums(*START)),
        "compiled": of_one(compiled_pendulums),
    }
    for scheme in (TRAPEZOIDAL, HEM5, MOREAU):
        yield (
            f"double pendulum, {scheme}",
            {way: cost(make, scheme, 1e-4, steps) for way, make in ways.items()},
        )
    for scheme in (TRAPEZOIDAL, MOREAU):
        yield (
            f"slider crank, {scheme}",
            {
                way: cost(partial(slider_crank, compiled=native), scheme, 1e-5, steps // 2)
                for way, native in (("Python class", False), ("C++", True))
            },
        )


def linear(steps: int) -> Iterator[tuple[str, dict[str, float]]]:
    """Two masses on springs in four ways."""
    ways: dict[str, Callable[[], sk.LagrangianDS]] = {
        "class with mass and forces": lambda: SpringsWithMass(*START),
        "… and force_jacobians": lambda: SpringsWithDerivatives(*START),
        "forces and a constant mass": lambda: Springs(*START, np.eye(2)),
        "LagrangianLinearTIDS": lambda: sk.LagrangianLinearTIDS(*START, np.eye(2), STIFFNESS * np.eye(2)),
    }
    for way, make in ways.items():
        yield way, {scheme: cost(of_one(make), scheme, 1e-4, steps) for scheme in (TRAPEZOIDAL, MOREAU)}


def sparse(steps: int) -> Iterator[tuple[str, dict[str, float]]]:
    """The elastic bar with sparse and with dense matrices."""
    bars: dict[str, Callable[[int], sk.NonSmoothDynamicalSystem]] = {
        "sparse": elastic_bar.build,
        "dense": dense_bar,
    }
    for elements in (10, 50, 200, 1000):
        dt, few = (5e-8, steps // 200) if elements == 1000 else (1e-7, steps // 10)
        yield (
            f"bar, {elements} elements",
            {
                f"{kind}, {scheme}": cost(partial(make, elements), scheme, dt, few)
                for kind, make in bars.items()
                for scheme in (TRAPEZOIDAL, MOREAU)
            },
        )


def recorded(steps: int) -> Iterator[tuple[str, dict[str, float]]]:
    """The slider crank in C++, nothing kept, every row in memory, and in a file."""
    with tempfile.TemporaryDirectory() as folder:
        ways: dict[str, dict[str, Any]] = {
            "nothing": {},
            "in memory": {"record_every": 1},
            "in a file": {"record_every": 1, "file": Path(folder) / "run.h5"},
        }
        costs = {
            way: cost(slider_crank, TRAPEZOIDAL, 1e-5, steps // 2, **options) for way, options in ways.items()
        }
    yield "slider crank, rows kept", costs


def main(steps: int = 20_000) -> None:
    """Print all tables."""
    for table in (ladder, linear, sparse, recorded):
        for name, costs in table(steps):
            figures = ", ".join(f"{way} {us:.3g}" for way, us in costs.items())
            print(f"{name} [µs a step]: {figures}")


if __name__ == "__main__":
    main()
