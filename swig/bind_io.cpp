#include <vector>

#include "bindings.hpp"
#include "saltus/io/recording.hpp"

namespace saltus::python {
namespace {

// One value a row
template <class Value>
py::array single(const std::vector<Value>& column) {
  return py::array_t<Value>(static_cast<py::ssize_t>(column.size()), column.data());
}

// Several values a row; two-dimensional even if it is one
py::array table(const std::vector<double>& column, long rows) {
  const py::ssize_t width = rows ? static_cast<py::ssize_t>(column.size()) / rows : 0;
  return py::array_t<double>(std::vector<py::ssize_t>{rows, width}, column.data());
}

}  // namespace

void bind_io(py::module_& module) {
  py::classh<Recording, Observer>(module, "Recording", "A run in memory, column by column.")
      .def(py::init<long>(), py::arg("every") = 1)
      .def_property_readonly("rows", &Recording::rows)
      .def(
          "columns",
          [](const Recording& r) {
            const long rows = r.rows();
            py::dict all;
            all["t"] = single(r.t);
            all["step"] = single(r.step);
            all["q"] = table(r.q, rows);
            all["v"] = table(r.v, rows);
            all["gap"] = table(r.gaps, rows);
            all["velocity"] = table(r.velocities, rows);
            all["lambda_plus"] = table(r.lambda_plus, rows);
            all["lambda_minus"] = table(r.lambda_minus, rows);
            all["impulse"] = table(r.impulse, rows);
            all["impulsive"] = single(r.impulsive).attr("astype")("bool");
            all["closed"] = single(r.closed);
            all["residual"] = single(r.residual);
            all["penetration"] = single(r.penetration);
            all["kinetic_energy"] = single(r.kinetic_energy);
            all["potential_energy"] = single(r.potential_energy);
            all["work_forces"] = single(r.work_forces);
            all["work_lambda"] = single(r.work_lambda);
            all["work_impulse"] = single(r.work_impulse);
            for (auto column : all) column.second.attr("flags").attr("writeable") = false;
            return all;
          },
          "Copies of all columns, name: read-only array.");
}

}  // namespace saltus::python
