// Thousands of random problems: what enumeration can solve, the default must solve, and its answer is
// judged by conditions that this suite writes out itself.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
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

// Friction in space has no enumeration to compare with: what mechanics makes, symmetric and with b in the
// range of G, has a solution, and the default must find it; of the harder ones nearly all.
struct SpatialFamily {
  const char* name;
  ProblemKind kind;
  double share;
};

void PrintTo(const SpatialFamily& family, std::ostream* out) { *out << family.name; }

class SpatialProblems : public testing::TestWithParam<SpatialFamily> {};

TEST_P(SpatialProblems, TheDefaultSolves) {
  std::mt19937 random(20150615);
  const auto solver = make_contact_solver("auto");
  solver->reserve(20);
  const int count = 2000;
  int solved = 0;
  for (int k = 0; k < count; ++k) {
    const ContactProblem problem = random_problem(random, GetParam().kind);
    ASSERT_NO_THROW(validate(problem));
    std::vector<double> P(problem.rows(), 0.0);
    if (solver->solve(problem, P.data()).status != SolveStatus::solved) continue;
    ++solved;
    ASSERT_LE(violation(problem, P), 1e-11 * terms(problem, P)) << "problem " << k << "\n" << dump(problem);
  }
  EXPECT_GE(solved, GetParam().share * count);
}

INSTANTIATE_TEST_SUITE_P(
    Families, SpatialProblems,
    testing::Values(
        SpatialFamily{"regular", {.space = 1.0, .largest_mu = 1.5}, 1.0},
        SpatialFamily{"beside_plane_friction", {.space = 0.5, .largest_mu = 1.5}, 1.0},
        SpatialFamily{"unsymmetric", {.moved = 1e-2, .space = 1.0, .largest_mu = 1.5}, 1.0},
        SpatialFamily{"dependent", {.dependent = 2, .space = 1.0, .largest_mu = 1.5}, 1.0},
        SpatialFamily{"without_friction", {.dependent = 1, .space = 1.0, .largest_mu = 0.0}, 1.0},
        SpatialFamily{"dependent_unsymmetric",
                      {.dependent = 2, .moved = 1e-6, .space = 1.0, .largest_mu = 1.5, .equalities = false},
                      0.99},
        SpatialFamily{"badly_scaled", {.scale_spread = 3.0, .space = 1.0, .largest_mu = 1.5}, 0.99}),
    [](const auto& test) { return std::string(test.param.name); });

bool well_conditioned(const ContactProblem& problem) {
  const auto eigenvalues = Eigen::SelfAdjointEigenSolver<Matrix>(problem.G.view()).eigenvalues();
  return eigenvalues[0] >= 1e-2 * eigenvalues[problem.rows() - 1];
}

TEST(UniqueProblems, WithLittleFrictionInSpaceEverySolverFindsTheSameVelocities) {
  // Little friction is a small change of a strictly convex problem: the solution is still the only one.
  std::mt19937 random(6);
  const auto reference_solver = make_contact_solver("auto");
  reference_solver->reserve(20);
  for (int k = 0; k < 300;) {
    const ContactProblem problem = random_problem(random, {.space = 1.0, .largest_mu = 0.1});
    if (!well_conditioned(problem)) continue;
    ++k;
    std::vector<double> reference(problem.rows(), 0.0);
    ASSERT_EQ(reference_solver->solve(problem, reference.data()).status, SolveStatus::solved)
        << dump(problem);
    const auto expected = relative_velocities(problem, reference);
    for (const SolverEntry& entry : contact_solvers()) {
      const auto solver = entry.make();
      if (!solver->accepts(problem)) continue;
      std::vector<double> P(problem.rows(), 0.0);
      ASSERT_EQ(solver->solve(problem, P.data()).status, SolveStatus::solved) << entry.name << dump(problem);
      const auto xi = relative_velocities(problem, P);
      for (int i = 0; i < problem.rows(); ++i)
        ASSERT_NEAR(xi[i], expected[i], 1e-10 * terms(problem, reference)) << entry.name << dump(problem);
    }
  }
}

TEST(Convergence, NewtonIsQuadraticWhereSweepsAreLinear) {
  std::mt19937 random(8);
  const auto newton = make_contact_solver("semismooth-newton"),
             prox = make_contact_solver("prox-fixed-point");
  int steps = 0, sweeps = 0, most_steps = 0;
  for (int k = 0; k < 300;) {
    const ContactProblem problem =
        random_problem(random, {.space = 1.0, .largest_mu = 0.5, .equalities = false});
    if (!well_conditioned(problem)) continue;
    ++k;
    std::vector<double> P(problem.rows(), 0.0), Q(P);
    const SolveReport fast = newton->solve(problem, P.data()), slow = prox->solve(problem, Q.data());
    if (fast.status != SolveStatus::solved || slow.status != SolveStatus::solved) continue;
    steps += fast.iterations;
    most_steps = std::max(most_steps, fast.iterations);
    sweeps += slow.iterations;
  }
  EXPECT_LE(most_steps, 12);
  EXPECT_GE(sweeps, 5 * steps);
}

TEST(ProxFixedPoint, StepsAdaptWhereFullOnesDiverge) {
  // Equalities with G = I + 2 J, J skew: sweeps with omega = 1 grow fourfold, below 2/3 they converge.
  const Matrix G = (Matrix(2, 2) << 1.0, 2.0, -2.0, 1.0).finished();
  const ContactProblem problem = problem_of(G, (Vec(2) << 1.0, 1.0).finished(), {Equality{}, Equality{}});
  std::vector<double> P(2, 0.0), Q(P);
  ASSERT_EQ(make_contact_solver("prox-fixed-point")->solve(problem, P.data()).status, SolveStatus::solved);
  EXPECT_NEAR(P[0], 0.2, 1e-11);  // P = -G⁻¹ b
  EXPECT_NEAR(P[1], -0.6, 1e-11);
  EXPECT_NE(make_contact_solver("nsgs")->solve(problem, Q.data()).status, SolveStatus::solved);
}

TEST(SubsetNewton, ContactsThatContradictEachOtherSlightly) {
  // One body, two contacts at one place, the second approached faster by 1e-6 and so the one that carries.
  const Matrix G = Matrix::Ones(2, 2);
  const ContactProblem problem =
      problem_of(G, (Vec(2) << -1.0, -1.0 - 1e-6).finished(), {NonNegative{}, NonNegative{}});
  std::vector<double> P(2, 0.0);
  ASSERT_EQ(make_contact_solver("subset-newton")->solve(problem, P.data()).status, SolveStatus::solved);
  EXPECT_EQ(P[0], 0.0);
  EXPECT_NEAR(P[1], 1.0 + 1e-6, 1e-14);
}

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
