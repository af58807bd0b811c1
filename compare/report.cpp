#include <cmath>
#include <cstdio>

#include "saltus/compare/comparison.hpp"
#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

std::string text_of(double value) { return std::isnan(value) ? "-" : number(value); }

}  // namespace

std::string to_text(const Comparison& comparison) {
  std::string text =
      "reference " + comparison.reference + ", Δt = " + number(comparison.reference_step) + " s\n";
  std::size_t width = 10;
  for (const CompareRow& row : comparison.rows) width = std::max(width, row.integrator.size());
  const auto line = [&](const std::string& name, const std::vector<std::string>& cells) {
    text += name + std::string(width - name.size(), ' ');
    for (const std::string& cell : cells) {
      char field[32];
      std::snprintf(field, sizeof field, " %12s", cell.c_str());
      text += field;
    }
    text += '\n';
  };
  line("integrator",
       {"dt [s]", "error q", "error v", "spectral", "order", "energy drift", "penetr. [m]", "residual",
        "us/step", "slowdown", "impulsive", "closed", "impacts", "unmatched", "time err [s]", "impulse err"});
  for (const CompareRow& row : comparison.rows) {
    const Figures& f = row.figures;
    line(row.integrator,
         {number(row.time_step), text_of(f.error_q), text_of(f.error_v), text_of(f.spectral),
          text_of(row.order), text_of(f.energy_drift), number(row.penetration), number(row.residual),
          text_of(row.us_per_step), text_of(row.slowdown), std::to_string(row.impulsive_steps),
          number(row.closed), std::to_string(f.impacts), std::to_string(f.unmatched),
          text_of(f.impact_time_error), text_of(f.impulse_error)});
  }
  for (const std::string& warning : comparison.warnings) text += "warning: " + warning + '\n';
  for (const Breach& breach : comparison.breaches) text += "BROKEN  " + breach.message + '\n';
  return text;
}

}  // namespace saltus
