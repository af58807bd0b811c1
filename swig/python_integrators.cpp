#include "python_integrators.hpp"

#include <pybind11/stl.h>

#include <stdexcept>

namespace saltus::python {
namespace {

template <class Class>
py::object python_object(const Class* self) {
  return py::reinterpret_borrow<py::object>(
      py::detail::get_object_handle(self, py::detail::get_type_info(typeid(Class))));
}

std::string class_name(const py::object& self) { return py::str(py::type::of(self).attr("__name__")); }

// The method of the object's class, not of the base.
template <class Class>
py::object method(const py::object& self, const char* name, const char* signature) {
  const py::object own = py::getattr(py::type::of(self), name, py::none());
  if (own.is_none() || own.is(py::getattr(py::type::of<Class>(), name, py::none()))) {
    const std::string message = class_name(self) + " must define " + signature;
    PyErr_SetString(PyExc_NotImplementedError, message.c_str());
    throw py::error_already_set();
  }
  return self.attr(name);
}

// An object of the same class with the same attributes; its C++ side is a new one.
template <class Class>
std::unique_ptr<Class> copy_of(const Class* self) {
  const py::object original = python_object(self);
  const py::object type = py::type::of(original);
  py::object copy = type.attr("__new__")(type);
  py::type::of<Class>().attr("__init__")(copy);
  copy.attr("__dict__").attr("update")(original.attr("__dict__"));
  return py::cast<std::unique_ptr<Class>>(std::move(copy));
}

void require_size(const Vec& x, Eigen::Index size, const char* what) {
  if (x.size() != size)
    throw std::invalid_argument(std::string(what) + " must have " + std::to_string(size) + " entries, got " +
                                std::to_string(x.size()));
}

}  // namespace

std::string PyIntegrator::name() const { return class_name(python_object<OneStepIntegrator>(this)); }

void PyIntegrator::prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) {
  const auto prepare = method<OneStepIntegrator>(python_object<OneStepIntegrator>(this), "prepare",
                                                 "prepare(self, system, solver)");
  // Copies: Python may keep them longer than the simulation lives.
  prepare(py::cast(std::make_unique<NonSmoothDynamicalSystem>(model)), py::cast(solver.clone()));
}

StepReport PyIntegrator::step(double dt, State& state, Reactions& reactions) {
  const py::object self = python_object<OneStepIntegrator>(this);
  const auto step = method<OneStepIntegrator>(self, "step", "step(self, dt, state, reactions)");
  py::object new_state = py::cast(state);
  py::object new_reactions = py::cast(reactions);
  StepReport report;
  try {
    const py::object result = step(dt, new_state, new_reactions);
    if (!py::isinstance<StepReport>(result))
      throw py::type_error(class_name(self) + ".step must return a StepReport, got " +
                           Py_TYPE(result.ptr())->tp_name);
    report = result.cast<StepReport>();
  } catch (const StepFailure& failure) {
    report.status = failure.status;
  } catch (py::error_already_set& error) {
    if (!error.matches(py::module_::import("saltus._core").attr("StepFailure"))) throw;
    report.status = error.value().attr("status").cast<StepStatus>();
  }
  if (report.status != StepStatus::ok) return report;
  const auto& s = new_state.cast<const State&>();
  const auto& r = new_reactions.cast<const Reactions&>();
  const bool finite = s.q.allFinite() && s.v.allFinite() && r.lambda_plus.allFinite() &&
                      r.lambda_minus.allFinite() && r.force.allFinite() && r.impulse.allFinite();
  if (!finite) {
    report.status = StepStatus::not_finite;
    return report;
  }
  state = s;
  reactions = r;
  return report;
}

std::vector<double> PyIntegrator::memory() const {
  const py::object self = python_object<OneStepIntegrator>(this);
  if (!py::hasattr(self, "memory")) return {};
  const Vec values = to_vec(self.attr("memory")(), "memory");
  return {values.data(), values.data() + values.size()};
}

void PyIntegrator::remember(std::span<const double> memory) {
  const py::object self = python_object<OneStepIntegrator>(this);
  if (!py::hasattr(self, "memory")) return OneStepIntegrator::remember(memory);
  const auto remember =
      method<OneStepIntegrator>(self, "remember", "remember(self, memory), as it has memory");
  remember(to_array(Eigen::Map<const Vec>(memory.data(), static_cast<Eigen::Index>(memory.size()))));
}

std::unique_ptr<OneStepIntegrator> PyIntegrator::clone() const { return copy_of<OneStepIntegrator>(this); }

std::string_view PyContactSolver::name() const {
  const py::gil_scoped_acquire lock;
  if (name_.empty()) name_ = class_name(python_object<ContactSolver>(this));
  return name_;
}

bool PyContactSolver::accepts(const ContactProblem& problem) const {
  const py::gil_scoped_acquire lock;
  const py::object self = python_object<ContactSolver>(this);
  return py::getattr(self, "accepts")(problem.sets).cast<bool>();
}

SolveReport PyContactSolver::solve(const ContactProblem& problem, double* P) {
  const py::gil_scoped_acquire lock;
  const auto solve =
      method<ContactSolver>(python_object<ContactSolver>(this), "solve", "solve(self, G, b, sets, P)");
  const int rows = problem.rows();
  SolveReport report{.solver = name()};
  py::array_t<double> impulses(rows, P);
  const py::object iterations = solve(py::array_t<double>({rows, rows}, problem.G.row(0)),
                                      py::array_t<double>(rows, problem.b.data()), problem.sets, impulses);
  if (!iterations.is_none() && !py::isinstance<py::int_>(iterations))
    throw py::type_error(std::string(name()) + ".solve must return None or the number of iterations, got " +
                         Py_TYPE(iterations.ptr())->tp_name);
  if (!iterations.is_none()) report.iterations = iterations.cast<int>();
  std::copy_n(impulses.data(), rows, P);
  Vec xi(rows);
  report.certificate = certify(problem, P, xi.data());
  if (!report.certificate.within(problem.tolerance)) report.status = SolveStatus::breakdown;
  return report;
}

std::unique_ptr<ContactSolver> PyContactSolver::clone() const {
  const py::gil_scoped_acquire lock;
  return copy_of<ContactSolver>(this);
}

PyConfiguration::PyConfiguration(const NonSmoothDynamicalSystem& model)
    : model_(std::make_shared<NonSmoothDynamicalSystem>(model)),
      layout_(std::make_shared<Layout>(*model_)),
      configuration_(layout_) {
  move_to(model_->q0(), model_->t0());
}

void PyConfiguration::move_to(const Vec& q, std::optional<double> t) {
  require_size(q, layout_->coordinates, "q");
  if (layout_->rheonomous && !t)
    throw std::invalid_argument("move_to needs the time, because a relation depends on it, got none");
  configuration_.move_to(q, t.value_or(model_->t0()));
  if (!configuration_.factorise()) throw StepFailure{StepStatus::mass_not_positive_definite};
  if (!configuration_.finite()) throw StepFailure{StepStatus::gap_not_finite};
}

Vec PyConfiguration::forces(double t, const Vec& v) const {
  require_size(v, layout_->n, "v");
  Vec h(layout_->n);
  evaluate_forces(*layout_, t, configuration_.q(), v, h);
  return h;
}

Vec PyConfiguration::rates(const Vec& v) const {
  require_size(v, layout_->n, "v");
  Vec rate(layout_->coordinates);
  position_rates(*layout_, configuration_.q(), v, rate);
  return rate;
}

Vec PyConfiguration::solve_mass(const Vec& x) const {
  require_size(x, layout_->n, "x");
  Vec y = x;
  configuration_.solve_mass(y);
  return y;
}

Vec PyConfiguration::velocities(const Vec& v) {
  require_size(v, layout_->n, "v");
  Vec gamma(layout_->rows);
  for (int k = 0; k < static_cast<int>(layout_->contacts.size()); ++k)
    configuration_.relative_velocity(k, v, gamma.data() + layout_->contacts[k].row);
  return gamma;
}

std::vector<int> PyConfiguration::closed() const {
  const auto closed = configuration_.closed_contacts();
  return {closed.begin(), closed.end()};
}

double PyConfiguration::kinetic_energy(const Vec& v) const {
  require_size(v, layout_->n, "v");
  return configuration_.kinetic_energy(v);
}

PyContactStage::PyContactStage(const NonSmoothDynamicalSystem& model, ContactSolver& solver)
    : model_(std::make_shared<NonSmoothDynamicalSystem>(model)),
      layout_(std::make_shared<Layout>(*model_, solver.tolerance())),
      stage_(layout_, solver) {}

ContactImpulses PyContactStage::solve(const std::vector<int>& active, PyConfiguration& constraint,
                                      PyConfiguration& force, const Vec& v, const std::optional<Vec>& before,
                                      const std::optional<Vec>& warm_start) {
  require_size(v, layout_->n, "v");
  if (before) require_size(*before, layout_->rows, "before");
  if (warm_start) require_size(*warm_start, layout_->rows, "warm_start");
  if (!constraint.has_layout_of(*layout_) || !force.has_layout_of(*layout_))
    throw std::invalid_argument(
        "constraint and force must be configurations of the system of this ContactStage");
  for (int contact : active)
    if (contact < 0 || contact >= static_cast<int>(layout_->contacts.size()))
      throw std::invalid_argument("active must hold numbers of contacts from 0 to " +
                                  std::to_string(layout_->contacts.size() - 1) + ", got " +
                                  std::to_string(contact));
  ContactAssembly& assembly = stage_.assembly();
  assembly.assemble(active, constraint.get(), force.get(), force.get());
  assembly.set_b(constraint.get(), v);
  if (before) assembly.add_restitution(*before);
  const Vec start = warm_start ? *warm_start : Vec(Vec::Zero(layout_->rows));
  assembly.gather(start, 1.0, stage_.P());
  StepReport report;
  if (!stage_.solve(report)) throw StepFailure{report.status};
  ContactImpulses result{Vec::Zero(layout_->rows), Vec::Zero(layout_->n), report.solver_iterations,
                         report.residual};
  assembly.scatter(stage_.P(), 1.0, result.impulse);
  assembly.apply(1.0, stage_.P().data(), result.velocity);
  return result;
}

}  // namespace saltus::python
