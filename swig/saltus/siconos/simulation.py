"""Simulations as scripts drive them, step by step."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeAlias

from saltus import kernel as native
from saltus import registry
from saltus._core import FirstOrderLive, LiveState
from saltus.siconos.arrays import Named, NotThere, methods, refuse_late
from saltus.siconos.first_order_relations import EulerMoreauOSI, ZeroOrderHoldOSI
from saltus.siconos.model import NonSmoothDynamicalSystem, System
from saltus.siconos.numerics import SICONOS_DPARAM_TOL, SolverOptions

if TYPE_CHECKING:
    from saltus.io import FirstOrderTrajectory, Trajectory

FirstOrderIntegrator: TypeAlias = EulerMoreauOSI | ZeroOrderHoldOSI
Integrator: TypeAlias = native.OneStepIntegrator | FirstOrderIntegrator

SICONOS_OSNSP_TS_VELOCITY = 0


@dataclass
class Changes:
    """What is changed in the simulations of a script, None as it says, and those that it made."""

    integrator: str | None = None  #: as `saltus.registry.make_integrator` takes it
    solver: str | None = None
    time_step: float | None = None  #: [s]
    until: float | None = None  #: [s]
    compose: bool = False  #: the first simulation that would take a step raises Composed instead
    simulations: list[TimeStepping] = field(default_factory=list)


class Composed(BaseException):
    """A simulation that would start; no error that a script can catch.

    Parameters
    ----------
    simulation : its model is composed, no step is taken
    """

    def __init__(self, simulation: TimeStepping) -> None:
        super().__init__()
        self.simulation = simulation


_changes: Changes | None = None


def change(changes: Changes | None) -> None:
    """Let simulations that are made from now on follow `changes`, and be listed in them; None: no longer."""
    global _changes  # the script in between knows nothing of it
    _changes = changes


def _in_place_of_the_scripts(name: str) -> native.OneStepIntegrator:
    """The integrator of that name; impulsive steps in ten parts where the scheme can, and no option is given.

    The step of a script is chosen for Moreau-Jean. What bounces has an error of the length of the step in
    which it hits, whatever the order of the scheme.
    """
    scheme = registry.make_integrator(name)
    if "(" in name or "impulsive_substeps" not in scheme.options:
        return scheme
    return registry.make_integrator(f"{name}(impulsive_substeps=10)")


class TimeDiscretisation(Named):
    """t_k = t0 + k h.

    Raises NotImplementedError for anything else than two numbers, ValueError if h is not positive and finite.
    """

    def __init__(self, t0: float, h: float) -> None:
        try:
            self.t0, self.h = float(t0), float(h)
        except (TypeError, ValueError) as error:
            raise NotThere(f"TimeDiscretisation(t0, h) of two numbers is there, got {t0!r}, {h!r}") from error
        if not 0.0 < self.h < math.inf:
            raise ValueError(f"h must be positive and finite, got {self.h:g}")

    def currentTimeStep(self, k: int) -> float:
        """[s], whatever k is."""
        return self.h

    def getTk(self, k: int) -> float:
        """t_k [s]."""
        return self.t0 + k * self.h


class OneStepNSProblem(Named):
    """The contact problems of a simulation: any of the names of scripts, as one solver takes them all.

    Parameters
    ----------
    solver : id of a solver, as SICONOS_LCP_LEMKE; if it is left out, Saltus's choice

    Raises
    ------
    NotImplementedError
        If there is no such solver.
    """

    hints = {
        "setMaxSize": "problems are sized by the model",
        "setMStorageType": "storage follows from the model",
        "setNumericsVerboseMode": "solvers print nothing",
        "setKeepLambdaAndYState": "impulses of the step before are the first guess",
    }

    def __init__(self, solver: int | None = None) -> None:
        self._options = SolverOptions(200 if solver is None else solver)
        self._chosen = solver is not None

    def setSolverId(self, solver: int) -> None:
        self._options.solverId = SolverOptions(solver).solverId
        self._chosen = True

    def numericsSolverOptions(self) -> SolverOptions:
        return self._options

    @property
    def method(self) -> str:
        """Name of the solver in `saltus.numerics.solvers()`."""
        return self._options.method if self._chosen else "auto"


class FrictionContact(OneStepNSProblem):
    """Contact problems with friction in dim = 2 or 3 dimensions, which the laws say as well."""

    def __init__(self, dim: int, solver: int | None = None) -> None:
        if dim not in (2, 3):
            raise ValueError(f"dim must be 2 or 3, got {dim}")
        super().__init__(solver)


class TimeStepping(Named):
    """A simulation with steps of equal size, driven by the script.

    Parameters
    ----------
    nsds, td, osi, osnspb : model, steps, integrator and contact problems; the last two can be inserted later.
        Any integrator of `saltus.kernel` can be given

    Raises
    ------
    ValueError
        At the first step: what `saltus.kernel.TimeStepping` raises.
    """

    hints = {
        "setNewtonMaxIteration": "the iteration ends at rounding, or says that it does not",
        "setNewtonOptions": "linear models are known to be linear",
        "setWarnOnNonConvergence": "what does not converge is an error",
        "setPrintStat": "nothing is printed",
        "setName": "names are not asked",
        "setDisplayNewtonConvergence": "nothing is printed",
        "setComputeResiduY": "the iteration ends at the residuals of all equations",
        "setComputeResiduR": "likewise",
    }

    def __init__(
        self,
        nsds: NonSmoothDynamicalSystem,
        td: TimeDiscretisation,
        osi: Integrator | None = None,
        osnspb: OneStepNSProblem | None = None,
    ) -> None:
        if not isinstance(nsds, NonSmoothDynamicalSystem) or not isinstance(td, TimeDiscretisation):
            got = f"{type(nsds).__name__}, {type(td).__name__}"
            raise TypeError(f"expected a NonSmoothDynamicalSystem and a TimeDiscretisation, got {got}")
        self._nsds, self._td, self._osi = nsds, td, osi
        self._problem = osnspb or OneStepNSProblem()
        self._simulation: native.TimeStepping | native.FirstOrderTimeStepping | None = None
        self._h, self._substeps = td.h, 1
        self._until: float | None = None
        self._step = 0
        self._computed = False
        self._driven: list[Any] = []
        self._changes = _changes
        if _changes is not None:
            _changes.simulations.append(self)
            self._follow(_changes)

    def _follow(self, changes: Changes) -> None:
        self._until = changes.until
        dt = changes.time_step
        if dt is None:
            return
        self._substeps = max(1, round(self._h / dt))
        if dt > self._h:
            self._h = dt
        elif abs(self._substeps * dt - self._h) > 1e-9 * self._h:
            raise ValueError(
                f"a smaller time step must be a whole fraction of the script's, {self._h:g} s, got {dt:g} s"
            )

    def insertIntegrator(self, osi: Integrator) -> None:
        """Raises NotImplementedError once the simulation is made."""
        refuse_late(self.started, "the integrator")
        self._osi = osi

    def insertNonSmoothProblem(self, problem: OneStepNSProblem, id: int = SICONOS_OSNSP_TS_VELOCITY) -> None:
        if id != SICONOS_OSNSP_TS_VELOCITY:
            raise NotThere(f"one problem, SICONOS_OSNSP_TS_VELOCITY = 0, is there, got {id}")
        refuse_late(self.started, "the problem")
        self._problem = problem

    def associate(self, osi: Integrator, ds: System) -> None:
        """One integrator takes all systems. Raises NotImplementedError for a second one."""
        if self._osi is not None and osi is not self._osi:
            raise NotThere("one integrator for all systems is there, got another one")
        self._osi = osi

    def setNewtonTolerance(self, tolerance: float) -> None:
        """Iterations end at 1e-12 of the velocities. Raises NotImplementedError if that is wider.

        Those of first-order models end at 1e-12 of the terms that cancel, recomputed, whatever is said.
        """
        if tolerance < 1e-12 and not self._nsds._first_order:
            raise NotThere(f"Newton's iteration ends at 1e-12 of the velocities, got {tolerance:g}")

    def nonSmoothDynamicalSystem(self) -> NonSmoothDynamicalSystem:
        return self._nsds

    def oneStepNSProblem(self, id: int) -> OneStepNSProblem:
        return self._problem

    def initialize(self) -> None:
        """Make the simulation now; the first step does it as well."""
        if self._simulation is None:
            self._start()

    def _start(self) -> native.TimeStepping | native.FirstOrderTimeStepping:
        changes = self._changes or Changes()
        if changes.compose:
            raise Composed(self)
        integrator = changes.integrator or self._osi
        solver = changes.solver or self._problem.method
        tolerance = float(self._problem.numericsSolverOptions().dparam[SICONOS_DPARAM_TOL])
        if self._nsds._first_order:
            self._simulation = self._start_first_order(integrator, solver, tolerance)
        else:
            self._simulation = self._start_lagrangian(integrator, solver, tolerance)
        return self._simulation

    def _start_lagrangian(
        self, integrator: Integrator | str | None, solver: str, tolerance: float
    ) -> native.TimeStepping:
        if integrator is None or isinstance(integrator, FirstOrderIntegrator):
            got = f"{type(integrator).__name__}, which is for first-order systems" if integrator else "none"
            raise ValueError(f"expected an integrator, as MoreauJeanOSI(0.5), got {got}")
        dt = self._h / self._substeps
        scheme = _in_place_of_the_scripts(integrator) if isinstance(integrator, str) else integrator
        simulation = native.TimeStepping(
            methods(self._nsds).native(), scheme, dt, solver=solver, tolerance=tolerance
        )
        self._driven = [ds for ds in self._nsds._systems if methods(ds).driven()]
        systems = [ds._live for ds in self._nsds._systems]
        contacts = [interaction._live for interaction, _, _ in self._nsds._links]
        simulation.add_observer(LiveState(systems, contacts, dt, self._substeps))
        return simulation

    def _start_first_order(
        self, integrator: Integrator | str | None, solver: str, tolerance: float
    ) -> native.FirstOrderTimeStepping:
        if not isinstance(integrator, FirstOrderIntegrator | str):
            raise ValueError(f"expected EulerMoreauOSI(theta) for first-order systems, got {integrator!r}")
        simulation = native.FirstOrderTimeStepping(
            methods(self._nsds).first_order_native(),
            integrator if isinstance(integrator, str) else integrator.native(),
            self._h / self._substeps,
            solver=solver,
            tolerance=tolerance,
        )
        systems = [ds._live for ds in self._nsds._systems]
        relations = [interaction._live for interaction, _, _ in self._nsds._links]
        simulation.add_observer(FirstOrderLive(systems, relations))
        return simulation

    @property
    def started(self) -> bool:
        """Say whether the simulation was made, by its first step or by initialize()."""
        return self._simulation is not None

    @property
    def trajectory(self) -> Trajectory | FirstOrderTrajectory:
        """What was recorded, every step of it, as `saltus.kernel.TimeStepping` does."""
        return (self._simulation or self._start()).trajectory

    def hasNextEvent(self) -> bool:
        """Say whether there is a whole step before T."""
        T = self._nsds.finalT() if self._until is None else self._until
        rounding = min(1e-12 * abs(T), 1e-3 * self._h)  # as saltus.kernel.TimeStepping.run
        return self.nextTime() <= T + rounding

    def computeOneStep(self) -> None:
        """Take the step to nextTime(): all live views are then of that time.

        Again before nextStep(), it is the same step with the same result.

        Raises
        ------
        SimulationError
            If it cannot be taken.
        """
        if self._computed:
            return
        simulation = self._simulation or self._start()
        for _ in range(self._substeps):
            for ds in self._driven:  # the state has moved on
                ds.evaluated_at = math.nan
            simulation.step()
        self._computed = True

    def nextStep(self) -> None:
        """Accept the step. Raises RuntimeError if there is none."""
        if not self._computed:
            raise RuntimeError("expected computeOneStep() before nextStep(), got none")
        self._computed = False
        self._step += 1

    def run(self) -> None:
        """All steps to T."""
        while self.hasNextEvent():
            self.computeOneStep()
            self.nextStep()

    def startingTime(self) -> float:
        """Where the step starts [s]."""
        return self._nsds.t0() + self._step * self._h

    def nextTime(self) -> float:
        """Where the step ends [s]."""
        return self._nsds.t0() + (self._step + 1) * self._h

    def timeStep(self) -> float:
        """From startingTime() to nextTime() [s]."""
        return self._h

    advanceToEvent = computeOneStep
    processEvents = nextStep
    getTk = startingTime
    getTkp1 = nextTime
