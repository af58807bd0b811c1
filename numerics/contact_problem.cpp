#include "saltus/numerics/contact_problem.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "saltus/numerics/text.hpp"

namespace saltus {

bool only_plane_friction(const ContactProblem& problem) {
  return std::all_of(problem.sets.begin(), problem.sets.end(), [](const ContactSet& set) {
    const auto* law = std::get_if<Coulomb>(&set);
    return !law || law->dim == 2;
  });
}

void validate(const ContactProblem& problem) {
  const int rows = problem.rows();
  if (problem.G.rows() != rows || problem.G.cols() != rows)
    throw std::invalid_argument("contact problem: G must be (" + std::to_string(rows) + ", " +
                                std::to_string(rows) + ") as b has " + std::to_string(rows) + " rows, got (" +
                                std::to_string(problem.G.rows()) + ", " + std::to_string(problem.G.cols()) +
                                ")");
  int needed = 0;
  for (const ContactSet& set : problem.sets) {
    if (const auto* law = std::get_if<Coulomb>(&set)) {
      if (law->dim != 2 && law->dim != 3)
        throw std::invalid_argument("contact problem: Coulomb dim must be 2 or 3, got " +
                                    std::to_string(law->dim));
      if (!(law->mu >= 0.0) || !std::isfinite(law->mu))
        throw std::invalid_argument("contact problem: Coulomb mu must be finite and >= 0, got " +
                                    number(law->mu));
    }
    needed += rows_of(set);
  }
  if (needed != rows)
    throw std::invalid_argument("contact problem: the sets take " + std::to_string(needed) + " rows, b has " +
                                std::to_string(rows));
  if (!problem.G.view().allFinite())
    throw std::invalid_argument("contact problem: G must be finite, got NaN or infinity");
  if (!problem.b.view().allFinite())
    throw std::invalid_argument("contact problem: b must be finite, got NaN or infinity");
}

}  // namespace saltus
