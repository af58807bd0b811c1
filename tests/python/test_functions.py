"""Model functions: compiled, of a shared library, and by pointer."""

import ctypes

import numpy as np
import pytest
import saltus
import saltus.kernel as sk

STIFFNESS = 50.0

SOURCE = """
typedef const double* in;
void forces(double t, int n, in q, in v, double* out, in p) {
  for (int i = 0; i < n; ++i) out[i] = -p[0] * q[i];
}
void uses_time(double t, int n, in q, in v, double* out, in p) { out[0] = t; }
void uses_v(double t, int n, in q, in v, double* out, in p) { out[0] = v[0]; }
"""


@pytest.fixture(scope="module")
def library(shared_library):
    return shared_library(SOURCE)


@saltus.compiled
def spring(t, q, v, out, parameters):
    for i in range(len(q)):
        out[i] = -parameters[0] * q[i]


def cffi_pointer(library):
    cffi = pytest.importorskip("cffi")
    ffi = cffi.FFI()
    ffi.cdef("void forces(double, int, const double*, const double*, double*, const double*);")
    return ffi.addressof(ffi.dlopen(str(library)), "forces")


def run(**functions):
    body = sk.LagrangianDS([1.0, 0.0], [0.0, 2.0], [[2.0, 0.5], [0.5, 1.0]], **functions)
    return sk.TimeStepping(sk.NonSmoothDynamicalSystem([body]), "HalfExplicitTrapezoidalOSI", 1e-3).run(0.2)


class Spring(sk.LagrangianDS):
    def forces(self, t, q, v, out):
        out[:] = -STIFFNESS * q


@pytest.mark.parametrize(
    "source",
    [
        lambda library: spring,
        lambda library: f"{library}:forces",
        lambda library: f"{library.with_name('own')}:forces",
        lambda library: ctypes.CDLL(str(library)).forces,
        cffi_pointer,
    ],
    ids=["compiled", "file", "undecorated", "ctypes", "cffi"],
)
def test_all_kinds_of_functions_give_the_trajectory_of_a_method(library, source):
    method = Spring([1.0, 0.0], [0.0, 2.0], [[2.0, 0.5], [0.5, 1.0]])
    expected = sk.TimeStepping(sk.NonSmoothDynamicalSystem([method]), "HalfExplicitTrapezoidalOSI", 1e-3).run(
        0.2
    )
    trajectory = run(forces=source(library), parameters=[STIFFNESS])
    assert np.array_equal(trajectory.q, expected.q)
    assert np.array_equal(trajectory.v, expected.v)


def staticmethod_of(compiled):
    """The Python code of a compiled function as a method."""
    return lambda self, *arguments: compiled(*arguments)


def test_every_method_of_a_model_can_be_compiled():
    @saltus.compiled
    def mass(q, out):
        out[0, 0] = 2.0
        out[1, 1] = 2.0 + q[0] ** 2

    @saltus.compiled
    def forces(t, q, v, out):
        out[0] = q[0] * v[1] ** 2 - 3.0 * q[0]
        out[1] = -2.0 * q[0] * v[0] * v[1]

    @saltus.compiled
    def force_jacobians(t, q, v, out):
        out[0, 0, 0] = v[1] ** 2 - 3.0
        out[0, 1, 0] = -2.0 * v[0] * v[1]
        out[1, 0, 1] = 2.0 * q[0] * v[1]
        out[1, 1, 0] = -2.0 * q[0] * v[1]
        out[1, 1, 1] = -2.0 * q[0] * v[0]

    @saltus.compiled
    def potential_energy(q):
        return 1.5 * q[0] ** 2

    @saltus.compiled
    def gap(q, out, parameters):
        out[0] = parameters[0] - q[0]

    @saltus.compiled
    def jacobian(q, out):
        out[0, 0] = -1.0
        out[1, 1] = q[0]

    @saltus.compiled
    def curvature(q, v, out):
        out[1] = v[0] * v[1]

    body = sk.LagrangianDS(
        [0.2, 0.0],
        [1.0, 3.0],
        mass,
        forces=forces,
        potential_energy=potential_energy,
        force_jacobians=force_jacobians,
    )
    system = sk.NonSmoothDynamicalSystem([body])
    relation = sk.LagrangianScleronomousR(
        2, gap=gap, jacobian=jacobian, curvature=curvature, parameters=[0.5]
    )
    system.link(sk.Interaction(relation, sk.NewtonImpactFrictionNSL(0.5, 0.0, 0.2, 2), name="wall"), body)
    report = system.check()
    assert report.ok, report
    assert {item.quantity for item in report.items} >= {
        "forces against potential_energy",
        "velocity-dependent forces against mass",
        "jacobian against gap",
        "curvature against jacobian",
    }

    class Methods(sk.LagrangianDS):  # the same functions as Python code
        pass

    class Wall(sk.LagrangianScleronomousR):
        def gap(self, q, out):
            out[0] = 0.5 - q[0]

    Methods.mass = staticmethod_of(mass)
    Methods.forces = staticmethod_of(forces)
    Methods.force_jacobians = staticmethod_of(force_jacobians)
    Wall.jacobian = staticmethod_of(jacobian)

    slow_body = Methods([0.2, 0.0], [1.0, 3.0])
    slow = sk.NonSmoothDynamicalSystem([slow_body])
    law = sk.NewtonImpactFrictionNSL(0.5, 0.0, 0.2, 2)
    slow.link(sk.Interaction(Wall(2), law, name="wall"), slow_body)
    for scheme in ("HalfExplicitTrapezoidalOSI", "MoreauJeanOSI"):
        fast_run = sk.TimeStepping(system, scheme, 1e-3).run(1.0)
        slow_run = sk.TimeStepping(slow, scheme, 1e-3).run(1.0)
        assert fast_run.impulsive.any()
        assert np.abs(fast_run.q - slow_run.q).max() < 1e-12
        assert np.abs(fast_run["wall"].impulse - slow_run["wall"].impulse).max() < 1e-12
        energy = 1.5 * fast_run.q[:, 0] ** 2
        assert fast_run.potential_energy == pytest.approx(energy, rel=1e-12)


def test_methods_and_functions_can_be_mixed():
    class Mixed(sk.LagrangianDS):
        def __init__(self):
            super().__init__([1.0, 0.0], [0.0, 2.0], forces=spring, parameters=[STIFFNESS])

        def mass(self, q, out):
            out[0, 0] = out[1, 1] = 2.0

    trajectory = sk.TimeStepping(
        sk.NonSmoothDynamicalSystem([Mixed()]), "HalfExplicitTrapezoidalOSI", 1e-4
    ).run(0.2)
    assert trajectory.q[-1] == pytest.approx([np.cos(1.0), 0.4 * np.sin(1.0)], abs=1e-7)


@pytest.mark.parametrize(("name", "what"), [("uses_time", "mass"), ("uses_v", "mass")])
def test_arguments_that_a_quantity_does_not_depend_on_are_nan(library, name, what):
    body = sk.LagrangianDS([1.0], [0.0], f"{library}:{name}", forces=spring, parameters=[1.0])
    with pytest.raises(ValueError, match="must be finite, got NaN"):
        sk.TimeStepping(sk.NonSmoothDynamicalSystem([body]), "HalfExplicitTrapezoidalOSI", 1e-3)


def test_an_exception_in_a_compiled_function_ends_the_run():
    @saltus.compiled
    def forces(t, q, v, out):
        if t > 0.05:
            raise ValueError
        out[0] = 1.0

    body = sk.LagrangianDS([0.0], [0.0], [[1.0]], forces=forces)
    simulation = sk.TimeStepping(sk.NonSmoothDynamicalSystem([body]), "HalfExplicitTrapezoidalOSI", 1e-3)
    with pytest.raises(sk.SimulationError) as caught:
        simulation.run(1.0)
    assert caught.value.time == pytest.approx(0.05, abs=2e-3)


def test_an_index_out_of_range_does_not_write_into_foreign_memory():
    @saltus.compiled
    def forces(t, q, v, out):
        out[len(q) + 1000] = 1.0

    body = sk.LagrangianDS([0.0], [0.0], [[1.0]], forces=forces)
    with pytest.raises(ValueError, match="forces of system 0"):
        sk.TimeStepping(sk.NonSmoothDynamicalSystem([body]), "HalfExplicitTrapezoidalOSI", 1e-3)


@pytest.mark.parametrize(
    ("forces", "error", "message"),
    [
        (lambda q: q, TypeError, "decorate it with @saltus.compiled"),
        (3, TypeError, "got int"),
        ("no_colon", ValueError, "library:name"),
        ("./nowhere:f", ValueError, "cannot be loaded"),
        (ctypes.CFUNCTYPE(None)(0), ValueError, "null pointer"),
        (saltus.compiled(lambda q, out: None), TypeError, r"must be \(t, q, v, out\)"),
    ],
)
def test_what_is_no_model_function_is_refused(forces, error, message):
    with pytest.raises(error, match=message):
        sk.LagrangianDS([0.0], [0.0], [[1.0]], forces=forces)


@pytest.mark.parametrize("name", ["q", "v", "parameters"])
def test_a_compiled_function_cannot_write_into_what_it_is_given(name):
    scope = {}
    exec(f"def forces(t, q, v, out, parameters):\n    {name}[0] = 99.0", scope)
    with pytest.raises(Exception, match="readonly array"):
        sk.LagrangianDS([0.0], [0.0], [[1.0]], forces=saltus.compiled(scope["forces"]), parameters=[1.0])


def test_a_compiled_function_that_returns_its_forces_is_refused():
    @saltus.compiled
    def forces(t, q, v, out):
        return 3.0

    with pytest.raises(TypeError, match="must write into out and return None, got float64"):
        sk.LagrangianDS([0.0], [0.0], [[1.0]], forces=forces)


def test_a_potential_energy_is_given_in_one_way():
    class Both(sk.LagrangianDS):
        def potential_energy(self, q):
            return 5.0

    @saltus.compiled
    def energy(q):
        return 1.0

    body = Both([0.0], [0.0], [[1.0]], forces=spring, parameters=[1.0], potential_energy=energy)
    with pytest.raises(ValueError, match="Both.potential_energy is defined"):
        sk.TimeStepping(sk.NonSmoothDynamicalSystem([body]), "HalfExplicitTrapezoidalOSI", 1e-3)


def test_a_missing_symbol_is_named(library):
    with pytest.raises(ValueError, match="exports no 'gravity'"):
        sk.LagrangianDS([0.0], [0.0], [[1.0]], forces=f"{library}:gravity")


def test_a_method_that_is_also_given_as_a_function_is_refused():
    body = Spring([0.0], [0.0], [[1.0]], forces=spring, parameters=[1.0])
    with pytest.raises(ValueError, match=r"Spring.forces is defined and forces= is given"):
        sk.TimeStepping(sk.NonSmoothDynamicalSystem([body]), "HalfExplicitTrapezoidalOSI", 1e-3)


def test_parameters_must_be_finite():
    with pytest.raises(ValueError, match="parameters must be finite"):
        sk.LagrangianDS([0.0], [0.0], [[1.0]], forces=spring, parameters=[np.nan])
