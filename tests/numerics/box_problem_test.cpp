// Laws of a box: against closed forms, against the laws written out, and in other units.
#include "saltus/numerics/box_problem.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "saltus/numerics/solvers/registry.hpp"

namespace saltus::test {
namespace {

constexpr double none = BoxLaws::unbounded;

Vec solve(const BoxLaws& laws, const Matrix& M, const Vec& q, const char* method = "auto") {
  const auto solver = make_contact_solver(method);
  BoxProblem problem;
  problem.prepare(laws, *solver);
  problem.set_matrix(M);
  Vec z = Vec::Zero(q.size());
  const SolveReport report = problem.solve(q, z);
  EXPECT_EQ(report.status, SolveStatus::solved) << method;
  EXPECT_LE(problem.residual(q, z, M * z + q), 1e-12) << method;
  return z;
}

// How far (z, w) is from the laws, written out as signs; z next to a bound is at it.
double violation(const BoxLaws& laws, const Vec& z, const Vec& w) {
  double worst = 0.0;
  for (int i = 0; i < laws.rows(); ++i) {
    worst = std::max({worst, laws.lower[i] - z[i], z[i] - laws.upper[i]});
    if (z[i] > laws.lower[i] + 1e-13) worst = std::max(worst, w[i]);
    if (z[i] < laws.upper[i] - 1e-13) worst = std::max(worst, -w[i]);
  }
  return worst;
}

struct Sample {
  BoxLaws laws;
  Matrix M;
  Vec q;
};

Sample random_sample(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const int n = 1 + static_cast<int>(random() % 6);
  Sample sample{{Vec(n), Vec(n)}, Matrix(n, n), Vec(n)};
  for (int i = 0; i < n; ++i) {
    const double l = uniform(random), width = 1.0 + uniform(random);
    const unsigned kind = random() % 4;
    sample.laws.lower[i] = kind == 0 || kind == 1 ? -none : l;
    sample.laws.upper[i] = kind == 0 || kind == 2 ? none : l + width;
    sample.q[i] = 3.0 * uniform(random);
    for (int j = 0; j < n; ++j) sample.M(i, j) = uniform(random);
    sample.M(i, i) += n;  // strictly diagonally dominant: one solution
  }
  return sample;
}

TEST(BoxProblem, OneRowIsAClampedDivision) {
  Matrix M(1, 1);
  M << 4.0;
  for (const auto& [l, u] : {std::pair{-1.0, 2.0}, {0.0, none}, {-none, 0.5}, {-none, none}, {0.25, 0.25}})
    for (double b : {-20.0, -3.0, 0.0, 1.0, 20.0}) {
      Vec q(1);
      q << b;
      const BoxLaws laws{Vec::Constant(1, l), Vec::Constant(1, u)};
      EXPECT_NEAR(solve(laws, M, q)[0], std::clamp(-b / 4.0, l, u), 1e-15) << l << " " << u << " " << b;
    }
}

TEST(BoxProblem, BoundsAreHitToTheBit) {
  Matrix M(1, 1);
  M << 0.3;
  Vec q(1);
  q << 7.0;
  const BoxLaws laws{Vec::Constant(1, -0.1), Vec::Constant(1, 0.7)};
  EXPECT_EQ(solve(laws, M, q)[0], -0.1);
  EXPECT_EQ(solve(laws, M, -q)[0], 0.7);
}

TEST(BoxProblem, RandomOnesObeyTheLaws) {
  std::mt19937 random(11);
  for (int k = 0; k < 300; ++k) {
    const Sample sample = random_sample(random);
    const Vec z = solve(sample.laws, sample.M, sample.q);
    EXPECT_LT(violation(sample.laws, z, sample.M * z + sample.q), 1e-12) << k;
  }
}

TEST(BoxProblem, MethodsAgreeWhereThereIsOneSolution) {
  std::mt19937 random(12);
  for (int k = 0; k < 50; ++k) {
    const Sample sample = random_sample(random);
    const Vec z = solve(sample.laws, sample.M, sample.q);
    EXPECT_LT((solve(sample.laws, sample.M, sample.q, "lemke") - z).norm(), 1e-11) << k;
  }
}

TEST(BoxProblem, UnitsDoNotMatter) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> exponent(-8.0, 8.0);
  for (int k = 0; k < 100; ++k) {
    Sample sample = random_sample(random);
    const Vec z = solve(sample.laws, sample.M, sample.q);
    for (int i = 0; i < z.size(); ++i) {  // w in one unit, z in another
      const double row = std::pow(10.0, exponent(random)), column = std::pow(10.0, exponent(random));
      sample.M.row(i) *= row;
      sample.q[i] *= row;
      sample.M.col(i) *= column;
      sample.laws.lower[i] /= column;
      sample.laws.upper[i] /= column;
      const Vec scaled = solve(sample.laws, sample.M, sample.q);
      EXPECT_NEAR(scaled[i] * column, z[i], 1e-11) << k << " " << i;
    }
  }
}

TEST(BoxProblem, TheResidualSeesAWrongAnswer) {
  const auto solver = make_contact_solver("auto");
  BoxProblem problem;
  problem.prepare({Vec::Constant(1, -1.0), Vec::Constant(1, 1.0)}, *solver);
  problem.set_matrix(Matrix::Constant(1, 1, 1.0));
  const auto residual = [&](double z, double w) {
    return problem.residual(Vec::Constant(1, 0.5), Vec::Constant(1, z), Vec::Constant(1, w));
  };
  EXPECT_EQ(residual(-0.5, 0.0), 0.0);
  EXPECT_EQ(residual(-1.0, 0.75), 0.0);
  EXPECT_EQ(residual(1.0, -0.75), 0.0);
  EXPECT_NEAR(residual(-0.25, 0.25), 0.25 / 3.0, 1e-15);  // of |q| + 2 (|z| + |lower|)
  EXPECT_NEAR(residual(1.25, -1.0), 0.25 / 5.0, 1e-15);
  EXPECT_TRUE(std::isnan(residual(NAN, 0.0)));
  EXPECT_TRUE(std::isnan(residual(0.0, NAN)));
}

// The second row is of the size of 1e-3, beside one of 1e9: both are solved to their own digits.
TEST(BoxProblem, ALargeRowDoesNotHideASmallOne) {
  Matrix M(2, 2);
  M << 1e-6, 0.0, 0.0, 1e-3;
  Vec q(2);
  q << 1e9, 0.5e-3;
  const auto solver = make_contact_solver("auto");
  BoxProblem problem;
  problem.prepare({Vec::Constant(2, -1.0), Vec::Constant(2, 1.0)}, *solver);
  problem.set_matrix(M);
  Vec z(2);
  z << -1.0, -0.5 + 1e-9;  // nearly solved
  EXPECT_EQ(problem.solve(q, z).status, SolveStatus::solved);
  EXPECT_EQ(z[0], -1.0);
  EXPECT_NEAR(z[1], -0.5, 1e-15);
}

TEST(BoxProblem, BadBoundsAreRefused) {
  const auto refused = [](double l, double u) {
    validate({Vec::Constant(1, l), Vec::Constant(1, u)}, "laws");
  };
  EXPECT_THROW(refused(1.0, 0.0), std::invalid_argument);
  EXPECT_THROW(refused(NAN, 0.0), std::invalid_argument);
  EXPECT_THROW(refused(none, none), std::invalid_argument);
  EXPECT_THROW(refused(-none, -none), std::invalid_argument);
  EXPECT_THROW(validate({Vec::Zero(1), Vec::Zero(2)}, "laws"), std::invalid_argument);
}

}  // namespace
}  // namespace saltus::test
