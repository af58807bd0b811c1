#pragma once
// What the files of the extension module share.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/SparseCore>
#include <string>

#include "saltus/io/recording.hpp"
#include "saltus/kernel/model/nonsmooth_law.hpp"
#include "saltus/numerics/contact_problem.hpp"

namespace saltus::python {

namespace py = pybind11;

void bind_numerics(py::module_& module);
void bind_models(py::module_& module);
void bind_bodies(py::module_& module);
void bind_plugged(py::module_& module);
void bind_kernel(py::module_& module);
void bind_integrators(py::module_& module);
void bind_first_order(py::module_& module);
void bind_io(py::module_& module);
void bind_live_state(py::module_& module);
void bind_compare(py::module_& module);
void bind_examples(py::module_& module);

/// Array-likes of constructors: converted and copied once, never views.
using ArrayLike = py::object;

/// @throws std::invalid_argument naming `what` unless it is an array of real numbers, none of them masked,
///         with one axis
Vec to_vec(const ArrayLike& values, const std::string& what);
/// The same with `size` entries.
Vec to_sized_vec(const ArrayLike& values, const std::string& what, Eigen::Index size);
/// The same with two axes.
Matrix to_matrix(const ArrayLike& values, const std::string& what);
/// Is it one of scipy.sparse?
bool is_sparse(const py::object& values);
/// Any matrix of scipy.sparse, duplicates summed up. @throws as to_matrix()
Eigen::SparseMatrix<double> to_sparse_matrix(const py::object& values, const std::string& what);
/// A contact problem whose G is an array, or a scipy.sparse.csr_array without duplicates and with ascending
/// columns. @throws std::invalid_argument as to_matrix() and validate()
ContactProblem to_problem(const py::object& G, const ArrayLike& b, const std::vector<ContactSet>& sets);
/// G of a contact problem, as an array or a scipy.sparse.csr_array.
py::object matrix_of(const ContactProblem& problem);
/// @throws py::type_error if the object's __init__ has not been called: there is no C++ object then
void require_initialised(py::handle self);
/// The C++ side of a Python object whose class may have forgotten super().__init__().
template <class Class>
const Class& initialised(const py::object& self) {
  require_initialised(self);
  return self.cast<const Class&>();
}
/// A recording with these columns, as Recording.columns() gives them.
Recording to_recording(const py::dict& columns);
/// A method that a function of saltus.notebook stands for: what an object looks like.
inline auto shown_by(const char* function) {
  return [function](const py::object& self) {
    return py::module_::import("saltus.notebook").attr(function)(self);
  };
}
/// The law's class by name, and its parameters, which the layout of a run keeps.
py::dict description(const NonSmoothLaw& law);
/// A new array with these values.
py::array_t<double> to_array(const Vec& values);
py::array_t<double> matrix_to_array(const Matrix& values);

}  // namespace saltus::python
