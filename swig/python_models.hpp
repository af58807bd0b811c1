#pragma once
// Models written in Python: classes that derive from LagrangianDS and LagrangianScleronomousR.
#include <pybind11/trampoline_self_life_support.h>

#include <memory>
#include <optional>
#include <vector>

#include "bindings.hpp"
#include "saltus/kernel/model/lagrangian_ds.hpp"
#include "saltus/kernel/model/relation.hpp"

namespace saltus::python {

/// An array that a method of a Python model reads or writes. It is made once and lives as long as the
/// model: making arrays is what costs in a call, not the call. Its memory belongs to a capsule, so that
/// numpy refuses to resize it, and it stays valid while anyone holds the array.
class CachedArray {
 public:
  /// @param writable  false: assignment in Python is an error
  CachedArray(std::vector<py::ssize_t> shape, bool writable);
  void set(const double* values) { std::copy_n(values, size_, data_); }
  void set_zero() { std::fill_n(data_, size_, 0.0); }
  /// @throws py::type_error if Python has changed the array's type or shape
  void get(double* values, const char* method) const;
  PyObject* object() const { return array_.ptr(); }

 private:
  std::vector<py::ssize_t> shape_;
  py::array_t<double> array_;
  double* data_ = nullptr;
  py::ssize_t size_ = 0;
};

/// The arrays of one call: positions and velocities (n), and what is written.
struct CallArrays {
  CallArrays(py::ssize_t n, const std::vector<py::ssize_t>& out);
  CachedArray q, v, out;
};

/// The arrays that one method of a model uses. Calls that overlap, from a method that runs another
/// simulation or from threads, and calls with other sizes get arrays of their own.
class ArrayPool {
 public:
  std::unique_ptr<CallArrays> take(py::ssize_t n, const std::vector<py::ssize_t>& out);
  void give_back(std::unique_ptr<CallArrays> arrays) { free_ = std::move(arrays); }

 private:
  std::unique_ptr<CallArrays> free_;
  py::ssize_t n_ = -1;
  std::vector<py::ssize_t> out_;
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
  /// Calls method(self, [t,] q, [v,] out) for a method that writes into `out` and returns None.
  /// @param t, v  nullptr: not among its arguments
  /// @throws py::type_error if something else is returned, py::error_already_set
  void fill(const double* t, const In& q, const double* v, double* out, std::vector<py::ssize_t> shape);
  /// "Class.method" for messages
  std::string full_name() const;
  /// @throws py::error_already_set with NotImplementedError, saying what the class must define
  [[noreturn]] void missing(const char* signature) const;

 private:
  const char* name_;
  PyObject* self_ = nullptr;
  py::object function_;
  bool searched_ = false;
  ArrayPool pool_;
};

class PyLagrangianDS final : public LagrangianDS, public py::trampoline_self_life_support {
 public:
  PyLagrangianDS(Vec q0, Vec v0, std::optional<Matrix> mass);
  void mass(const In& q, OutMatrix M) const override;
  void forces(double t, const In& q, const In& v, Out h) const override;
  bool constant_mass() const override { return constant_mass_.has_value(); }
  double potential_energy(const In& q) const override;

 private:
  bool find(CachedMethod& method) const;

  std::optional<Matrix> constant_mass_;
  mutable CachedMethod mass_{"mass"}, forces_{"forces"}, potential_energy_{"potential_energy"};
};

class PyRelation final : public Relation, public py::trampoline_self_life_support {
 public:
  explicit PyRelation(int size) : Relation(size) {}
  void gap(const In& q, Out g) const override;
  void jacobian(const In& q, OutMatrix J) const override;
  void curvature(const In& q, const In& v, Out c) const override;
  bool has_curvature() const override;

 private:
  bool find(CachedMethod& method) const;

  mutable CachedMethod gap_{"gap"}, jacobian_{"jacobian"}, curvature_{"curvature"};
};

}  // namespace saltus::python
