#include <pybind11/stl.h>

#include <cstdint>

#include "bindings.hpp"
#include "functions.hpp"
#include "saltus/kernel/model/plugged_models.hpp"

namespace saltus::python {
namespace {

// Of an object with the `address` of a C function, which it keeps alive; None: no function
template <class Signature>
PluggedFunction<Signature> plugged(const py::object& function) {
  if (function.is_none()) return {};
  const auto address = function.attr("address").cast<std::uintptr_t>();
  return {reinterpret_cast<Signature*>(address), hold(function)};
}

std::optional<Matrix> optional_matrix(const std::optional<py::object>& values, const char* what) {
  if (!values) return std::nullopt;
  return to_matrix(*values, what);
}

std::unique_ptr<PluggedDS> make_system(const ArrayLike& q0, const ArrayLike& v0, const py::dict& functions,
                                       const std::optional<py::object>& mass,
                                       const std::optional<py::object>& stiffness,
                                       const std::optional<py::object>& damping, const ArrayLike& force,
                                       const ArrayLike& z) {
  const auto of = [&](const char* name) -> py::object {
    return functions.contains(name) ? py::object(functions[name]) : py::none();
  };
  PluggedDS::Terms terms;
  terms.mass = plugged<PluggedDS::OfPosition>(of("Mass"));
  terms.internal_force = plugged<PluggedDS::OfTimeAndState>(of("FInt"));
  terms.gyroscopic_force = plugged<PluggedDS::OfState>(of("FGyr"));
  terms.external_force = plugged<PluggedDS::OfTime>(of("FExt"));
  terms.internal_dq = plugged<PluggedDS::OfTimeAndState>(of("JacobianFIntq"));
  terms.internal_dv = plugged<PluggedDS::OfTimeAndState>(of("JacobianFIntqDot"));
  terms.gyroscopic_dq = plugged<PluggedDS::OfState>(of("JacobianFGyrq"));
  terms.gyroscopic_dv = plugged<PluggedDS::OfState>(of("JacobianFGyrqDot"));
  terms.constant_mass = optional_matrix(mass, "mass");
  terms.stiffness = optional_matrix(stiffness, "stiffness");
  terms.damping = optional_matrix(damping, "damping");
  terms.constant_force = to_vec(force, "force");
  terms.z = to_vec(z, "z");
  return std::make_unique<PluggedDS>(to_vec(q0, "q0"), to_vec(v0, "v0"), std::move(terms));
}

}  // namespace

void bind_plugged(py::module_& module) {
  py::classh<PluggedDS, LagrangianDS>(
      module, "PluggedDS", py::is_final(),
      R"(A system whose terms are functions with the signatures of Siconos's plugins.

Parameters
----------
q0, v0 : (n,) initial position and velocity
functions : "Mass", "FInt", "FGyr", "FExt", "JacobianFIntq", "JacobianFIntqDot", "JacobianFGyrq", "JacobianFGyrqDot",
    each an object with the `address` of a C function
mass : (n, n) if it is no function
stiffness, damping : (n, n) K, C, zero if left out
force : (n,) what is constant of F_ext − F_int − F_gyr
z : parameters of all functions

Raises
------
ValueError
    If shapes disagree, a value is not finite, or mass is given twice or not at all.
)")
      .def(py::init(&make_system), py::arg("q0"), py::arg("v0"), py::arg("functions"), py::arg("mass"),
           py::arg("stiffness"), py::arg("damping"), py::arg("force"), py::arg("z"));

  py::classh<PluggedRelation, Relation>(module, "PluggedRelation", py::is_final(),
                                        R"(y = h(q) by functions with the signatures of Siconos's plugins.

Parameters
----------
size : number of rows
h, jacobian, rate : h, H = ∂h/∂q, and Ḣ or None: objects with the `address` of a C function

Raises
------
ValueError
    If size < 1 or a function is missing.
)")
      .def(py::init([](int size, const py::object& h, const py::object& jacobian, const py::object& rate) {
             return std::make_unique<PluggedRelation>(size, plugged<PluggedRelation::OfPosition>(h),
                                                      plugged<PluggedRelation::OfPosition>(jacobian),
                                                      plugged<PluggedRelation::OfState>(rate));
           }),
           py::arg("size"), py::arg("h"), py::arg("jacobian"), py::arg("rate"));

  py::classh<PluggedRheonomousRelation, Relation>(module, "PluggedRheonomousRelation", py::is_final(),
                                                  R"(y = h(t, q) likewise, with ∂h/∂t.

Parameters
----------
size : number of rows
h, jacobian, motion : h, H = ∂h/∂q, ∂h/∂t: objects with the `address` of a C function

Raises
------
ValueError
    If size < 1 or a function is missing.
)")
      .def(py::init([](int size, const py::object& h, const py::object& jacobian, const py::object& motion) {
             using Signature = PluggedRheonomousRelation::OfTimeAndPosition;
             return std::make_unique<PluggedRheonomousRelation>(
                 size, plugged<Signature>(h), plugged<Signature>(jacobian), plugged<Signature>(motion));
           }),
           py::arg("size"), py::arg("h"), py::arg("jacobian"), py::arg("motion"));
}

}  // namespace saltus::python
