// The two factorisations against Eigen's own.
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <limits>
#include <random>

#include "saltus/numerics/linear/dense_solve.hpp"
#include "saltus/numerics/linear/sparse_solve.hpp"
#include "saltus/numerics/linear/spd_factor.hpp"

namespace saltus::test {
namespace {

Matrix random_matrix(std::mt19937& random, int rows, int cols) {
  std::normal_distribution<double> normal;
  return Matrix::NullaryExpr(rows, cols, [&] { return normal(random); });
}

InMatrix view(const Matrix& M) { return {M.data(), M.rows(), M.cols()}; }

Vec solve_with(DenseSolve& solve, const Matrix& A, const Vec& y) {
  const int n = static_cast<int>(y.size());
  solve.resize(n);
  solve.A().view() = A;
  solve.y().view() = y;
  return In(solve.solve(), n);
}

TEST(SpdFactor, SolvesEverySize) {
  // Sizes 2, 3, 4, 6 are compiled on their own, 1 and diagonals are divisions.
  std::mt19937 random(1);
  for (int n = 1; n <= 9; ++n) {
    const Matrix A = random_matrix(random, n, n);
    const Matrix M = A * A.transpose() + Matrix::Identity(n, n);
    const Vec x = random_matrix(random, n, 1);
    for (bool constant : {false, true}) {
      SpdFactor factor;
      factor.reserve(n);
      ASSERT_TRUE(constant ? factor.factorise_constant(view(M)) : factor.factorise(view(M)));
      Vec y = M * x;
      factor.solve(y.data());
      EXPECT_LT((y - x).norm(), 1e-12 * x.norm()) << "n = " << n;
    }
  }
}

TEST(SpdFactor, ADiagonalIsDividedBy) {
  const Matrix M = (Vec(3) << 2.0, 4.0, 8.0).finished().asDiagonal();
  SpdFactor factor;
  ASSERT_TRUE(factor.factorise_constant(view(M)));
  Vec x = Vec::Ones(3);
  factor.solve(x.data());
  EXPECT_EQ(x, (Vec(3) << 0.5, 0.25, 0.125).finished());  // exact: powers of two
}

TEST(SpdFactor, CanBeUsedAgainForAnotherSize) {
  SpdFactor factor;
  const Matrix large = 3.0 * Matrix::Identity(5, 5);
  ASSERT_TRUE(factor.factorise_constant(view(large)));
  const Matrix small = (Matrix(2, 2) << 2.0, 1.0, 1.0, 2.0).finished();
  ASSERT_TRUE(factor.factorise(view(small)));
  Vec x = (Vec(2) << 3.0, 3.0).finished();
  factor.solve(x.data());
  EXPECT_NEAR(x[0], 1.0, 1e-15);
  EXPECT_NEAR(x[1], 1.0, 1e-15);
}

TEST(SpdFactor, RefusesWhatIsNotPositiveDefinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (int n : {1, 2, 3, 4, 5, 6}) {
    for (double bad : {-1.0, 0.0, nan, inf}) {
      Matrix M = Matrix::Identity(n, n);
      M(n - 1, n - 1) = bad;
      SpdFactor factor;
      EXPECT_FALSE(factor.factorise(view(M))) << n << ", " << bad;
      EXPECT_FALSE(factor.factorise_constant(view(M))) << n << ", " << bad;
    }
  }
  const Matrix indefinite = (Matrix(2, 2) << 1.0, 2.0, 2.0, 1.0).finished();
  EXPECT_FALSE(SpdFactor().factorise(view(indefinite)));
}

TEST(DenseSolve, SolvesRegularSystems) {
  std::mt19937 random(2);
  DenseSolve solve;
  for (int n = 1; n <= 30; ++n) {
    const Matrix A = random_matrix(random, n, n);
    const Vec y = random_matrix(random, n, 1);
    const Vec expected = A.fullPivHouseholderQr().solve(y);
    EXPECT_LT((solve_with(solve, A, y) - expected).norm(), 1e-10 * expected.norm()) << "n = " << n;
  }
}

TEST(DenseSolve, PivotsWhereTheDiagonalIsZero) {
  DenseSolve solve;
  const Matrix A = (Matrix(2, 2) << 0.0, 2.0, 4.0, 0.0).finished();
  const Vec x = solve_with(solve, A, (Vec(2) << 6.0, 8.0).finished());
  EXPECT_EQ(x, (Vec(2) << 2.0, 3.0).finished());
}

TEST(DenseSolve, PivotsAreRelativeToTheirColumn) {
  // Impulses of a light and a heavy body differ by 10^14 without the system being singular.
  DenseSolve solve;
  const Matrix A = (Matrix(2, 2) << 1e-14, 0.0, 0.0, 1.0).finished();
  const Vec x = solve_with(solve, A, (Vec(2) << 1e-14, 1.0).finished());
  EXPECT_NEAR(x[0], 1.0, 1e-15);
  EXPECT_NEAR(x[1], 1.0, 1e-15);
}

TEST(DenseSolve, SingularSystemsGiveThePseudoInverse) {
  // Consistent or not: least squares of minimum norm. 30 is beyond what fits on the stack.
  std::mt19937 random(3);
  DenseSolve solve;
  for (int n : {2, 3, 4, 6, 10, 24, 25, 30}) {
    for (int rank = 1; rank < n; rank += 1 + n / 4) {
      const Matrix A = random_matrix(random, n, rank) * random_matrix(random, rank, n);
      const Vec y = random_matrix(random, n, 1);
      Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> reference;
      reference.setThreshold(1e-10);
      reference.compute(A);
      ASSERT_EQ(reference.rank(), rank);
      const Vec expected = reference.pseudoInverse() * y;
      EXPECT_LT((solve_with(solve, A, y) - expected).norm(), 1e-8 * expected.norm())
          << n << ", rank " << rank;
    }
  }
}

TEST(DenseSolve, ALoadSharedByEqualContactsIsSharedEqually) {
  DenseSolve solve;
  const Vec x = solve_with(solve, Matrix::Constant(2, 2, 1.0), Vec::Constant(2, 3.0));
  EXPECT_NEAR(x[0], 1.5, 1e-14);
  EXPECT_NEAR(x[1], 1.5, 1e-14);
  EXPECT_EQ(solve_with(solve, Matrix::Zero(2, 2), Vec::Constant(2, 3.0)).norm(), 0.0);
}

TEST(SparseSolve, NoEquationsHaveASolution) {
  SparseSolve linear;  // whose vectors have no storage yet
  EXPECT_NE(linear.solve(), nullptr);
  EXPECT_NE(linear.solve_again(), nullptr);
}

TEST(SparseSolve, SingularEquationsHaveNone) {
  SparseSolve linear;
  for (const double corner : {1.0, 2.0}) {  // the same structure, singular and not
    linear.A().clear();
    for (const double last : {1.0, corner}) {
      linear.A().add(0, 1.0);
      linear.A().add(1, last);
      linear.A().end_row();
    }
    linear.y() = {3.0, 4.0};
    const double* x = linear.solve();
    ASSERT_EQ(x != nullptr, corner == 2.0);
    if (!x) continue;
    EXPECT_DOUBLE_EQ(x[0], 2.0);
    EXPECT_DOUBLE_EQ(x[1], 1.0);
  }
}

}  // namespace
}  // namespace saltus::test
