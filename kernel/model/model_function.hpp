#pragma once
#include <memory>
#include <string_view>

#include "saltus/numerics/pool.hpp"

namespace saltus {

/// The C signature of all model functions, whatever they are written in:
///   void f(double t, int n, const double* q, const double* v, double* out, const double* params)
/// @param t       time [s]; NaN where the quantity does not depend on it
/// @param n       freedoms of the linked systems
/// @param q, v    (n); v is full of NaN where the quantity does not depend on it
/// @param out     row by row, zero at the call
/// @param params  as they were given to the model
using ModelFunctionPointer = void (*)(double, int, const double*, const double*, double*, const double*);

/// A model function, and what keeps it where it is.
struct ModelFunction {
  ModelFunctionPointer call = nullptr;
  std::shared_ptr<const void> owner;
  explicit operator bool() const { return call != nullptr; }
};

/// The function of a shared library, "library:function"; it must have C linkage.
/// @throws std::invalid_argument as load_symbol()
ModelFunction load_model_function(std::string_view library_and_function);

/// What model functions are called with beside the state.
class FunctionArguments {
 public:
  /// @throws std::invalid_argument if a parameter is not finite
  explicit FunctionArguments(Vec parameters);
  const Vec& parameters() const { return parameters_; }
  void call(const ModelFunction& function, double t, const In& q, const In& v, double* out) const {
    function.call(t, static_cast<int>(q.size()), q.data(), v.data(), out, parameters_.data());
  }
  /// For quantities that do not depend on the time.
  void call(const ModelFunction& function, const In& q, const In& v, double* out) const;
  /// For quantities that depend on the position alone.
  void call(const ModelFunction& function, const In& q, double* out) const;

 private:
  Vec parameters_;
};

}  // namespace saltus
