#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include <array>
#include <optional>

#include "python_first_order.hpp"
#include "saltus/kernel/first_order/first_order_time_stepping.hpp"
#include "saltus/kernel/model/nonsmooth_law.hpp"
#include "saltus/numerics/solvers/registry.hpp"

namespace saltus::python {
namespace {

using Array = py::array_t<double, py::array::c_style>;
using Optional = std::optional<ArrayLike>;

std::optional<Matrix> optional_matrix(const Optional& values, const char* what) {
  return values ? std::optional(to_matrix(*values, what)) : std::nullopt;
}

std::optional<Vec> optional_vec(const Optional& values, const char* what) {
  return values ? std::optional(to_vec(*values, what)) : std::nullopt;
}

template <class System>
std::unique_ptr<System> make_linear_ds(const ArrayLike& x0, const Optional& A, const Optional& b,
                                       const Optional& M) {
  return std::make_unique<System>(
      to_vec(x0, "x0"),
      FirstOrderLinearDS::Terms{optional_matrix(A, "A"), optional_vec(b, "b"), optional_matrix(M, "M")});
}

template <class Relation>
std::unique_ptr<Relation> make_linear_relation(const ArrayLike& C, const ArrayLike& B, const Optional& D,
                                               const Optional& e) {
  return std::make_unique<Relation>(to_matrix(C, "C"), to_matrix(B, "B"),
                                    FirstOrderLinearR::Terms{optional_matrix(D, "D"), optional_vec(e, "e")});
}

void bind_systems(py::module_& module) {
  py::classh<FirstOrderDS, PyFirstOrderDS>(
      module, "FirstOrderNonLinearDS",
      R"(A first-order system M ẋ = f(t, x) + r. Derive from it and define

    def f(self, t, x, out): ...            # out (n,)
    def jacobian(self, t, x, out): ...     # optional, out (n, n): ∂f/∂x, by differences if it is left out

`out` is zero at the call; x is read-only and reused: copy what you want to keep.

Parameters
----------
x0 : (n,) initial state
M : (n, n), the identity if left out. It may be singular if M − θ Δt ∂f/∂x is not

Raises
------
ValueError
    If a shape is wrong or a value is not finite.
)")
      .def(py::init([](const ArrayLike& x0, const Optional& M) {
             return std::make_unique<PyFirstOrderDS>(to_vec(x0, "x0"), optional_matrix(M, "M"));
           }),
           py::arg("x0"), py::arg("M") = py::none())
      .def_property_readonly(
          "dimension", [](py::object self) { return initialised<FirstOrderDS>(self).dimension(); },
          "entries of x")
      .def_property_readonly("x0",
                             [](py::object self) { return to_array(initialised<FirstOrderDS>(self).x0()); })
      .def("__repr__", shown_by("first_order_ds_text"))
      .def("_repr_html_", shown_by("first_order_ds"));

  py::classh<FirstOrderLinearDS, FirstOrderDS, PyFirstOrderLinearDS>(
      module, "FirstOrderLinearDS",
      R"(Linear system M ẋ = A(t) x + b(t) + r. What varies is a method of a derived class,

    def A(self, t, out): ...               # out (n, n)
    def b(self, t, out): ...               # out (n,)

Parameters
----------
x0 : (n,) initial state
A : (n, n), b : (n,), zero if left out
M : (n, n), the identity if left out. It may be singular if M − θ Δt A is not

Raises
------
ValueError
    If a shape is wrong or a value is not finite.
)")
      .def(py::init(&make_linear_ds<PyFirstOrderLinearDS>), py::arg("x0"), py::arg("A") = py::none(),
           py::arg("b") = py::none(), py::arg("M") = py::none());

  py::classh<FirstOrderLinearTIDS, FirstOrderLinearDS>(
      module, "FirstOrderLinearTIDS", py::is_final(),
      "The same with constant A, b and M: the matrices of a step are made once.")
      .def(py::init(&make_linear_ds<FirstOrderLinearTIDS>), py::arg("x0"), py::arg("A") = py::none(),
           py::arg("b") = py::none(), py::arg("M") = py::none());
}

void bind_relations(py::module_& module) {
  py::classh<FirstOrderRelation, PyFirstOrderRelation>(
      module, "FirstOrderNonLinearR",
      R"(Output y = h(t, x, λ) and input r = g(t, x, λ) of first-order systems. Derive from it and define

    def output(self, t, x, lam, out): ...           # out (size,): y
    def input(self, t, x, lam, out): ...            # out (n,): r
    def output_dx(self, t, x, lam, out): ...        # optional, out (size, n): ∂h/∂x, likewise
    def output_dlambda(self, t, x, lam, out): ...   # (size, size)
    def input_dx(self, t, x, lam, out): ...         # (n, n)
    def input_dlambda(self, t, x, lam, out): ...    # (n, size)

What is left out is found by differences. x is [x1; x2] between two systems. `out` is zero at the call; x and lam are
read-only and reused: copy what you want to keep.

Parameters
----------
size : entries of y and of λ

Raises
------
ValueError
    If size < 1.
)")
      .def(py::init<int>(), py::arg("size"))
      .def_property_readonly("size",
                             [](py::object self) { return initialised<FirstOrderRelation>(self).size(); });

  py::classh<FirstOrderLinearR, FirstOrderRelation, PyFirstOrderLinearR>(
      module, "FirstOrderLinearR",
      R"(Linear relation y = C(t) x + D(t) λ + e(t), r = B(t) λ. What varies is a method of a derived class,

    def C(self, t, out): ...               # out (size, n), likewise D, B
    def e(self, t, out): ...               # out (size,)

Parameters
----------
C : (size, n)
B : (n, size)
D : (size, size), e : (size,), zero if left out

Raises
------
ValueError
    If shapes disagree or a value is not finite.
)")
      .def(py::init(&make_linear_relation<PyFirstOrderLinearR>), py::arg("C"), py::arg("B"),
           py::arg("D") = py::none(), py::arg("e") = py::none());

  py::classh<FirstOrderLinearTIR, FirstOrderLinearR>(module, "FirstOrderLinearTIR", py::is_final(),
                                                     "The same with constant matrices.")
      .def(py::init(&make_linear_relation<FirstOrderLinearTIR>), py::arg("C"), py::arg("B"),
           py::arg("D") = py::none(), py::arg("e") = py::none());
}

void bind_laws(py::module_& module) {
  py::class_<BoxLaws>(
      module, "BoxLaws",
      R"(Laws between y and λ, row by row: −y in the normal cone of [lower, upper] at λ, so that
y > 0 where λ = lower, y < 0 where λ = upper, y = 0 between.

Parameters
----------
lower, upper : (size,) bounds, -inf and inf where there are none

Raises
------
ValueError
    If sizes differ or lower > upper.
)")
      .def(py::init([](const ArrayLike& lower, const ArrayLike& upper) {
             BoxLaws laws{to_vec(lower, "lower"), to_vec(upper, "upper")};
             validate(laws, "BoxLaws");
             return laws;
           }),
           py::arg("lower"), py::arg("upper"))
      .def_property_readonly("size", &BoxLaws::rows)
      .def_property_readonly("lower", [](const BoxLaws& self) { return to_array(self.lower); })
      .def_property_readonly("upper", [](const BoxLaws& self) { return to_array(self.upper); });
  module.def("complementarity_laws", &complementarity_laws, py::arg("n"));
  module.def("relay_laws", &relay_laws, py::arg("n"), py::arg("lower") = -1.0, py::arg("upper") = 1.0);
  module.def("equality_laws", &equality_laws, py::arg("n"));
  module.def("mixed_complementarity_laws", &mixed_complementarity_laws, py::arg("equalities"),
             py::arg("inequalities"));
}

void bind_system(py::module_& module) {
  using Systems = std::vector<std::shared_ptr<FirstOrderDS>>;
  py::classh<FirstOrderSystem>(module, "FirstOrderSystemBase")
      .def(py::init([](const Systems& systems, double t0) {
             return std::make_unique<FirstOrderSystem>(
                 FirstOrderSystem::Systems(systems.begin(), systems.end()), t0);
           }),
           py::arg("systems"), py::arg("t0") = 0.0)
      .def(
          "connect",
          [](FirstOrderSystem& self, std::shared_ptr<FirstOrderRelation> relation, const BoxLaws& laws,
             const FirstOrderDS& first, const FirstOrderDS* second,
             std::string name) { self.link(std::move(relation), laws, first, second, std::move(name)); },
          py::arg("relation"), py::arg("law"), py::arg("ds1"), py::arg("ds2") = py::none(),
          py::arg("name") = "")
      .def_property_readonly("t0", &FirstOrderSystem::t0)
      .def_property_readonly("dimension", &FirstOrderSystem::dimension, "entries of x")
      .def_property_readonly(
          "dimensions",
          [](const FirstOrderSystem& self) {
            std::vector<int> all;
            for (const auto& system : self.systems()) all.push_back(system->dimension());
            return all;
          },
          "entries of x of each system")
      .def_property_readonly(
          "interactions",
          [](const FirstOrderSystem& self) {
            std::vector<std::pair<std::string, int>> all;
            for (const auto& link : self.links()) all.emplace_back(link.name, link.relation->size());
            return all;
          },
          "names of the relations and their sizes");
}

py::array rows_of(const std::vector<double>& column, long rows) {
  const py::ssize_t width = rows > 0 ? static_cast<py::ssize_t>(column.size()) / rows : 0;
  py::array_t<double> array({static_cast<py::ssize_t>(rows), width}, column.data());
  array.attr("flags").attr("writeable") = false;
  return array;
}

template <class Value>
py::array column_of(const std::vector<Value>& column) {
  py::array_t<Value> array(static_cast<py::ssize_t>(column.size()), column.data());
  array.attr("flags").attr("writeable") = false;
  return array;
}

py::dict to_dict(const FirstOrderRecording& recording) {
  py::dict all;
  all["t"] = column_of(recording.t);
  all["step"] = column_of(recording.step);
  all["x"] = rows_of(recording.x, recording.rows());
  all["r"] = rows_of(recording.r, recording.rows());
  all["y"] = rows_of(recording.y, recording.rows());
  all["lambda"] = rows_of(recording.lambda, recording.rows());
  all["iterations"] = column_of(recording.iterations);
  all["residual"] = column_of(recording.residual);
  return all;
}

/// Keeps arrays of Python what the simulation is.
class FirstOrderLive final : public FirstOrderObserver {
 public:
  using Arrays = std::vector<std::array<Array, 2>>;
  FirstOrderLive(Arrays systems, Arrays relations)
      : systems_(std::move(systems)), relations_(std::move(relations)) {}

  void observe(long, const FirstOrderState& state, const FirstOrderReport&) override {
    copy(systems_, state.x, state.r);
    copy(relations_, state.y, state.lambda);
  }

 private:
  static void copy(Arrays& arrays, const Vec& first, const Vec& second) {
    py::ssize_t at = 0;
    for (auto& [one, other] : arrays) {
      const py::ssize_t size = one.size();
      if (other.size() != size || at + size > first.size())
        throw std::invalid_argument("the arrays of a FirstOrderLive must have the sizes of the model");
      std::copy_n(first.data() + at, size, one.mutable_data());
      std::copy_n(second.data() + at, size, other.mutable_data());
      at += size;
    }
    if (at != first.size())
      throw std::invalid_argument("the arrays of a FirstOrderLive must have the sizes of the model");
  }

  Arrays systems_, relations_;
};

FirstOrderLive::Arrays to_live(const std::vector<std::array<py::array, 2>>& all) {
  FirstOrderLive::Arrays result;
  for (const auto& arrays : all) {
    for (const py::array& array : arrays)  // a converted copy would be seen by nobody
      if (!py::isinstance<Array>(array))
        throw py::type_error("the arrays of a FirstOrderLive must be contiguous and of float64");
    result.push_back({Array(arrays[0]), Array(arrays[1])});
  }
  return result;
}

void bind_simulation(py::module_& module) {
  py::classh<FirstOrderObserver>(module, "FirstOrderObserver", "Looks at the steps of a run.");
  py::classh<FirstOrderRecording, FirstOrderObserver>(module, "FirstOrderRecording",
                                                      "A run in memory, column by column.")
      .def(py::init<long>(), py::arg("every") = 1)
      .def_property_readonly("rows", &FirstOrderRecording::rows)
      .def("columns", &to_dict, "Copies of all columns, name: read-only array.");
  py::classh<FirstOrderLive, FirstOrderObserver>(
      module, "FirstOrderLive",
      "Keeps given arrays what the simulation is: of each system x and r, of each relation y and lambda.")
      .def(py::init([](const std::vector<std::array<py::array, 2>>& systems,
                       const std::vector<std::array<py::array, 2>>& relations) {
             return std::make_unique<FirstOrderLive>(to_live(systems), to_live(relations));
           }),
           py::arg("systems"), py::arg("relations"));
  py::class_<FirstOrderReport>(module, "FirstOrderReport", "What a step says about itself.")
      .def_readonly("iterations", &FirstOrderReport::iterations, "of Newton's method")
      .def_readonly("solver_iterations", &FirstOrderReport::solver_iterations, "of all these")
      .def_readonly("residual", &FirstOrderReport::residual,
                    "of the motion and the laws, relative to the terms that cancel");
  py::classh<FirstOrderTimeStepping>(module, "FirstOrderTimeSteppingBase")
      .def(py::init([](const FirstOrderSystem& system, double theta, double gamma, bool gamma_for_relation,
                       bool hold, double time_step, const std::string& solver, double tolerance) {
             const auto method = make_contact_solver(solver);
             method->set_tolerance(tolerance);
             return std::make_unique<FirstOrderTimeStepping>(
                 system, EulerMoreau::Weights{theta, gamma, gamma_for_relation, hold}, time_step, *method);
           }),
           py::arg("system"), py::arg("theta"), py::arg("gamma"), py::arg("gamma_for_relation"),
           py::arg("hold"), py::arg("time_step"), py::arg("solver"), py::arg("tolerance"))
      .def("add_observer", &FirstOrderTimeStepping::add_observer)
      .def("advance",
           [](FirstOrderTimeStepping& self, double until, const std::function<void(double)>& progress) {
             self.set_progress([progress](double t) {
               if (PyErr_CheckSignals() != 0) throw py::error_already_set();
               if (progress) progress(t);
             });
             self.run(until);
           })
      .def("take_step", &FirstOrderTimeStepping::step)
      .def_property_readonly("time_step", &FirstOrderTimeStepping::time_step)
      .def_property_readonly("steps", &FirstOrderTimeStepping::steps)
      .def_property_readonly("report", [](const FirstOrderTimeStepping& self) { return self.report(); })
      .def_property_readonly("t", [](const FirstOrderTimeStepping& self) { return self.state().t; })
      .def_property_readonly("x",
                             [](const FirstOrderTimeStepping& self) { return to_array(self.state().x); });
}

}  // namespace

void bind_first_order(py::module_& module) {
  bind_systems(module);
  bind_relations(module);
  bind_laws(module);
  bind_system(module);
  bind_simulation(module);
}

}  // namespace saltus::python
