#pragma once
// Models written in Python: classes that derive from a system or a relation.
#include <pybind11/trampoline_self_life_support.h>

#include <memory>
#include <vector>

#include "bindings.hpp"
#include "saltus/kernel/model/bodies/newton_euler_ds.hpp"
#include "saltus/kernel/model/force_law.hpp"
#include "saltus/kernel/model/function_models.hpp"
#include "saltus/kernel/model/lagrangian_linear_tids.hpp"

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

/// The arrays of one call: positions (coordinates), velocities (freedoms), and what is written.
struct CallArrays {
  CallArrays(py::ssize_t coordinates, py::ssize_t freedoms, const std::vector<py::ssize_t>& out);
  CachedArray q, v, out;
};

/// The arrays that one method of a model uses. Calls that overlap, from a method that runs another
/// simulation or from threads, and calls with other sizes get arrays of their own.
class ArrayPool {
 public:
  std::unique_ptr<CallArrays> take(py::ssize_t coordinates, py::ssize_t freedoms,
                                   const std::vector<py::ssize_t>& out);
  void give_back(std::unique_ptr<CallArrays> arrays) { free_ = std::move(arrays); }

 private:
  std::unique_ptr<CallArrays> free_;
  py::ssize_t coordinates_ = -1, freedoms_ = -1;
  std::vector<py::ssize_t> out_;
};

/// One overridable method of a Python object: looked up in its class once, then called directly.
class CachedMethod {
 public:
  explicit CachedMethod(const char* name) : name_(name) {}
  /// Looks the method up; only the first call does.
  /// @tparam Class  bound class of the C++ object, whose own attribute does not count as an implementation
  /// @return false if the object's class does not implement the method
  template <class Class>
  bool find(const Class* object) {
    if (!searched_)  // the Python object outlives the C++ one, so that self is borrowed
      search(py::detail::get_object_handle(object, py::detail::get_type_info(typeid(Class))).ptr(),
             py::type::of<Class>());
    return static_cast<bool>(function_);
  }
  /// Calls method(self, arguments...). @throws py::error_already_set
  py::object call(std::initializer_list<PyObject*> arguments);
  /// Calls method(self, [t,] q, [v,] out) for a method that writes into `out` and returns None.
  /// @param t, v  nullptr: not among its arguments
  /// @throws py::type_error if something else is returned, py::error_already_set
  /// @param start  what is in `out` at the call, zero if nullptr
  void fill(const double* t, const In& q, const In* v, double* out, std::vector<py::ssize_t> shape,
            const double* start = nullptr);
  /// Calls method(self, t, out), likewise.
  void fill_at(double t, double* out, std::vector<py::ssize_t> shape);
  /// Calls method(self, q) for a method that returns a number. @throws py::type_error if it is none
  double number(const In& q);
  /// @throws std::invalid_argument if the class implements what was also given to its base class
  void forbid(bool found) const;
  /// "Class.method" for messages
  std::string full_name() const;
  /// @throws py::error_already_set with NotImplementedError, saying what the class must define
  [[noreturn]] void missing(const char* signature) const;

 private:
  void search(PyObject* self, py::handle base);
  void take(const py::object& result, const CallArrays& arrays, double* out) const;

  const char* name_;
  PyObject* self_ = nullptr;
  py::object function_;
  bool searched_ = false;
  ArrayPool pool_;
};

/// Functions where they are given, else the methods of a Python class. Only those can have a velocity map.
class PyLagrangianDS final : public FunctionDS, public py::trampoline_self_life_support {
 public:
  PyLagrangianDS(Vec q0, Vec v0, Functions functions, Vec parameters)
      : FunctionDS(Incomplete{}, std::move(q0), std::move(v0), std::move(functions), std::move(parameters)) {}
  void mass(const In& q, OutMatrix M) const override;
  void forces(double t, const In& q, const In& v, Out h) const override;
  bool force_jacobians(double t, const In& q, const In& v, OutMatrix dh_dq, OutMatrix dh_dv) const override;
  double potential_energy(const In& q) const override;
  /// @throws std::invalid_argument if there is one beside functions, whose n would not tell both sizes
  bool has_velocity_map() const override;
  void position_rate(const In& q, const In& v, Out rate) const override;
  void normalise(Out q) const override;

 private:
  bool find(CachedMethod& method) const { return method.find<LagrangianDS>(this); }

  mutable CachedMethod mass_{"mass"}, forces_{"forces"}, force_jacobians_{"force_jacobians"},
      potential_energy_{"potential_energy"}, velocity_map_{"velocity_map"}, normalise_{"normalise"};
};

/// A linear system whose force is a method of a Python class.
class PyLagrangianLinearTIDS final : public LagrangianLinearTIDS, public py::trampoline_self_life_support {
 public:
  using LagrangianLinearTIDS::LagrangianLinearTIDS;

 private:
  void external_force(double t, Out f) const override;
  bool driven() const override;

  mutable bool looked_at_ = false;
  mutable CachedMethod external_force_{"external_force"};
};

/// A rigid body whose varying loads are methods of a Python class.
class PyNewtonEulerDS final : public NewtonEulerDS, public py::trampoline_self_life_support {
 public:
  using NewtonEulerDS::NewtonEulerDS;
  void loads(double t, const In& q, const In& v, BodyLoads& loads) const override;
  bool varying_loads() const override;
  double potential_energy(const In& q) const override;

 private:
  bool find(CachedMethod& method) const { return method.find<NewtonEulerDS>(this); }

  mutable bool looked_at_ = false;
  mutable CachedMethod force_{"force"}, moment_{"moment"}, body_force_{"body_force"},
      body_moment_{"body_moment"}, potential_energy_{"potential_energy"};
};

/// Functions where they are given, else the methods of a Python class.
class PyRelation final : public FunctionRelation, public py::trampoline_self_life_support {
 public:
  PyRelation(int size, Functions functions, Vec parameters)
      : FunctionRelation(Incomplete{}, size, std::move(functions), std::move(parameters)) {}
  void gap(const In& q, Out g) const override;
  void jacobian(const In& q, OutMatrix J) const override;
  void curvature(const In& q, const In& v, Out c) const override;
  bool has_curvature() const override;

 private:
  bool find(CachedMethod& method) const { return method.find<Relation>(this); }

  mutable CachedMethod gap_{"gap"}, jacobian_{"jacobian"}, curvature_{"curvature"};
};

/// A relation that depends on the time, of methods of a Python class.
class PyRheonomousRelation final : public RheonomousRelation, public py::trampoline_self_life_support {
 public:
  using RheonomousRelation::RheonomousRelation;
  void gap_at(double t, const In& q, Out g) const override;
  void jacobian_at(double t, const In& q, OutMatrix J) const override;
  void motion_at(double t, const In& q, Out w) const override;
  void curvature_at(double t, const In& q, const In& v, Out c) const override;
  bool has_curvature() const override { return find(curvature_); }

 private:
  bool find(CachedMethod& method) const { return method.find<RheonomousRelation>(this); }
  void call(CachedMethod& method, double t, const In& q, const In* v, double* out,
            std::vector<py::ssize_t> shape, const char* signature) const;

  mutable CachedMethod gap_{"gap"}, jacobian_{"jacobian"}, motion_{"motion"}, curvature_{"curvature"};
};

/// A force that Python gives: a number, a model function, or a callable of (t, length, rate).
/// @throws std::invalid_argument if it is none of these
Actuator make_actuator(const py::object& force, const ArrayLike& parameters);

}  // namespace saltus::python
