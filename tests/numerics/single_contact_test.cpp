// One contact alone: every branch of the laws against numbers worked out by hand, for every solver.
#include <gtest/gtest.h>

#include "saltus/numerics/solvers/registry.hpp"
#include "support/complementarity.hpp"

namespace saltus::test {
namespace {

struct Case {
  const char* what;
  ContactProblem problem;
  std::vector<double> P;
};

Case coulomb(const char* what, double mu, std::array<double, 2> b, std::vector<double> P) {
  // m_eff of a sphere's contact point: 1/m in the normal, 7/(2m) in the tangential direction, m = 2 kg
  const Matrix G = (Matrix(2, 2) << 0.5, 0.0, 0.0, 1.75).finished();
  return {what, problem_of(G, (Vec(2) << b[0], b[1]).finished(), {Coulomb{mu, 2}}), std::move(P)};
}

// The same sphere in space, its friction along (3, 4)/5 of what it is in the plane
Case in_space(const char* what, double mu, std::array<double, 2> b, std::vector<double> P) {
  const Matrix G = Vec((Vec(3) << 0.5, 1.75, 1.75).finished()).asDiagonal();
  return {what,
          problem_of(G, (Vec(3) << b[0], 0.6 * b[1], 0.8 * b[1]).finished(), {Coulomb{mu, 3}}),
          {P[0], 0.6 * P[1], 0.8 * P[1]}};
}

Case one_row(const char* what, ContactSet set, double g, double b, double P) {
  return {what, problem_of(Matrix::Constant(1, 1, g), Vec::Constant(1, b), {set}), {P}};
}

std::vector<Case> cases_in_space() {
  return {
      in_space("space: open", 0.3, {1.0, 5.0}, {0.0, 0.0}),
      in_space("space: sticks", 0.3, {-1.0, 0.7}, {2.0, -0.4}),
      in_space("space: slips forward", 0.3, {-1.0, 1.4}, {2.0, -0.6}),
      in_space("space: slips backward", 0.3, {-1.0, -1.4}, {2.0, 0.6}),
      in_space("space: no friction", 0.0, {-1.0, 1.4}, {2.0, 0.0}),
      in_space("space: on the cone's edge", 0.3, {-1.0, 1.05}, {2.0, -0.6}),
  };
}

std::vector<Case> cases_in_plane() {
  return {
      one_row("equality, pulls", Equality{}, 2.0, 3.0, -1.5),
      one_row("equality, pushes", Equality{}, 2.0, -3.0, 1.5),
      one_row("separates", NonNegative{}, 2.0, 3.0, 0.0),
      one_row("approaches", NonNegative{}, 2.0, -3.0, 1.5),
      one_row("touches", NonNegative{}, 2.0, 0.0, 0.0),
      coulomb("open: slides without a force", 0.3, {1.0, 5.0}, {0.0, 0.0}),
      coulomb("sticks", 0.3, {-1.0, 0.7}, {2.0, -0.4}),
      coulomb("sticks, other direction", 0.3, {-1.0, -0.7}, {2.0, 0.4}),
      coulomb("slips forward", 0.3, {-1.0, 1.4}, {2.0, -0.6}),
      coulomb("slips backward", 0.3, {-1.0, -1.4}, {2.0, 0.6}),
      coulomb("no friction", 0.0, {-1.0, 1.4}, {2.0, 0.0}),
      coulomb("on the cone's edge", 0.3, {-1.0, 1.05}, {2.0, -0.6}),
  };
}

std::vector<Case> cases() {
  std::vector<Case> all = cases_in_plane();
  for (Case& c : cases_in_space()) all.push_back(std::move(c));
  return all;
}

// Normal and tangential direction coupled, as where a rod meets the ground at an angle:
// G = [2 1; 1 3], b = (-1, 2), mu = 0.1. Slip: P_N (2 - 0.1) = 1, xi_T = 2 + (1 - 0.3)/1.9 > 0.
Case coupled_slip() {
  const Matrix G = (Matrix(2, 2) << 2.0, 1.0, 1.0, 3.0).finished();
  return {"coupled slip",
          problem_of(G, (Vec(2) << -1.0, 2.0).finished(), {Coulomb{0.1, 2}}),
          {1 / 1.9, -0.1 / 1.9}};
}

// Those that come near a solution step by step stop at their tolerance, the others at rounding.
double accuracy(const std::string& solver) {
  const bool stepwise = solver == "prox-fixed-point" || solver == "proximal-newton" ||
                        solver == "interior-point" || solver == "psor";
  return stepwise ? 1e-11 : 1e-13;
}

TEST(SingleContact, EverySolverFindsTheClosedForm) {
  std::vector<Case> all = cases();
  all.push_back(coupled_slip());
  for (const SolverEntry& entry : contact_solvers()) {
    for (const Case& c : all) {
      const auto solver = entry.make();
      if (!solver->accepts(c.problem)) continue;
      solver->reserve(c.problem.rows());
      std::vector<double> P(c.P.size(), 0.0);
      const SolveReport report = solver->solve(c.problem, P.data());
      EXPECT_EQ(report.status, SolveStatus::solved) << entry.name << ", " << c.what;
      for (std::size_t i = 0; i < P.size(); ++i)
        EXPECT_NEAR(P[i], c.P[i], accuracy(entry.name)) << entry.name << ", " << c.what;
    }
  }
}

TEST(SingleContact, AWarmStartDoesNotChangeTheAnswer) {
  for (const SolverEntry& entry : contact_solvers()) {
    for (const Case& c : cases()) {
      const auto solver = entry.make();
      if (!solver->accepts(c.problem)) continue;
      solver->reserve(c.problem.rows());
      std::vector<double> P(c.P.size(), 7.0);
      EXPECT_EQ(solver->solve(c.problem, P.data()).status, SolveStatus::solved)
          << entry.name << ", " << c.what;
      for (std::size_t i = 0; i < P.size(); ++i)
        EXPECT_NEAR(P[i], c.P[i], accuracy(entry.name)) << entry.name << ", " << c.what;
    }
  }
}

TEST(SingleContact, EveryPlaneCaseIsAccepted) {
  // Else the loops above would check nothing. The function of Fischer and Burmeister knows no friction.
  for (const SolverEntry& entry : contact_solvers())
    for (const Case& c : cases_in_plane())
      EXPECT_EQ(entry.make()->accepts(c.problem),
                entry.name != "fischer-burmeister" || rows_of(c.problem.sets[0]) == 1)
          << entry.name << ", " << c.what;
}

}  // namespace
}  // namespace saltus::test
