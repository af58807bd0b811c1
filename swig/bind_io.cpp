#include "saltus/io/csv.hpp"

#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include <sstream>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "bindings.hpp"
#include "saltus/io/recording.hpp"

namespace saltus::python {
namespace {

// A row's values, of a column with several a row two-dimensional even if it is one.
template <class Value>
py::array to_array(const std::vector<Value>& column, long rows, bool single) {
  std::vector<py::ssize_t> shape{rows};
  if (!single) shape.push_back(rows ? static_cast<py::ssize_t>(column.size()) / rows : 0);
  py::array array = py::array_t<Value>(shape, column.data());
  if constexpr (std::is_same_v<Value, unsigned char>) array = array.attr("astype")("bool");
  array.attr("flags").attr("writeable") = false;
  return array;
}

py::dict to_dict(const Recording& recording) {
  py::dict all;
  for (const Column& column : run_columns())
    std::visit(
        [&](auto member) {
          const bool single = column.width == Column::Width::one;
          all[py::str(column.name)] = to_array(recording.*member, recording.rows(), single);
        },
        column.values);
  return all;
}

template <class Value>
std::vector<Value> to_column(const py::object& values) {
  const py::array_t<Value, py::array::c_style | py::array::forcecast> array(values);
  return {array.data(), array.data() + array.size()};
}

}  // namespace

// The inverse of to_dict
Recording to_recording(const py::dict& columns) {
  Recording recording;
  for (const Column& column : run_columns())
    std::visit(
        [&](auto member) {
          using Values = std::remove_reference_t<decltype(recording.*member)>;
          recording.*member = to_column<typename Values::value_type>(columns[py::str(column.name)]);
        },
        column.values);
  return recording;
}

void bind_io(py::module_& module) {
  py::classh<Recording, Observer>(module, "Recording", "A run in memory, column by column.")
      .def(py::init<long>(), py::arg("every") = 1)
      .def_property_readonly("rows", &Recording::rows, "number of the rows in memory")
      .def_property_readonly("handed_on", &Recording::handed_on, "number of those handed on before")
      .def("columns", &to_dict, "Copies of all columns, name: read-only array.")
      .def(
          "stream",
          [](Recording& self, py::function sink, long rows, double seconds) {
            self.stream(
                [sink = std::move(sink)](const Recording& chunk) { sink(chunk.handed_on(), to_dict(chunk)); },
                rows, seconds);
          },
          py::arg("sink"), py::arg("rows"), py::arg("seconds"),
          "Call sink(number of the first row, columns) and forget the rows, when there are that many, or\n"
          "when that time has passed.")
      .def("flush", &Recording::flush, "Hand on what is there.");
  module.def(
      "run_columns",
      [] {
        py::dict units;
        for (const Column& column : run_columns()) units[py::str(column.name)] = py::str(column.unit);
        return units;
      },
      "The columns of a run, name: unit.");
  module.def(
      "csv_header",
      [](int coordinates, int freedoms, const std::vector<std::tuple<std::string, int, int>>& contacts) {
        std::vector<ContactWidth> widths;
        for (const auto& [name, rows, gaps] : contacts) widths.push_back({name, rows, gaps});
        std::ostringstream text;
        write_csv_header(text, coordinates, freedoms, widths);
        return text.str();
      },
      py::arg("coordinates"), py::arg("freedoms"), py::arg("contacts"),
      "First line of a run as CSV; contacts are (name, rows, gaps) in their order.");
  module.def(
      "csv_rows",
      [](const py::dict& columns) {
        std::ostringstream text;
        write_csv_rows(text, to_recording(columns));
        return text.str();
      },
      py::arg("columns"), "The lines of these rows as CSV.");
}

}  // namespace saltus::python
