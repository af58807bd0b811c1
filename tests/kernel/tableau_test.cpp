// The engine of the half-explicit schemes with tableaux that are not in the registry, and what it refuses.
#include <gtest/gtest.h>

#include <limits>

#include "saltus/kernel/integrators/half_explicit/half_explicit.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

// Appendix B: the constraint is taken at the stage's own position, Ac = Av = Aq.
Tableau appendix_b(const char* name, const Matrix& A, const Vec& c) { return {name, A, A, A, c}; }

Tableau heun() {
  return appendix_b("Heun", (Matrix(2, 2) << 1.0, 0.0, 0.5, 0.5).finished(), vec({0.0, 1.0}));
}

Tableau kutta() {
  return appendix_b("Kutta, order 3",
                    (Matrix(3, 3) << 0.5, 0.0, 0.0, -1.0, 2.0, 0.0, 1.0 / 6, 2.0 / 3, 1.0 / 6).finished(),
                    vec({0.0, 0.5, 1.0}));
}

Tableau classic() {
  return appendix_b("Runge-Kutta, order 4",
                    (Matrix(4, 4) << 0.5, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0 / 6,
                     1.0 / 3, 1.0 / 3, 1.0 / 6)
                        .finished(),
                    vec({0.0, 0.5, 0.5, 1.0}));
}

Tableau euler() { return appendix_b("Euler", Matrix::Ones(1, 1), vec({0.0})); }

void expect_orders(const Tableau& tableau, int free, int bilateral, const std::vector<double>& dt) {
  const HalfExplicit scheme("under test", tableau, HalfExplicitSettings{});
  const double until = 0.5;
  const Orders flight =
      measure_orders(make_double_pendulum(), scheme, exact_double_pendulum(until), until, dt);
  EXPECT_GE(flight.q, free - 0.2) << tableau.name;
  EXPECT_GE(flight.v, free - 0.2) << tableau.name;
  EXPECT_LE(std::min(flight.q, flight.v), free + 0.5) << tableau.name;
  const Orders rod = measure_orders(make_pendulum(), scheme, exact_pendulum(until), until, dt);
  EXPECT_GE(rod.q, bilateral - 0.2) << tableau.name;
  EXPECT_GE(rod.v, bilateral - 0.2) << tableau.name;
  EXPECT_LE(std::min(rod.q, rod.v), bilateral + 0.5) << tableau.name;
}

TEST(Tableau, EulerHasOrderOne) { expect_orders(euler(), 1, 1, {1e-3, 5e-4, 2.5e-4}); }
TEST(Tableau, HeunHasOrderTwo) { expect_orders(heun(), 2, 2, {2e-3, 1e-3, 5e-4}); }
TEST(Tableau, KuttaHasOrderThree) { expect_orders(kutta(), 3, 3, {5e-3, 2.5e-3, 1.25e-3}); }
TEST(Tableau, ClassicRungeKuttaHasOrderFourAndThreeUnderConstraints) {
  expect_orders(classic(), 4, 3, {1e-2, 5e-3, 2.5e-3});
}

TEST(Tableau, SlidingWithFrictionKeepsTheOrder) {
  for (const auto& [tableau, order] : {std::pair(heun(), 2), std::pair(kutta(), 3)}) {
    const HalfExplicit scheme("under test", tableau, HalfExplicitSettings{});
    const Orders orders =
        measure_orders(make_bowl(0.3), scheme, exact_bowl(0.3, 0.25), 0.25, {6.25e-4, 3.125e-4, 1.5625e-4});
    EXPECT_GE(orders.q, order - 0.2) << tableau.name;
    EXPECT_GE(orders.v, order - 0.2) << tableau.name;
  }
}

TEST(Tableau, EveryStageCarriesTheWeightAtRest) {
  for (const Tableau& tableau : {euler(), heun(), kutta(), classic()}) {
    const HalfExplicit scheme("under test", tableau, HalfExplicitSettings{});
    for (const Row& row : rows_of_run(make_ball(-1e-4, 0.0, 0.5), scheme, 1e-3, 0.05)) {
      if (row.state.t == 0.0) continue;
      EXPECT_NEAR(row.reactions.lambda_plus[0], 2.0 * gravity, 1e-9) << tableau.name;
      EXPECT_NEAR(row.reactions.lambda_minus[0], 2.0 * gravity, 1e-9) << tableau.name;
      EXPECT_EQ(row.reactions.impulse[0], 0.0);
      EXPECT_NEAR(row.state.v[0], 0.0, 1e-15);
    }
  }
}

TEST(Tableau, TheImpactLawHoldsForEveryTableau) {
  for (const Tableau& tableau : {euler(), heun(), kutta(), classic()}) {
    const HalfExplicit scheme("under test", tableau, HalfExplicitSettings{});
    const State end = run_to(make_two_balls(1.0, 1.0, 2.0, -1.0, 0.5), scheme, 1e-3, 0.1);
    EXPECT_NEAR(end.v[1] - end.v[0], 1.5, 1e-13) << tableau.name;
  }
}

TEST(Tableau, RefusesWhatCannotWork) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NO_THROW(validate(trapezoidal_tableau()));
  auto refused = [](auto change, const std::vector<std::string>& words) {
    Tableau t = heun();
    change(t);
    expect_refusal([&] { validate(t); }, words);
    expect_refusal([&] { HalfExplicit("under test", t, HalfExplicitSettings{}); }, words);
  };
  refused([](auto& t) { t.c.resize(0); }, {"Heun", "at least one stage"});
  refused([](auto& t) { t.Av = Matrix::Zero(3, 3); }, {"Heun", "(2, 2)", "got (3, 3)"});
  refused([](auto& t) { t.Ac = Matrix::Zero(2, 3); }, {"(2, 2)", "got (2, 3)"});
  refused([](auto& t) { t.Aq = Matrix::Zero(1, 2); }, {"(2, 2)", "got (1, 2)"});
  // b_s <= 0: the last multiplier's sign would be turned round, or it would not act at all
  refused([](auto& t) { t.Av.row(1) << 1.5, -0.5; }, {"positive", "row 2", "-0.5"});
  refused([](auto& t) { t.Av.row(1) << 1.0, 0.0; }, {"positive", "row 2", "got 0"});
  // a_{1,0} < 0 with c = (0, -1)
  refused(
      [](auto& t) {
        t.Ac.row(0) << -1.0, 0.0;
        t.Av = t.Aq = t.Ac;
        t.c[1] = -1.0;
      },
      {"positive", "row 1"});
  refused([](auto& t) { t.Av(0, 0) = 0.9; }, {"row 1", "sum up to 1"});
  refused([](auto& t) { t.Aq(1, 0) = 0.6; }, {"row 2", "sum up to 1"});
  refused([&](auto& t) { t.Av(1, 1) = nan; }, {"row 2"});
}

}  // namespace
}  // namespace saltus::test
