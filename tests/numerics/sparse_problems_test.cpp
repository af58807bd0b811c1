// Problems whose G is stored by sparse rows: the same problems, and parts that know nothing of each other.
#include <gtest/gtest.h>

#include "saltus/numerics/problems.hpp"
#include "saltus/numerics/solvers/components.hpp"
#include "saltus/numerics/solvers/nsgs.hpp"
#include "saltus/numerics/solvers/registry.hpp"
#include "support/complementarity.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

std::vector<ContactProblem> some(int count, const ProblemKind& kind) {
  std::mt19937 random(20261122);
  std::vector<ContactProblem> problems;
  for (int k = 0; k < count; ++k) problems.push_back(random_problem(random, kind));
  return problems;
}

TEST(SparseProblems, AreTheSameProblems) {
  for (const ContactProblem& dense : some(200, {.dependent = 1, .moved = 1e-2, .space = 0.3})) {
    const ContactProblem sparse = with_sparse_rows(dense);
    const int rows = dense.rows();
    ASSERT_NO_THROW(validate(sparse));
    EXPECT_EQ(saltus::dense(sparse).G.view(), dense.G.view());
    const Vec P = Vec::LinSpaced(rows, -1.0, 2.0);
    Vec xi(rows), xi_of_sparse(rows);
    const Certificate expected = certify(dense, P.data(), xi.data());
    const Certificate certificate = certify(sparse, P.data(), xi_of_sparse.data());
    EXPECT_EQ(certificate.residual, expected.residual);
    EXPECT_EQ(certificate.scale, expected.scale);
    EXPECT_EQ(xi, xi_of_sparse);
    EXPECT_EQ(problem_residual(sparse, P.data()), problem_residual(dense, P.data()));
  }
}

TEST(SparseProblems, AreRefusedWhereTheirRowsAreWrong) {
  const ContactProblem good = column_of_balls(3, 1.0);
  auto refused = [&](auto spoil, const std::vector<std::string>& words) {
    ContactProblem bad = good;
    spoil(bad.sparse);
    expect_refusal([&] { validate(bad); }, words);
  };
  refused([](SparseRows& G) { G.end_row(); }, {"G must be (3, 3)", "got 4 sparse rows"});
  refused([](SparseRows& G) { G.column[1] = 3; }, {"sparse row 0 must ascend within 0...2", "got 3 after 0"});
  refused([](SparseRows& G) { G.column[0] = -1; }, {"sparse row 0", "got -1 after -1"});
  refused([](SparseRows& G) { std::swap(G.column[2], G.column[3]); }, {"sparse row 1", "got 0 after 1"});
  refused([](SparseRows& G) { G.value[4] = NAN; }, {"G must be finite"});
}

TEST(SparseProblems, FallApartIntoComponents) {
  const auto problems = some(30, {.space = 0.3});
  const ContactProblem whole = with_sparse_rows(side_by_side(problems));
  Components components;
  // A problem may itself have parts: each contact belongs to one, and nothing couples two of them.
  const int count = components.find(whole);
  ASSERT_GE(count, 30);
  const Vec numbers = Vec::LinSpaced(whole.rows(), 1.0, whole.rows());
  Vec again = Vec::Zero(whole.rows());
  int rows = 0, contacts = 0;
  for (int k = 0; k < count; ++k) {
    Vec part_numbers(components.rows(k));
    components.gather(k, numbers.data(), part_numbers.data());
    components.scatter(k, part_numbers.data(), again.data());
    const ContactProblem sparse = components.part(whole, k, true);
    const ContactProblem dense = components.part(whole, k, false);
    ASSERT_NO_THROW(validate(sparse));
    EXPECT_EQ(saltus::dense(sparse).G.view(), dense.G.view());
    for (int i = 0; i < dense.rows(); ++i) {
      const int row = static_cast<int>(part_numbers[i]) - 1;
      EXPECT_EQ(dense.b[i], whole.b[row]);
      double sum = 0.0, sum_of_whole = 0.0;  // nothing is lost
      for_row(dense, i, [&](int, double entry) { sum += std::abs(entry); });
      for_row(whole, row, [&](int, double entry) { sum_of_whole += std::abs(entry); });
      EXPECT_DOUBLE_EQ(sum, sum_of_whole);
    }
    rows += dense.rows();
    contacts += dense.contacts();
  }
  EXPECT_EQ(rows, whole.rows());
  EXPECT_EQ(contacts, whole.contacts());
  EXPECT_EQ(again, numbers);
}

TEST(SparseProblems, TheDefaultSolvesManyAtOnce) {
  const ContactProblem dense = side_by_side(some(60, {.dependent = 1}));
  const ContactProblem sparse = with_sparse_rows(dense);
  std::vector<double> P(dense.rows(), 0.0);
  const auto solver = make_contact_solver("auto");
  const SolveReport report = solver->solve(sparse, P.data());
  EXPECT_EQ(report.status, SolveStatus::solved);
  EXPECT_LE(violation(dense, P), 1e-11 * terms(dense, P));
}

TEST(SparseProblems, AColumnIsExact) {
  const int n = 3000;
  const double weight = 9.81e-3;
  const ContactProblem problem = column_of_balls(n, weight);
  for (const char* name : {"auto", "proximal-newton"}) {
    std::vector<double> P(n, 0.0);
    const SolveReport report = make_contact_solver(name)->solve(problem, P.data());
    EXPECT_EQ(report.status, SolveStatus::solved) << name;
    EXPECT_LE(report.iterations, 3) << name;  // nothing is in doubt
    for (int i = 0; i < n; ++i) EXPECT_NEAR(P[i] / (weight * (n - i)), 1.0, 1e-9) << name << " " << i;
  }
}

// Forces grow with the square of the length: large terms alone are no sign that there is no solution.
TEST(SparseProblems, ALongColumnThatLands) {
  const int n = 12000;
  ContactProblem problem = column_of_balls(n, 0.0);
  problem.b.view().setConstant(-1.0);
  std::vector<double> P(n, 0.0);
  EXPECT_EQ(make_contact_solver("auto")->solve(problem, P.data()).status, SolveStatus::solved);
  EXPECT_NEAR(P[0] / (0.5 * n * (n + 1.0)), 1.0, 1e-7);  // P_i = sum of k = 1...n-i over what lies above
}

// Discs in rows of n, n - 1, ..., 1, of mass and inertia one and radius R on a plane, that slide and fall:
// impulses are not unique. With μ = 0.2 velocities are, with 0.3 methods find different ones.
ContactProblem pyramid(int n, double mu) {
  const double R = 1.0, speed = 0.05;
  std::vector<Eigen::Vector2d> centres;
  for (int row = 0; row < n; ++row)
    for (int k = 0; k < n - row; ++k) centres.emplace_back(2 * R * k + R * row, R + row * std::sqrt(3.0) * R);
  const int discs = static_cast<int>(centres.size());
  std::vector<Vec> W;
  auto touch = [&](int i, int j, const Eigen::Vector2d& normal) {
    const Eigen::Vector2d tangent(normal.y(), -normal.x());
    for (const Eigen::Vector2d& e : {normal, tangent}) {
      W.push_back(Vec::Zero(3 * discs));
      W.back().segment<3>(3 * i) << e, (e == tangent ? R : 0.0);
      if (j >= 0) W.back().segment<3>(3 * j) << -e, (e == tangent ? R : 0.0);
    }
  };
  for (int i = 0; i < discs; ++i) {
    if (i < n) touch(i, -1, {0.0, 1.0});
    for (int j = i + 1; j < discs; ++j)
      if ((centres[i] - centres[j]).norm() < 2.01 * R) touch(i, j, (centres[i] - centres[j]) / (2.0 * R));
  }
  const int rows = static_cast<int>(W.size());
  Matrix transposed(rows, 3 * discs);
  for (int i = 0; i < rows; ++i) transposed.row(i) = W[i];
  Vec v = Vec::Zero(3 * discs);
  for (int i = 0; i < discs; ++i) v.segment<2>(3 * i) << speed, -0.01;
  return problem_of(transposed * transposed.transpose(), transposed * v,
                    std::vector<ContactSet>(rows / 2, Coulomb{mu, 2}));
}

// Two methods that share nothing but the law: Gauss-Seidel sweeps and the paths through the interior.
TEST(SparseProblems, VelocitiesOfAPyramidAreThoseOfAnotherMethod) {
  const ContactProblem problem = pyramid(8, 0.2);
  std::vector<double> P(problem.rows(), 0.0), of_sweeps = P;
  EXPECT_EQ(make_contact_solver("interior-point")->solve(with_sparse_rows(problem), P.data()).status,
            SolveStatus::solved);
  EXPECT_LE(violation(problem, P), 1e-11 * terms(problem, P));
  EXPECT_EQ(Nsgs(200000).solve(with_sparse_rows(problem), of_sweeps.data()).status, SolveStatus::solved);
  const auto u = relative_velocities(problem, P), expected = relative_velocities(problem, of_sweeps);
  for (int i = 0; i < problem.rows(); ++i) EXPECT_NEAR(u[i], expected[i], 1e-9) << i;
}

// Too many contacts for all but the interior-point method: 20 to 30 iterations, whatever depends on what.
TEST(SparseProblems, ALargePyramidTakesFewIterations) {
  ContactProblem problem = pyramid(20, 0.3);
  problem.tolerance = 1e-8;
  for (const char* name : {"interior-point", "auto"}) {
    std::vector<double> P(problem.rows(), 0.0);
    const SolveReport report = make_contact_solver(name)->solve(with_sparse_rows(problem), P.data());
    EXPECT_EQ(report.status, SolveStatus::solved);
    EXPECT_EQ(report.solver, "interior-point");
    EXPECT_LE(report.iterations, 60);
    EXPECT_LE(violation(problem, P), 1e-7 * terms(problem, P));
  }
}

struct Family {
  const char* name;
  ProblemKind kind;
  double share;  // that must be solved
};
void PrintTo(const Family& family, std::ostream* out) { *out << family.name; }
class SparseEquations : public testing::TestWithParam<Family> {};

TEST_P(SparseEquations, SolveAndNeverBoast) {
  const auto problems = some(1000, GetParam().kind);
  for (const char* name : {"proximal-newton", "interior-point"}) {
    const auto solver = make_contact_solver(name);
    int solved = 0;
    for (const ContactProblem& problem : problems) {
      std::vector<double> P(problem.rows(), 0.0);
      const SolveReport report = solver->solve(with_sparse_rows(problem), P.data());
      if (report.status == SolveStatus::solved) {
        ASSERT_LE(violation(problem, P), 1e-11 * terms(problem, P)) << name;
      }
      solved += report.status == SolveStatus::solved;
    }
    EXPECT_GE(solved, GetParam().share * static_cast<double>(problems.size())) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Families, SparseEquations,
                         testing::Values(Family{"regular", {}, 0.99},
                                         Family{"dependent", {.dependent = 2}, 0.99},
                                         Family{"frictionless", {.dependent = 1, .friction = false}, 0.99},
                                         Family{"in_space", {.space = 1.0}, 0.95}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace saltus::test
