#include <pybind11/stl.h>

#include <memory>
#include <stdexcept>

#include "bindings.hpp"
#include "python_integrators.hpp"
#include "saltus/numerics/problems.hpp"
#include "saltus/numerics/solvers/registry.hpp"
#include "saltus/numerics/text.hpp"

namespace saltus::python {
namespace {

struct Solution {
  py::array_t<double> P, xi;
  std::string status, solver;
  double residual, scale;
  int iterations;
};

template <class T>
std::vector<T> to_list(const py::object& values) {
  const auto array = py::array_t<T, py::array::c_style | py::array::forcecast>::ensure(values);
  return {array.data(), array.data() + array.size()};
}

}  // namespace

ContactProblem to_problem(const py::object& G, const ArrayLike& b, const std::vector<ContactSet>& sets) {
  ContactProblem problem{{}, to_vec(b, "b"), sets};
  if (py::hasattr(G, "indptr"))
    problem.sparse = {to_list<int>(G.attr("indptr")), to_list<int>(G.attr("indices")),
                      to_list<double>(G.attr("data"))};
  else
    problem.G = to_matrix(G, "G");
  validate(problem);
  return problem;
}

py::object matrix_of(const ContactProblem& problem) {
  if (!problem.is_sparse()) return matrix_to_array(problem.G.view());
  const auto array = [](const auto& values) {
    return py::array_t<typename std::decay_t<decltype(values)>::value_type>(values.size(), values.data());
  };
  const SparseRows& G = problem.sparse;
  return py::module_::import("scipy.sparse")
      .attr("csr_array")(py::make_tuple(array(G.value), array(G.column), array(G.start)),
                         py::arg("shape") = py::make_tuple(problem.rows(), problem.rows()));
}

namespace {

Solution solve(const ArrayLike& G, const ArrayLike& b, const std::vector<ContactSet>& sets,
               const std::string& solver, const std::optional<ArrayLike>& warm_start) {
  const auto method = make_contact_solver(solver);
  ContactProblem problem = to_problem(G, b, sets);
  if (problem.is_sparse() && !method->takes_sparse()) problem = dense(problem);
  if (!method->accepts(problem))
    throw std::invalid_argument(
        "the contact solver '" + solver +
        "' does not accept this problem: its sets or its size are not among those it solves");
  Vec P = Vec::Zero(problem.rows());
  if (warm_start) {
    const Vec start = to_vec(*warm_start, "warm_start");
    if (start.size() != P.size() || !start.allFinite())
      throw std::invalid_argument("warm_start must be finite and have " + std::to_string(P.size()) +
                                  " entries as b has, got " + std::to_string(start.size()) +
                                  (start.allFinite() ? "" : " with NaN or infinity"));
    P = start;
  }
  method->reserve(problem.rows());
  const SolveReport report = method->solve(problem, P.data());
  Vec xi(P.size());
  const Certificate certificate = certify(problem, P.data(), xi.data());
  return {to_array(P),
          to_array(xi),
          std::string(to_string(report.status)),
          std::string(report.solver),
          certificate.residual,
          certificate.scale,
          report.iterations};
}

void bind_problems(py::module_& module) {
  py::class_<ProblemSolution>(module, "ProblemSolution",
                              "What a solver found, judged by a residual that was computed outside of it.")
      .def_property_readonly(
          "solution", [](const ProblemSolution& self) { return to_array(self.solution); },
          "(rows,) z of a complementarity problem, r of a friction problem")
      .def_property_readonly(
          "status", [](const ProblemSolution& self) { return std::string(to_string(self.status)); },
          "'solved', 'ray', 'iteration-limit' or 'breakdown'")
      .def_readonly("iterations", &ProblemSolution::iterations, "of the method that answered")
      .def_readonly("residual", &ProblemSolution::residual, "relative, as the problem's class defines it")
      .def_readonly("solver", &ProblemSolution::solver, "the method that answered")
      .def_readonly(
          "unique", &ProblemSolution::unique,
          "is it the only solution with these w or u? None if it is no solution, or that is not known")
      .def("__repr__",
           [](const ProblemSolution& self) {
             return std::string(to_string(self.status)) + " by " + self.solver + " in " +
                    std::to_string(self.iterations) + " iterations, residual " + number(self.residual) +
                    ", " + std::to_string(self.solution.size()) + " unknowns" +
                    (self.unique == false ? ", not unique" : "");
           })
      .def("_repr_html_", shown_by("solution"));
  module.def(
      "solve_problem",
      [](const ArrayLike& G, const ArrayLike& b, const std::vector<ContactSet>& sets,
         const std::string& solver, double tolerance, const std::optional<ArrayLike>& warm_start) {
        const ContactProblem problem = to_problem(G, b, sets);
        const Vec start = warm_start ? to_vec(*warm_start, "warm_start") : Vec(Vec::Zero(problem.rows()));
        const auto method = make_contact_solver(solver);
        py::gil_scoped_release others_may_run;  // solvers in Python take it back
        return solve_problem(problem, *method, tolerance, start);
      },
      py::arg("G"), py::arg("b"), py::arg("sets"), py::arg("solver"), py::arg("tolerance"),
      py::arg("warm_start"));
  module.def(
      "problem_residual",
      [](const ArrayLike& G, const ArrayLike& b, const std::vector<ContactSet>& sets, const ArrayLike& P) {
        const ContactProblem problem = to_problem(G, b, sets);
        return problem_residual(problem, to_sized_vec(P, "solution", problem.rows()).data());
      },
      py::arg("G"), py::arg("b"), py::arg("sets"), py::arg("P"));
}

}  // namespace

void bind_numerics(py::module_& module) {
  py::class_<Equality>(module, "Equality", "The set of xi = 0, P free. One row.").def(py::init<>());
  py::class_<NonNegative>(module, "NonNegative", "The set of 0 <= xi, 0 <= P, xi P = 0. One row.")
      .def(py::init<>());
  py::class_<Coulomb>(module, "Coulomb",
                      "Coulomb's law (7): a normal row and dim - 1 tangential rows, |P_T| <= mu P_N.")
      .def(py::init([](double mu, int dim) { return Coulomb{mu, dim}; }), py::arg("mu"), py::arg("dim") = 2)
      .def_readonly("mu", &Coulomb::mu)
      .def_readonly("dim", &Coulomb::dim);

  py::class_<Solution>(module, "ContactSolution", "What a contact solver found, and its certificate.")
      .def_readonly("P", &Solution::P, "(rows,) impulses [N s]")
      .def_readonly("xi", &Solution::xi, "(rows,) G P + b [m/s]")
      .def_readonly("status", &Solution::status, "'solved', 'ray', 'iteration-limit' or 'breakdown'")
      .def_readonly("solver", &Solution::solver, "the method that answered")
      .def_readonly("residual", &Solution::residual, "natural map, computed outside the solver [m/s]")
      .def_readonly("scale", &Solution::scale, "size of the terms in G P + b [m/s]")
      .def_readonly("iterations", &Solution::iterations)
      .def("__repr__",
           [](const Solution& s) {
             return "ContactSolution(status='" + s.status + "', solver='" + s.solver +
                    "', residual=" + std::string(py::str(py::float_(s.residual))) + ")";
           })
      .def("_repr_html_", shown_by("contact_solution"));
  py::classh<ContactSolver, PyContactSolver>(module, "ContactSolver", py::dynamic_attr(),
                                             R"(A contact solver. To write one, derive from it and define

    def solve(self, G, b, sets, P): ...    # write the impulses into P (rows,), which comes in as warm start
    def accepts(self, sets): ...           # optional: can it take these contact sets?

`solve` may return its number of iterations. Whether the problem is solved is not its word: the certificate is computed
from P.
)")
      .def(py::init<>())
      .def_property_readonly("name", [](const ContactSolver& self) { return std::string(self.name()); })
      .def(
          "accepts", [](const ContactSolver&, const std::vector<ContactSet>&) { return true; },
          py::arg("sets"));
  module.def("load_contact_solver", &load_contact_solver);
  module.def("register_solver_class", [](const std::string& name, const std::string& summary,
                                         const py::function& make) {
    PyObject* const factory = py::function(make).release().ptr();  // lives as long as the process
    register_contact_solver({name, summary, [factory] {
                               return py::cast<std::unique_ptr<ContactSolver>>(py::handle(factory)());
                             }});
  });
  module.def("solve", &solve, py::arg("G"), py::arg("b"), py::arg("sets"), py::arg("solver") = "auto",
             py::arg("warm_start") = py::none(),
             R"(Find P such that xi = G P + b and every contact's law holds between xi and P.

Parameters
----------
G : (rows, rows) [1/kg], an array or a scipy.sparse.csr_array; may be unsymmetric and rank-deficient
b : (rows,) [m/s]
sets : contact sets in the order of the rows
solver : name out of solvers()
warm_start : (rows,) [N s]

Raises
------
ValueError
    If shapes disagree, a value is not finite, or the solver does not accept the problem.
)");
  bind_problems(module);
  module.def(
      "solvers",
      [] {
        py::dict table;
        for (const SolverEntry& entry : contact_solvers()) table[py::str(entry.name)] = entry.summary;
        return table;
      },
      "The registered contact solvers, name: summary.");
}

}  // namespace saltus::python
