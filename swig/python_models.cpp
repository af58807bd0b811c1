#include "python_models.hpp"

#include <stdexcept>

namespace saltus::python {
namespace {

template <class Class>
PyObject* python_self(const Class* object) {
  return py::detail::get_object_handle(object, py::detail::get_type_info(typeid(Class))).ptr();
}

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

CallArrays::CallArrays(py::ssize_t n, const std::vector<py::ssize_t>& shape)
    : q({n}, false), v({n}, false), out(shape, true) {}

std::unique_ptr<CallArrays> ArrayPool::take(py::ssize_t n, const std::vector<py::ssize_t>& out) {
  if (free_ && n == n_ && out == out_) return std::move(free_);
  n_ = n;
  out_ = out;
  return std::make_unique<CallArrays>(n, out);
}

bool CachedMethod::find(PyObject* self, py::handle base) {
  if (!searched_) {
    searched_ = true;
    self_ = self;
    const py::object type = py::type::of(py::handle(self));
    const py::object found = py::getattr(type, name_, py::none());
    if (!found.is_none() && !found.is(py::getattr(base, name_, py::none()))) function_ = found;
  }
  return static_cast<bool>(function_);
}

py::object CachedMethod::call(std::initializer_list<PyObject*> arguments) {
  PyObject* stack[5] = {self_};
  std::copy(arguments.begin(), arguments.end(), stack + 1);
  PyObject* result = PyObject_Vectorcall(function_.ptr(), stack, arguments.size() + 1, nullptr);
  if (!result) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(result);
}

void CachedMethod::fill(const double* t, const In& q, const double* v, double* out,
                        std::vector<py::ssize_t> shape) {
  auto arrays = pool_.take(q.size(), shape);
  arrays->q.set(q.data());
  arrays->out.set_zero();
  if (v) arrays->v.set(v);
  PyObject* const Q = arrays->q.object();
  PyObject* const V = arrays->v.object();
  PyObject* const O = arrays->out.object();
  const py::object time = t ? py::float_(*t) : py::object();
  const py::object result = t ? call({time.ptr(), Q, V, O}) : v ? call({Q, V, O}) : call({Q, O});
  if (!result.is_none())
    throw py::type_error(full_name() + " must write into out and return None, got " +
                         Py_TYPE(result.ptr())->tp_name);
  arrays->out.get(out, name_);
  pool_.give_back(std::move(arrays));
}

std::string CachedMethod::full_name() const { return std::string(Py_TYPE(self_)->tp_name) + "." + name_; }

void CachedMethod::missing(const char* signature) const {
  const std::string message = std::string(Py_TYPE(self_)->tp_name) + " must define " + signature;
  PyErr_SetString(PyExc_NotImplementedError, message.c_str());
  throw py::error_already_set();
}

PyLagrangianDS::PyLagrangianDS(Vec q0, Vec v0, std::optional<Matrix> mass)
    : LagrangianDS(std::move(q0), std::move(v0)), constant_mass_(std::move(mass)) {}

bool PyLagrangianDS::find(CachedMethod& method) const {
  return method.find(python_self<LagrangianDS>(this), py::type::of<LagrangianDS>());
}

void PyLagrangianDS::mass(const In& q, OutMatrix M) const {
  if (constant_mass_ && find(mass_))
    throw std::invalid_argument(mass_.full_name() +
                                " is defined and a constant mass= is given: one of them must go");
  if (constant_mass_) {
    M = *constant_mass_;
    return;
  }
  if (!find(mass_)) mass_.missing("mass(self, q, out), or give LagrangianDS a constant mass=");
  mass_.fill(nullptr, q, nullptr, M.data(), {M.rows(), M.cols()});
}

void PyLagrangianDS::forces(double t, const In& q, const In& v, Out h) const {
  if (!find(forces_)) forces_.missing("forces(self, t, q, v, out)");
  forces_.fill(&t, q, v.data(), h.data(), {h.size()});
}

double PyLagrangianDS::potential_energy(const In& q) const {
  if (!find(potential_energy_)) return LagrangianDS::potential_energy(q);
  CachedArray position({q.size()}, false);
  position.set(q.data());
  const py::object energy = potential_energy_.call({position.object()});
  const double value = PyFloat_AsDouble(energy.ptr());
  if (value == -1.0 && PyErr_Occurred()) {
    PyErr_Clear();
    throw py::type_error(potential_energy_.full_name() + " must return a number, got " +
                         Py_TYPE(energy.ptr())->tp_name);
  }
  return value;
}

bool PyRelation::find(CachedMethod& method) const {
  return method.find(python_self<Relation>(this), py::type::of<Relation>());
}

void PyRelation::gap(const In& q, Out g) const {
  if (!find(gap_)) gap_.missing("gap(self, q, out)");
  gap_.fill(nullptr, q, nullptr, g.data(), {g.size()});
}

void PyRelation::jacobian(const In& q, OutMatrix J) const {
  if (!find(jacobian_)) jacobian_.missing("jacobian(self, q, out)");
  jacobian_.fill(nullptr, q, nullptr, J.data(), {J.rows(), J.cols()});
}

bool PyRelation::has_curvature() const { return find(curvature_); }

void PyRelation::curvature(const In& q, const In& v, Out c) const {
  if (!has_curvature()) curvature_.missing("curvature(self, q, v, out)");
  curvature_.fill(nullptr, q, v.data(), c.data(), {c.size()});
}

}  // namespace saltus::python
