// Newton's method with a line search: where the method without one cycles, and where there is no solution.
#include "saltus/numerics/solvers/globalised_newton.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "saltus/numerics/solvers/registry.hpp"
#include "support/complementarity.hpp"

namespace saltus::test {
namespace {

constexpr const char* both[] = {"damped-newton", "fischer-burmeister"};

ContactProblem lcp(const Matrix& M, const Vec& q) {
  return problem_of(M, q, std::vector<ContactSet>(q.size(), NonNegative{}));
}

TEST(GlobalisedNewton, SolvesWhereNewtonAloneCycles) {
  // A P-matrix for which the open and closed rows repeat. Ben Gharbia, Gilbert, Math. Program. 134 (2012)
  // 349-364
  const Matrix M = (Matrix(3, 3) << 1.0, 0.0, 2.0, 2.0, 1.0, 0.0, 0.0, 2.0, 1.0).finished();
  const ContactProblem problem = lcp(M, -Vec::Ones(3));
  const Vec start = (Vec(3) << -1.0, 1.0, 0.0).finished();
  Vec P = start;
  EXPECT_EQ(make_contact_solver("semismooth-newton")->solve(problem, P.data()).status,
            SolveStatus::iteration_limit);
  for (const char* name : both) {
    P = start;
    EXPECT_EQ(make_contact_solver(name)->solve(problem, P.data()).status, SolveStatus::solved) << name;
    EXPECT_LE((P - Vec::Constant(3, 1.0 / 3.0)).norm(), 1e-11) << name;
  }
}

TEST(GlobalisedNewton, SolvesEveryRandomComplementarityProblem) {
  for (const ProblemKind& kind :
       {ProblemKind{.friction = false}, ProblemKind{.dependent = 2, .friction = false},
        ProblemKind{.scale_spread = 3.0, .friction = false}}) {
    std::mt19937 random(9);
    const auto solver = make_contact_solver("fischer-burmeister");
    for (int k = 0; k < 1000; ++k) {
      const ContactProblem problem = random_problem(random, kind);
      std::vector<double> P(problem.rows(), 0.0);
      ASSERT_EQ(solver->solve(problem, P.data()).status, SolveStatus::solved) << k;
      ASSERT_LE(violation(problem, P), 1e-11 * terms(problem, P)) << k;
    }
  }
}

TEST(GlobalisedNewton, SolvesMostRandomContacts) {
  for (const double space : {0.0, 1.0}) {
    std::mt19937 random(9);
    const auto solver = make_contact_solver("damped-newton");
    int solved = 0;
    for (int k = 0; k < 1000; ++k) {
      const ContactProblem problem = random_problem(random, {.dependent = k % 3, .space = space});
      std::vector<double> P(problem.rows(), 0.0);
      if (solver->solve(problem, P.data()).status != SolveStatus::solved) continue;
      ++solved;
      ASSERT_LE(violation(problem, P), 1e-11 * terms(problem, P)) << k;
    }
    EXPECT_GE(solved, 980);
  }
}

TEST(GlobalisedNewton, IsQuadraticInSpace) {
  // One contact that slides, from a start that does not: the direction of sliding is what is iterated.
  const Matrix G = (Matrix(3, 3) << 1.0, 0.1, 0.2, 0.1, 2.0, 0.5, 0.2, 0.5, 4.0).finished();
  const ContactProblem problem = problem_of(G, (Vec(3) << -1.0, 3.0, 4.0).finished(), {Coulomb{0.5, 3}});
  std::vector<double> P(3, 0.0);
  const SolveReport report = make_contact_solver("damped-newton")->solve(problem, P.data());
  ASSERT_EQ(report.status, SolveStatus::solved);
  EXPECT_LE(report.iterations, 6);
  EXPECT_LE(violation(problem, P), 1e-12);
}

TEST(GlobalisedNewton, EndsWhereThereIsNoSolution) {
  const Matrix M = (Matrix(2, 2) << 1.0, 2.0, -1.0, -1.0).finished();
  for (const char* name : both) {
    Vec P = Vec::Zero(2);
    const SolveReport report = make_contact_solver(name)->solve(lcp(M, Vec::Constant(2, -1.0)), P.data());
    EXPECT_NE(report.status, SolveStatus::solved) << name;
    EXPECT_GT(report.certificate.residual, 0.1) << name;
    EXPECT_LE(report.iterations, 200) << name;
    EXPECT_TRUE(P.allFinite()) << name;
  }
}

TEST(GlobalisedNewton, TheUnitsOfMassAndVelocityDoNotMatter) {
  const Matrix M = (Matrix(2, 2) << 2.0, 1.0, 1.0, 2.0).finished();
  for (const char* name : both)
    for (const double mass : {1e-100, 1.0, 1e100})
      for (const double unit : {1e-200, 1.0, 1e180}) {
        Vec P = Vec::Zero(2);
        const SolveReport report =
            make_contact_solver(name)->solve(lcp(M / mass, Vec::Constant(2, -unit)), P.data());
        EXPECT_EQ(report.status, SolveStatus::solved) << name << ' ' << mass << ' ' << unit;
        EXPECT_NEAR(P[0] / (mass * unit), 1.0 / 3.0, 1e-11) << name;
      }
}

TEST(GlobalisedNewton, TakesManySparseRows) {
  // The natural map closes one ball after the other, the other function all at once.
  const struct {
    const char* name;
    int n;
  } cases[] = {{"damped-newton", 150}, {"fischer-burmeister", 3000}};
  for (const auto& [name, n] : cases) {
    const auto solver = make_contact_solver(name);
    ASSERT_TRUE(solver->takes_sparse());
    Vec P = Vec::Zero(n);
    ASSERT_EQ(solver->solve(column_of_balls(n, 1.0), P.data()).status, SolveStatus::solved) << name;
    for (int i = 0; i < n; ++i) ASSERT_NEAR(P[i], n - i, 1e-6 * n) << name;
  }
}

TEST(GlobalisedNewton, TheFunctionOfFischerAndBurmeisterTakesNoFriction) {
  const ContactProblem plane = problem_of(Matrix::Identity(2, 2), Vec::Zero(2), {Coulomb{0.5, 2}});
  EXPECT_FALSE(make_contact_solver("fischer-burmeister")->accepts(plane));
  EXPECT_TRUE(make_contact_solver("damped-newton")->accepts(plane));
}

}  // namespace
}  // namespace saltus::test
