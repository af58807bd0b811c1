#include "python_models.hpp"

#include <stdexcept>
#include <vector>

namespace saltus::python {
namespace {

template <class Class>
PyObject* python_self(const Class* object) {
  return py::detail::get_object_handle(object, py::detail::get_type_info(typeid(Class))).ptr();
}

}  // namespace

void CachedArray::shape(std::initializer_list<py::ssize_t> shape, bool writable) {
  if (size_ >= 0) {
    py::ssize_t size = 1;
    for (py::ssize_t extent : shape) size *= extent;
    if (size != size_)
      throw std::invalid_argument("a relation can only be used with systems of one dimension: had " +
                                  std::to_string(size_) + " entries, now " + std::to_string(size));
    return;
  }
  array_ = py::array_t<double>(std::vector<py::ssize_t>(shape));
  data_ = array_.mutable_data();
  size_ = array_.size();
  if (!writable) array_.attr("flags").attr("writeable") = false;
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

void CachedMethod::fill(std::initializer_list<PyObject*> arguments) {
  const py::object result = call(arguments);
  if (result.is_none()) return;
  throw py::type_error(std::string(Py_TYPE(self_)->tp_name) + "." + name_ +
                       " must write into out and return None, got " + Py_TYPE(result.ptr())->tp_name);
}

void CachedMethod::missing(const char* signature) const {
  const std::string message = std::string(Py_TYPE(self_)->tp_name) + " must define " + signature;
  PyErr_SetString(PyExc_NotImplementedError, message.c_str());
  throw py::error_already_set();
}

PyLagrangianDS::PyLagrangianDS(Vec q0, Vec v0, std::optional<Matrix> mass)
    : LagrangianDS(std::move(q0), std::move(v0)), constant_mass_(std::move(mass)) {}

void PyLagrangianDS::mass(const In& q, OutMatrix M) const {
  if (constant_mass_) {
    M = *constant_mass_;
    return;
  }
  if (!mass_.find(python_self<LagrangianDS>(this), py::type::of<LagrangianDS>()))
    mass_.missing("mass(self, q, out), or give LagrangianDS a constant mass=");
  q_.shape({dimension()}, false);
  M_.shape({dimension(), dimension()}, true);
  q_.set(q.data());
  M_.set_zero();
  mass_.fill({q_.object(), M_.object()});
  M_.get(M.data());
}

void PyLagrangianDS::forces(double t, const In& q, const In& v, Out h) const {
  if (!forces_.find(python_self<LagrangianDS>(this), py::type::of<LagrangianDS>()))
    forces_.missing("forces(self, t, q, v, out)");
  q_.shape({dimension()}, false);
  v_.shape({dimension()}, false);
  h_.shape({dimension()}, true);
  q_.set(q.data());
  v_.set(v.data());
  h_.set_zero();
  const py::float_ time(t);
  forces_.fill({time.ptr(), q_.object(), v_.object(), h_.object()});
  h_.get(h.data());
}

double PyLagrangianDS::potential_energy(const In& q) const {
  if (!potential_energy_.find(python_self<LagrangianDS>(this), py::type::of<LagrangianDS>()))
    return LagrangianDS::potential_energy(q);
  q_.shape({dimension()}, false);
  q_.set(q.data());
  return potential_energy_.call({q_.object()}).cast<double>();
}

void PyRelation::gap(const In& q, Out g) const {
  if (!gap_.find(python_self<Relation>(this), py::type::of<Relation>())) gap_.missing("gap(self, q, out)");
  q_.shape({q.size()}, false);
  g_.shape({g.size()}, true);
  q_.set(q.data());
  g_.set_zero();
  gap_.fill({q_.object(), g_.object()});
  g_.get(g.data());
}

void PyRelation::jacobian(const In& q, OutMatrix J) const {
  if (!jacobian_.find(python_self<Relation>(this), py::type::of<Relation>()))
    jacobian_.missing("jacobian(self, q, out)");
  q_.shape({q.size()}, false);
  J_.shape({size(), q.size()}, true);
  q_.set(q.data());
  J_.set_zero();
  jacobian_.fill({q_.object(), J_.object()});
  J_.get(J.data());
}

bool PyRelation::has_curvature() const {
  return curvature_.find(python_self<Relation>(this), py::type::of<Relation>());
}

void PyRelation::curvature(const In& q, const In& v, Out c) const {
  if (!has_curvature()) curvature_.missing("curvature(self, q, v, out)");
  q_.shape({q.size()}, false);
  v_.shape({v.size()}, false);
  c_.shape({size()}, true);
  q_.set(q.data());
  v_.set(v.data());
  c_.set_zero();
  curvature_.fill({q_.object(), v_.object(), c_.object()});
  c_.get(c.data());
}

}  // namespace saltus::python
