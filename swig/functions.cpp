#include "functions.hpp"

#include <cstdint>

namespace saltus::python {

bool is_function(const py::object& object) {
  return py::isinstance<py::str>(object) || PyCallable_Check(object.ptr()) || py::hasattr(object, "address");
}

std::shared_ptr<const py::object> hold(const py::object& object) {
  return {new py::object(object), [](const py::object* held) {
            const py::gil_scoped_acquire gil;
            delete held;
          }};
}

ModelFunction to_model_function(const py::object& function, const char* method, int rows,
                                const Vec& parameters) {
  if (function.is_none()) return {};
  if (py::isinstance<py::str>(function)) return load_model_function(function.cast<std::string>());
  const auto address = py::module_::import("saltus.functions")
                           .attr("address")(function, method, rows, parameters.size())
                           .cast<std::uintptr_t>();
  return {reinterpret_cast<ModelFunctionPointer>(address), hold(function)};
}

}  // namespace saltus::python
