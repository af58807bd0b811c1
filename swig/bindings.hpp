#pragma once
// What the files of the extension module share.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>

#include "saltus/numerics/pool.hpp"

namespace saltus::python {

namespace py = pybind11;

void bind_numerics(py::module_& module);
void bind_kernel(py::module_& module);
void bind_io(py::module_& module);
void bind_examples(py::module_& module);

/// Array-likes of constructors: converted and copied once, never views.
using ArrayLike = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// @throws std::invalid_argument naming `what` unless the array has one axis
Vec to_vec(const ArrayLike& array, const std::string& what);
/// @throws std::invalid_argument naming `what` unless the array has two axes
Matrix to_matrix(const ArrayLike& array, const std::string& what);
/// A new array with these values.
py::array_t<double> to_array(const Vec& values);

}  // namespace saltus::python
