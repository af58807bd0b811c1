#include "saltus/kernel/model/model_function.hpp"

#include <limits>
#include <stdexcept>
#include <vector>

#include "saltus/numerics/plugin.hpp"

namespace saltus {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

ModelFunction load_model_function(std::string_view library_and_function) {
  PluginSymbol symbol = load_symbol(library_and_function);
  return {reinterpret_cast<ModelFunctionPointer>(const_cast<void*>(symbol.address)), std::move(symbol.owner)};
}

FunctionArguments::FunctionArguments(Vec parameters) : parameters_(std::move(parameters)) {
  if (!parameters_.allFinite()) throw std::invalid_argument("parameters must be finite, got NaN or infinity");
}

void FunctionArguments::call(const ModelFunction& function, const In& q, const In& v, double* out) const {
  call(function, nan, q, v, out);
}

void FunctionArguments::call(const ModelFunction& function, const In& q, double* out) const {
  thread_local std::vector<double> none;  // a model may be shared by simulations in several threads
  if (none.size() < static_cast<std::size_t>(q.size())) none.assign(q.size(), nan);
  call(function, nan, q, {none.data(), q.size()}, out);
}

}  // namespace saltus
