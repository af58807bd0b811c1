#pragma once
// Models written in Python: classes that derive from LagrangianDS and LagrangianScleronomousR.
#include <pybind11/trampoline_self_life_support.h>

#include <optional>

#include "bindings.hpp"
#include "saltus/kernel/model/lagrangian_ds.hpp"
#include "saltus/kernel/model/relation.hpp"

namespace saltus::python {

/// An array that a method of a Python model reads or writes. It is made once and lives as long as the
/// model: making arrays is what costs in a call, not the call.
class CachedArray {
 public:
  /// Makes the array at the first call. @param writable  false: assignment in Python is an error
  void shape(std::initializer_list<py::ssize_t> shape, bool writable);
  void set(const double* values) { std::copy_n(values, size_, data_); }
  void set_zero() { std::fill_n(data_, size_, 0.0); }
  void get(double* values) const { std::copy_n(data_, size_, values); }
  PyObject* object() const { return array_.ptr(); }

 private:
  py::array_t<double> array_;
  double* data_ = nullptr;
  py::ssize_t size_ = -1;
};

/// One overridable method of a Python object: looked up in its class once, then called directly.
class CachedMethod {
 public:
  explicit CachedMethod(const char* name) : name_(name) {}
  /// @param self  of the Python object, borrowed: it outlives the C++ object
  /// @param base  the class whose own attribute does not count as an implementation
  /// @return false if the object's class does not implement the method
  bool find(PyObject* self, py::handle base);
  /// Calls method(self, arguments...). @throws py::error_already_set
  py::object call(std::initializer_list<PyObject*> arguments);
  /// As call(), for methods that write into `out`.
  /// @throws py::type_error if something else than None is returned
  void fill(std::initializer_list<PyObject*> arguments);
  /// @throws py::error_already_set with NotImplementedError, saying what the class must define
  [[noreturn]] void missing(const char* signature) const;

 private:
  const char* name_;
  PyObject* self_ = nullptr;
  py::object function_;
  bool searched_ = false;
};

class PyLagrangianDS final : public LagrangianDS, public py::trampoline_self_life_support {
 public:
  PyLagrangianDS(Vec q0, Vec v0, std::optional<Matrix> mass);
  void mass(const In& q, OutMatrix M) const override;
  void forces(double t, const In& q, const In& v, Out h) const override;
  bool constant_mass() const override { return constant_mass_.has_value(); }
  double potential_energy(const In& q) const override;

 private:
  std::optional<Matrix> constant_mass_;
  mutable CachedMethod mass_{"mass"}, forces_{"forces"}, potential_energy_{"potential_energy"};
  mutable CachedArray q_, v_, h_, M_;
};

class PyRelation final : public Relation, public py::trampoline_self_life_support {
 public:
  explicit PyRelation(int size) : Relation(size) {}
  void gap(const In& q, Out g) const override;
  void jacobian(const In& q, OutMatrix J) const override;
  void curvature(const In& q, const In& v, Out c) const override;
  bool has_curvature() const override;

 private:
  mutable CachedMethod gap_{"gap"}, jacobian_{"jacobian"}, curvature_{"curvature"};
  mutable CachedArray q_, v_, g_, J_, c_;
};

}  // namespace saltus::python
