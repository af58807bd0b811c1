#pragma once
#include "bindings.hpp"
#include "saltus/kernel/model/model_function.hpp"

namespace saltus::python {

/// Is this a model function rather than an array of numbers?
bool is_function(const py::object& object);

/// Keeps a Python object, and lets it go with the interpreter's lock.
std::shared_ptr<const py::object> hold(const py::object& object);

/// A model function as Python gives it: None, "library:function", what @saltus.compiled returns, or a pointer
/// to a C function of ctypes or cffi.
/// @param method  that it stands for: "forces"
/// @param rows    of a relation, 0 for a system
/// @throws std::invalid_argument if it is none of these
ModelFunction to_model_function(const py::object& function, const char* method, int rows,
                                const Vec& parameters);

}  // namespace saltus::python
