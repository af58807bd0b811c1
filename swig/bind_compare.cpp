#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include <cmath>

#include "bindings.hpp"
#include "saltus/compare/comparison.hpp"

namespace saltus::python {
namespace {

using Named = std::pair<std::string, std::shared_ptr<OneStepIntegrator>>;

// None stands for what cannot be told: JSON knows no NaN.
py::object told(double value) { return std::isnan(value) ? py::object(py::none()) : py::float_(value); }

py::dict to_dict(const Figures& f) {
  py::dict all;
  all["common_times"] = f.common_times;
  all["end"] = f.end;
  all["error_q"] = told(f.error_q);
  all["error_v"] = told(f.error_v);
  all["spectral"] = told(f.spectral);
  all["normalised"] = told(f.normalised);
  all["energy_drift"] = told(f.energy_drift);
  all["impacts"] = f.impacts;
  all["reference_impacts"] = f.reference_impacts;
  all["unmatched"] = f.unmatched;
  all["impact_time_error"] = told(f.impact_time_error);
  all["impulse_error"] = told(f.impulse_error);
  return all;
}

py::dict to_dict(const CompareRow& row) {
  py::dict all = to_dict(row.figures);
  all["integrator"] = row.integrator;
  all["baseline"] = row.baseline;
  all["time_step"] = row.time_step;
  all["order"] = told(row.order);
  all["steps"] = row.steps;
  all["impulsive_steps"] = row.impulsive_steps;
  all["closed"] = row.closed;
  all["penetration"] = row.penetration;
  all["residual"] = row.residual;
  all["us_per_step"] = told(row.us_per_step);
  all["slowdown"] = told(row.slowdown);
  all["ended"] = row.ended;
  return all;
}

py::dict to_dict(const Breach& breach) {
  py::dict all;
  all["integrator"] = breach.integrator;
  all["time_step"] = breach.time_step > 0.0 ? told(breach.time_step) : py::none();
  all["limit"] = breach.limit;
  all["value"] = told(breach.value);
  all["allowed"] = told(breach.allowed);
  all["message"] = breach.message;
  return all;
}

py::dict to_dict(const Comparison& comparison) {
  py::list rows, breaches;
  for (const CompareRow& row : comparison.rows) rows.append(to_dict(row));
  for (const Breach& breach : comparison.breaches) breaches.append(to_dict(breach));
  py::dict orders;
  for (const auto& [name, order] : comparison.orders) orders[py::str(name)] = told(order);
  const auto& doubling = comparison.reference_doubling;
  py::dict all;
  all["reference"] = comparison.reference;
  all["reference_step"] = comparison.reference_step;
  all["reference_moves"] = doubling ? told(doubling->error_q) : py::none();
  all["rows"] = rows;
  all["orders"] = orders;
  all["warnings"] = comparison.warnings;
  all["breaches"] = breaches;
  all["text"] = to_text(comparison);
  return all;
}

Candidate to_candidate(const Named& named) { return {named.first, named.second}; }

Reference to_reference(const std::optional<Named>& made, const py::object& columns, const std::string& name,
                       double time_step) {
  if (made) return ReferenceRun{to_candidate(*made), time_step};
  if (!columns.is_none())
    return RecordedReference{name, time_step, std::make_shared<Recording>(to_recording(columns))};
  return {};
}

Limits to_limits(const std::map<std::string, double>& given) {
  Limits limits;
  const std::map<std::string, std::optional<double> Limits::*> known = {
      {"max-error", &Limits::max_error},
      {"max-energy-drift", &Limits::max_energy_drift},
      {"max-impulse-error", &Limits::max_impulse_error},
      {"max-penetration", &Limits::max_penetration},
      {"max-slowdown", &Limits::max_slowdown},
      {"min-order", &Limits::min_order}};
  for (const auto& [name, value] : given) limits.*known.at(name) = value;
  return limits;
}

}  // namespace

void bind_compare(py::module_& module) {
  module.def(
      "compare_integrators",
      [](const NonSmoothDynamicalSystem& system, const std::vector<Named>& integrators,
         const std::optional<Named>& baseline, const std::vector<double>& time_steps, double until,
         const std::optional<Named>& reference, const py::object& recorded, const std::string& reference_name,
         double reference_step, const std::map<std::string, double>& limits, int timings,
         const CompareProgress& progress) {
        CompareSettings settings{.time_steps = time_steps, .until = until, .timings = timings};
        for (const Named& named : integrators) settings.integrators.push_back(to_candidate(named));
        if (baseline) settings.baseline = to_candidate(*baseline);
        settings.reference = to_reference(reference, recorded, reference_name, reference_step);
        settings.limits = to_limits(limits);
        settings.progress = [&progress](const std::string& label, double fraction) {
          if (PyErr_CheckSignals() != 0) throw py::error_already_set();
          if (progress) progress(label, fraction);
        };
        return to_dict(compare(system, settings));
      },
      py::arg("system"), py::arg("integrators"), py::arg("baseline"), py::arg("time_steps"), py::arg("until"),
      py::arg("reference"), py::arg("recorded"), py::arg("reference_name"), py::arg("reference_step"),
      py::arg("limits"), py::arg("timings"), py::arg("progress"),
      "Run and compare integrators, each (name, integrator); see saltus.compare.");
}

}  // namespace saltus::python
