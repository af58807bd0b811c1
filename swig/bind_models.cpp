#include <pybind11/stl.h>

#include "bindings.hpp"
#include "functions.hpp"
#include "python_models.hpp"
#include "saltus/kernel/model/distance.hpp"
#include "saltus/kernel/model/driven.hpp"
#include "saltus/kernel/model/lagrangian_linear_tids.hpp"
#include "saltus/kernel/model/nonsmooth_law.hpp"

namespace saltus::python {
namespace {

LagrangianLinearTIDS::Term to_term(const py::object& values, const char* what) {
  if (is_sparse(values)) return to_sparse_matrix(values, what);
  return to_matrix(values, what);
}

std::optional<LagrangianLinearTIDS::Term> optional_term(const std::optional<py::object>& values,
                                                        const char* what) {
  if (!values) return std::nullopt;
  return to_term(*values, what);
}

std::unique_ptr<PyLagrangianDS> make_lagrangian_ds(const ArrayLike& q0, const ArrayLike& v0,
                                                   const py::object& mass, const py::object& forces,
                                                   const py::object& potential_energy,
                                                   const py::object& force_jacobians,
                                                   const ArrayLike& parameters) {
  Vec values = to_vec(parameters, "parameters");
  FunctionDS::Functions functions{
      .forces = to_model_function(forces, "forces", 0, values),
      .force_jacobians = to_model_function(force_jacobians, "force_jacobians", 0, values),
      .potential_energy = to_model_function(potential_energy, "potential_energy", 0, values)};
  if (is_function(mass))
    functions.mass = to_model_function(mass, "mass", 0, values);
  else if (!mass.is_none())
    functions.constant_mass = to_matrix(mass, "mass");
  return std::make_unique<PyLagrangianDS>(to_vec(q0, "q0"), to_vec(v0, "v0"), std::move(functions),
                                          std::move(values));
}

std::unique_ptr<PyRelation> make_relation(int size, const py::object& gap, const py::object& jacobian,
                                          const py::object& curvature, const ArrayLike& parameters) {
  Vec values = to_vec(parameters, "parameters");
  FunctionRelation::Functions functions{to_model_function(gap, "gap", size, values),
                                        to_model_function(jacobian, "jacobian", size, values),
                                        to_model_function(curvature, "curvature", size, values)};
  return std::make_unique<PyRelation>(size, std::move(functions), std::move(values));
}

void bind_systems(py::module_& module) {
  py::classh<LagrangianDS, PyLagrangianDS>(
      module, "LagrangianDS", py::dynamic_attr(),
      R"(A mechanical system q̇ = Y(q) v, M(q) v̇ = h(t, q, v) + W λ, (74), (2). Derive from it and define

    def mass(self, q, out): ...            # out (n, n): M(q), unless a constant mass is given
    def forces(self, t, q, v, out): ...    # out (n,): h(t, q, v), external forces included
    def potential_energy(self, q): ...     # optional, [J]: only reported
    def force_jacobians(self, t, q, v, out): ...   # optional, out (2, n, n): ∂h/∂q Y, ∂h/∂v, for implicit schemes
    def velocity_map(self, q, out): ...    # optional, out (coordinates, n): Y(q), the identity if left out
    def normalise(self, q, out): ...       # optional, with it: coordinates brought back to allowed ones; out is q

`out` is zero at the call; q and v are read-only and reused: copy what you want to keep.

Each of the first four can be a function instead, if q̇ = v, which costs tens of nanoseconds where a method costs hundreds: what
`saltus.compiled` makes, "library:function", or a C pointer, see `saltus.functions`. A class that gives all it needs
as functions need not be derived from.

Parameters
----------
q0, v0 : (n,) initial position and velocity; q0 (coordinates,) with a velocity map
mass : (n, n) constant mass, or a function
forces, potential_energy, force_jacobians : functions
parameters : handed on to the functions

Raises
------
ValueError
    If shapes disagree, a value is not finite, or something is given as a function and as a method. That q0 and v0
    differ in size without a velocity map is found when the NonSmoothDynamicalSystem is made.
)")
      .def(py::init(&make_lagrangian_ds), py::arg("q0"), py::arg("v0"), py::arg("mass") = py::none(),
           py::kw_only(), py::arg("forces") = py::none(), py::arg("potential_energy") = py::none(),
           py::arg("force_jacobians") = py::none(), py::arg("parameters") = py::tuple())
      .def(
          "add_shape",
          [](py::object self, py::object shape, py::object pose) {
            py::module_::import("saltus.scene").attr("attach")(self, shape, pose);
          },
          py::arg("shape"), py::arg("pose") = py::none(),
          "Let the system look like this in pictures: a Disc, Box, Polyline, Sphere, Cylinder or Mesh whose "
          "frame\n"
          "is at pose(q) = (x [m], y [m], angle [rad]), or (x, y, z [m], and a unit quaternion w, x, y, z). "
          "A\n"
          "NewtonEulerDS tells itself where it is. Shapes are stored with the run.")
      .def_property_readonly(
          "dimension", [](py::object self) { return initialised<LagrangianDS>(self).dimension(); },
          "entries of v")
      .def_property_readonly(
          "coordinates", [](py::object self) { return initialised<LagrangianDS>(self).coordinates(); },
          "entries of q")
      .def_property_readonly("q0",
                             [](py::object self) { return to_array(initialised<LagrangianDS>(self).q0()); })
      .def_property_readonly("v0",
                             [](py::object self) { return to_array(initialised<LagrangianDS>(self).v0()); })
      .def("__repr__", shown_by("dynamical_system_text"))
      .def("_repr_html_", shown_by("dynamical_system"));

  py::classh<LagrangianLinearTIDS, LagrangianDS, PyLagrangianLinearTIDS>(
      module, "LagrangianLinearTIDS", R"(Linear time-invariant system M v̇ + C v + K q = f + W λ.

A force that varies with time is a method of a derived class, in the place of external_force:

    def external_force(self, t, out): ...   # out (n,): f(t) [N], zero at the call

Parameters
----------
q0, v0 : (n,) initial position and velocity
mass : (n, n) M, symmetric positive definite
stiffness, damping : (n, n) K [N/m], C [N s/m], zero if left out
external_force : (n,) f [N], zero if left out

Each matrix is an array or any of scipy.sparse. If one of them is sparse, none is stored densely: a step of a bar of
100 000 elements then costs as much per element as one of 1000. M, and the matrix of an implicit scheme, are factorised
once, by a method that fits their structure: banded, by minimum degree, or unsymmetric.

Raises
------
ValueError
    If shapes disagree, a value is not finite, or mass is not symmetric positive definite. A force that is given
    twice is found by the simulation.
)")
      .def(py::init([](const ArrayLike& q0, const ArrayLike& v0, const ArrayLike& mass,
                       const std::optional<ArrayLike>& stiffness, const std::optional<ArrayLike>& damping,
                       const std::optional<ArrayLike>& external_force) {
             LagrangianLinearTIDS::Terms terms{optional_term(stiffness, "stiffness"),
                                               optional_term(damping, "damping"), std::nullopt};
             if (external_force) terms.external_force = to_vec(*external_force, "external_force");
             return std::make_unique<PyLagrangianLinearTIDS>(to_vec(q0, "q0"), to_vec(v0, "v0"),
                                                             to_term(mass, "mass"), std::move(terms));
           }),
           py::arg("q0"), py::arg("v0"), py::arg("mass"), py::arg("stiffness") = py::none(),
           py::arg("damping") = py::none(), py::arg("external_force") = py::none());
}

void bind_relations(py::module_& module) {
  py::classh<Relation, PyRelation>(
      module, "LagrangianScleronomousR",
      R"(Geometry g(q), Wᵀ(q) of a contact or joint, (14)-(15). Derive from it and define

    def gap(self, q, out): ...             # out (1,) [m] for a contact, (size,) for an equality
    def jacobian(self, q, out): ...        # out (size, n): normal row, then 0-2 tangential rows; γ = out v
    def curvature(self, q, v, out): ...    # out (size,): (dWᵀ/dt) v, only for acceleration-level schemes

`out` is zero at the call; q and v are read-only and reused: copy what you want to keep. For an
interaction between two systems q is [q1; q2].

Each of them can be a function instead, if q̇ = v, as in LagrangianDS.

Parameters
----------
size : number of rows
gap, jacobian, curvature : functions
parameters : handed on to the functions

Raises
------
ValueError
    If size < 1.
)")
      .def(py::init(&make_relation), py::arg("size"), py::kw_only(), py::arg("gap") = py::none(),
           py::arg("jacobian") = py::none(), py::arg("curvature") = py::none(),
           py::arg("parameters") = py::tuple())
      .def_property_readonly("size", [](py::object self) { return initialised<Relation>(self).size(); });
  py::classh<LagrangianLinearTIR, Relation>(module, "LagrangianLinearTIR", py::is_final(),
                                            R"(Linear relation: gap (H q + b) in the normal rows, Wᵀ = H.

Parameters
----------
H : (size, n)
b : (size,) [m], zero if left out

Raises
------
ValueError
    If shapes disagree or a value is not finite.
)")
      .def(py::init([](const ArrayLike& H, const std::optional<ArrayLike>& b) {
             Matrix rows = to_matrix(H, "H");
             const Vec offset = b ? to_vec(*b, "b") : Vec(Vec::Zero(rows.rows()));
             return std::make_unique<LagrangianLinearTIR>(std::move(rows), offset);
           }),
           py::arg("H"), py::arg("b") = py::none());
  py::classh<Distance, Relation>(
      module, "Distance", py::is_final(),
      R"(Distance of two points that depend linearly on q, or of one and the ground:
g = |H q + b| − length. The length of a spring, a rod if it is an equality, the contact of two discs or spheres. Where
the points meet its gradient is not defined: a run ends there.

Parameters
----------
H : (1 to 3, n): H q + b leads from one point to the other
b : (rows of H,) [m], zero if left out
length : of a rod, or the sum of the radii [m]

Raises
------
ValueError
    If shapes disagree or a value is not finite.
)")
      .def(py::init([](const ArrayLike& H, const std::optional<ArrayLike>& b, double length) {
             Matrix rows = to_matrix(H, "H");
             const Vec offset = b ? to_vec(*b, "b") : Vec(Vec::Zero(rows.rows()));
             return std::make_unique<Distance>(std::move(rows), offset, length);
           }),
           py::arg("H"), py::arg("b") = py::none(), py::arg("length") = 0.0);
}

// p(t) of a Python callable that returns (position, velocity, acceleration)
Driven::Function to_motion(const py::function& motion) {
  const auto held = hold(motion);
  return [held](double t) -> Motion {
    const py::object result = (*held)(t);
    try {
      const auto [position, velocity, acceleration] = result.cast<std::tuple<double, double, double>>();
      return {position, velocity, acceleration};
    } catch (const py::cast_error&) {
      throw py::type_error("motion must return three numbers (position, velocity, acceleration), got " +
                           std::string(py::repr(result)));
    }
  };
}

void bind_driven(py::module_& module) {
  py::classh<Driven, Relation>(module, "Driven", py::is_final(),
                               R"(A relation whose first gap is driven: g = g_r(q) − p(t).

As an equality it makes a freedom follow p, if g_r is linear in q; a rod changes its length, a floor moves along its
normal.

Parameters
----------
relation : g_r, which does not depend on the time itself
motion : function of t that returns (p, ṗ, p̈) [m or rad, m/s, m/s²]; the last is for schemes on acceleration level

Raises
------
ValueError
    If the relation depends on the time.
TypeError
    If motion is not callable, or returns something else.
)")
      .def(py::init([](std::shared_ptr<Relation> relation, const py::function& motion) {
             return std::make_unique<Driven>(std::move(relation), to_motion(motion));
           }),
           py::arg("relation"), py::arg("motion"));
}

void bind_rheonomous(py::module_& module) {
  py::classh<RheonomousRelation, Relation, PyRheonomousRelation>(
      module, "LagrangianRheonomousR",
      R"(Geometry g(t, q) that moves by itself: γ = Wᵀ(t, q) v + w(t, q). Derive from it and define

    def gap(self, t, q, out): ...            # out (1,) [m] for a contact, (size,) for an equality
    def jacobian(self, t, q, out): ...       # out (size, n): Wᵀ
    def motion(self, t, q, out): ...         # out (size,): w, in normal rows ∂g/∂t, in tangential ones the speed of a
                                             # belt [m/s]
    def curvature(self, t, q, v, out): ...   # out (size,): γ̇ − Wᵀ v̇, only for acceleration-level schemes

`out` is zero at the call; q and v are read-only and reused: copy what you want to keep. Without curvature, schemes on
acceleration level refuse it by name.

Parameters
----------
size : number of rows

Raises
------
ValueError
    If size < 1.
)")
      .def(py::init<int>(), py::arg("size"));
}

void bind_laws(py::module_& module) {
  py::class_<NonSmoothLaw>(module, "NonSmoothLaw", "Which forces and jumps an interaction admits.")
      .def_property_readonly("size", &NonSmoothLaw::size, "number of rows")
      .def_property_readonly("restitution", [](const NonSmoothLaw& law) { return to_array(law.restitution); })
      .def_readonly("bilateral", &NonSmoothLaw::bilateral)
      .def_property_readonly("description", &description, "its class by name, and its parameters")
      .def("__repr__", shown_by("law_text"));
  py::class_<NewtonImpactNSL, NonSmoothLaw>(
      module, "NewtonImpactNSL",
      "Unilateral contact without friction, Newton's impact law (6) with restitution e in [0, 1].\n\n"
      "Raises ValueError if e is outside.")
      .def(py::init<double>(), py::arg("e"));
  py::class_<NewtonImpactFrictionNSL, NonSmoothLaw>(
      module, "NewtonImpactFrictionNSL",
      "Unilateral contact with Coulomb friction mu >= 0 (4), Newton's impact law (6)-(7) with restitution\n"
      "en, et in [0, 1]; dim 2 in the plane, 3 in space.\n\nRaises ValueError if a value is outside.")
      .def(py::init<double, double, double, int>(), py::arg("en"), py::arg("et"), py::arg("mu"),
           py::arg("dim") = 2);
  py::class_<EqualityConditionNSL, NonSmoothLaw>(module, "EqualityConditionNSL",
                                                 "A bilateral constraint g = 0 of n rows.")
      .def(py::init<int>(), py::arg("n"));
}

void bind_force_elements(py::module_& module) {
  py::class_<ForceLaw>(module, "ForceLaw", "The force of an element, positive where it lengthens it.");
  py::class_<SpringDamper, ForceLaw>(
      module, "SpringDamper",
      R"(Linear spring and damper in parallel, f = −stiffness (l − rest_length) − damping l̇ [N].

Parameters
----------
stiffness : of either sign: a negative one pushes away from rest_length [N/m]
damping : >= 0 [N s/m]
rest_length : length without force [m]

Raises
------
ValueError
    If a value is not finite, or damping is negative.
)")
      .def(py::init<double, double, double>(), py::arg("stiffness"), py::arg("damping") = 0.0,
           py::arg("rest_length") = 0.0);
  py::class_<Actuator, ForceLaw>(module, "Actuator",
                                 R"(A given force f = u(t, l, l̇) [N], or a spring that is not linear.

Its work is that of an external force: it has no potential energy.

Parameters
----------
force : a number, or a function of (t, length, rate) that returns the force; `saltus.compiled` makes it fast, and
    "library:function" and C pointers serve as well: they get n = 1, q = length, v = rate, and write out[0]
parameters : handed on to a compiled or C function

Raises
------
ValueError
    If a number is not finite, or parameters are given without a function that takes them.
TypeError
    If force is something else, or returns something else than a number.
)")
      .def(py::init(&make_actuator), py::arg("force"), py::arg("parameters") = py::tuple());
  py::classh<ForceElement>(
      module, "ForceElement",
      R"(A spring, damper or actuator: the gap of a relation of one row is its length (or angle) l(q),
its Jacobian Wᵀ = ∂l/∂q, and W f(t, l, l̇) is part of the forces h.

Parameters
----------
relation : of size 1
law : SpringDamper or Actuator
name : for messages; unique in a system, which gives one if it is left out

Raises
------
ValueError
    If the relation has more than one row.
)")
      .def(py::init([](std::shared_ptr<Relation> relation, const ForceLaw& law, std::string name) {
             return std::make_shared<ForceElement>(std::move(relation), law, std::move(name));
           }),
           py::arg("relation"), py::arg("law"), py::arg("name") = "")
      .def_property_readonly("name", &ForceElement::name);
}

}  // namespace

py::dict description(const NonSmoothLaw& law) {
  using namespace py::literals;
  if (law.bilateral) return py::dict("name"_a = "EqualityConditionNSL");
  if (law.sets.size() != 1) return py::dict("name"_a = "NonSmoothLaw");
  const double normal = law.restitution[0];
  const auto* coulomb = std::get_if<Coulomb>(&law.sets.front());
  if (!coulomb) return py::dict("name"_a = "NewtonImpactNSL", "restitution"_a = normal);
  return py::dict("name"_a = "NewtonImpactFrictionNSL", "restitution"_a = normal,
                  "tangential_restitution"_a = law.restitution[1], "friction"_a = coulomb->mu);
}

void bind_models(py::module_& module) {
  bind_systems(module);
  bind_relations(module);
  bind_rheonomous(module);
  bind_driven(module);
  bind_laws(module);
  bind_force_elements(module);
}

}  // namespace saltus::python
