// Thousands of random problems: what enumeration can solve, the default must solve, and its answer is
// judged by conditions that this suite writes out itself.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <sstream>

#include "saltus/numerics/solvers/registry.hpp"
#include "support/complementarity.hpp"

namespace saltus::test {
namespace {

struct Family {
  const char* name;
  ProblemKind kind;
  int count;
};

void PrintTo(const Family& family, std::ostream* out) { *out << family.name; }

class RandomProblems : public testing::TestWithParam<Family> {};

std::string dump(const ContactProblem& problem) {
  std::ostringstream text;
  text << std::hexfloat << "G =\n"
       << problem.G.view() << "\nb = " << problem.b.view().transpose() << "\nsets:";
  for (const ContactSet& set : problem.sets) {
    const auto* law = std::get_if<Coulomb>(&set);
    text << (law ? " C" : std::holds_alternative<Equality>(set) ? " E" : " N");
    if (law) text << law->mu;
  }
  return text.str();
}

TEST_P(RandomProblems, TheDefaultSolvesWhatEnumerationCan) {
  std::mt19937 random(20150615);
  const auto automatic = make_contact_solver("auto");
  const auto enumeration = make_contact_solver("enumeration");
  automatic->reserve(20);
  enumeration->reserve(20);
  int solvable = 0;
  for (int k = 0; k < GetParam().count; ++k) {
    const ContactProblem problem = random_problem(random, GetParam().kind);
    ASSERT_NO_THROW(validate(problem));
    std::vector<double> P(problem.rows(), 0.0), reference(problem.rows(), 0.0);
    const bool found = enumeration->solve(problem, reference.data()).status == SolveStatus::solved;
    const SolveReport report = automatic->solve(problem, P.data());
    solvable += found;
    if (found) {
      ASSERT_EQ(report.status, SolveStatus::solved) << "problem " << k << "\n" << dump(problem);
      ASSERT_LE(violation(problem, reference), 1e-11 * terms(problem, reference)) << dump(problem);
    }
    if (report.status == SolveStatus::solved) {
      ASSERT_LE(violation(problem, P), 1e-11 * terms(problem, P)) << "problem " << k << "\n" << dump(problem);
    }
  }
  EXPECT_GE(solvable, 0.95 * GetParam().count);  // else the test above would be an empty one
}

INSTANTIATE_TEST_SUITE_P(
    Families, RandomProblems,
    testing::Values(Family{"regular", {}, 15000}, Family{"unsymmetric", {.moved = 1e-2}, 15000},
                    Family{"dependent", {.dependent = 2}, 10000},
                    // the same equality twice, at slightly different places, contradicts itself: none here
                    Family{
                        "dependent_unsymmetric", {.dependent = 2, .moved = 1e-6, .equalities = false}, 3000},
                    Family{"badly_scaled", {.scale_spread = 3.0}, 10000},
                    Family{"frictionless", {.dependent = 1, .friction = false}, 2000}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(UniqueProblems, EverySolverFindsTheSameVelocities) {
  // G symmetric positive definite and no friction: P is the solution of a strictly convex problem.
  std::mt19937 random(4);
  for (const SolverEntry& entry : contact_solvers()) {
    const auto solver = entry.make();
    const auto enumeration = make_contact_solver("enumeration");
    solver->reserve(20);
    enumeration->reserve(20);
    for (int k = 0; k < 500;) {
      const ContactProblem problem = random_problem(random, {.friction = false});
      const auto eigenvalues = Eigen::SelfAdjointEigenSolver<Matrix>(problem.G.view()).eigenvalues();
      if (eigenvalues[0] < 1e-2 * eigenvalues[problem.rows() - 1]) continue;
      ++k;
      std::vector<double> P(problem.rows(), 0.0), reference(P);
      ASSERT_EQ(enumeration->solve(problem, reference.data()).status, SolveStatus::solved);
      ASSERT_EQ(solver->solve(problem, P.data()).status, SolveStatus::solved) << entry.name << "\n"
                                                                              << dump(problem);
      const auto xi = relative_velocities(problem, P), expected = relative_velocities(problem, reference);
      const double scale = terms(problem, reference);
      for (int i = 0; i < problem.rows(); ++i) ASSERT_NEAR(xi[i], expected[i], 1e-10 * scale) << entry.name;
    }
  }
}

TEST(UniqueProblems, AWarmStartFromTheSolutionTakesNoIteration) {
  std::mt19937 random(5);
  const auto solver = make_contact_solver("semismooth-newton");
  solver->reserve(20);
  for (int k = 0; k < 100; ++k) {
    const ContactProblem problem = random_problem(random, {.friction = false});
    std::vector<double> P(problem.rows(), 0.0);
    if (solver->solve(problem, P.data()).status != SolveStatus::solved) continue;
    const std::vector<double> before = P;
    EXPECT_EQ(solver->solve(problem, P.data()).iterations, 0);
    EXPECT_EQ(P, before);
  }
}

TEST(ManyContacts, BeyondEnumerationTheDefaultSolvesColumns) {
  // n equal balls on each other, all closed, falling at 1 m/s: contact i stops all balls above it,
  // P_i = (n - i) m v. G is tridiagonal, and beyond 16 contacts enumeration is not there to help.
  const int n = 60;
  Matrix G = 2.0 * Matrix::Identity(n, n);
  G(0, 0) = 1.0;
  for (int i = 1; i < n; ++i) G(i, i - 1) = G(i - 1, i) = -1.0;
  Vec b = Vec::Zero(n);
  b[0] = -1.0;
  const ContactProblem problem = problem_of(G, b, std::vector<ContactSet>(n, NonNegative{}));
  const auto solver = make_contact_solver("auto");
  solver->reserve(n);
  std::vector<double> P(n, 0.0);
  ASSERT_EQ(solver->solve(problem, P.data()).status, SolveStatus::solved);
  for (int i = 0; i < n; ++i) EXPECT_NEAR(P[i], n - i, 1e-10 * n);
}

}  // namespace
}  // namespace saltus::test
