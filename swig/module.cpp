#include <pybind11/stl.h>

#include <limits>
#include <stdexcept>
#include <vector>

#include "bindings.hpp"

namespace saltus::python {
namespace {

std::string shape_of(const py::array& array) {
  return py::str(py::tuple(py::cast(std::vector<py::ssize_t>(array.shape(), array.shape() + array.ndim()))));
}

void require_real(const py::object& array, const std::string& what) {
  const std::string kind = py::str(array.attr("dtype").attr("kind"));
  if (std::string("biuf").find(kind) == std::string::npos)
    throw std::invalid_argument(what + " must be an array of real numbers, got " +
                                std::string(py::str(array.attr("dtype"))));
}

// Real numbers only: a conversion that drops imaginary parts, masks or units is no conversion.
py::array_t<double> to_numbers(const ArrayLike& values, const std::string& what) {
  const py::module_ numpy = py::module_::import("numpy");
  py::array array;
  try {
    array = numpy.attr("asarray")(values);
  } catch (const py::error_already_set& error) {
    throw std::invalid_argument(what +
                                " must be an array of numbers: " + std::string(py::str(error.value())));
  }
  require_real(array, what);
  if (py::cast<bool>(numpy.attr("ma").attr("is_masked")(values)))
    throw std::invalid_argument(what + " must not be masked, got masked entries");
  return py::array_t<double, py::array::c_style | py::array::forcecast>(array);
}

}  // namespace

void require_initialised(py::handle self) {
  auto* instance = reinterpret_cast<py::detail::instance*>(self.ptr());
  if (instance->get_value_and_holder().holder_constructed()) return;
  throw py::type_error(std::string(Py_TYPE(self.ptr())->tp_name) +
                       ": super().__init__() must be called first");
}

Vec to_vec(const ArrayLike& values, const std::string& what) {
  const auto array = to_numbers(values, what);
  if (array.ndim() != 1)
    throw std::invalid_argument(what + " must have one axis, got shape " + shape_of(array));
  return Eigen::Map<const Vec>(array.data(), array.shape(0));
}

Vec to_sized_vec(const ArrayLike& values, const std::string& what, Eigen::Index size) {
  Vec x = to_vec(values, what);
  if (x.size() != size)
    throw std::invalid_argument(what + " must have " + std::to_string(size) + " entries, got " +
                                std::to_string(x.size()));
  return x;
}

Matrix to_matrix(const ArrayLike& values, const std::string& what) {
  const auto array = to_numbers(values, what);
  if (array.ndim() != 2)
    throw std::invalid_argument(what + " must have two axes, got shape " + shape_of(array));
  return Eigen::Map<const Matrix>(array.data(), array.shape(0), array.shape(1));
}

bool is_sparse(const py::object& values) {
  // Without scipy being imported there is no such object.
  const py::dict modules = py::module_::import("sys").attr("modules");
  return modules.contains("scipy.sparse") && py::cast<bool>(modules["scipy.sparse"].attr("issparse")(values));
}

Eigen::SparseMatrix<double> to_sparse_matrix(const py::object& values, const std::string& what) {
  require_real(values, what);
  const py::tuple shape = values.attr("shape");
  if (shape.size() != 2)
    throw std::invalid_argument(what + " must have two axes, got shape " + std::string(py::str(shape)));
  const py::object columns = values.attr("tocsc")(py::arg("copy") = true);
  columns.attr("sum_duplicates")();  // also sorts
  using Indices = py::array_t<int, py::array::c_style | py::array::forcecast>;
  using Values = py::array_t<double, py::array::c_style | py::array::forcecast>;
  const Values entries(columns.attr("data"));
  if (entries.size() > std::numeric_limits<int>::max())
    throw std::invalid_argument(what + " must have fewer than 2^31 entries, got " +
                                std::to_string(entries.size()));
  const Indices start(columns.attr("indptr")), row(columns.attr("indices"));
  return Eigen::Map<const Eigen::SparseMatrix<double>>(py::cast<Eigen::Index>(shape[0]),
                                                       py::cast<Eigen::Index>(shape[1]), entries.size(),
                                                       start.data(), row.data(), entries.data());
}

py::array_t<double> to_array(const Vec& values) { return py::array_t<double>(values.size(), values.data()); }

py::array_t<double> matrix_to_array(const Matrix& values) {
  return py::array_t<double>({values.rows(), values.cols()}, values.data());
}

}  // namespace saltus::python

PYBIND11_MODULE(_core, module) {
  module.doc() = "The C++ side of Saltus.";
  module.attr("__version__") = SALTUS_VERSION;
  saltus::python::bind_numerics(module);
  saltus::python::bind_integrators(module);
  saltus::python::bind_models(module);
  saltus::python::bind_bodies(module);
  saltus::python::bind_plugged(module);
  saltus::python::bind_kernel(module);
  saltus::python::bind_first_order(module);
  saltus::python::bind_io(module);
  saltus::python::bind_live_state(module);
  saltus::python::bind_compare(module);
  saltus::python::bind_examples(module);
}
