// One contact in space: the closed form against a search over the angle of slip that knows only the law.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

#include "saltus/numerics/solvers/one_contact.hpp"
#include "saltus/numerics/solvers/registry.hpp"
#include "support/complementarity.hpp"

namespace saltus::test {
namespace {

ContactProblem spatial(const Matrix& G, const Vec& b, double mu) {
  return problem_of(G, b, {Coulomb{mu, 3}});
}

std::optional<std::vector<double>> closed_form(const ContactProblem& problem) {
  std::vector<double> P(3, 7.0);
  if (!solve_one_contact(problem.sets[0], problem.G.row(0), 3, problem.b.data(), P.data())) return {};
  return P;
}

// P of slip in the direction of the angle, and how far the velocity is off the line of friction.
struct Trial {
  std::vector<double> P;
  double across, along;
};

std::optional<Trial> slip_at(const ContactProblem& problem, double angle) {
  const double mu = std::get<Coulomb>(problem.sets[0]).mu, c = std::cos(angle), s = std::sin(angle);
  const double effective = problem.G(0, 0) + mu * (c * problem.G(0, 1) + s * problem.G(0, 2));
  if (effective <= 0.0) return {};
  const double normal = -problem.b[0] / effective;
  Trial trial{{normal, mu * normal * c, mu * normal * s}, 0.0, 0.0};
  const std::vector<double> xi = relative_velocities(problem, trial.P);
  trial.across = c * xi[2] - s * xi[1];
  trial.along = c * xi[1] + s * xi[2];
  return trial;
}

// The slip with the least normal impulse, by a scan and bisection; no polynomial.
std::optional<std::vector<double>> searched_slip(const ContactProblem& problem) {
  const int grid = 4000;
  std::optional<std::vector<double>> best;
  for (int k = 0; k < grid; ++k) {
    double low = 2.0 * M_PI * k / grid, high = 2.0 * M_PI * (k + 1) / grid;
    auto left = slip_at(problem, low), right = slip_at(problem, high);
    if (!left || !right || (left->across < 0.0) == (right->across < 0.0)) continue;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      const auto trial = slip_at(problem, middle);
      ((trial->across < 0.0) == (left->across < 0.0) ? low : high) = middle;
    }
    const auto root = slip_at(problem, low);
    if (root->along <= 0.0 && (!best || root->P[0] < (*best)[0])) best = root->P;
  }
  return best;
}

// Stick first, then slip, as the closed form documents it
std::optional<std::vector<double>> searched(const ContactProblem& problem) {
  const double mu = std::get<Coulomb>(problem.sets[0]).mu;
  if (problem.b[0] >= 0.0) return std::vector<double>(3, 0.0);
  const Vec stick = -problem.G.view().inverse() * problem.b.view();
  if (stick[0] >= 0.0 && stick.tail(2).norm() <= mu * stick[0])
    return std::vector<double>(stick.data(), stick.data() + 3);
  return searched_slip(problem);
}

void expect_the_same_as_searched(const ContactProblem& problem, int k) {
  const auto P = closed_form(problem), expected = searched(problem);
  if (P) {
    EXPECT_LE(violation(problem, *P), 1e-11 * terms(problem, *P)) << k;
  }
  ASSERT_EQ(P.has_value(), expected.has_value()) << k << "\n" << problem.G.view() << "\n" << problem.b.view();
  if (!P) return;
  const double size = std::abs((*expected)[0]);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR((*P)[i], (*expected)[i], 1e-7 * size) << k;
}

TEST(ContactInSpace, TheClosedFormIsWhatASearchFinds) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> mu(0.0, 1.5);
  for (int k = 0; k < 1500; ++k) {
    const Matrix A = Matrix::NullaryExpr(3, 4, [&] { return normal(random); });
    const Matrix N = Matrix::NullaryExpr(3, 3, [&] { return normal(random); });
    const Matrix G = A * A.transpose() + (k % 3 == 0 ? 0.0 : k % 3 == 1 ? 0.05 : 1.0) * N;
    const Vec b = Vec::NullaryExpr(3, [&] { return normal(random); });
    expect_the_same_as_searched(spatial(G, b, mu(random)), k);
  }
}

TEST(ContactInSpace, PositiveDefiniteBlocksAlwaysHaveASolution) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> mu(0.0, 3.0), decade(-3.0, 3.0);
  for (int k = 0; k < 20000; ++k) {
    const Matrix A = Matrix::NullaryExpr(3, 3, [&] { return normal(random); });
    const Matrix scale =
        Vec(Vec::NullaryExpr(3, [&] { return std::pow(10.0, decade(random)); })).asDiagonal();
    const Vec b = Vec::NullaryExpr(3, [&] { return normal(random); });
    const ContactProblem problem = spatial(A * scale * A.transpose(), b, mu(random));
    const auto P = closed_form(problem);
    ASSERT_TRUE(P) << k << "\n" << problem.G.view() << "\n" << b;
    EXPECT_LE(violation(problem, *P), 1e-11 * terms(problem, *P)) << k;
  }
}

TEST(ContactInSpace, BlocksOfAnyRank) {
  // G = W Wᵀ, b = W v with one or two freedoms: there is a solution, but the block has no inverse.
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> mu(0.0, 1.5);
  for (int k = 0; k < 10000; ++k) {
    const int rank = 1 + k % 2;
    const Matrix W = Matrix::NullaryExpr(3, rank, [&] { return normal(random); });
    const Vec v = Vec::NullaryExpr(rank, [&] { return normal(random); });
    const ContactProblem problem = spatial(W * W.transpose(), W * v, mu(random));
    const auto P = closed_form(problem);
    ASSERT_TRUE(P) << k << "\n" << problem.G.view() << "\n" << problem.b.view();
    EXPECT_LE(violation(problem, *P), 1e-11 * terms(problem, *P)) << k;
  }
}

TEST(ContactInSpace, WhatCannotMoveSidewaysTakesNoFriction) {
  Matrix G = Matrix::Zero(3, 3);
  G(0, 0) = 2.0;
  const auto P = closed_form(spatial(G, (Vec(3) << -1.0, 0.0, 0.0).finished(), 0.5));
  ASSERT_TRUE(P);
  EXPECT_NEAR((*P)[0], 0.5, 1e-15);
  EXPECT_EQ((*P)[1], 0.0);
  EXPECT_EQ((*P)[2], 0.0);
}

TEST(ContactInSpace, OneFreedomAskingForFrictionTakesTheLeastImpulse) {
  // xi = w (w·P - 1) with w = (1, 3, 4): 3 P_1 + 4 P_2 + P_N = 1 and |P_T| = mu P_N along (3, 4)/5.
  const Vec w = (Vec(3) << 1.0, 3.0, 4.0).finished();
  const auto P = closed_form(spatial(w * w.transpose(), -w, 0.2));
  ASSERT_TRUE(P);
  const std::vector<double> expected = {0.5, 0.06, 0.08};  // P_N (1 + 5 mu) = 1
  for (int i = 0; i < 3; ++i) EXPECT_NEAR((*P)[i], expected[i], 1e-14);
}

TEST(ContactInSpace, WithoutASolutionPIsUntouched) {
  const auto problem = spatial(-Matrix::Identity(3, 3), (Vec(3) << -1.0, 0.5, 0.0).finished(), 0.3);
  EXPECT_FALSE(closed_form(problem));
  std::vector<double> P = {7.0, 8.0, 9.0};
  solve_one_contact(problem.sets[0], problem.G.row(0), 3, problem.b.data(), P.data());
  EXPECT_EQ(P, (std::vector<double>{7.0, 8.0, 9.0}));
}

TEST(ContactInSpace, TheTangentFrameDoesNotMatter) {
  std::mt19937 random(4);
  for (const SolverEntry& entry : contact_solvers()) {
    const auto solver = entry.make();
    solver->reserve(20);
    int compared = 0;
    for (int k = 0; k < 300; ++k) {
      // Little friction: then the solution is the only one.
      const ContactProblem problem =
          random_problem(random, {.moved = 1e-3, .space = 1.0, .largest_mu = 0.1, .equalities = false});
      if (!solver->accepts(problem)) continue;
      const Matrix R = tangents_turned_by(0.7, problem);
      const ContactProblem turned =
          problem_of(R * problem.G.view() * R.transpose(), R * problem.b.view(), problem.sets);
      Vec P = Vec::Zero(problem.rows()), Q = P;
      if (solver->solve(problem, P.data()).status != SolveStatus::solved) continue;
      if (solver->solve(turned, Q.data()).status != SolveStatus::solved) continue;
      const Vec difference = problem.G.view() * (P - R.transpose() * Q);
      EXPECT_LE(difference.cwiseAbs().maxCoeff(), 1e-9 * terms(problem, {P.data(), P.data() + P.size()}))
          << entry.name << " " << k;
      ++compared;
    }
    const bool in_space = solver->accepts(spatial(Matrix::Identity(3, 3), Vec::Zero(3), 0.1));
    EXPECT_GE(compared, in_space ? 285 : 0) << entry.name;
  }
}

TEST(ContactInSpace, PlaneMotionIsThatOfThePlaneLaw) {
  // The second tangent neither moves nor couples: G = diag(G₂, g), b = (b₂, 0).
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> mu(0.0, 0.5);
  for (int k = 0; k < 2000; ++k) {
    const Matrix A = Matrix::NullaryExpr(2, 2, [&] { return normal(random); });
    const Matrix G = A * A.transpose() + 0.5 * Matrix::Identity(2, 2);
    const Vec b = Vec::NullaryExpr(2, [&] { return normal(random); });
    Matrix G3 = Matrix::Zero(3, 3);
    G3.topLeftCorner(2, 2) = G;
    G3(2, 2) = 1.7;
    const ContactProblem space = spatial(G3, (Vec(3) << b, 0.0).finished(), mu(random));
    const auto P = closed_form(space);
    double plane[2];
    const double friction = std::get<Coulomb>(space.sets[0]).mu;
    const PoolMatrix G2(G);
    ASSERT_TRUE(solve_one_contact(Coulomb{friction, 2}, G2.row(0), 2, b.data(), plane));
    ASSERT_TRUE(P);
    for (int i = 0; i < 2; ++i) EXPECT_NEAR((*P)[i], plane[i], 1e-13 * (1.0 + plane[0])) << k;
    EXPECT_NEAR((*P)[2], 0.0, 1e-13 * (1.0 + plane[0])) << k;
  }
}

}  // namespace
}  // namespace saltus::test
