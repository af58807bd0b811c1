// Problems for their own sake: their residuals, worked out by hand, and what is called solved.
#include "saltus/numerics/problems.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "saltus/numerics/observed_solver.hpp"
#include "saltus/numerics/solvers/lemke.hpp"
#include "saltus/numerics/solvers/registry.hpp"
#include "support/complementarity.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

using Rows = std::initializer_list<double>;

Vec vec(Rows values) { return Eigen::Map<const Vec>(values.begin(), static_cast<int>(values.size())); }

Matrix square(int n, Rows values) { return Eigen::Map<const Matrix>(values.begin(), n, n); }

ContactProblem lcp(const Matrix& M, const Vec& q) {
  return problem_of(M, q, std::vector<ContactSet>(q.size(), NonNegative{}));
}

ProblemSolution solve(const ContactProblem& problem, const char* solver = "auto", double tolerance = 1e-12) {
  return solve_problem(problem, *make_contact_solver(solver), tolerance, Vec::Zero(problem.rows()));
}

TEST(ComplementarityResidual, IsThatOfTheDefinition) {
  // w = (2 + 1 - 3, 1 - 8 + 4) = (0, -3): min(z, w) = (0, -3); |q| = 4, |M| = 9 (second row), |z| = 1
  const ContactProblem problem = lcp(square(2, {2.0, 1.0, 1.0, -8.0}), vec({-3.0, 4.0}));
  EXPECT_DOUBLE_EQ(complementarity_residual(problem, vec({1.0, 1.0}).data()), 3.0 / 13.0);
}

TEST(ComplementarityResidual, AnEqualityHasItsWholeRow) {
  ContactProblem problem = lcp(Matrix::Identity(2, 2), vec({1.0, 1.0}));
  EXPECT_EQ(complementarity_residual(problem, vec({0.0, 0.0}).data()), 0.0);
  problem.sets[1] = Equality{};
  EXPECT_DOUBLE_EQ(complementarity_residual(problem, vec({0.0, 0.0}).data()), 1.0);
  problem.sets = {Coulomb{0.5, 2}};
  EXPECT_NE(refusal([&] { complementarity_residual(problem, vec({0.0, 0.0}).data()); }).find("Coulomb"),
            std::string::npos);
}

TEST(FrictionResidual, VanishesInEveryModeOfCoulombsLaw) {
  const Matrix W = 2.0 * Matrix::Identity(3, 3);
  const struct {
    Vec q, r;
  } cases[] = {{vec({1.0, 5.0, 0.0}), vec({0.0, 0.0, 0.0})},      // open
               {vec({-2.0, 0.6, 0.8}), vec({1.0, -0.3, -0.4})},   // sticking, at the edge of the cone
               {vec({-2.0, 6.0, 8.0}), vec({1.0, -0.3, -0.4})}};  // sliding
  for (const auto& [q, r] : cases)
    EXPECT_LE(friction_residual(problem_of(W, q, {Coulomb{0.5, 3}}), r.data()), 1e-15);
}

TEST(ComplementarityResidual, IsNotSmallWhereItsTermsOverflow) {
  // |min(z, w)| = 1e300 over |M| |z| = 1e309
  const ContactProblem problem = lcp(square(2, {1e160, 0.0, 0.0, 1.0}), vec({-1e300, -1e149}));
  EXPECT_FALSE(complementarity_residual(problem, vec({0.0, 1e149}).data()) <= 1e-12);
}

TEST(FrictionResidual, OfAnyUnitOfVelocity) {
  // nothing presses against the approach: the residual is 1
  for (const double unit : {1e-300, 1e-170, 1.0, 1e170, 1e300})
    EXPECT_NEAR(friction_residual(problem_of(Matrix::Identity(2, 2), vec({-unit, 0.0}), {Coulomb{0.0, 2}}),
                                  vec({0.0, 0.0}).data()),
                1.0, 1e-15);
}

TEST(FrictionResidual, APullIsNotAllowedWithoutFrictionEither) {
  const ContactProblem problem = problem_of(Matrix::Identity(2, 2), vec({1.0, 0.0}), {Coulomb{0.0, 2}});
  EXPECT_DOUBLE_EQ(friction_residual(problem, vec({-1.0, 0.0}).data()), 1.0);
}

TEST(FrictionResidual, LargeFrictionHoldsWhatAHalfSpaceHolds) {
  // mu |u_T| overflows: an infinite û must not look like one that opens the contact
  const auto fast =
      problem_of(Matrix::Identity(2, 2), (Vec(2) << -4e307, 1e308).finished(), {Coulomb{10.0, 2}});
  const double nothing[2] = {0.0, 0.0};
  EXPECT_FALSE(friction_residual(fast, nothing) <= 1.0);
  // mu² overflows, û = 0 and r is on the border of the half space r_N >= 0, 1e-160 from the cone
  const ContactProblem problem = problem_of(Matrix::Identity(2, 2), vec({0.0, -1.0}), {Coulomb{1e160, 2}});
  EXPECT_NEAR(friction_residual(problem, vec({0.0, 1.0}).data()), 0.0, 1e-15);
}

TEST(FrictionResidual, IsTheNaturalMapWithDeSaxcesTerm) {
  // r = 0: u = q, û = (-2 + mu 5, 3, 4) = (0.5, 3, 4), -û/d projected on the cone of mu = 0.5: it lies in the
  // polar cone where -0.5 + 0.5·5 <= 0, which is not so; N = (-0.5 + 2.5)/1.25 = 1.6, T = -0.8 (0.6, 0.8).
  const ContactProblem problem =
      problem_of(4.0 * Matrix::Identity(3, 3), vec({-2.0, 3.0, 4.0}), {Coulomb{0.5, 3}});
  EXPECT_NEAR(friction_residual(problem, vec({0.0, 0.0, 0.0}).data()), std::hypot(1.6, 0.8) / std::sqrt(29.0),
              1e-15);
}

TEST(FrictionResidual, DoesNotDependOnTheUnitOfMass) {
  Vec r = vec({0.9, -0.2, -0.4});
  const Vec q = vec({-2.0, 6.0, 8.0});
  const double light =
      friction_residual(problem_of(2.0 * Matrix::Identity(3, 3), q, {Coulomb{0.5, 3}}), r.data());
  r *= 1e6;
  const double heavy =
      friction_residual(problem_of(2e-6 * Matrix::Identity(3, 3), q, {Coulomb{0.5, 3}}), r.data());
  EXPECT_GT(light, 0.01);
  EXPECT_NEAR(heavy, light, 1e-14);
}

TEST(FrictionResidual, OfAMixedProblemHasEveryRow) {
  const ContactProblem problem = problem_of(Matrix::Identity(4, 4), vec({-1.0, 0.0, -2.0, 3.0}),
                                            {Coulomb{0.5, 2}, NonNegative{}, Equality{}});
  EXPECT_EQ(friction_residual(problem, vec({1.0, 0.0, 2.0, -3.0}).data()), 0.0);
  EXPECT_DOUBLE_EQ(friction_residual(problem, vec({1.0, 0.0, 2.0, -2.0}).data()), 1.0 / std::sqrt(14.0));
  EXPECT_DOUBLE_EQ(friction_residual(problem, vec({1.0, 0.0, 0.0, -3.0}).data()), 2.0 / std::sqrt(14.0));
}

TEST(SolveProblem, KnownComplementarityProblems) {
  // Cottle, Pang, Stone: The Linear Complementarity Problem, 1992
  const struct {
    Matrix M;
    Vec q, z;
  } cases[] = {
      {square(4, {11, 0, 10, -1, 0, 11, 10, -1, 10, 10, 21, -1, 1, 1, 1, 0}), vec({50, 50, 10, -6}),
       vec({2, 2, 2, 92})},
      {square(2, {1, -1, -1, 1}), vec({1, -1}), vec({0, 1})},
      {square(3, {0, -1, -1, 1, 0, 0, -1, 0, 0}), vec({0, -1, 1}), vec({1, 0, 0})},
  };
  for (const auto& [M, q, z] : cases) {
    EXPECT_EQ(problem_residual(lcp(M, q), z.data()), 0.0);
    for (const char* solver : {"auto", "lemke"}) {
      const ProblemSolution answer = solve(lcp(M, q), solver);
      EXPECT_EQ(answer.status, SolveStatus::solved) << solver;
      EXPECT_LE(answer.residual, 1e-15) << solver;
    }
  }
}

TEST(SolveProblem, NothingToSolve) {
  EXPECT_EQ(solve(problem_of(Matrix(0, 0), Vec(0), {})).status, SolveStatus::solved);
  for (const ContactSet& set :
       {ContactSet(NonNegative{}), ContactSet(Coulomb{0.3, 3}), ContactSet(Equality{})}) {
    const int rows = rows_of(set);
    const ProblemSolution answer = solve(problem_of(Matrix::Identity(rows, rows), Vec::Zero(rows), {set}));
    EXPECT_EQ(answer.status, SolveStatus::solved);
    EXPECT_EQ(answer.residual, 0.0);
    EXPECT_TRUE(answer.solution.isZero(0.0));
  }
}

TEST(SolveProblem, ARayOfLemkesMethodIsReportedWhereNothingElseHelps) {
  for (const char* solver : {"auto", "lemke"}) {
    const ProblemSolution answer = solve(lcp(square(2, {1, 2, -1, -1}), vec({-1, -1})), solver);
    EXPECT_EQ(answer.status, SolveStatus::ray) << solver;
    EXPECT_GT(answer.residual, 0.1);
  }
  // A bimatrix game with three isolated solutions: Lemke's path ends, other methods find one.
  Matrix game = Matrix::Zero(4, 4);
  game.topRightCorner(2, 2) << 10, 20, 30, 15;
  game.bottomLeftCorner(2, 2) << 10, 20, 30, 15;
  EXPECT_EQ(solve(lcp(game, Vec::Constant(4, -1.0)), "lemke").status, SolveStatus::ray);
  EXPECT_EQ(solve(lcp(game, Vec::Constant(4, -1.0))).status, SolveStatus::solved);
}

// A solver that says of anything that it is solved
class Liar final : public ContactSolver {
 public:
  std::string_view name() const override { return "liar"; }
  bool accepts(const ContactProblem&) const override { return true; }
  void reserve(int) override {}
  SolveReport solve(const ContactProblem&, double*) override { return {.iterations = 1, .solver = name()}; }
  std::unique_ptr<ContactSolver> clone() const override { return std::make_unique<Liar>(); }
};

TEST(SolveProblem, DoesNotBelieveTheMethod) {
  Liar liar;
  const ContactProblem problem = lcp(Matrix::Identity(2, 2), vec({-1.0, 1.0}));
  const ProblemSolution answer = solve_problem(problem, liar, 1e-12, Vec::Zero(2));
  EXPECT_EQ(answer.status, SolveStatus::breakdown);
  EXPECT_DOUBLE_EQ(answer.residual, 1.0);
  EXPECT_LE(answer.iterations, 20);
  // and takes a start that is a solution, whoever found it
  EXPECT_EQ(solve_problem(problem, liar, 1e-12, vec({1.0, 0.0})).status, SolveStatus::solved);
}

TEST(SolveProblem, TriesHarderWhereTheCertificateIsSatisfiedTooEarly) {
  // W r is 1e3 times larger than q: 1e-12 of the one is 1e-9 of the other.
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const Matrix H = Matrix::NullaryExpr(9, 6, [&] { return normal(random); });
  Matrix W = H.transpose() * H;
  const ContactProblem problem =
      problem_of(W, vec({-1, 0.1, 0.2, -1, 0.3, 0.1}), {Coulomb{0.3, 3}, Coulomb{0.3, 3}});
  for (double tolerance : {1e-4, 1e-8, 1e-12, 1e-14}) {
    const ProblemSolution answer = solve(problem, "nsgs", tolerance);
    EXPECT_EQ(answer.status, SolveStatus::solved) << tolerance;
    EXPECT_LE(answer.residual, tolerance);
  }
  EXPECT_LT(solve(problem, "nsgs", 1e-4).iterations, solve(problem, "nsgs", 1e-12).iterations);
}

// A solver that answers z = (1, -1e-9), which the laws take for rounding where M is small
class Below final : public ContactSolver {
 public:
  std::string_view name() const override { return "below"; }
  bool accepts(const ContactProblem&) const override { return true; }
  void reserve(int) override {}
  SolveReport solve(const ContactProblem&, double* P) override {
    P[0] = 1.0;
    P[1] = -1e-9;
    return {.iterations = 1, .solver = name()};
  }
  std::unique_ptr<ContactSolver> clone() const override { return std::make_unique<Below>(); }
};

TEST(SolveProblem, WhatMustNotBeNegativeIsNot) {
  Below below;
  const ContactProblem problem = lcp(square(2, {1, 0, 0, 1e-12}), vec({-1, 1}));
  const ProblemSolution answer = solve_problem(problem, below, 1e-12, Vec::Zero(2));
  EXPECT_EQ(answer.status, SolveStatus::solved);
  EXPECT_EQ(answer.solution[1], 0.0);
}

TEST(SolveProblem, RefusesWhatIsNoProblem) {
  const ContactProblem good = lcp(Matrix::Identity(2, 2), vec({-1.0, 1.0}));
  const auto method = make_contact_solver("auto");
  auto says = [](const std::string& message, const char* words) {
    EXPECT_NE(message.find(words), std::string::npos) << message;
  };
  says(refusal([&] { solve_problem(good, *method, 0.0, Vec::Zero(2)); }), "tolerance must be positive");
  says(refusal([&] { solve_problem(good, *method, std::nan(""), Vec::Zero(2)); }),
       "tolerance must be positive");
  says(refusal([&] { solve_problem(good, *method, 1e-12, Vec::Zero(3)); }), "2 entries, got 3");
  says(refusal([&] { solve_problem(good, *method, 1e-12, vec({0.0, std::nan("")})); }), "NaN");
  const ContactProblem space = problem_of(Matrix::Identity(3, 3), Vec::Zero(3), {Coulomb{0.5, 3}});
  says(refusal([&] { solve(space, "lemke"); }), "'lemke' does not accept");
}

TEST(Lemke, EqualitiesWithoutABlockOfTheirOwn) {
  // z0 + z1 - 2 = 0, z1 - z0 + 1 >= 0 ⟂ z1 >= 0 with no z0 in its own row: z = (2, 0) has w1 = -1, so z1 =
  // 1/2
  const ContactProblem problem =
      problem_of(square(2, {0, 1, -1, 1}), vec({-0.5, 0.25}), {Equality{}, NonNegative{}});
  const ProblemSolution answer = solve(problem, "lemke");
  ASSERT_EQ(answer.status, SolveStatus::solved);
  EXPECT_NEAR(answer.solution[1], 0.5, 1e-15);
  EXPECT_NEAR(answer.solution[0], 0.75, 1e-15);  // w1 = -z0 + z1 + 1/4 = 0
}

TEST(ObservedSolver, ShowsEveryProblemAndItsClonesDoToo) {
  ObservedSolver solver(make_contact_solver("lemke"));
  const auto clone = solver.clone();
  int seen = 0;
  solver.watch([&](const ContactProblem& problem, const double* P, const SolveReport& report) {
    ++seen;
    EXPECT_EQ(problem.rows(), 1);
    EXPECT_DOUBLE_EQ(P[0], 0.5);
    EXPECT_EQ(report.status, SolveStatus::solved);
  });
  const ContactProblem problem = lcp(square(1, {2.0}), vec({-1.0}));
  double P = 0.0;
  solver.solve(problem, &P);
  clone->solve(problem, &P);
  EXPECT_EQ(seen, 2);
  EXPECT_EQ(solver.name(), "lemke");
  solver.watch({});
  clone->solve(problem, &P);
  EXPECT_EQ(seen, 2);
}

}  // namespace
}  // namespace saltus::test
