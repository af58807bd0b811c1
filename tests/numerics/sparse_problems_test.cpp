// Problems whose G is stored by sparse rows: the same problems, and parts that know nothing of each other.
#include <gtest/gtest.h>

#include "saltus/numerics/problems.hpp"
#include "saltus/numerics/solvers/components.hpp"
#include "saltus/numerics/solvers/proximal_newton.hpp"
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

struct Family {
  const char* name;
  ProblemKind kind;
  double share;  // that must be solved
};
void PrintTo(const Family& family, std::ostream* out) { *out << family.name; }
class ProximalPoints : public testing::TestWithParam<Family> {};

TEST_P(ProximalPoints, SolveAndNeverBoast) {
  int solved = 0;
  const auto problems = some(1000, GetParam().kind);
  for (const ContactProblem& problem : problems) {
    ProximalNewton solver;
    std::vector<double> P(problem.rows(), 0.0), xi(problem.rows());
    const SolveReport report = solver.solve(with_sparse_rows(problem), P.data());
    const bool exact = violation(problem, P) <= 1e-11 * terms(problem, P);
    if (report.status == SolveStatus::solved) {
      ASSERT_TRUE(exact);
    }
    solved += report.status == SolveStatus::solved;
  }
  EXPECT_GE(solved, GetParam().share * static_cast<double>(problems.size()));
}

INSTANTIATE_TEST_SUITE_P(Families, ProximalPoints,
                         testing::Values(Family{"regular", {}, 0.99},
                                         Family{"dependent", {.dependent = 2}, 0.99},
                                         Family{"frictionless", {.dependent = 1, .friction = false}, 0.99},
                                         Family{"in_space", {.space = 1.0}, 0.95}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace saltus::test
