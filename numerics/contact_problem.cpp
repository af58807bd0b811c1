#include "saltus/numerics/contact_problem.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "saltus/numerics/text.hpp"

namespace saltus {

namespace {

void validate_shape(const ContactProblem& problem) {
  const int rows = problem.rows();
  const std::string expected = "contact problem: G must be (" + std::to_string(rows) + ", " +
                               std::to_string(rows) + ") as b has " + std::to_string(rows) + " rows, got ";
  if (problem.is_sparse() && problem.sparse.rows() != rows)
    throw std::invalid_argument(expected + std::to_string(problem.sparse.rows()) + " sparse rows");
  if (!problem.is_sparse() && (problem.G.rows() != rows || problem.G.cols() != rows))
    throw std::invalid_argument(expected + "(" + std::to_string(problem.G.rows()) + ", " +
                                std::to_string(problem.G.cols()) + ")");
  if (!problem.is_sparse()) return;
  for (int i = 0; i < rows; ++i) {
    int last = -1;
    for_row(problem, i, [&](int j, double) {
      if (j <= last || j >= rows)
        throw std::invalid_argument("contact problem: columns of the sparse row " + std::to_string(i) +
                                    " must ascend within 0..." + std::to_string(rows - 1) + ", got " +
                                    std::to_string(j) + " after " + std::to_string(last));
      last = j;
    });
  }
}

bool finite_matrix(const ContactProblem& problem) {
  if (!problem.is_sparse()) return problem.G.view().allFinite();
  const std::vector<double>& values = problem.sparse.value;
  return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}

}  // namespace

bool only_plane_friction(const ContactProblem& problem) {
  return std::all_of(problem.sets.begin(), problem.sets.end(), [](const ContactSet& set) {
    const auto* law = std::get_if<Coulomb>(&set);
    return !law || law->dim == 2;
  });
}

ContactProblem dense(const ContactProblem& problem) {
  const int rows = problem.rows();
  ContactProblem copy{Matrix(Matrix::Zero(rows, rows)), problem.b, problem.sets, problem.tolerance};
  for (int i = 0; i < rows; ++i) for_row(problem, i, [&](int j, double entry) { copy.G(i, j) = entry; });
  return copy;
}

void validate(const ContactProblem& problem) {
  const int rows = problem.rows();
  validate_shape(problem);
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
  if (!finite_matrix(problem))
    throw std::invalid_argument("contact problem: G must be finite, got NaN or infinity");
  if (!problem.b.view().allFinite())
    throw std::invalid_argument("contact problem: b must be finite, got NaN or infinity");
}

}  // namespace saltus
