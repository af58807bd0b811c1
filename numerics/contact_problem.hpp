#pragma once
#include <variant>
#include <vector>

#include "saltus/numerics/pool.hpp"
#include "saltus/numerics/sparse_rows.hpp"

namespace saltus {

/// xi = 0, P free. One row.
struct Equality {};
/// 0 <= xi, 0 <= P, xi P = 0, the rows of (6), (31), (69). One row.
struct NonNegative {};
/// Coulomb's law: the first row is NonNegative, the other dim-1 rows are tangential with
/// |P_T| <= mu P_N, and P_T = -mu P_N xi_T/|xi_T| where xi_T != 0, (7), (32), (35), (70).
struct Coulomb {
  double mu = 0.0;  ///< friction coefficient [-]
  int dim = 2;      ///< 2 (plane) or 3 (space): number of rows
};
using ContactSet = std::variant<Equality, NonNegative, Coulomb>;

/// Number of rows that a set takes.
inline int rows_of(const ContactSet& set) {
  const auto* coulomb = std::get_if<Coulomb>(&set);
  return coulomb ? coulomb->dim : 1;
}

/// The default bound on residual/scale of a Certificate, the paper's 1e-12 (Section 5).
inline constexpr double default_tolerance = 1e-12;

/// Find P such that xi = G P + b, and each contact's law holds between xi and P.
/// G may be unsymmetric (half-explicit rows take W at two positions) and rank-deficient.
struct ContactProblem {
  PoolMatrix G;                  ///< (rows, rows) [1/kg] in mechanics; empty if `sparse` stands for it
  PoolVec b;                     ///< (rows) [m/s]
  std::vector<ContactSet> sets;  ///< in the order of the rows
  double tolerance = default_tolerance;  ///< bound on residual/scale of a Certificate that counts as solved
  SparseRows sparse = {};                ///< G where it has few entries; has no rows if G is dense
  bool brief = false;                    ///< there is another way: no search where Newton's method fails

  bool is_sparse() const { return !sparse.empty(); }
  int rows() const { return b.size(); }
  int contacts() const { return static_cast<int>(sets.size()); }
};

/// Calls f(column, entry) for the entries of a row of G that may differ from zero.
template <class Function>
void for_row(const ContactProblem& problem, int row, Function f) {
  if (problem.is_sparse()) {
    const SparseRows& G = problem.sparse;
    for (int k = G.start[row]; k < G.start[row + 1]; ++k) f(G.column[k], G.value[k]);
  } else {
    const double* G = problem.G.row(row);
    for (int j = 0; j < problem.rows(); ++j) f(j, G[j]);
  }
}

/// Entry (i, j) of G.
inline double entry(const ContactProblem& problem, int i, int j) {
  return problem.is_sparse() ? problem.sparse.at(i, j) : problem.G(i, j);
}

/// The same problem with G stored densely.
ContactProblem dense(const ContactProblem& problem);

/// Has every Coulomb contact the dim 2? Then the laws are piecewise linear.
bool only_plane_friction(const ContactProblem& problem);

/// @throws std::invalid_argument if the sizes of G, b and the sets disagree, columns of a sparse row do not
///         ascend, a set is not a set (mu < 0, dim not 2 or 3) or a value is not finite
void validate(const ContactProblem& problem);

}  // namespace saltus
