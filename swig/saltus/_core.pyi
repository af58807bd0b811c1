"""Types of the extension module."""

from collections.abc import Callable, Mapping, Sequence
from enum import Enum
from typing import Any, final, overload

from numpy.typing import ArrayLike

from saltus.io import FirstOrderTrajectory, Trajectory
from saltus.scene import Place
from saltus.shapes import Pose, Shape
from saltus.typing import (
    FloatArray,
    IntArray,
    IntegratorEntry,
    Matrix,
    ModelFunction,
    OptionValue,
    SparseMatrix,
)

__version__: str

# numerics

class Equality: ...
class NonNegative: ...

class Coulomb:
    def __init__(self, mu: float, dim: int = 2) -> None: ...
    @property
    def mu(self) -> float: ...
    @property
    def dim(self) -> int: ...

class ContactSolution:
    @property
    def P(self) -> FloatArray: ...
    @property
    def xi(self) -> FloatArray: ...
    @property
    def status(self) -> str: ...
    @property
    def solver(self) -> str: ...
    @property
    def residual(self) -> float: ...
    @property
    def scale(self) -> float: ...
    @property
    def iterations(self) -> int: ...

def solve(
    G: ArrayLike | Matrix,
    b: ArrayLike,
    sets: Sequence[Equality | NonNegative | Coulomb],
    solver: str = "auto",
    warm_start: ArrayLike | None = None,
) -> ContactSolution: ...

class ProblemSolution:
    @property
    def solution(self) -> FloatArray: ...
    @property
    def status(self) -> str: ...
    @property
    def solver(self) -> str: ...
    @property
    def residual(self) -> float: ...
    @property
    def iterations(self) -> int: ...
    @property
    def unique(self) -> bool | None: ...

def solve_problem(
    G: ArrayLike | Matrix,
    b: ArrayLike,
    sets: Sequence[Equality | NonNegative | Coulomb],
    solver: str,
    tolerance: float,
    warm_start: ArrayLike | None,
) -> ProblemSolution: ...
def problem_residual(
    G: ArrayLike | Matrix, b: ArrayLike, sets: Sequence[Equality | NonNegative | Coulomb], P: ArrayLike
) -> float: ...

class ContactSolver:
    def __init__(self) -> None: ...
    @property
    def name(self) -> str: ...
    def accepts(self, sets: Sequence[Equality | NonNegative | Coulomb]) -> bool: ...

def load_contact_solver(library_and_class: str) -> str: ...
def register_solver_class(name: str, summary: str, make: Callable[[], ContactSolver]) -> None: ...
def solvers() -> dict[str, str]: ...

# kernel: models

class LagrangianDS:
    def __init__(
        self,
        q0: ArrayLike,
        v0: ArrayLike,
        mass: ArrayLike | ModelFunction | None = None,
        *,
        forces: ModelFunction | None = None,
        potential_energy: ModelFunction | None = None,
        force_jacobians: ModelFunction | None = None,
        parameters: ArrayLike = ...,
    ) -> None: ...
    @property
    def dimension(self) -> int: ...
    @property
    def coordinates(self) -> int: ...
    @property
    def q0(self) -> FloatArray: ...
    @property
    def v0(self) -> FloatArray: ...
    def add_shape(self, shape: Shape, pose: Pose | None = None) -> None: ...

class NewtonEulerDS(LagrangianDS):
    def __init__(
        self,
        q0: ArrayLike,
        v0: ArrayLike,
        mass: float,
        inertia: ArrayLike,
        *,
        force: ArrayLike | None = None,
        moment: ArrayLike | None = None,
        body_force: ArrayLike | None = None,
        body_moment: ArrayLike | None = None,
    ) -> None: ...
    @property
    def body_mass(self) -> float: ...
    @property
    def inertia(self) -> FloatArray: ...

def rotation_matrix(quaternion: ArrayLike) -> FloatArray: ...

class LagrangianLinearTIDS(LagrangianDS):
    def __init__(
        self,
        q0: ArrayLike,
        v0: ArrayLike,
        mass: ArrayLike | SparseMatrix,
        stiffness: ArrayLike | SparseMatrix | None = None,
        damping: ArrayLike | SparseMatrix | None = None,
        external_force: ArrayLike | None = None,
    ) -> None: ...

@final
class PluggedDS(LagrangianDS):
    def __init__(
        self,
        q0: ArrayLike,
        v0: ArrayLike,
        functions: Mapping[str, Any],
        mass: ArrayLike | None,
        stiffness: ArrayLike | None,
        damping: ArrayLike | None,
        force: ArrayLike,
        z: ArrayLike,
    ) -> None: ...

class LagrangianScleronomousR:
    def __init__(
        self,
        size: int,
        *,
        gap: ModelFunction | None = None,
        jacobian: ModelFunction | None = None,
        curvature: ModelFunction | None = None,
        parameters: ArrayLike = ...,
    ) -> None: ...
    @property
    def size(self) -> int: ...

@final
class LagrangianLinearTIR(LagrangianScleronomousR):
    def __init__(self, H: ArrayLike, b: ArrayLike | None = None) -> None: ...

class LagrangianRheonomousR(LagrangianScleronomousR):
    def __init__(self, size: int) -> None: ...

@final
class PluggedRelation(LagrangianScleronomousR):
    def __init__(self, size: int, h: Any, jacobian: Any, rate: Any) -> None: ...

@final
class PluggedRheonomousRelation(LagrangianScleronomousR):
    def __init__(self, size: int, h: Any, jacobian: Any, motion: Any) -> None: ...

@final
class Driven(LagrangianScleronomousR):
    def __init__(
        self,
        relation: LagrangianScleronomousR,
        motion: Callable[[float], tuple[float, float, float]],
    ) -> None: ...

@final
class SpherePlane(LagrangianScleronomousR):
    def __init__(
        self,
        size: int,
        *,
        radius: float,
        point: ArrayLike,
        normal: ArrayLike,
        centre: ArrayLike = ...,
    ) -> None: ...

@final
class SphereSphere(LagrangianScleronomousR):
    def __init__(
        self,
        size: int,
        *,
        radius1: float = 0.0,
        radius2: float = 0.0,
        centre1: ArrayLike = ...,
        centre2: ArrayLike = ...,
    ) -> None: ...

@final
class SphereBox(LagrangianScleronomousR):
    def __init__(
        self,
        size: int,
        *,
        radius: float,
        half_lengths: ArrayLike,
        box_centre: ArrayLike = ...,
        centre: ArrayLike = ...,
    ) -> None: ...

@final
class Joint(LagrangianScleronomousR):
    @staticmethod
    def weld(ds1: LagrangianDS, ds2: LagrangianDS | None = None, *, at: ArrayLike) -> Joint: ...
    @staticmethod
    def pivot(
        ds1: LagrangianDS, ds2: LagrangianDS | None = None, *, at: ArrayLike, axis: ArrayLike = ...
    ) -> Joint: ...
    @staticmethod
    def ball(ds1: LagrangianDS, ds2: LagrangianDS | None = None, *, at: ArrayLike) -> Joint: ...
    @staticmethod
    def slider(
        ds1: LagrangianDS, ds2: LagrangianDS | None = None, *, at: ArrayLike, axis: ArrayLike
    ) -> Joint: ...

class NonSmoothLaw:
    @property
    def description(self) -> dict[str, Any]: ...
    @property
    def size(self) -> int: ...
    @property
    def restitution(self) -> FloatArray: ...
    @property
    def bilateral(self) -> bool: ...

class NewtonImpactNSL(NonSmoothLaw):
    def __init__(self, e: float) -> None: ...

class NewtonImpactFrictionNSL(NonSmoothLaw):
    def __init__(self, en: float, et: float, mu: float, dim: int = 2) -> None: ...

class EqualityConditionNSL(NonSmoothLaw):
    def __init__(self, n: int) -> None: ...

class Interaction:
    @overload
    def __init__(self, relation: LagrangianScleronomousR, law: NonSmoothLaw, name: str = "") -> None: ...
    @overload
    def __init__(self, law: NonSmoothLaw, relation: LagrangianScleronomousR, name: str = "") -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def law(self) -> NonSmoothLaw: ...
    def show_at(self, place: Place) -> None: ...

@final
class Distance(LagrangianScleronomousR):
    def __init__(self, H: ArrayLike, b: ArrayLike | None = None, length: float = 0.0) -> None: ...

class ForceLaw: ...

class SpringDamper(ForceLaw):
    def __init__(self, stiffness: float, damping: float = 0.0, rest_length: float = 0.0) -> None: ...

class Actuator(ForceLaw):
    def __init__(
        self,
        force: float | Callable[[float, float, float], float] | ModelFunction,
        parameters: ArrayLike = ...,
    ) -> None: ...

class ForceElement:
    def __init__(self, relation: LagrangianScleronomousR, law: ForceLaw, name: str = "") -> None: ...
    @property
    def name(self) -> str: ...

class CheckItem:
    @property
    def subject(self) -> str: ...
    @property
    def quantity(self) -> str: ...
    @property
    def deviation(self) -> float: ...
    @property
    def tolerance(self) -> float: ...
    @property
    def note(self) -> str: ...
    @property
    def advisory(self) -> bool: ...
    @property
    def ok(self) -> bool: ...

class NonSmoothDynamicalSystemBase:
    def __init__(self, systems: Sequence[LagrangianDS], t0: float = 0.0) -> None: ...
    def link(self, interaction: Interaction, ds1: LagrangianDS, ds2: LagrangianDS | None = None) -> None: ...
    def add_force(
        self, element: ForceElement, ds1: LagrangianDS, ds2: LagrangianDS | None = None
    ) -> None: ...
    @property
    def t0(self) -> float: ...
    @property
    def dimension(self) -> int: ...
    @property
    def coordinates(self) -> int: ...
    def check_items(self) -> list[CheckItem]: ...
    def places(self, link: int, q: FloatArray) -> tuple[FloatArray, FloatArray] | None: ...
    def contacts(self) -> list[tuple[str, int, int, int, int, dict[str, Any]]]: ...

def neighbours(centres: ArrayLike, radii: ArrayLike, within: float = 0.0) -> IntArray: ...
def load_model(library_and_function: str) -> NonSmoothDynamicalSystemBase: ...

# kernel: integrators and simulations

class Tableau:
    def __init__(
        self, A: ArrayLike, b: ArrayLike, name: str = "own", order: int | tuple[int, int] | None = None
    ) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def A(self) -> FloatArray: ...
    @property
    def b(self) -> FloatArray: ...
    @property
    def c(self) -> FloatArray: ...
    @property
    def order(self) -> tuple[int, int]: ...

class OneStepIntegrator:
    def __init__(self) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def options(self) -> dict[str, OptionValue]: ...

def make_integrator(name: str, options: Mapping[str, OptionValue] = ...) -> OneStepIntegrator: ...
def integrator_properties(name: str, options: Mapping[str, OptionValue] = ...) -> dict[str, Any]: ...
def integrators() -> list[IntegratorEntry]: ...
def register_class(
    name: str,
    summary: str,
    properties: Mapping[str, Any],
    options: Mapping[str, float | str],
    make: Callable[..., OneStepIntegrator],
) -> None: ...
def load_integrator(library_and_class: str) -> str: ...

class State:
    t: float
    @property
    def q(self) -> FloatArray: ...
    @q.setter
    def q(self, q: ArrayLike) -> None: ...
    @property
    def v(self) -> FloatArray: ...
    @v.setter
    def v(self, v: ArrayLike) -> None: ...

class Reactions:
    @property
    def lambda_plus(self) -> FloatArray: ...
    @lambda_plus.setter
    def lambda_plus(self, x: ArrayLike) -> None: ...
    @property
    def lambda_minus(self) -> FloatArray: ...
    @lambda_minus.setter
    def lambda_minus(self, x: ArrayLike) -> None: ...
    @property
    def force(self) -> FloatArray: ...
    @force.setter
    def force(self, x: ArrayLike) -> None: ...
    @property
    def impulse(self) -> FloatArray: ...
    @impulse.setter
    def impulse(self, x: ArrayLike) -> None: ...

class StepReport:
    def __init__(self) -> None: ...
    impulsive: bool
    closed: int
    solver_iterations: int
    residual: float
    penetration: float
    kinetic_energy: float
    work_forces: float
    work_lambda: float
    work_impulse: float
    accepted_steps: int
    rejected_steps: int
    event_steps: int
    captures: int

class Configuration:
    def __init__(self, system: NonSmoothDynamicalSystemBase) -> None: ...
    def move_to(self, q: ArrayLike, t: float | None = None) -> None: ...
    def rates(self, v: ArrayLike) -> FloatArray: ...
    @property
    def q(self) -> FloatArray: ...
    @property
    def gaps(self) -> FloatArray: ...
    @property
    def closed(self) -> list[int]: ...
    @property
    def penetration(self) -> float: ...
    def forces(self, t: float, v: ArrayLike) -> FloatArray: ...
    def solve_mass(self, x: ArrayLike) -> FloatArray: ...
    def velocities(self, v: ArrayLike) -> FloatArray: ...
    def kinetic_energy(self, v: ArrayLike) -> float: ...

class ContactImpulses:
    @property
    def impulse(self) -> FloatArray: ...
    @property
    def velocity(self) -> FloatArray: ...
    @property
    def iterations(self) -> int: ...
    @property
    def residual(self) -> float: ...

class ContactStage:
    def __init__(self, system: NonSmoothDynamicalSystemBase, solver: ContactSolver) -> None: ...
    def solve(
        self,
        active: Sequence[int],
        constraint: Configuration,
        force: Configuration,
        v: ArrayLike,
        before: ArrayLike | None = None,
        warm_start: ArrayLike | None = None,
    ) -> ContactImpulses: ...

class StepStatus(Enum):
    ok = ...
    solver_failed = ...
    mass_not_positive_definite = ...
    iteration_failed = ...
    gap_not_finite = ...
    accumulation = ...
    not_finite = ...

class StepFailure(ArithmeticError):
    status: StepStatus

class Observer: ...

class Event:
    @property
    def t(self) -> float: ...
    @property
    def q(self) -> FloatArray: ...
    @property
    def v_before(self) -> FloatArray: ...
    @property
    def v(self) -> FloatArray: ...
    @property
    def gaps(self) -> FloatArray: ...
    @property
    def velocities_before(self) -> FloatArray: ...
    @property
    def velocities(self) -> FloatArray: ...
    @property
    def impulse(self) -> FloatArray: ...
    @property
    def generalised_impulse(self) -> FloatArray: ...
    @property
    def force(self) -> FloatArray: ...
    @property
    def generalised_force(self) -> FloatArray: ...

class TimeSteppingBase:
    def __init__(
        self,
        system: NonSmoothDynamicalSystemBase,
        integrator: OneStepIntegrator,
        time_step: float,
        solver: str,
        tolerance: float = 1e-12,
    ) -> None: ...
    def add_observer(self, observer: Observer) -> None: ...
    def add_callback(
        self, callback: Callable[[int, float, FloatArray, FloatArray, StepReport], object]
    ) -> None: ...
    def watch_problems(
        self,
        watcher: Callable[
            [Matrix, FloatArray, list[Equality | NonNegative | Coulomb], FloatArray, str], object
        ]
        | None,
    ) -> None: ...
    def advance(self, until: float, progress: Callable[[float], None] | None) -> None: ...
    def take_step(self) -> StepReport: ...
    def checkpoint(self) -> dict[str, Any]: ...
    def restore(self, values: Mapping[str, Any]) -> None: ...
    @property
    def events(self) -> list[Event]: ...
    @property
    def time_step(self) -> float: ...
    @property
    def steps(self) -> int: ...
    @property
    def report(self) -> StepReport: ...
    @property
    def t(self) -> float: ...
    @property
    def q(self) -> FloatArray: ...
    @property
    def v(self) -> FloatArray: ...

def stability_warning(
    system: NonSmoothDynamicalSystemBase, integrator: OneStepIntegrator, time_step: float
) -> str | None: ...

class SimulationError(RuntimeError):
    time: float
    step: int
    contacts: list[str]
    residual: float
    trajectory: Trajectory | FirstOrderTrajectory

# first-order systems

class FirstOrderNonLinearDS:
    def __init__(self, x0: ArrayLike, M: ArrayLike | None = None) -> None: ...
    @property
    def dimension(self) -> int: ...
    @property
    def x0(self) -> FloatArray: ...

class FirstOrderLinearDS(FirstOrderNonLinearDS):
    def __init__(
        self,
        x0: ArrayLike,
        A: ArrayLike | None = None,
        b: ArrayLike | None = None,
        M: ArrayLike | None = None,
    ) -> None: ...

@final
class FirstOrderLinearTIDS(FirstOrderLinearDS): ...

class FirstOrderNonLinearR:
    def __init__(self, size: int) -> None: ...
    @property
    def size(self) -> int: ...

class FirstOrderLinearR(FirstOrderNonLinearR):
    def __init__(
        self, C: ArrayLike, B: ArrayLike, D: ArrayLike | None = None, e: ArrayLike | None = None
    ) -> None: ...

@final
class FirstOrderLinearTIR(FirstOrderLinearR): ...

class BoxLaws:
    def __init__(self, lower: ArrayLike, upper: ArrayLike) -> None: ...
    @property
    def size(self) -> int: ...
    @property
    def lower(self) -> FloatArray: ...
    @property
    def upper(self) -> FloatArray: ...

def complementarity_laws(n: int) -> BoxLaws: ...
def relay_laws(n: int, lower: float = -1.0, upper: float = 1.0) -> BoxLaws: ...
def equality_laws(n: int) -> BoxLaws: ...
def mixed_complementarity_laws(equalities: int, inequalities: int) -> BoxLaws: ...

class FirstOrderSystemBase:
    def __init__(self, systems: Sequence[FirstOrderNonLinearDS], t0: float = 0.0) -> None: ...
    def connect(
        self,
        relation: FirstOrderNonLinearR,
        law: BoxLaws,
        ds1: FirstOrderNonLinearDS,
        ds2: FirstOrderNonLinearDS | None = None,
        name: str = "",
    ) -> None: ...
    @property
    def t0(self) -> float: ...
    @property
    def dimension(self) -> int: ...
    @property
    def dimensions(self) -> list[int]: ...
    @property
    def interactions(self) -> list[tuple[str, int]]: ...

class FirstOrderObserver: ...

class FirstOrderRecording(FirstOrderObserver):
    def __init__(self, every: int = 1) -> None: ...
    @property
    def rows(self) -> int: ...
    def columns(self) -> dict[str, Any]: ...

class FirstOrderLive(FirstOrderObserver):
    def __init__(
        self, systems: Sequence[Sequence[FloatArray]], relations: Sequence[Sequence[FloatArray]]
    ) -> None: ...

class FirstOrderReport:
    @property
    def iterations(self) -> int: ...
    @property
    def solver_iterations(self) -> int: ...
    @property
    def residual(self) -> float: ...

class FirstOrderTimeSteppingBase:
    def __init__(
        self,
        system: FirstOrderSystemBase,
        theta: float,
        gamma: float,
        gamma_for_relation: bool,
        hold: bool,
        time_step: float,
        solver: str,
        tolerance: float,
    ) -> None: ...
    def add_observer(self, observer: FirstOrderObserver) -> None: ...
    def advance(self, until: float, progress: Callable[[float], None] | None) -> None: ...
    def take_step(self) -> FirstOrderReport: ...
    @property
    def time_step(self) -> float: ...
    @property
    def steps(self) -> int: ...
    @property
    def report(self) -> FirstOrderReport: ...
    @property
    def t(self) -> float: ...
    @property
    def x(self) -> FloatArray: ...

# io

class Recording(Observer):
    def __init__(self, every: int = 1) -> None: ...
    @property
    def rows(self) -> int: ...
    @property
    def handed_on(self) -> int: ...
    def columns(self) -> dict[str, Any]: ...
    def stream(self, sink: Callable[[int, dict[str, Any]], object], rows: int, seconds: float) -> None: ...
    def flush(self) -> None: ...

@final
class LiveState(Observer):
    def __init__(
        self,
        systems: Sequence[tuple[FloatArray, FloatArray, FloatArray, FloatArray]],
        contacts: Sequence[tuple[FloatArray, FloatArray, FloatArray, FloatArray]],
        time_step: float,
        steps: int = 1,
    ) -> None: ...

def run_columns() -> dict[str, str]: ...
def csv_header(coordinates: int, freedoms: int, contacts: Sequence[tuple[str, int, int]]) -> str: ...
def csv_rows(columns: Mapping[str, Any]) -> str: ...

# compare

def compare_integrators(
    system: NonSmoothDynamicalSystemBase,
    integrators: Sequence[tuple[str, OneStepIntegrator]],
    baseline: tuple[str, OneStepIntegrator] | None,
    time_steps: Sequence[float],
    until: float,
    reference: tuple[str, OneStepIntegrator] | None,
    recorded: Mapping[str, Any] | None,
    reference_name: str,
    reference_step: float,
    limits: Mapping[str, float],
    timings: int,
    progress: Callable[[str, float], object] | None,
) -> dict[str, Any]: ...

# examples

class SliderCrankParameters:
    l1: float
    l2: float
    a: float
    b: float
    c: float
    m1: float
    m2: float
    m3: float
    J1: float
    J2: float
    J3: float
    gravity: float

@final
class CompiledSliderCrank(LagrangianDS):
    def __init__(self, q0: ArrayLike, v0: ArrayLike, parameters: SliderCrankParameters) -> None: ...

@final
class CompiledSliderCorner(LagrangianScleronomousR):
    def __init__(self, xi: float, eta: float, size: int, parameters: SliderCrankParameters) -> None: ...

@final
class CompiledSliderGuide(LagrangianScleronomousR):
    def __init__(self, parameters: SliderCrankParameters) -> None: ...

def bare_slider_crank(time_step: float, steps: int) -> tuple[FloatArray, FloatArray]: ...
def compiled_ball_in_box(oblique: bool) -> NonSmoothDynamicalSystemBase: ...
def compiled_elastic_bar(elements: int, damping: float) -> NonSmoothDynamicalSystemBase: ...
def bare_elastic_bar(
    elements: int, damping: float, gap: float, time_step: float, steps: int
) -> tuple[FloatArray, FloatArray]: ...

class AxleParameters:
    elements: int
    length: float
    radius: float
    density: float
    E: float
    G: float
    mass_damping: float
    torsional_damping: float
    mount_stiffness: float
    mount_damping: float
    drive_torque: float
    drive_until: float
    fault_torque: float
    gravity: float

@final
class CompiledAxle(LagrangianDS):
    def __init__(self, q0: ArrayLike, v0: ArrayLike, parameters: AxleParameters) -> None: ...
    def force_jacobians(self, t: float, q: ArrayLike, v: ArrayLike) -> tuple[FloatArray, FloatArray]: ...

@final
class CompiledAxleWeld(LagrangianScleronomousR):
    def __init__(self, axle: CompiledAxle, s: float) -> None: ...
    @staticmethod
    def held(axle: CompiledAxle, s: float) -> tuple[FloatArray, FloatArray]: ...

@final
class CompiledJournalContact(LagrangianScleronomousR):
    def __init__(self, size: int, *, disc: float, circle: float, along: float) -> None: ...

@final
class CompiledMountedBody(NewtonEulerDS):
    def __init__(
        self,
        q0: ArrayLike,
        v0: ArrayLike,
        *,
        mass: float,
        inertia: ArrayLike,
        stiffness: float,
        damping: float,
        gravity: float,
    ) -> None: ...

def compiled_rotor() -> NonSmoothDynamicalSystemBase: ...
