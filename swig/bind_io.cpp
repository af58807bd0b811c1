#include <vector>

#include "bindings.hpp"
#include "saltus/io/recording.hpp"

namespace saltus::python {
namespace {

template <class Value>
py::array_t<Value> table(const std::vector<Value>& column, long rows) {
  if (rows == 0 || column.size() == static_cast<std::size_t>(rows))
    return py::array_t<Value>(static_cast<py::ssize_t>(column.size()), column.data());
  const py::ssize_t width = static_cast<py::ssize_t>(column.size()) / rows;
  return py::array_t<Value>(std::vector<py::ssize_t>{rows, width}, column.data());
}

// Positions stay two-dimensional for one freedom.
py::array_t<double> wide(const std::vector<double>& column, long rows) {
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
            all["t"] = table(r.t, rows);
            all["step"] = table(r.step, rows);
            all["q"] = wide(r.q, rows);
            all["v"] = wide(r.v, rows);
            all["gap"] = wide(r.gaps, rows);
            all["velocity"] = wide(r.velocities, rows);
            all["lambda_plus"] = wide(r.lambda_plus, rows);
            all["lambda_minus"] = wide(r.lambda_minus, rows);
            all["impulse"] = wide(r.impulse, rows);
            all["impulsive"] = table(r.impulsive, rows).attr("astype")("bool");
            all["closed"] = table(r.closed, rows);
            all["residual"] = table(r.residual, rows);
            all["penetration"] = table(r.penetration, rows);
            all["kinetic_energy"] = table(r.kinetic_energy, rows);
            all["potential_energy"] = table(r.potential_energy, rows);
            all["work_forces"] = table(r.work_forces, rows);
            all["work_lambda"] = table(r.work_lambda, rows);
            all["work_impulse"] = table(r.work_impulse, rows);
            for (auto column : all) column.second.attr("flags").attr("writeable") = false;
            return all;
          },
          "Copies of all columns, name: read-only array.");
}

}  // namespace saltus::python
