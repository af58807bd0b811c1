// Products with sparse matrices, and their factors by structure, against dense ones.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>
#include <random>

#include "saltus/numerics/linear/largest_eigenvector.hpp"
#include "saltus/numerics/linear/sparse_factor.hpp"
#include "support/bar.hpp"

namespace saltus::test {
namespace {

using Method = SparseFactor::Method;

Vec random_vector(int n) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  return Vec::NullaryExpr(n, [&] { return normal(random); });
}

// Diagonally dominant with the given diagonals and their mirror images, the lower ones times `skew`.
SparseEntries banded(int n, const std::vector<int>& offsets, double skew = 1.0) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 5.0 + 0.1 * (i % 7));
    for (const int offset : offsets) {
      if (i + offset >= n) continue;
      const double value = -1.0 + 0.05 * (i % 5);
      entries.emplace_back(i, i + offset, value);
      entries.emplace_back(i + offset, i, skew * value);
    }
  }
  SparseEntries A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

SparseEntries laplacian(int side) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < side * side; ++i) {
    entries.emplace_back(i, i, 4.0);
    for (const int next : {i % side + 1 < side ? i + 1 : -1, i + side < side * side ? i + side : -1}) {
      if (next < 0) continue;
      entries.emplace_back(i, next, -1.0);
      entries.emplace_back(next, i, -1.0);
    }
  }
  SparseEntries A(side * side, side * side);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

void expect_products(const SparseEntries& entries, bool by_diagonals) {
  const SparseMatrix A(entries);
  EXPECT_EQ(A.by_diagonals(), by_diagonals);
  const int n = static_cast<int>(entries.rows());
  const Vec x = random_vector(n), start = Vec::LinSpaced(n, 1.0, 2.0), expected = start - 3.0 * (entries * x);
  Vec y = start;
  A.add_product(-3.0, x.data(), y.data());
  EXPECT_LT((y - expected).norm(), 1e-13 * expected.norm()) << n;
  EXPECT_NEAR(A.form(x.data()), x.dot(entries * x), 1e-12 * n);
}

// Solves with the factor, by which method.
void expect_solution(SparseFactor& factor, const SparseEntries& A, Method method) {
  ASSERT_TRUE(factor.factorise(A));
  EXPECT_EQ(factor.method(), method) << A.rows();
  const Vec x = random_vector(static_cast<int>(A.rows()));
  Vec y = A * x;
  factor.solve(y.data());
  EXPECT_LT((y - x).norm(), 1e-12 * x.norm()) << A.rows();
}

TEST(SparseMatrix, MultipliesByDiagonalsAndByRows) {
  for (int n : {1, 2, 5, 511, 512, 513, 1300}) {  // rows are taken in parts of 512
    expect_products(banded(n, {1}), true);
    expect_products(banded(n, {1, 2}, 0.3), true);
    expect_products(banded(n, {}), true);
  }
  SparseEntries scattered = banded(1300, {1});
  for (int k = 0; k < 60; ++k) scattered.coeffRef(1299 - k * 17, k * 11) = 2.0;
  scattered.makeCompressed();
  expect_products(scattered, false);
}

TEST(SparseMatrix, DropsZeros) {
  SparseEntries A = banded(10, {1});
  A.coeffRef(0, 9) = 0.0;
  EXPECT_EQ(SparseMatrix(A).entries().nonZeros(), 28);
}

TEST(SparseFactor, IsChosenByStructure) {
  for (int n : {2, 3, 4, 5, 6, 7, 1000, 1001}) {  // eliminated from both ends to the middle
    SparseFactor factor;
    expect_solution(factor, banded(n, {1}), Method::tridiagonal);
  }
  for (int n : {1, 3, 1000}) {
    SparseFactor diagonal, pentadiagonal, with_a_hole;
    expect_solution(diagonal, banded(n, {}), Method::band);
    if (n < 3) continue;
    expect_solution(pentadiagonal, banded(n, {1, 2}), Method::band);
    if (n > 3) expect_solution(with_a_hole, banded(n, {1, 4}), Method::band);
  }
  SparseFactor mesh, ring, unsymmetric, indefinite;
  expect_solution(mesh, laplacian(30), Method::cholesky);
  expect_solution(ring, banded(500, {1, 499}), Method::cholesky);
  expect_solution(unsymmetric, banded(1000, {1}, 0.5), Method::lu);
  SparseEntries A = banded(100, {1});
  A.coeffRef(50, 50) = -5.0;
  expect_solution(indefinite, A, Method::lu);
}

TEST(SparseFactor, CanBeUsedAgain) {
  SparseFactor factor;
  for (const double scale : {1.0, 3.0}) expect_solution(factor, scale * laplacian(30), Method::cholesky);
  expect_solution(factor, banded(40, {1}), Method::tridiagonal);
  expect_solution(factor, banded(40, {1}, 0.1), Method::lu);
  expect_solution(factor, banded(50, {1}, 0.1), Method::lu);
  expect_solution(factor, banded(40, {1}), Method::tridiagonal);
}

TEST(SparseFactor, RefusesWhatItCannotFactorise) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const SparseEntries& good : {banded(50, {}), banded(50, {1}), banded(50, {1, 2}), laplacian(20)}) {
    for (const int place : {0, 20, 25, 49}) {
      for (const double bad : {-1.0, nan, inf, 1e-320}) {
        SparseEntries A = good;
        A.coeffRef(place, place) = bad;
        EXPECT_FALSE(SparseFactor().factorise_positive(A)) << place << ", " << bad;
        EXPECT_EQ(SparseFactor().factorise(A), std::isfinite(bad));
      }
    }
  }
  SparseEntries singular = banded(20, {1}, 0.5);
  for (int j = 0; j < 20; ++j)
    if (singular.coeff(7, j) != 0.0) singular.coeffRef(7, j) = 0.0;
  EXPECT_FALSE(SparseFactor().factorise(singular));
}

TEST(SparseFactor, GivesTheSmallestPivot) {
  SparseFactor factor;
  ASSERT_TRUE(factor.factorise_positive(banded(1, {})));
  EXPECT_EQ(factor.smallest_pivot(), 5.0);
  for (const SparseEntries& A : {banded(50, {1}), banded(50, {1, 2}), laplacian(20)}) {
    ASSERT_TRUE(factor.factorise_positive(A));
    const double lowest = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Eigen::MatrixXd(A)).eigenvalues()[0];
    EXPECT_GE(factor.smallest_pivot(), lowest * (1.0 - 1e-12));  // of any order of elimination
    EXPECT_LE(factor.smallest_pivot(), Vec(A.diagonal()).minCoeff());
  }
}

TEST(LargestEigenvector, OfSparseMatricesIsThatOfDenseOnes) {
  for (int n : {1, 2, 3, 8, 40}) {
    const Bar bar{std::max(n - 1, 1)};
    const SparseEntries K = bar.stiffness(), M = bar.mass();
    const Vec mode = largest_eigenvector(K, M), dense = largest_eigenvector(Matrix(K), Matrix(M));
    EXPECT_NEAR(mode.dot(M * mode), 1.0, 1e-12);
    EXPECT_NEAR(std::abs(mode.dot(M * dense)), 1.0, 1e-6) << n;
    EXPECT_NEAR(mode.dot(K * mode) / dense.dot(K * dense), 1.0, 1e-9) << n;
  }
}

TEST(LargestEigenvector, OfALongBarComesNearFromBelow) {
  const Bar bar{1000};
  const SparseEntries K = bar.stiffness(), M = bar.mass();
  const Vec mode = largest_eigenvector(K, M);
  const double exact = bar.omega() * bar.omega(), found = mode.dot(K * mode) / mode.dot(M * mode);
  EXPECT_LE(found, exact * (1.0 + 1e-12));
  EXPECT_GE(found, exact * (1.0 - 1e-3));
}

}  // namespace
}  // namespace saltus::test
