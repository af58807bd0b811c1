// The engine of the half-explicit schemes with tableaux that are not in the registry, and what it refuses.
#include <gtest/gtest.h>

#include <limits>

#include "saltus/kernel/integrators/half_explicit/half_explicit.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

Tableau euler() { return runge_kutta("Euler", Matrix::Zero(1, 1), vec({1.0})); }

// Those of Appendix B
std::vector<Tableau> tableaux() {
  return {euler(), heun_tableau(), third_order_tableau(), kutta3_tableau(), rk4_tableau(), hem5_tableau()};
}

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
TEST(Tableau, HeunHasOrderTwo) { expect_orders(heun_tableau(), 2, 2, {2e-3, 1e-3, 5e-4}); }
TEST(Tableau, ThirdOrderHasOrderThree) {
  expect_orders(third_order_tableau(), 3, 3, {5e-3, 2.5e-3, 1.25e-3});
}
TEST(Tableau, KuttaHasOrderThree) { expect_orders(kutta3_tableau(), 3, 3, {5e-3, 2.5e-3, 1.25e-3}); }
TEST(Tableau, ClassicRungeKuttaHasOrderFourAndThreeUnderConstraints) {
  expect_orders(rk4_tableau(), 4, 3, {1e-2, 5e-3, 2.5e-3});
}
TEST(Tableau, Hem5HasOrderFive) { expect_orders(hem5_tableau(), 5, 5, {2.5e-2, 1.25e-2, 6.25e-3}); }

TEST(Tableau, EveryStageCarriesTheWeightAtRest) {
  for (const Tableau& tableau : tableaux()) {
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
  for (const Tableau& tableau : tableaux()) {
    const HalfExplicit scheme("under test", tableau, HalfExplicitSettings{});
    const State end = run_to(make_two_balls(1.0, 1.0, 2.0, -1.0, 0.5), scheme, 1e-3, 0.1);
    EXPECT_NEAR(end.v[1] - end.v[0], 1.5, 1e-13) << tableau.name;
  }
}

TEST(Tableau, RefusesWhatCannotWork) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NO_THROW(validate(trapezoidal_tableau()));
  auto refused = [](auto change, const std::vector<std::string>& words) {
    Tableau t = heun_tableau();
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
  refused([](auto& t) { t.Av.row(1) << 1.0 - 1e-9, 1e-9; }, {"at least 1e-06", "row 2", "1e-09"});
  refused(
      [](auto& t) {
        t.Ac.row(0) << 1e300, 0.0;
        t.Av = t.Aq = t.Ac;
        t.c[1] = 1e300;
      },
      {"must not exceed 1000", "1e+300", "row 1"});
  refused([](auto& t) { t.Av(0, 0) = 0.9; }, {"row 1", "sum up to 1"});
  refused([](auto& t) { t.Aq(1, 0) = 0.6; }, {"row 2", "sum up to 1"});
  refused([&](auto& t) { t.Av(1, 1) = nan; }, {"row 2"});
}

TEST(Tableau, RungeKuttaBecomesRows) {
  Matrix A = Matrix::Zero(3, 3);
  A(1, 0) = 0.5;
  A.row(2) << -1.0, 2.0, 0.0;
  const Vec b = vec({1.0, 4.0, 1.0}) / 6.0;
  const Tableau t = runge_kutta("mine", A, b);
  EXPECT_EQ(t.name, "mine");
  EXPECT_EQ(t.c, vec({0.0, 0.5, 1.0}));
  EXPECT_EQ(t.Av.topRows(2), A.bottomRows(2));
  EXPECT_EQ(t.Av.row(2).transpose(), b);
  EXPECT_EQ(t.Ac, t.Av);
  EXPECT_EQ(t.Aq, t.Av);
  for (const Tableau& known : tableaux()) EXPECT_NO_THROW(validate(known)) << known.name;
}

TEST(Tableau, RungeKuttaRefusesWhatIsNotExplicit) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  auto refused = [](auto change, const std::vector<std::string>& words) {
    Matrix A = (Matrix(2, 2) << 0.0, 0.0, 1.0, 0.0).finished();
    Vec b = vec({0.5, 0.5});
    change(A, b);
    expect_refusal([&] { runge_kutta("mine", A, b); }, words);
  };
  refused([](auto&, auto& b) { b.resize(0); }, {"'mine'", "at least one stage"});
  refused([](auto& A, auto&) { A = Matrix::Zero(3, 2); }, {"'mine'", "must be (2, 2)", "got (3, 2)"});
  refused([](auto&, auto& b) { b = Vec::Ones(3); }, {"must be (3, 3)", "got (2, 2)"});
  refused([&](auto& A, auto&) { A(1, 0) = nan; }, {"A[1, 0]", "finite", "nan"});
  refused([&](auto&, auto& b) { b[1] = 1.0 / 0.0; }, {"b[1]", "finite", "inf"});
  refused([](auto& A, auto&) { A(1, 1) = 0.5; }, {"A[1, 1]", "diagonal", "got 0.5"});
  refused([](auto& A, auto&) { A(0, 1) = -1.0; }, {"A[0, 1]", "diagonal", "got -1"});
}

}  // namespace
}  // namespace saltus::test
