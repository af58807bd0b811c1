// Lemke's method: problems with known solutions, degenerate ones, and those without a solution.
#include "saltus/numerics/solvers/lemke.hpp"

#include <gtest/gtest.h>

#include <random>

namespace saltus {
namespace {

struct Answer {
  LcpOutcome outcome;
  Vec z;
  int pivots;
};

Answer lcp(const Matrix& M, const Vec& q) {
  LemkeLcp method;
  const int n = static_cast<int>(q.size());
  method.resize(n);
  method.M().view() = M;
  method.q().view() = q;
  Answer answer{LcpOutcome::solved, Vec::Zero(n), 0};
  answer.outcome = method.solve(answer.z.data());
  answer.pivots = method.pivots();
  return answer;
}

// Natural map min(z, M z + q), relative to the terms in it
double residual(const Matrix& M, const Vec& q, const Vec& z) {
  const Vec w = M * z + q;
  const double scale = q.cwiseAbs().maxCoeff() + M.cwiseAbs().maxCoeff() * z.cwiseAbs().maxCoeff();
  return w.cwiseMin(z).cwiseAbs().maxCoeff() / scale;
}

// 1 on the diagonal, 2 below (lower) or above it: Murty's and Fathi's families are made of it
Matrix triangle(int n, double off) {
  Matrix M = Matrix::Identity(n, n);
  M.triangularView<Eigen::StrictlyLower>().setConstant(off);
  return M;
}

TEST(LemkeLcp, WithoutAnythingToDoTheSolutionIsZero) {
  const Answer answer = lcp(Matrix::Identity(3, 3), Vec::Constant(3, 2.0));
  EXPECT_EQ(answer.outcome, LcpOutcome::solved);
  EXPECT_EQ(answer.pivots, 0);
  EXPECT_TRUE(answer.z.isZero(0.0));
}

TEST(LemkeLcp, FindsASolutionOfASegment) {
  Matrix M(2, 2);
  M << 1, 1, 1, 1;
  const Answer answer = lcp(M, Vec::Constant(2, -1.0));
  EXPECT_EQ(answer.outcome, LcpOutcome::solved);
  EXPECT_NEAR(answer.z.sum(), 1.0, 1e-15);
  EXPECT_GE(answer.z.minCoeff(), 0.0);
}

// The P-matrix of Murty's exponential example has the solution e_1 for q = -e
TEST(LemkeLcp, MurtysTriangle) {
  for (int n : {2, 6, 10}) {  // the path has 2^n pivots
    const Matrix M = triangle(n, 2.0);
    const Answer answer = lcp(M, Vec::Constant(n, -1.0));
    ASSERT_EQ(answer.outcome, LcpOutcome::solved) << n;
    EXPECT_LE((answer.z - Vec::Unit(n, 0)).cwiseAbs().maxCoeff(), 1e-14) << n;
  }
}

TEST(LemkeLcp, FathisMatrixIsBadlyConditionedAndPositiveDefinite) {
  for (int n : {4, 12, 30}) {
    const Matrix T = triangle(n, 2.0);
    const Matrix M = T * T.transpose();
    const Vec q = Vec::Constant(n, -1.0);
    const Answer answer = lcp(M, q);
    ASSERT_EQ(answer.outcome, LcpOutcome::solved) << n;
    EXPECT_LE(residual(M, q, answer.z), 1e-14) << n;
  }
}

// Ties in every ratio test: without the lexicographic rule such problems may cycle
TEST(LemkeLcp, DegenerateProblemsEnd) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> entry(-2, 2);
  for (int trial = 0; trial < 500; ++trial) {
    const int n = 2 + trial % 7;
    const Matrix W = Matrix::NullaryExpr(n / 2 + 1, n, [&] { return double(entry(random)); });
    const Vec v = Vec::NullaryExpr(n / 2 + 1, [&] { return double(entry(random)); });
    const Matrix M = W.transpose() * W;  // semidefinite, q in its range: solvable
    const Vec q = W.transpose() * v;
    const Answer answer = lcp(M, q);
    ASSERT_EQ(answer.outcome, LcpOutcome::solved) << trial;
    if (q.isZero(0.0)) continue;
    EXPECT_LE(residual(M, q, answer.z), 1e-12) << trial;
  }
}

// Entries and solutions over 28 powers of ten: the path is the same after scaling
TEST(LemkeLcp, UnitsDoNotMatter) {
  std::mt19937 random(6);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponent(-4.0, 4.0);
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 2 + trial % 9;
    const Matrix W = Matrix::NullaryExpr(n, n, [&] { return normal(random); });
    const Vec unit = Vec::NullaryExpr(n, [&] { return std::pow(10.0, exponent(random)); });
    const double all = std::pow(10.0, 3.0 * exponent(random));
    const Matrix M = all * unit.asDiagonal() * (W.transpose() * W) * unit.asDiagonal();
    const Vec q = unit.cwiseProduct(Vec::NullaryExpr(n, [&] { return normal(random); }));
    const Answer answer = lcp(M, q);
    ASSERT_EQ(answer.outcome, LcpOutcome::solved) << trial;
    EXPECT_LE(residual(M, q, answer.z), 1e-14) << trial;
  }
}

TEST(LemkeLcp, LargeProblemsKeepTheirAccuracy) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const int n = 200;  // several times the interval of refactorisation
  const Matrix W = Matrix::NullaryExpr(n, n, [&] { return normal(random); });
  const Matrix M = W.transpose() * W + 0.01 * Matrix::Identity(n, n);
  const Vec q = Vec::NullaryExpr(n, [&] { return normal(random); });
  const Answer answer = lcp(M, q);
  ASSERT_EQ(answer.outcome, LcpOutcome::solved);
  EXPECT_GT(answer.pivots, 50);
  EXPECT_LE(residual(M, q, answer.z), 1e-13);
}

TEST(LemkeLcp, WithoutASolutionThePathEndsInARay) {
  const Answer answer = lcp(-Matrix::Identity(2, 2), Vec::Constant(2, -1.0));
  EXPECT_EQ(answer.outcome, LcpOutcome::ray);
}

// Semidefinite but for rounding: what is a pivot and what is not decides whether the path has an end
TEST(Lemke, NearlySingularProblemsAreSolved) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal;
  Lemke method;
  for (int trial = 0; trial < 2000; ++trial) {
    const int n = 2 + trial % 11;
    const Matrix W = Matrix::NullaryExpr(n / 2, n, [&] { return normal(random); });
    const double shift = std::pow(10.0, -6.0 - 10.0 * unit(random));
    const Matrix M = W.transpose() * W + shift * Matrix::Identity(n, n);
    Vec q(n), z(n);
    for (int i = 0; i < n; ++i) {
      const bool closed = unit(random) < 0.5;
      z[i] = closed ? unit(random) : 0.0;
      q[i] = closed ? 0.0 : unit(random);
    }
    q -= M * z;
    ContactProblem problem{M, q, std::vector<ContactSet>(n, NonNegative{})};
    ASSERT_EQ(method.solve(problem, z.data()).status, SolveStatus::solved) << trial;
  }
}

TEST(Lemke, ARayIsReportedAsOne) {
  ContactProblem problem{Matrix(Matrix::Zero(1, 1)), Vec(Vec::Constant(1, -1.0)), {NonNegative{}}};
  double P = 0.0;
  const SolveReport report = Lemke().solve(problem, &P);
  EXPECT_EQ(report.status, SolveStatus::ray);
  EXPECT_EQ(to_string(report.status), "ray");
}

// The block form of plane friction, worked out by hand: G = 2 I, so P_N = 1 in all three
TEST(Lemke, PlaneFrictionSticksAndSlidesBothWays) {
  const struct {
    double b, P;
  } cases[] = {{0.5, -0.25}, {4.0, -0.5}, {-4.0, 0.5}};
  for (const auto& [b, expected] : cases) {
    ContactProblem problem{Matrix(2.0 * Matrix::Identity(2, 2)), Vec(Vec::Zero(2)), {Coulomb{0.5, 2}}};
    problem.b[0] = -2.0;
    problem.b[1] = b;
    double P[2] = {0.0, 0.0};
    EXPECT_EQ(Lemke().solve(problem, P).status, SolveStatus::solved);
    EXPECT_NEAR(P[0], 1.0, 1e-15);
    EXPECT_NEAR(P[1], expected, 1e-15);
  }
}

TEST(Lemke, EqualitiesBesidesContacts) {
  Matrix G(3, 3);
  G << 2, 1, 0, 1, 2, 1, 0, 1, 2;
  Vec b(3);
  b << -1, -2, 1;
  ContactProblem problem{G, b, {Equality{}, NonNegative{}, Equality{}}};
  Vec P = Vec::Zero(3);
  ASSERT_EQ(Lemke().solve(problem, P.data()).status, SolveStatus::solved);
  EXPECT_LE((G * P + b).cwiseAbs().maxCoeff(), 1e-15);  // the contact is closed: all rows are equations
  EXPECT_GT(P[1], 0.0);
}

}  // namespace
}  // namespace saltus
