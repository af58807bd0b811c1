#include "saltus/numerics/problems.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "saltus/numerics/text.hpp"
#include "saltus/numerics/uniqueness.hpp"

namespace saltus {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double largest(const Vec& x) { return x.size() > 0 ? x.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() : 0.0; }

// |x|, also where squares would overflow or vanish
double norm(const Vec& x) {
  const double size = largest(x);
  return size > 0.0 && std::isfinite(size) ? size * (x / size).norm() : size;
}

// Terms that have overflowed say nothing.
double relative(double residual, double size) { return std::isfinite(size) ? residual / size : infinity; }

// G P + b
Vec response(const ContactProblem& problem, const double* P) {
  Vec xi = problem.b.view();
  for (int i = 0; i < problem.rows(); ++i)
    for_row(problem, i, [&](int j, double entry) { xi[i] += entry * P[j]; });
  return xi;
}

// proj_K of x = (N, T...), K = { |T| <= mu N }
void project_on_cone(double mu, Out x) {
  auto T = x.tail(x.size() - 1);
  const double length = norm(T);
  if (x[0] >= 0.0 && length <= mu * x[0]) return;
  const double edge = std::hypot(1.0, mu), cosine = 1.0 / edge, sine = mu / edge;
  const double along = cosine * x[0] + sine * length;
  if (along <= 0.0) {  // in the polar cone
    x.setZero();
    return;
  }
  x[0] = cosine * along;
  if (length > 0.0) T *= sine * along / length;
}

// d (r - proj(r - û/d)) of one contact, in the place of u
void natural_map(const ContactSet& set, double d, const double* r, Out u) {
  if (std::holds_alternative<Equality>(set)) return;
  const auto* law = std::get_if<Coulomb>(&set);
  const Vec force = d * In(r, u.size());
  if (law) u[0] += law->mu * norm(u.tail(u.size() - 1));  // De Saxcé
  u = force - u;
  if (!u.allFinite()) {  // an infinite û would look like one that opens the contact
    u.setConstant(infinity);
    return;
  }
  if (law)
    project_on_cone(law->mu, u);
  else
    u[0] = std::max(u[0], 0.0);
  u = force - u;
}

// Below this a certificate is rounding.
constexpr double least_tolerance = 1e-15;

// P that must not be negative is so by rounding at most: the sets say what is meant.
void project(const ContactProblem& problem, Vec& P) {
  int row = 0;
  for (const ContactSet& set : problem.sets) {
    if (std::holds_alternative<NonNegative>(set) && P[row] < 0.0) P[row] = 0.0;
    row += rows_of(set);
  }
}

// Solves from answer.solution. @return what the method says of itself
bool take_answer(const ContactProblem& problem, ContactSolver& method, ProblemSolution& answer) {
  const SolveReport report = method.solve(problem, answer.solution.data());
  answer.status = report.status;
  answer.iterations += report.iterations;
  answer.solver = report.solver;
  answer.residual = problem_residual(problem, answer.solution.data());
  Vec projected = answer.solution;
  project(problem, projected);
  const double residual = problem_residual(problem, projected.data());
  if (residual < answer.residual) {
    answer.residual = residual;
    answer.solution = projected;
  }
  return report.status == SolveStatus::solved;
}

void require_solvable(const ContactProblem& problem, const ContactSolver& method, double tolerance,
                      const Vec& start) {
  if (!(tolerance > 0.0) || !std::isfinite(tolerance))
    throw std::invalid_argument("tolerance must be positive and finite, got " + number(tolerance));
  if (start.size() != problem.rows() || !start.allFinite())
    throw std::invalid_argument("the warm start must be finite and have " + std::to_string(problem.rows()) +
                                " entries, got " + std::to_string(start.size()) +
                                (start.allFinite() ? "" : " with NaN or infinity"));
  if (!method.accepts(problem))
    throw std::invalid_argument("the contact solver '" + std::string(method.name()) +
                                "' does not accept this problem: its sets or its size are not among those "
                                "it solves");
}

}  // namespace

double complementarity_residual(const ContactProblem& problem, const double* z) {
  const int rows = problem.rows();
  const In x(z, rows);
  if (!x.allFinite()) return infinity;
  const Vec w = response(problem, z);
  double worst = 0.0;
  for (int i = 0; i < rows; ++i) {
    const ContactSet& set = problem.sets[i];
    if (std::holds_alternative<Coulomb>(set))
      throw std::invalid_argument("complementarity residual: there must be no friction, got a Coulomb set");
    const double entry = std::holds_alternative<Equality>(set) ? w[i] : std::min(w[i], x[i]) + 0.0 * w[i];
    if (std::isnan(entry)) return infinity;
    worst = std::max(worst, std::abs(entry));
  }
  if (worst == 0.0) return 0.0;
  double size_of_M = 0.0;
  for (int i = 0; i < rows; ++i) {
    double sum = 0.0;
    for_row(problem, i, [&](int, double entry) { sum += std::abs(entry); });
    size_of_M = std::max(size_of_M, sum);
  }
  return relative(worst, largest(problem.b.view()) + size_of_M * largest(x));
}

double friction_residual(const ContactProblem& problem, const double* r) {
  const int rows = problem.rows();
  if (!In(r, rows).allFinite()) return infinity;
  Vec map = response(problem, r);
  double d = 0.0;
  for (int i = 0; i < rows; ++i) d = std::max(d, std::abs(entry(problem, i, i)));
  if (d == 0.0) d = 1.0;
  int row = 0;
  for (const ContactSet& set : problem.sets) {
    const int count = rows_of(set);
    natural_map(set, d, r + row, Out(map.data() + row, count));
    row += count;
  }
  const double size = norm(problem.b.view());
  return relative(norm(map), size > 0.0 ? size : 1.0);
}

double problem_residual(const ContactProblem& problem, const double* P) {
  const bool friction = std::any_of(problem.sets.begin(), problem.sets.end(), [](const ContactSet& set) {
    return std::holds_alternative<Coulomb>(set);
  });
  return friction ? friction_residual(problem, P) : complementarity_residual(problem, P);
}

ProblemSolution solve_problem(const ContactProblem& given, ContactSolver& method, double tolerance,
                              const Vec& start) {
  validate(given);
  ContactProblem problem = given.is_sparse() && !method.takes_sparse() ? dense(given) : given;
  require_solvable(problem, method, tolerance, start);
  ProblemSolution answer{
      .solution = start, .status = SolveStatus::solved, .solver = std::string(method.name()), .unique = true};
  if (problem.rows() == 0) return answer;
  method.reserve(problem.rows());
  problem.tolerance = tolerance;
  bool solved = take_answer(problem, method, answer);
  // The method goes by its certificate, which is relative to other terms: it may have to try harder.
  while (!(answer.residual <= tolerance) && solved && problem.tolerance > least_tolerance) {
    problem.tolerance =
        std::max(least_tolerance, 0.1 * problem.tolerance * std::min(1.0, tolerance / answer.residual));
    ProblemSolution next = answer;
    solved = take_answer(problem, method, next);
    if (next.residual < answer.residual) answer = next;
  }
  if (answer.residual <= tolerance) {
    answer.status = SolveStatus::solved;
  } else if (answer.status == SolveStatus::solved) {
    answer.status = SolveStatus::breakdown;
  }
  problem.tolerance = tolerance;
  answer.unique =
      answer.status == SolveStatus::solved ? is_only_solution(problem, answer.solution.data()) : std::nullopt;
  return answer;
}

}  // namespace saltus
