#include <pybind11/stl.h>

#include <stdexcept>
#include <vector>

#include "bindings.hpp"

namespace saltus::python {
namespace {

std::string shape_of(const py::array& array) {
  return py::str(py::tuple(py::cast(std::vector<py::ssize_t>(array.shape(), array.shape() + array.ndim()))));
}

}  // namespace

Vec to_vec(const ArrayLike& array, const std::string& what) {
  if (array.ndim() != 1)
    throw std::invalid_argument(what + " must have one axis, got shape " + shape_of(array));
  return Eigen::Map<const Vec>(array.data(), array.shape(0));
}

Matrix to_matrix(const ArrayLike& array, const std::string& what) {
  if (array.ndim() != 2)
    throw std::invalid_argument(what + " must have two axes, got shape " + shape_of(array));
  return Eigen::Map<const Matrix>(array.data(), array.shape(0), array.shape(1));
}

py::array_t<double> to_array(const Vec& values) { return py::array_t<double>(values.size(), values.data()); }

}  // namespace saltus::python

PYBIND11_MODULE(_core, module) {
  module.doc() = "The C++ side of Saltus.";
  module.attr("__version__") = SALTUS_VERSION;
  saltus::python::bind_numerics(module);
  saltus::python::bind_kernel(module);
  saltus::python::bind_io(module);
  saltus::python::bind_examples(module);
}
