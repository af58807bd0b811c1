// Projected over-relaxation: single sweeps worked out by hand, and what becomes of rows without a diagonal.
#include "saltus/numerics/solvers/psor.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "saltus/numerics/solvers/registry.hpp"
#include "support/complementarity.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

Vec vec(std::initializer_list<double> values) {
  return Eigen::Map<const Vec>(values.begin(), static_cast<int>(values.size()));
}

// n equal balls on each other that fall together: P_i = n - i
ContactProblem column(int n) {
  Matrix G = 2.0 * Matrix::Identity(n, n);
  G(0, 0) = 1.0;
  for (int i = 1; i < n; ++i) G(i, i - 1) = G(i - 1, i) = -1.0;
  Vec b = Vec::Zero(n);
  b[0] = -1.0;
  return problem_of(G, b, std::vector<ContactSet>(n, NonNegative{}));
}

TEST(Psor, ASweepTakesWhatTheRowsBeforeHaveBecome) {
  const Matrix G = (Matrix(3, 3) << 2.0, 1.0, 0.0, 1.0, 2.0, 0.0, 0.0, 1.0, 4.0).finished();
  const ContactProblem problem =
      problem_of(G, vec({-1.0, -1.0, 2.0}), {NonNegative{}, NonNegative{}, Equality{}});
  Vec P = Vec::Zero(3);
  const SolveReport report = Psor(1.5, 1).solve(problem, P.data());
  EXPECT_EQ(report.status, SolveStatus::iteration_limit);
  EXPECT_EQ(report.iterations, 1);
  EXPECT_DOUBLE_EQ(P[0], 0.75);        // 1.5 · 1 / 2
  EXPECT_DOUBLE_EQ(P[1], 0.1875);      // 1.5 (1 - 0.75) / 2
  EXPECT_DOUBLE_EQ(P[2], -0.8203125);  // -1.5 (2 + 0.1875) / 4
}

TEST(Psor, BothTangentsOfAContactTakeTheSameStep) {
  // P_N = 1, P_T = -(3, 4)/4 is longer than mu P_N and shrinks to it. Steps of their own would turn it.
  const Matrix G = vec({1.0, 2.0, 4.0}).asDiagonal();
  const ContactProblem problem = problem_of(G, vec({-1.0, 3.0, 4.0}), {Coulomb{0.5, 3}});
  Vec P = Vec::Zero(3);
  Psor(1.0, 1).solve(problem, P.data());
  EXPECT_DOUBLE_EQ(P[0], 1.0);
  EXPECT_DOUBLE_EQ(P[1], -0.3);
  EXPECT_DOUBLE_EQ(P[2], -0.4);
  std::vector<double> Q(3, 0.0);
  ASSERT_EQ(make_contact_solver("pgs")->solve(problem, Q.data()).status, SolveStatus::solved);
  EXPECT_LE(violation(problem, Q), 1e-11);
  EXPECT_GT(std::abs(Q[1] / Q[2] - 0.75), 0.01);  // the law has another direction than the first sweep
}

TEST(Psor, OverRelaxationTakesFewerSweeps) {
  const int n = 12;
  Vec P = Vec::Zero(n), Q = P;
  const SolveReport over = make_contact_solver("psor")->solve(column(n), P.data()),
                    plain = make_contact_solver("pgs")->solve(column(n), Q.data());
  ASSERT_EQ(over.status, SolveStatus::solved);
  ASSERT_EQ(plain.status, SolveStatus::solved);
  EXPECT_LE(over.iterations, 0.6 * plain.iterations);  // (2 - 1.3)/1.3 = 0.54 is that of many rows
  for (int i = 0; i < n; ++i) EXPECT_NEAR(P[i], n - i, 1e-8);
}

TEST(Psor, ARowWithoutAPositiveDiagonalKeepsItsImpulse) {
  // A multiplier of a constraint, [1 1; -1 0]: its row has no diagonal entry, and nothing moves it.
  const Matrix saddle = (Matrix(2, 2) << 1.0, 1.0, -1.0, 0.0).finished();
  Vec P = vec({0.0, 0.5});
  const SolveReport report = make_contact_solver("pgs")->solve(
      problem_of(saddle, vec({-2.0, 1.0}), {NonNegative{}, Equality{}}), P.data());
  EXPECT_EQ(report.status, SolveStatus::breakdown);
  EXPECT_LE(report.iterations, 3);
  EXPECT_EQ(P[1], 0.5);
  // A negative one is as good as a positive one in an equality, and no use in an inequality.
  const struct {
    ContactSet set;
    SolveStatus status;
    double P;
  } cases[] = {{Equality{}, SolveStatus::solved, 1.5}, {NonNegative{}, SolveStatus::breakdown, 0.0}};
  for (const auto& [set, status, expected] : cases) {
    double p = 0.0;
    const double b = status == SolveStatus::solved ? 3.0 : -3.0;
    EXPECT_EQ(make_contact_solver("pgs")
                  ->solve(problem_of(Matrix::Constant(1, 1, -2.0), vec({b}), {set}), &p)
                  .status,
              status);
    EXPECT_EQ(p, expected);
  }
  // Rows of zeros, along which nothing moves: friction in the plane written in space.
  Vec Q = Vec::Zero(3);
  const Matrix flat = vec({0.5, 1.75, 0.0}).asDiagonal();
  EXPECT_EQ(make_contact_solver("psor")
                ->solve(problem_of(flat, vec({-1.0, 1.4, 0.0}), {Coulomb{0.3, 3}}), Q.data())
                .status,
            SolveStatus::solved);
  EXPECT_NEAR(Q[1], -0.6, 1e-11);
  EXPECT_EQ(Q[2], 0.0);
}

TEST(Psor, WhatDivergesEndsAndKeepsTheBest) {
  // Rows that drive each other: each sweep multiplies P by four.
  const Matrix G = (Matrix(2, 2) << 1.0, -2.0, -2.0, 1.0).finished();
  Vec P = Vec::Zero(2);
  const SolveReport report = make_contact_solver("pgs")->solve(
      problem_of(G, vec({-1.0, -1.0}), {NonNegative{}, NonNegative{}}), P.data());
  EXPECT_EQ(report.status, SolveStatus::breakdown);
  EXPECT_LE(report.certificate.residual, 1.0);  // that of the start
}

TEST(Psor, SparseRowsGiveTheSameBits) {
  std::mt19937 random(3);
  for (int k = 0; k < 200; ++k) {
    const ContactProblem problem = random_problem(random, {.space = 0.5});
    Vec P = Vec::Zero(problem.rows()), Q = P;
    make_contact_solver("psor")->solve(problem, P.data());
    make_contact_solver("psor")->solve(with_sparse_rows(problem), Q.data());
    ASSERT_EQ(P, Q) << k;
  }
}

TEST(Psor, RelaxationIsBetweenZeroAndTwo) {
  for (const double relaxation : {0.0, 2.0, -1.0, std::nan("")})
    EXPECT_NE(refusal([&] { Psor{relaxation}; }).find("in (0, 2)"), std::string::npos) << relaxation;
}

}  // namespace
}  // namespace saltus::test
