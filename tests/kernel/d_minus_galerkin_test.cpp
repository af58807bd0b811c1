// The D⁻ Galerkin schemes: coefficients, orders, conservation, limits, and steps in which contacts change.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>

#include "saltus/kernel/assembly/configuration.hpp"
#include "saltus/kernel/integrators/d_minus/coefficients.hpp"
#include "saltus/numerics/solvers/registry.hpp"
#include "slider_crank/slider_crank.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

struct Member {
  const char* name;
  int stages;
  const char* points;
  int order;
  double limit;  // of ωΔt without damping; 0: every step grows
};

std::unique_ptr<OneStepIntegrator> make_galerkin(int stages, const char* points = "lobatto",
                                                 const char* activity = "start") {
  return make_integrator("DMinusGalerkinOSI",
                         {{"stages", double(stages)}, {"points", points}, {"activity", activity}});
}

void expect_rows(const Matrix& A, std::vector<double> entries, double denominator) {
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(entries.size()); ++i)
    EXPECT_NEAR(A(i / A.cols(), i % A.cols()), entries[i] / denominator, 1e-16) << i;
}

TEST(GalerkinCoefficients, AreTheRationalsThatTheyHaveToBe) {
  const Tableau one = d_minus_tableau(1, StagePoints::lobatto);
  expect_rows(one.Aq, {1, 1, 1, 1}, 2);
  expect_rows(one.Av, {2, 0, 1, 1}, 2);
  for (StagePoints points : {StagePoints::lobatto, StagePoints::chebyshev}) {
    const Tableau two = d_minus_tableau(2, points);
    expect_rows(two.Aq, {5, 8, -1, 4, 16, 4, 4, 16, 4}, 24);
    expect_rows(two.Av, {3, 3, 0, 0, 12, 0, 2, 8, 2}, 12);
  }
  const Tableau chebyshev = d_minus_tableau(3, StagePoints::chebyshev);
  expect_rows(chebyshev.Aq, {59, 94, -14, 5, 27, 270, 162, -27, 32, 256, 256, 32, 32, 256, 256, 32}, 576);
  expect_rows(chebyshev.Av, {16, 21, -1, 0, 0, 81, 27, 0, 16, 48, 80, 0, 8, 64, 64, 8}, 144);
  const Tableau lobatto = d_minus_tableau(3, StagePoints::lobatto);
  EXPECT_NEAR(lobatto.c[1], (1.0 - 1.0 / std::sqrt(5.0)) / 2.0, 1e-16);
  expect_rows(lobatto.Aq.bottomRows(1), {1, 5, 5, 1}, 12);
  for (int l = 0; l < 4; ++l)  // q of a velocity that is a polynomial of degree 3 in time
    for (int power = 0; power < 4; ++power) {
      const double end = l < 3 ? lobatto.c[l + 1] : 1.0;
      EXPECT_NEAR(lobatto.Aq.row(l).dot(Vec(lobatto.c.array().pow(power))),
                  std::pow(end, power + 1) / (power + 1), 1e-16);
    }
}

class Galerkin : public testing::TestWithParam<Member> {
 protected:
  std::unique_ptr<OneStepIntegrator> make(const char* activity = "start") const {
    return make_galerkin(GetParam().stages, GetParam().points, activity);
  }
  // Neither in rounding nor before the asymptotic range
  std::vector<double> steps(double until, bool free) const {
    const int order = GetParam().order, first = order == 2 ? 100 : order == 4 ? 20 : free ? 8 : 4;
    return {until / first, until / (1.5 * first), until / (2 * first), until / (3 * first)};
  }
  void expect(const NonSmoothDynamicalSystem& model, const State& exact, double until,
              const char* activity = "start") const {
    const Orders orders =
        measure_orders(model, *make(activity), exact, until, steps(until, model.links().empty()));
    EXPECT_NEAR(orders.q, GetParam().order, 0.25);
    EXPECT_NEAR(orders.v, GetParam().order, 0.25);
  }
  // Order of the mean force of the last step, whose exact value is that of Boole's rule
  void expect_mean(const NonSmoothDynamicalSystem& model, double until, int coarsest,
                   const std::function<double(double)>& force) const {
    const std::vector<double> dt = {until / coarsest, until / (1.5 * coarsest), until / (2 * coarsest)};
    std::vector<double> errors;
    for (double h : dt) {
      const Row last = rows_of_run(model, *make("sticky"), h, until).back();
      double mean = 0.0;
      const double weights[] = {7, 32, 12, 32, 7};
      for (int k = 0; k < 5; ++k) mean += weights[k] / 90.0 * force(until - h + 0.25 * k * h);
      errors.push_back(std::abs(std::abs(last.reactions.force[0]) - mean));
    }
    EXPECT_GE(slope(dt, errors), GetParam().order - 0.4);
  }
};

TEST_P(Galerkin, OrderInFreeMotion) { expect(make_double_pendulum(), exact_double_pendulum(0.5), 0.5); }

TEST_P(Galerkin, OrderUnderABilateralConstraint) { expect(make_pendulum(), exact_pendulum(0.5), 0.5); }

TEST_P(Galerkin, OrderInSliding) {
  expect(make_bowl(0.3), exact_bowl(0.3, 0.2), 0.2);
  for (double mu : {0.0, 0.3}) {
    const auto model = make_touching_bowl(mu, 0.5);
    expect(model, exact_touching_bowl(mu, 0.2), 0.2, "sticky");
    for (const Row& row : rows_of_run(model, *make("sticky"), 0.01, 0.2))
      EXPECT_FALSE(row.report.impulsive) << row.state.t;
  }
}

TEST_P(Galerkin, OrderOfASliderCrankWithEqualityConstraints) {
  const auto model = examples::make_slider_crank(examples::Guidance::equality);
  const double until = 0.01;
  const State fine = run_to(model, *make_galerkin(3), until / 500, until);
  const Orders orders = measure_orders(model, *make(), fine, until, {until / 40, until / 60, until / 80});
  EXPECT_NEAR(orders.q, GetParam().order, 0.15);
  EXPECT_NEAR(orders.v, GetParam().order, 0.15);
}

TEST_P(Galerkin, OrderOfTheMeanForce) {
  const bool sixth = GetParam().order == 6;
  expect_mean(make_pendulum(), 0.4, sixth ? 20 : 40, pendulum_tension);
  expect_mean(make_bowl(0.3), 0.2, sixth ? 8 : 20, [](double t) {
    const State at = exact_bowl(0.3, t);
    return 2.0 * (at.v.squaredNorm() - gravity * at.q[1]) / at.q.norm();
  });
}

TEST_P(Galerkin, ConservesTheEnergyOfSwingsBetterThanItsOrderAsks) {
  const double bound = GetParam().stages == 1 ? 1.0 : GetParam().order == 6 ? 1e-6 : 1e-3;
  for (const auto& model : {make_pendulum(), make_double_pendulum()}) {
    TimeStepping simulation(model, *make(), 0.02);
    const Layout layout(model);
    double start = 0.0, change = 0.0;
    for (int k = 0; k < 16000; ++k) {
      const StepReport& report = simulation.step();
      const double energy = report.kinetic_energy + potential_energy(layout, 0.0, simulation.state().q);
      if (k == 0) start = energy;
      change = std::max(change, std::abs(energy - start));
    }
    EXPECT_LT(change, bound * std::abs(start));
  }
}

// Spectral radius of a step of q̈ = −q
double radius(const OneStepIntegrator& scheme, double dt) {
  Eigen::Matrix2d step;
  const auto model = make_oscillator(1.0, 0.0, 0.0);
  const auto solver = make_contact_solver("auto");
  const auto copy = scheme.clone();
  copy->prepare(model, *solver);
  for (int column : {0, 1}) {
    State state{0.0, vec({column == 0 ? 1.0 : 0.0}), vec({column == 0 ? 0.0 : 1.0})};
    Reactions reactions;
    reactions.set_zero(0);
    EXPECT_EQ(copy->step(dt, state, reactions).status, StepStatus::ok);
    step.col(column) << state.q[0], state.v[0];
  }
  const std::complex<double> half = 0.5 * step.trace();
  const std::complex<double> root = std::sqrt(half * half - step.determinant());
  return std::max(std::abs(half + root), std::abs(half - root));
}

TEST_P(Galerkin, UndampedOscillationsAreBoundedUpToTheLimit) {
  const double limit = GetParam().limit;
  if (limit == 0.0) {
    EXPECT_GT(radius(*make(), 0.5), 1.0 + 1e-8);
    EXPECT_LT(radius(*make(), 0.5), 1.0 + 1e-3);
    return;
  }
  for (double part : {0.1, 0.5, 0.9, 0.999}) EXPECT_LT(radius(*make(), part * limit), 1.0 + 1e-12) << part;
  EXPECT_GT(radius(*make(), 1.001 * limit), 1.001);
}

TEST_P(Galerkin, AContactThatApproachesAtTheStartIsTakenPlastically) {
  for (const char* activity : {"start", "sticky"}) {
    TimeStepping simulation(make_ball(-1e-4, -1.0, 0.9), *make(activity), 1e-3);
    EXPECT_FALSE(simulation.step().impulsive);
    EXPECT_NEAR(simulation.state().v[0], 0.0, 1e-13);
  }
}

TEST_P(Galerkin, ABlockThatHitsAWallStaysOnTheFloor) {
  const double dt = 1e-3;
  int impacts = 0;
  for (const Row& row : rows_of_run(make_block_before_wall(dt, 0.5), *make(), dt, 0.02)) {
    EXPECT_NEAR(row.state.v[1], 0.0, 1e-13) << row.state.t;
    impacts += row.report.impulsive;
  }
  EXPECT_EQ(impacts, 1);
}

INSTANTIATE_TEST_SUITE_P(Members, Galerkin,
                         testing::Values(Member{"One", 1, "lobatto", 2, 2.0},
                                         Member{"Two", 2, "lobatto", 4, std::sqrt(8.0)},
                                         Member{"Three", 3, "lobatto", 6, 3.1127},
                                         Member{"Chebyshev", 3, "chebyshev", 4, 0.0}),
                         [](const auto& test) { return test.param.name; });

TEST(GalerkinContacts, ACrankWithoutClearanceStaysInItsGuide) {
  // Four contacts of which two carry, that depend on each other; the half-explicit scheme sinks in by 1.8 µm.
  const auto model = examples::make_slider_crank(examples::Guidance::no_clearance);
  for (int stages : {2, 3})
    for (const Row& row : rows_of_run(model, *make_galerkin(stages, "lobatto", "sticky"), 1e-4, 0.1))
      EXPECT_LT(row.report.penetration, stages == 2 ? 1e-10 : 1e-13) << stages << " " << row.state.t;
}

TEST(GalerkinContacts, ForceAndLimitOfFrictionAreThoseOfTheScheme) {
  // A block is pulled by a growing force: it sticks with λ_T = −F until μ m g is reached, then slides.
  const double mu = 0.5, rate = 40.0, m = 2.0, until = 0.4, start = mu * m * gravity / rate;
  class Pulled final : public LagrangianDS {
   public:
    explicit Pulled(double rate) : LagrangianDS(vec({0.0, -1e-4}), Vec::Zero(2)), rate_(rate) {}
    void mass(const In&, OutMatrix M) const override { M << 2.0, 0.0, 0.0, 2.0; }
    void forces(double t, const In&, const In&, Out h) const override { h << rate_ * t, -2.0 * gravity; }
    double rate_;
  };
  const auto block = std::make_shared<Pulled>(rate);
  NonSmoothDynamicalSystem model({block});
  const Matrix rows = (Matrix(2, 2) << 0.0, 1.0, 1.0, 0.0).finished();
  model.link(linear_contact(rows, Vec::Zero(2), NewtonImpactFrictionNSL(0.0, 0.0, mu, 2), "floor"), *block);
  for (int stages : {1, 2, 3}) {
    for (const Row& row : rows_of_run(model, *make_galerkin(stages), 1e-3, until)) {
      if (row.state.t == 0.0) continue;
      const double mean = row.state.t - 0.5e-3, slide = std::max(row.state.t - start, 0.0);
      EXPECT_NEAR(row.state.v[0], 0.5 * rate / m * slide * slide, 1e-4) << row.state.t;
      if (row.state.t < start) {
        EXPECT_EQ(std::abs(row.state.v[0]) > 1e-14, false) << row.state.t;
        EXPECT_NEAR(row.reactions.force[1], -rate * mean, 1e-9) << row.state.t;
      } else if (slide > 1e-3) {
        EXPECT_NEAR(row.reactions.force[1], -mu * m * gravity, 1e-9) << row.state.t;
      }
    }
  }
}

TEST(GalerkinOptions, WhatIsNoMemberIsRefused) {
  const auto make = [](const Options& options) {
    return [=] { make_integrator("DMinusGalerkinOSI", options); };
  };
  for (double stages : {0.0, 4.0, 2.5, std::nan("")})
    expect_refusal(make({{"stages", stages}}), {"DMinusGalerkinOSI", "stages must be 1, 2 or 3"});
  expect_refusal(make({{"points", "gauss"}}), {"points", "lobatto, chebyshev", "'gauss'"});
  expect_refusal(make({{"activity", "predicted"}}), {"activity", "start, sticky", "'predicted'"});
  EXPECT_EQ(integrator_properties("DMinusGalerkinOSI", {{"stages", 3.0}}).order_bilateral, 6);
  EXPECT_EQ(integrator_properties("DMinusGalerkinOSI", {{"stages", 3.0}, {"points", "chebyshev"}}).order_free,
            4);
}

}  // namespace
}  // namespace saltus::test
