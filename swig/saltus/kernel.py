"""Models, integrators and simulations of nonsmooth mechanics.

Every registered integrator is a factory of this module under its name, its options are keywords:
``HalfExplicitTrapezoidalOSI(activity="start")``, ``ExplicitMoreauJeanOSI()``.
"""

from __future__ import annotations

import os
import warnings
import weakref
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from saltus import _core, notebook, registry
from saltus._core import (
    Actuator,
    CheckItem,
    Configuration,
    ContactStage,
    Distance,
    Driven,
    EqualityConditionNSL,
    ForceElement,
    ForceLaw,
    Interaction,
    Joint,
    LagrangianDS,
    LagrangianLinearTIDS,
    LagrangianLinearTIR,
    LagrangianRheonomousR,
    LagrangianScleronomousR,
    NewtonEulerDS,
    NewtonImpactFrictionNSL,
    NewtonImpactNSL,
    NonSmoothLaw,
    OneStepIntegrator,
    Reactions,
    SimulationError,
    SphereBox,
    SpherePlane,
    SphereSphere,
    SpringDamper,
    State,
    StepFailure,
    StepReport,
    Tableau,
    integrators,
    neighbours,
    rotation_matrix,
)
from saltus.first_order import (
    BoxLaws,
    ComplementarityConditionNSL,
    EulerMoreauOSI,
    FirstOrderLinearDS,
    FirstOrderLinearR,
    FirstOrderLinearTIDS,
    FirstOrderLinearTIR,
    FirstOrderNonLinearDS,
    FirstOrderNonLinearR,
    FirstOrderReport,
    FirstOrderSystem,
    FirstOrderTimeStepping,
    MixedComplementarityConditionNSL,
    RelayNSL,
    ZeroOrderHoldOSI,
)
from saltus.io import Layout, Provenance, Trajectory
from saltus.io.checkpoints import pack, require_same
from saltus.io.hdf5 import read_checkpoint, read_run, write_run
from saltus.io.records import Continued, Loaded, Rows, plain
from saltus.io.stream import Stream
from saltus.registry import IntegratorFactory, register_integrator
from saltus.scene import Appearance, Fixture
from saltus.shapes import Box, Cylinder, Disc, Mesh, Polyline, Pose, Shape, Sphere, require_shape

if TYPE_CHECKING:
    from saltus.typing import FloatArray, OptionValue

__all__ = [
    "Actuator",
    "Box",
    "BoxLaws",
    "CheckReport",
    "ComplementarityConditionNSL",
    "Configuration",
    "ContactStage",
    "Cylinder",
    "Disc",
    "Distance",
    "Driven",
    "EqualityConditionNSL",
    "EulerMoreauOSI",
    "FirstOrderLinearDS",
    "FirstOrderLinearR",
    "FirstOrderLinearTIDS",
    "FirstOrderLinearTIR",
    "FirstOrderNonLinearDS",
    "FirstOrderNonLinearR",
    "FirstOrderReport",
    "FirstOrderSystem",
    "FirstOrderTimeStepping",
    "ForceElement",
    "ForceLaw",
    "Interaction",
    "Joint",
    "LagrangianDS",
    "LagrangianLinearTIDS",
    "LagrangianLinearTIR",
    "LagrangianRheonomousR",
    "LagrangianScleronomousR",
    "Mesh",
    "MixedComplementarityConditionNSL",
    "NewtonEulerDS",
    "NewtonImpactFrictionNSL",
    "NewtonImpactNSL",
    "NonSmoothDynamicalSystem",
    "NonSmoothLaw",
    "OneStepIntegrator",
    "Polyline",
    "Pose",
    "Reactions",
    "RelayNSL",
    "Shape",
    "SimulationError",
    "Sphere",
    "SphereBox",
    "SpherePlane",
    "SphereSphere",
    "SpringDamper",
    "StabilityWarning",
    "State",
    "StepFailure",
    "StepReport",
    "Tableau",
    "TimeStepping",
    "ZeroOrderHoldOSI",
    "integrators",
    "neighbours",
    "register_integrator",
    "rotation_matrix",
]


def __getattr__(name: str) -> IntegratorFactory:
    if any(entry["name"] == name for entry in integrators()):
        return registry.integrator(name)
    raise AttributeError(f"module 'saltus.kernel' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*__all__, *(entry["name"] for entry in integrators())]


def _storable(options: Mapping[str, OptionValue]) -> dict[str, Any]:
    """As a file can keep them."""

    def plain(value: OptionValue) -> Any:
        if not isinstance(value, Tableau):
            return value
        return {"name": value.name, "A": value.A.tolist(), "b": value.b.tolist()}

    return {name: plain(value) for name, value in options.items()}


@dataclass(frozen=True)
class CheckReport:
    """What `NonSmoothDynamicalSystem.check` found; prints as a table."""

    items: tuple[CheckItem, ...]

    @property
    def ok(self) -> bool:
        """True if every item is within its tolerance."""
        return all(item.ok for item in self.items)

    def __str__(self) -> str:
        lines = [
            f"{notebook.verdict_of(item):<3}  {item.subject:<16} {item.quantity:<42} "
            f"deviation {item.deviation:8.1e} (at most {item.tolerance:.0e})  {item.note}"
            for item in self.items
        ]
        return "\n".join(line.rstrip() for line in lines)

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return notebook.check_report(self)


class NonSmoothDynamicalSystem(_core.NonSmoothDynamicalSystemBase):
    """Dynamical systems, the interactions and the force elements between them, or with the ground.

    Positions q and velocities v of the whole are those of the systems, one after the other.

    Parameters
    ----------
    systems : the dynamical systems
    t0 : initial time [s]
    parameters : what the model was made with, by name, to be kept with its runs: numbers and words, or
        lists and mappings of them

    Raises
    ------
    ValueError
        If there is no system, one stands twice, t0 is not finite, or parameters are something else.
    """

    def __init__(
        self,
        systems: Sequence[LagrangianDS],
        t0: float = 0.0,
        *,
        parameters: Mapping[str, Any] | None = None,
    ) -> None:
        self._systems = tuple(systems)
        self._parameters = plain(parameters or {})
        self._numbers = {id(ds): number for number, ds in enumerate(self._systems)}
        self._links: list[tuple[Interaction, tuple[int, ...]]] = []
        self._scenery: list[tuple[Shape, Fixture]] = []
        super().__init__(list(self._systems), t0)

    @property
    def systems(self) -> tuple[LagrangianDS, ...]:
        """The dynamical systems, in the order of their freedoms."""
        return self._systems

    @property
    def parameters(self) -> Mapping[str, Any]:
        """What the model was made with, by name."""
        return self._parameters

    @property
    def links(self) -> Sequence[tuple[Interaction, tuple[int, ...]]]:
        """The interactions, and the numbers of the one or two systems that each acts on."""
        return self._links

    @property
    def scenery(self) -> Sequence[tuple[Shape, Fixture]]:
        """What pictures show around the systems."""
        return self._scenery

    def link(self, interaction: Interaction, ds1: LagrangianDS, ds2: LagrangianDS | None = None) -> None:
        """Let an interaction act between ds1 and the ground, or between ds1 and ds2.

        Raises
        ------
        ValueError
            If a system is not part of this one, the name is taken, or sizes disagree.
        """
        super().link(interaction, ds1, ds2)
        ends = [ds1] if ds2 is None else [ds1, ds2]
        self._links.append((interaction, tuple(self._numbers[id(ds)] for ds in ends)))

    def add_shape(self, shape: Shape, pose: Fixture = (0.0, 0.0, 0.0)) -> None:
        """Let pictures show something around the systems, such as a floor.

        Parameters
        ----------
        shape : a Disc, Box, Polyline, Sphere, Cylinder or Mesh
        pose : x [m], y [m], angle [rad]; or x, y, z [m] and a unit quaternion (w, x, y, z); or a function of
            the time [s] that returns one of these

        Raises
        ------
        TypeError
            If shape is not a shape. That a pose is wrong is found when a picture is made.
        """
        require_shape(shape)
        self._scenery.append((shape, pose))

    def check(self) -> CheckReport:
        """Compare mass, forces, jacobian and curvature with finite differences at the initial state.

        Normal rows of the Jacobian against the gap's gradient, curvature against the Jacobian's rate, the
        part of the forces that is even in v against what a varying mass matrix demands, forces at rest
        against the potential energy where it is defined ("see": forces without potential are no error),
        the Jacobian of force elements against the gradient of their length,
        gap and velocity of bilateral constraints against zero; gaps and relative velocities at t0 are noted.
        """
        return CheckReport(tuple(self.check_items()))

    def __repr__(self) -> str:
        return notebook.model_text(self)

    def _repr_html_(self) -> str:
        return notebook.model(self)


def _forces_at_rest(scheme: OneStepIntegrator) -> bool | None:
    """What the table of integrators says of a scheme, if it is there."""
    known = {entry["name"]: entry["properties"] for entry in integrators()}
    return known[scheme.name]["forces_at_rest"] if scheme.name in known else None


def _weakly(simulation: TimeStepping) -> Callable[[int], bytes]:
    """Checkpoints of a simulation that is not kept alive by who asks for them; empty when it is gone."""
    known = weakref.ref(simulation)

    def packed(rows: int) -> bytes:
        still = known()
        return b"" if still is None else still._packed(rows)

    return packed


class StabilityWarning(UserWarning):
    """The time step is too large for the scheme: free oscillations grow by more than 1 % in a period."""


class TimeStepping(_core.TimeSteppingBase):
    """Event-capturing simulation with fixed steps, t_k = t0 + k Δt.

    Parameters
    ----------
    system : NonSmoothDynamicalSystem, as it is now: interactions linked later are not seen
    integrator : made by a factory of this module, or a name: of one of them, "library:Class" of a plugin,
        "file.py:Class" of a Python class; options can follow, "MoreauJeanOSI(theta=0.5)"
    time_step : Δt > 0 [s]
    solver : name of a contact solver, see ``saltus.numerics.solvers()``, or of a plugin's or a Python class
    tolerance : of the contact problems, relative to the terms that cancel in them. For many contacts that
        depend on each other 1e-8 is several times cheaper than the default
    record_every : keep every n-th row, and all impulsive steps
    file : HDF5 file that rows go to while the run goes on, instead of the memory. A run that is there is
        replaced. The file can be read at any time with `saltus.io.read_hdf5`, also if the program is
        killed: then at most the last second, or the last 4 MiB, is missing.
    resume : go on with the run that is in the file, from its last checkpoint, with the bits of a run that was
        never interrupted; if there is no file, begin. A Python integrator that carries something from step to
        step must have `memory` and `remember`

    Raises
    ------
    ValueError
        If Δt is not positive and finite, a name is unknown, the integrator or the solver cannot take the
        model, or the model's mass, forces, gaps or Jacobians are not finite at t0; if the run to resume is of
        another model or simulation.
    OSError
        If the file cannot be written, FileExistsError if there is another file than a run.

    Warns
    -----
    StabilityWarning
        If the fastest free oscillation of the linear time-invariant systems, with the force elements between
        them, grows by more than 1 % in a period; it names the largest Δt at which it does not grow, or, if
        it always does, by less than that. Contacts and systems that are not linear are not judged.
    """

    def __init__(
        self,
        system: NonSmoothDynamicalSystem,
        integrator: OneStepIntegrator | str,
        time_step: float,
        *,
        solver: str = "auto",
        tolerance: float = 1e-12,
        record_every: int = 1,
        file: str | os.PathLike[str] | None = None,
        resume: bool = False,
    ) -> None:
        if not isinstance(system, NonSmoothDynamicalSystem):
            raise TypeError(f"system must be a NonSmoothDynamicalSystem, got {type(system).__name__}")
        scheme = registry.make_integrator(integrator) if isinstance(integrator, str) else integrator
        if not isinstance(scheme, OneStepIntegrator):
            hint = f": call it, {scheme.name}()" if isinstance(scheme, IntegratorFactory) else ""
            raise TypeError(f"integrator must be a OneStepIntegrator or a name, got {integrator!r}{hint}")
        if not isinstance(time_step, Real):
            raise TypeError(f"time_step must be a number, got {type(time_step).__name__}")
        super().__init__(system, scheme, float(time_step), registry.solver(solver), tolerance)
        if (unstable := _core.stability_warning(system, scheme, float(time_step))) is not None:
            warnings.warn(unstable, StabilityWarning, stacklevel=2)
        layout = Layout.of(system.contacts(), [ds.coordinates for ds in system.systems])
        provenance = Provenance(
            scheme.name,
            plain(_storable(scheme.options)),
            float(time_step),
            solver,
            int(record_every),
            system.parameters,
            float(tolerance),
            _forces_at_rest(scheme),
        )
        self._start: dict[str, Any] = {"t0": system.t0, "q0": self.q, "v0": self.v}
        self._look: Appearance = Appearance.of(system)
        if resume and file is None:
            raise ValueError("resume needs a file to go on with, got none")
        before = None
        if resume and file is not None and os.path.exists(file):
            rows = self._go_on(file, layout, provenance)
            before = (file, rows) if self.steps else None
        recording = _core.Recording(record_every)
        self.add_observer(recording)
        self._stream: Stream | None = (
            None
            if file is None
            else Stream(file, recording, layout, provenance, self._look, _weakly(self), before)
        )
        self._source: Rows = self._stream or recording
        self._trajectory: Trajectory = Trajectory(self._source, layout, provenance, self._look)

    @property
    def trajectory(self) -> Trajectory:
        """What is recorded so far."""
        return self._trajectory

    def run(self, until: float, progress: Callable[[float], None] | bool | None = None) -> Trajectory:
        """Take all steps with t_k <= until (1 + 1e-12), never a shortened one.

        A further call continues the same trajectory. `progress` is called with the time every few hundred
        steps; True shows steps, steps a second and what remains. However the run ends, what was recorded is
        then in the file, if there is one. Ctrl-C ends it after the step that is being taken.

        Raises
        ------
        SimulationError
            If a step cannot be taken; its ``trajectory`` is what was recorded so far.
        ValueError
            If until is not finite.
        OSError
            If the file can no longer be written.
        KeyboardInterrupt
            After Ctrl-C; it says how to go on.
        """
        try:
            if progress is True:
                from saltus.progress import shown

                with shown(self, until) as report:
                    self.advance(until, report)
            else:
                self.advance(until, progress or None)
        except SimulationError as error:
            error.trajectory = self._trajectory
            raise
        except KeyboardInterrupt as error:
            how = "resume=True goes on with it" if self._stream else "run() goes on, save() keeps it"
            raise KeyboardInterrupt(
                f"the run ended after step {self.steps} at t = {self.t:g} s; {how}"
            ) from error
        finally:
            self._close_file()
        return self._trajectory

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the run so far, and all that it takes to go on with it: see `load`.

        The file is that of `Trajectory.to_hdf5`, an existing run is replaced as a whole.

        Raises
        ------
        OSError
            If the file cannot be written, FileExistsError if there is another file than a run; what was
            there is untouched.
        """
        run = self._trajectory
        checkpoint = self._packed(len(run))
        return write_run(path, self._source, run.layout, run.provenance, run.scene, checkpoint)

    def load(self, path: str | os.PathLike[str]) -> None:
        """Go on with a run that `save` wrote, or a simulation with ``file=``, with the same bits.

        Model, integrator, Δt, solver and tolerance must be those of that run: what can be compared is. Rows
        recorded until then come first in the trajectory. Nothing in the file is executed.

        Raises
        ------
        ValueError
            If the file holds something else, or the run of another model or simulation; or this simulation
            writes to a file itself, whose run ``resume=True`` goes on with.
        OSError
            If the file cannot be read.
        """
        if self._stream is not None:
            raise ValueError("a simulation with file= goes on by resume=True, got load()")
        run = self._trajectory
        skip = self._source.rows
        rows = self._go_on(path, run.layout, run.provenance)
        columns = {name: column[:rows] for name, column in read_run(path)[0].columns().items()}
        recording = self._source.after if isinstance(self._source, Continued) else self._source
        if recording is not self._source:
            skip = recording.rows
        self._source = Continued(Loaded(rows, columns), recording, skip)
        self._trajectory = Trajectory(self._source, run.layout, run.provenance, self._look)

    def _go_on(self, path: str | os.PathLike[str], layout: Layout, provenance: Provenance) -> int:
        """Take the state of a run in a file; how many rows it has until then."""
        _, its_layout, its_provenance, _ = read_run(path)
        require_same(path, (its_layout, its_provenance), (layout, provenance))
        values = read_checkpoint(path)
        for name, start in self._start.items():
            if not np.array_equal(values[name], start):
                raise ValueError(
                    f"the run in '{path}' goes on only with a model of the same {name}, got another"
                )
        self.restore(values)
        return int(values["rows"])

    def _packed(self, rows: int) -> bytes:
        return pack({**self.checkpoint(), **self._start}, rows)

    def step(self) -> StepReport:
        """Take one step. Raises SimulationError if it cannot be taken."""
        try:
            return self.take_step()
        except SimulationError as error:
            error.trajectory = self._trajectory
            self._close_file()
            raise

    def observe(self, callback: Callable[[int, float, FloatArray, FloatArray, StepReport], object]) -> None:
        """Call ``callback(step, t, q, v, report)`` for row 0 and after every step."""
        self.add_callback(callback)

    def __repr__(self) -> str:
        scheme = self._trajectory.provenance.integrator
        return f"<TimeStepping {scheme}: t = {self.t:g} s, {self.steps} steps of {self.time_step:g} s>"

    def _close_file(self) -> None:
        if self._stream is not None:
            self._stream.close()
