#pragma once
// Problems for their own sake: complementarity and friction, with a residual that does not depend on who
// solves.
#include <optional>
#include <string>

#include "saltus/numerics/contact_solver.hpp"

namespace saltus {

/// Largest entry of the natural map of a linear complementarity problem w = M z + q, mixed with equalities:
///   |min(z_i, w_i)|, |w_i| in a row of an Equality,
/// divided by |q|_inf + |M|_inf |z|_inf, with the largest sum of a row as norm of M; 0 if all vanish,
/// infinite if a term is not finite.
/// @param z (rows)
/// @throws std::invalid_argument if there is a Coulomb set
double complementarity_residual(const ContactProblem& problem, const double* z);

/// Norm of the natural map of Coulomb's law with De Saxcé's term, u = W r + q and d = max_k |W_kk|:
///   d |r - proj_K(r - (u + mu |u_T| n)/d)| / |q|,  K = { |r_T| <= mu r_N },
/// as velocities; r_i >= 0 for NonNegative and u_i for Equality. Not divided where q = 0, infinite or NaN
/// where a term has overflowed.
/// De Saxcé, Feng, Math. Comput. Modelling 28 (1998) 225-245.
/// @param r (rows)
double friction_residual(const ContactProblem& problem, const double* r);

/// The friction residual if a set is Coulomb, the complementarity residual otherwise.
double problem_residual(const ContactProblem& problem, const double* P);

struct ProblemSolution {
  Vec solution;                     ///< (rows)
  SolveStatus status;               ///< solved only where the residual is within the tolerance
  int iterations = 0;               ///< of the methods that answered
  double residual = 0.0;            ///< problem_residual() of the solution
  std::string solver;               ///< name of the method that answered
  std::optional<bool> unique = {};  ///< is_only_solution() where it is solved; nothing if that is not known
};

/// Solves a problem and judges the answer by problem_residual(), whatever the method says of itself.
/// Where that is satisfied too early it goes on with a smaller ContactProblem::tolerance.
/// @param start  (rows) warm start
/// @throws std::invalid_argument as validate(), if the method does not accept the problem, the tolerance is
///         not positive and finite, or the start is not finite or has another size
ProblemSolution solve_problem(const ContactProblem& given, ContactSolver& method, double tolerance,
                              const Vec& start);

}  // namespace saltus
