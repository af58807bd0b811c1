// What is refused, what is reported as unsolved, and the table of solvers.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "saltus/numerics/solvers/registry.hpp"
#include "support/complementarity.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

const double nan = std::numeric_limits<double>::quiet_NaN();
const double inf = std::numeric_limits<double>::infinity();

TEST(Solvers, WithoutASolutionNoneSaysSolved) {
  // G <= 0 cannot stop the approach: xi = -1 - P < 0, or xi = -1 for every P. The least residual is that of
  // P = -1/2, which pulls as much as it approaches.
  for (const SolverEntry& entry : contact_solvers()) {
    for (double g : {-1.0, 0.0}) {
      for (const ContactSet& set :
           {ContactSet(NonNegative{}), ContactSet(Coulomb{0.5, 2}), ContactSet(Coulomb{0.5, 3})}) {
        const int rows = rows_of(set);
        Vec b = Vec::Zero(rows);
        b[0] = -1.0;
        Matrix G = Matrix::Zero(rows, rows);
        G(0, 0) = g;
        const ContactProblem problem = problem_of(G, b, {set});
        const auto solver = entry.make();
        if (!solver->accepts(problem)) continue;
        solver->reserve(rows);
        std::vector<double> P(rows, 0.0);
        const SolveReport report = solver->solve(problem, P.data());
        EXPECT_NE(report.status, SolveStatus::solved) << entry.name << ", G = " << g;
        EXPECT_GE(report.certificate.residual, g < 0.0 ? 0.49 : 0.99) << entry.name << ", G = " << g;
      }
    }
  }
}

TEST(Solvers, ContradictingEqualitiesAreNotSolved) {
  const ContactProblem problem =
      problem_of(Matrix::Constant(2, 2, 1.0), (Vec(2) << 1.0, -1.0).finished(), {Equality{}, Equality{}});
  for (const SolverEntry& entry : contact_solvers()) {
    const auto solver = entry.make();
    solver->reserve(2);
    std::vector<double> P(2, 0.0);
    EXPECT_NE(solver->solve(problem, P.data()).status, SolveStatus::solved) << entry.name;
  }
}

TEST(Solvers, AFailureOfTheDefaultKeepsTheBestOfItsAttempts) {
  // The first contact can be solved, the second cannot: its residual 1 is the least there is.
  const Matrix G = (Matrix(2, 2) << 1.0, 0.0, 0.0, 0.0).finished();
  const ContactProblem problem =
      problem_of(G, (Vec(2) << -5.0, -1.0).finished(), {NonNegative{}, NonNegative{}});
  const auto solver = make_contact_solver("auto");
  solver->reserve(2);
  std::vector<double> P(2, 0.0);
  const SolveReport report = solver->solve(problem, P.data());
  EXPECT_NE(report.status, SolveStatus::solved);
  EXPECT_DOUBLE_EQ(report.certificate.residual, 1.0);
  EXPECT_DOUBLE_EQ(P[0], 5.0);
}

TEST(Solvers, AFailureOfTheDefaultKeepsNothingThatHasOverflowed) {
  // Sweeps double the impulses of the first two contacts against each other, the third cannot be solved.
  Matrix G = Matrix::Identity(3, 3);
  G(0, 1) = G(1, 0) = -2.0;
  G(2, 2) = -1.0;
  const ContactProblem problem =
      problem_of(G, (Vec(3) << -1.0, -1.0, -1.0).finished(), {NonNegative{}, NonNegative{}, NonNegative{}});
  const auto solver = make_contact_solver("auto");
  std::vector<double> P(3, 0.0);
  const SolveReport report = solver->solve(problem, P.data());
  EXPECT_NE(report.status, SolveStatus::solved);
  EXPECT_TRUE(report.certificate.finite());
  for (double p : P) EXPECT_LT(std::abs(p), 1e6);
}

TEST(Solvers, TheReportedCertificateIsThatOfTheAnswer) {
  std::mt19937 random(11);
  for (const SolverEntry& entry : contact_solvers()) {
    const auto solver = entry.make();
    solver->reserve(20);
    for (int k = 0; k < 100; ++k) {
      const ContactProblem problem =
          random_problem(random, {.dependent = k % 3, .moved = 0.05, .space = k % 2 * 0.5});
      if (!solver->accepts(problem)) continue;
      std::vector<double> P(problem.rows(), 0.0), xi(P);
      const SolveReport report = solver->solve(problem, P.data());
      EXPECT_EQ(report.certificate.residual, certify(problem, P.data(), xi.data()).residual) << entry.name;
      EXPECT_EQ(report.status == SolveStatus::solved, report.certificate.within(default_tolerance))
          << entry.name;
    }
  }
}

TEST(Solvers, ThoseThatListModesTakeNoFrictionInSpace) {
  const ContactProblem space = problem_of(Matrix::Identity(3, 3), Vec::Zero(3), {Coulomb{0.5, 3}});
  for (const SolverEntry& entry : contact_solvers())
    EXPECT_EQ(entry.make()->accepts(space),
              entry.name != "enumeration" && entry.name != "lemke" && entry.name != "fischer-burmeister")
        << entry.name;
}

TEST(Solvers, EnumerationKnowsItsLimit) {
  // 2^16 combinations: 16 contacts without friction, 8 with, any number of equalities.
  const auto many = [](int n, ContactSet set) {
    const int rows = n * rows_of(set);
    return problem_of(Matrix::Identity(rows, rows), Vec::Zero(rows), std::vector<ContactSet>(n, set));
  };
  const auto enumeration = make_contact_solver("enumeration");
  EXPECT_TRUE(enumeration->accepts(many(16, NonNegative{})));
  EXPECT_FALSE(enumeration->accepts(many(17, NonNegative{})));
  EXPECT_TRUE(enumeration->accepts(many(8, Coulomb{0.1, 2})));
  EXPECT_FALSE(enumeration->accepts(many(9, Coulomb{0.1, 2})));
  EXPECT_TRUE(enumeration->accepts(many(40, Equality{})));
  EXPECT_FALSE(enumeration->accepts(many(400, NonNegative{})));  // the count itself must not overflow
}

TEST(Solvers, SubsetsAreThoseOfTenContactsAtMost) {
  const auto many = [](int n, ContactSet set) {
    const int rows = n * rows_of(set);
    return problem_of(Matrix::Identity(rows, rows), Vec::Zero(rows), std::vector<ContactSet>(n, set));
  };
  const auto subsets = make_contact_solver("subset-newton");
  EXPECT_TRUE(subsets->accepts(many(10, Coulomb{0.1, 3})));
  EXPECT_FALSE(subsets->accepts(many(11, NonNegative{})));
  EXPECT_TRUE(subsets->accepts(many(40, Equality{})));
}

TEST(Solvers, NamesAndClones) {
  std::set<std::string> names;
  for (const SolverEntry& entry : contact_solvers()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_EQ(make_contact_solver(entry.name)->name(), entry.name);
    EXPECT_EQ(entry.make()->clone()->name(), entry.name);
    EXPECT_FALSE(entry.summary.empty());
  }
  EXPECT_EQ(to_string(SolveStatus::solved), "solved");
  EXPECT_EQ(to_string(SolveStatus::iteration_limit), "iteration-limit");
  EXPECT_EQ(to_string(SolveStatus::breakdown), "breakdown");
}

TEST(Solvers, AnUnknownNameIsRefusedWithThoseThatExist) {
  const std::string message = refusal([] { make_contact_solver("newton"); });
  EXPECT_NE(message.find("'newton'"), std::string::npos) << message;
  for (const SolverEntry& entry : contact_solvers())
    EXPECT_NE(message.find(entry.name), std::string::npos) << message;
}

TEST(Solvers, SaySolvedExactlyWhereTheCertificateDoes) {
  // One row that cannot be solved is small beside the terms of the others: at P = 0, where friction overflows
  // in the tableau, and at a start where equalities balance large impulses.
  Matrix balance = Matrix::Zero(3, 3);
  balance.bottomRightCorner(2, 2) << 1.0, -1.0, -1.0, 1.0;
  const struct {
    ContactProblem problem;
    std::vector<double> start;
  } cases[] = {{problem_of(1e150 * Matrix::Identity(3, 3), Eigen::Vector3d(1e20, -1.0, 0.0),
                           {NonNegative{}, Coulomb{1e200, 2}}),
                {0.0, 0.0, 0.0}},
               {problem_of(balance, Eigen::Vector3d(-1.0, 0.0, 0.0), {NonNegative{}, Equality{}, Equality{}}),
                {0.0, 1e20, 1e20}}};
  for (const auto& [problem, start] : cases) {
    for (const SolverEntry& entry : contact_solvers()) {
      const auto solver = entry.make();
      if (!solver->accepts(problem)) continue;
      solver->reserve(3);
      std::vector<double> P = start, xi(3);
      const bool solved = solver->solve(problem, P.data()).status == SolveStatus::solved;
      EXPECT_EQ(solved, certify(problem, P.data(), xi.data()).within(problem.tolerance)) << entry.name;
    }
  }
}

TEST(Solvers, WhereEverythingOverflowsTheAnswerDependsOnTheProblemAlone) {
  const ContactProblem problem = problem_of(Matrix::Constant(2, 2, -1e250), (Vec(2) << -1.0, -2.0).finished(),
                                            {NonNegative{}, NonNegative{}});
  const ContactProblem other =
      problem_of(Matrix::Identity(2, 2), (Vec(2) << -3.0, -5.0).finished(), {NonNegative{}, NonNegative{}});
  for (const SolverEntry& entry : contact_solvers()) {
    std::vector<double> first(2, 1e200), again(2, 1e200), between(2, 7.0);
    const auto solver = entry.make();
    solver->reserve(2);
    solver->solve(problem, first.data());
    solver->solve(other, between.data());
    solver->solve(problem, again.data());
    EXPECT_EQ(first, again) << entry.name;
  }
}

TEST(ContactProblem, ValidateNamesWhatIsWrong) {
  const ContactProblem good =
      problem_of(Matrix::Identity(3, 3), Vec::Zero(3), {NonNegative{}, Coulomb{0.5, 2}});
  EXPECT_NO_THROW(validate(good));
  auto refused = [&](auto change) {
    ContactProblem bad = good;
    change(bad);
    return refusal([&] { validate(bad); });
  };
  auto says = [](const std::string& message, std::initializer_list<const char*> words) {
    for (const char* word : words)
      EXPECT_NE(message.find(word), std::string::npos) << word << ": " << message;
  };
  says(refused([](auto& p) { p.G = Matrix(Matrix::Identity(2, 2)); }), {"G must be (3, 3)", "got (2, 2)"});
  says(refused([](auto& p) { p.G = Matrix(Matrix::Zero(3, 2)); }), {"G must be (3, 3)", "got (3, 2)"});
  says(refused([](auto& p) { p.sets.push_back(Equality{}); }), {"sets take 4", "b has 3"});
  says(refused([](auto& p) { p.sets[1] = Coulomb{0.5, 4}; }), {"dim", "2 or 3", "got 4"});
  says(refused([](auto& p) { p.sets[1] = Coulomb{-0.5, 2}; }), {"mu", ">= 0", "got -0.5"});
  says(refused([](auto& p) { p.sets[1] = Coulomb{nan, 2}; }), {"mu", "finite"});
  says(refused([](auto& p) { p.sets[1] = Coulomb{inf, 2}; }), {"mu", "finite"});
  says(refused([](auto& p) { p.G(2, 1) = nan; }), {"G must be finite"});
  says(refused([](auto& p) { p.G(0, 0) = inf; }), {"G must be finite"});
  says(refused([](auto& p) { p.b[2] = nan; }), {"b must be finite"});
}

}  // namespace
}  // namespace saltus::test
