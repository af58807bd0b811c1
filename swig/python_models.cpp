#include "python_models.hpp"

#include <stdexcept>

#include "functions.hpp"

namespace saltus::python {
namespace {

py::ssize_t product(const std::vector<py::ssize_t>& shape) {
  py::ssize_t size = 1;
  for (py::ssize_t extent : shape) size *= extent;
  return size;
}

}  // namespace

CachedArray::CachedArray(std::vector<py::ssize_t> shape, bool writable)
    : shape_(std::move(shape)), size_(product(shape_)) {
  auto* memory = new std::vector<double>(size_);
  const py::capsule owner(memory, [](void* pointer) { delete static_cast<std::vector<double>*>(pointer); });
  data_ = memory->data();
  array_ = py::array_t<double>(shape_, data_, owner);
  if (!writable) array_.attr("flags").attr("writeable") = false;
}

void CachedArray::get(double* values, const char* method) const {
  bool intact = py::isinstance<py::array_t<double>>(array_) && array_.data() == data_ &&
                array_.ndim() == static_cast<py::ssize_t>(shape_.size());
  for (std::size_t k = 0; intact && k < shape_.size(); ++k)
    intact = array_.shape(static_cast<py::ssize_t>(k)) == shape_[k];
  if (!intact) throw py::type_error(std::string(method) + " must leave type and shape of out as they are");
  std::copy_n(data_, size_, values);
}

CallArrays::CallArrays(py::ssize_t coordinates, py::ssize_t freedoms, const std::vector<py::ssize_t>& shape)
    : q({coordinates}, false), v({freedoms}, false), out(shape, true) {}

std::unique_ptr<CallArrays> ArrayPool::take(py::ssize_t coordinates, py::ssize_t freedoms,
                                            const std::vector<py::ssize_t>& out) {
  if (free_ && coordinates == coordinates_ && freedoms == freedoms_ && out == out_) return std::move(free_);
  coordinates_ = coordinates;
  freedoms_ = freedoms;
  out_ = out;
  return std::make_unique<CallArrays>(coordinates, freedoms, out);
}

void CachedMethod::search(PyObject* self, py::handle base) {
  searched_ = true;
  self_ = self;
  const py::object type = py::type::of(py::handle(self));
  const py::object found = py::getattr(type, name_, py::none());
  if (!found.is_none() && !found.is(py::getattr(base, name_, py::none()))) function_ = found;
}

py::object CachedMethod::call(std::initializer_list<PyObject*> arguments) {
  PyObject* stack[5] = {self_};
  std::copy(arguments.begin(), arguments.end(), stack + 1);
  PyObject* result = PyObject_Vectorcall(function_.ptr(), stack, arguments.size() + 1, nullptr);
  if (!result) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(result);
}

void CachedMethod::fill(const double* t, const In& q, const In* v, double* out,
                        std::vector<py::ssize_t> shape, const double* start) {
  auto arrays = pool_.take(q.size(), v ? v->size() : 0, shape);
  arrays->q.set(q.data());
  if (start)
    arrays->out.set(start);
  else
    arrays->out.set_zero();
  if (v) arrays->v.set(v->data());
  PyObject* const Q = arrays->q.object();
  PyObject* const V = arrays->v.object();
  PyObject* const O = arrays->out.object();
  const py::object time = t ? py::float_(*t) : py::object();
  const py::object result = t && v ? call({time.ptr(), Q, V, O})
                            : t    ? call({time.ptr(), Q, O})
                            : v    ? call({Q, V, O})
                                   : call({Q, O});
  take(result, *arrays, out);
  pool_.give_back(std::move(arrays));
}

void CachedMethod::fill_at(double t, double* out, std::vector<py::ssize_t> shape) {
  auto arrays = pool_.take(0, 0, shape);
  arrays->out.set_zero();
  const py::float_ time(t);
  take(call({time.ptr(), arrays->out.object()}), *arrays, out);
  pool_.give_back(std::move(arrays));
}

void CachedMethod::take(const py::object& result, const CallArrays& arrays, double* out) const {
  if (!result.is_none())
    throw py::type_error(full_name() + " must write into out and return None, got " +
                         Py_TYPE(result.ptr())->tp_name);
  arrays.out.get(out, name_);
}

double CachedMethod::number(const In& q) {
  CachedArray position({q.size()}, false);
  position.set(q.data());
  const py::object result = call({position.object()});
  const double value = PyFloat_AsDouble(result.ptr());
  if (value == -1.0 && PyErr_Occurred()) {
    PyErr_Clear();
    throw py::type_error(full_name() + " must return a number, got " + Py_TYPE(result.ptr())->tp_name);
  }
  return value;
}

std::string CachedMethod::full_name() const { return std::string(Py_TYPE(self_)->tp_name) + "." + name_; }

void CachedMethod::forbid(bool found) const {
  if (found)
    throw std::invalid_argument(full_name() + " is defined and " + name_ +
                                "= is given to the base class: one of them must go");
}

void CachedMethod::missing(const char* signature) const {
  const std::string message = std::string(Py_TYPE(self_)->tp_name) + " must define " + signature;
  PyErr_SetString(PyExc_NotImplementedError, message.c_str());
  throw py::error_already_set();
}

void PyLagrangianDS::mass(const In& q, OutMatrix M) const {
  const bool given = functions().mass || functions().constant_mass;
  if (given) {
    mass_.forbid(find(mass_));
    return FunctionDS::mass(q, M);
  }
  if (!find(mass_)) mass_.missing("mass(self, q, out), or give LagrangianDS mass=");
  mass_.fill(nullptr, q, nullptr, M.data(), {M.rows(), M.cols()});
}

void PyLagrangianDS::forces(double t, const In& q, const In& v, Out h) const {
  if (functions().forces) {
    forces_.forbid(find(forces_));
    return FunctionDS::forces(t, q, v, h);
  }
  if (!find(forces_)) forces_.missing("forces(self, t, q, v, out), or give LagrangianDS forces=");
  forces_.fill(&t, q, &v, h.data(), {h.size()});
}

bool PyLagrangianDS::force_jacobians(double t, const In& q, const In& v, OutMatrix dh_dq,
                                     OutMatrix dh_dv) const {
  if (functions().force_jacobians) {
    force_jacobians_.forbid(find(force_jacobians_));
    return FunctionDS::force_jacobians(t, q, v, dh_dq, dh_dv);
  }
  if (!find(force_jacobians_)) return false;
  std::vector<double> both(2 * dh_dq.size());
  force_jacobians_.fill(&t, q, &v, both.data(), {2, dh_dq.rows(), dh_dq.cols()});
  std::copy_n(both.data(), dh_dq.size(), dh_dq.data());
  std::copy_n(both.data() + dh_dq.size(), dh_dv.size(), dh_dv.data());
  return true;
}

double PyLagrangianDS::potential_energy(const In& q) const {
  if (functions().potential_energy) potential_energy_.forbid(find(potential_energy_));
  if (!find(potential_energy_)) return FunctionDS::potential_energy(q);
  return potential_energy_.number(q);
}

bool PyLagrangianDS::has_velocity_map() const {
  if (!find(velocity_map_)) {
    if (find(normalise_))
      throw std::invalid_argument(normalise_.full_name() +
                                  " is asked for only beside velocity_map, got none");
    return false;
  }
  const Functions& given = functions();
  if (given.mass || given.forces || given.force_jacobians || given.potential_energy)
    throw std::invalid_argument(velocity_map_.full_name() +
                                " takes methods beside it, compiled and C functions are for q̇ = v");
  return true;
}

void PyLagrangianDS::position_rate(const In& q, const In& v, Out rate) const {
  Matrix Y(q.size(), v.size());
  velocity_map_.fill(nullptr, q, nullptr, Y.data(), {Y.rows(), Y.cols()});
  rate.noalias() = Y * v;
}

void PyLagrangianDS::normalise(Out q) const {
  if (!find(normalise_)) return;
  const Vec before = q;
  normalise_.fill(nullptr, {before.data(), before.size()}, nullptr, q.data(), {q.size()}, before.data());
}

namespace {

// Methods of other classes would have no effect.
template <class Class>
void refuse_methods(const Class* object, std::initializer_list<const char*> names, const char* asked_for) {
  for (const char* name : names)
    if (CachedMethod method(name); method.find<Class>(object))
      throw std::invalid_argument(method.full_name() + " is not asked for: " + asked_for);
}

}  // namespace

bool PyLagrangianLinearTIDS::driven() const {
  if (!looked_at_)
    refuse_methods<LagrangianLinearTIDS>(
        this, {"forces", "mass", "force_jacobians", "velocity_map", "normalise", "potential_energy"},
        "what varies in a linear system is external_force");
  looked_at_ = true;
  return external_force_.find<LagrangianLinearTIDS>(this);
}

void PyLagrangianLinearTIDS::external_force(double t, Out f) const {
  if (!driven()) return LagrangianLinearTIDS::external_force(t, f);
  external_force_.forbid(has_external_force());
  external_force_.fill_at(t, f.data(), {f.size()});
}

void PyNewtonEulerDS::loads(double t, const In& q, const In& v, BodyLoads& loads) const {
  if (!looked_at_)
    refuse_methods<NewtonEulerDS>(this, {"forces", "mass", "force_jacobians", "velocity_map", "normalise"},
                                  "loads of a rigid body are force, moment, body_force and body_moment");
  looked_at_ = true;
  const auto take = [&](CachedMethod& method, Vec3& load) {
    if (!find(method)) return;
    method.forbid(!load.isZero(0.0));
    method.fill(&t, q, &v, load.data(), {3});
  };
  take(force_, loads.force);
  take(moment_, loads.moment);
  take(body_force_, loads.body_force);
  take(body_moment_, loads.body_moment);
}

bool PyNewtonEulerDS::varying_loads() const {
  return find(force_) || find(moment_) || find(body_force_) || find(body_moment_);
}

double PyNewtonEulerDS::potential_energy(const In& q) const {
  return find(potential_energy_) ? potential_energy_.number(q) : NewtonEulerDS::potential_energy(q);
}

void PyRheonomousRelation::call(CachedMethod& method, double t, const In& q, const In* v, double* out,
                                std::vector<py::ssize_t> shape, const char* signature) const {
  if (!find(method)) method.missing(signature);
  method.fill(&t, q, v, out, std::move(shape));
}

void PyRheonomousRelation::gap_at(double t, const In& q, Out g) const {
  call(gap_, t, q, nullptr, g.data(), {g.size()}, "gap(self, t, q, out)");
}

void PyRheonomousRelation::jacobian_at(double t, const In& q, OutMatrix J) const {
  call(jacobian_, t, q, nullptr, J.data(), {J.rows(), J.cols()}, "jacobian(self, t, q, out)");
}

void PyRheonomousRelation::motion_at(double t, const In& q, Out w) const {
  call(motion_, t, q, nullptr, w.data(), {w.size()}, "motion(self, t, q, out)");
}

void PyRheonomousRelation::curvature_at(double t, const In& q, const In& v, Out c) const {
  call(curvature_, t, q, &v, c.data(), {c.size()}, "curvature(self, t, q, v, out)");
}

void PyRelation::gap(const In& q, Out g) const {
  if (functions().gap) {
    gap_.forbid(find(gap_));
    return FunctionRelation::gap(q, g);
  }
  if (!find(gap_)) gap_.missing("gap(self, q, out), or give the relation gap=");
  gap_.fill(nullptr, q, nullptr, g.data(), {g.size()});
}

void PyRelation::jacobian(const In& q, OutMatrix J) const {
  if (functions().jacobian) {
    jacobian_.forbid(find(jacobian_));
    return FunctionRelation::jacobian(q, J);
  }
  if (!find(jacobian_)) jacobian_.missing("jacobian(self, q, out), or give the relation jacobian=");
  jacobian_.fill(nullptr, q, nullptr, J.data(), {J.rows(), J.cols()});
}

bool PyRelation::has_curvature() const { return functions().curvature || find(curvature_); }

void PyRelation::curvature(const In& q, const In& v, Out c) const {
  if (functions().curvature) {
    curvature_.forbid(find(curvature_));
    return FunctionRelation::curvature(q, v, c);
  }
  if (!find(curvature_)) curvature_.missing("curvature(self, q, v, out)");
  curvature_.fill(nullptr, q, &v, c.data(), {c.size()});
}

namespace {

// f of a Python callable of (t, length, rate)
ForceLaw::Function callable_force(const py::object& callable) {
  const auto held = hold(callable);
  return [held](double t, double length, double rate) {
    const py::object force = (*held)(t, length, rate);
    const double value = PyFloat_AsDouble(force.ptr());
    if (value == -1.0 && PyErr_Occurred()) {
      PyErr_Clear();
      throw py::type_error("the force of an Actuator must return a number, got " +
                           std::string(Py_TYPE(force.ptr())->tp_name));
    }
    return value;
  };
}

}  // namespace

Actuator make_actuator(const py::object& force, const ArrayLike& parameters) {
  Vec values = to_vec(parameters, "parameters");
  const auto refuse_parameters = [&](const char* kind) {
    if (values.size() > 0)
      throw std::invalid_argument("parameters are for compiled and C functions, got " +
                                  std::to_string(values.size()) + " for a force that is a " + kind);
  };
  if (py::module_::import("saltus.functions").attr("is_native")(force).cast<bool>()) {
    ModelFunction function = to_model_function(force, "force", 1, values);
    return Actuator(std::move(function), std::move(values));
  }
  if (PyCallable_Check(force.ptr())) {
    refuse_parameters("Python function");
    return Actuator(callable_force(force));
  }
  const double constant = PyFloat_AsDouble(force.ptr());
  if (constant == -1.0 && PyErr_Occurred()) {
    PyErr_Clear();
    throw py::type_error(
        "force must be a number, a function of (t, length, rate), a compiled one or a pointer to a C "
        "function, "
        "got " +
        std::string(Py_TYPE(force.ptr())->tp_name));
  }
  refuse_parameters("number");
  return Actuator(constant);
}

}  // namespace saltus::python
