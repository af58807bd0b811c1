// The energy balance in the step reports.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "slider_crank/slider_crank.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"
#include "support/spatial_models.hpp"

namespace saltus::test {
namespace {

class Energy : public testing::TestWithParam<std::string> {};

double kinetic(const examples::SliderCrank& crank, const Vec& q, const Vec& v) {
  Matrix M = Matrix::Zero(3, 3);
  crank.mass(In(q.data(), 3), OutMatrix(M.data(), 3, 3));
  return 0.5 * v.dot(M * v);
}

// Change of the kinetic energy that the reported works do not explain, over a whole run.
double unexplained(const std::vector<Row>& rows) {
  double work = 0.0;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const StepReport& report = rows[k].report;
    work += report.work_forces + report.work_lambda + report.work_impulse;
  }
  return rows.back().report.kinetic_energy - rows.front().report.kinetic_energy - work;
}

// Errors that fall with this order, or that are rounding: an implicit scheme's balance is an identity.
testing::AssertionResult vanishes(const std::vector<double>& dt, const std::vector<double>& errors,
                                  int order) {
  if (*std::max_element(errors.begin(), errors.end()) < 1e-11) return testing::AssertionSuccess();
  const double measured = slope(dt, errors);
  return (measured >= order - 0.2 ? testing::AssertionSuccess() : testing::AssertionFailure())
         << "order " << measured << ", finest error " << errors.back();
}

// With a variable mass dT/dt = vᵀh + ½ vᵀṀv: h holds the gyroscopic forces, the second term must be there
// too.
TEST_P(Energy, WorksExplainTheKineticEnergyUpToTheOrderOfTheScheme) {
  const auto properties = scheme_properties(GetParam());
  const std::vector<double> dt = {1e-3, 5e-4, 2.5e-4};
  std::vector<double> damped, variable_mass, bilateral;
  for (double h : dt) {
    const auto scheme = make_scheme(GetParam());
    damped.push_back(
        std::abs(unexplained(rows_of_run(make_oscillator(5.0, 1.0, 0.0, 0.5), *scheme, h, 0.5))));
    variable_mass.push_back(std::abs(unexplained(rows_of_run(make_double_pendulum(), *scheme, h / 2, 0.3))));
    bilateral.push_back(std::abs(unexplained(rows_of_run(make_pendulum(), *scheme, h, 0.5))));
  }
  EXPECT_TRUE(vanishes(dt, damped, properties.order_free));
  EXPECT_TRUE(vanishes(dt, variable_mass, std::min(2, properties.order_free)));  // that of ½ vᵀṀv
  EXPECT_TRUE(vanishes(dt, bilateral, properties.order_bilateral));
}

class EnergyOfFriction : public Energy {};

TEST_P(EnergyOfFriction, WorksExplainTheKineticEnergyInSliding) {
  const std::vector<double> dt = {1e-3, 5e-4, 2.5e-4};
  const Sledge sledge{
      .position = vec({0.3, 0.0}), .velocity = vec({1.0, 2.0}), .mu = 0.2, .stiffness = vec({20.0, 60.0})};
  for (const NonSmoothDynamicalSystem& model : {make_bowl(0.3), make_sledge(sledge)}) {
    std::vector<double> sliding;
    for (double h : dt)
      sliding.push_back(std::abs(unexplained(rows_of_run(model, *make_scheme(GetParam()), h, 0.25))));
    EXPECT_TRUE(vanishes(dt, sliding, scheme_properties(GetParam()).order_sliding));
  }
}

TEST_P(Energy, KineticEnergyIsThatOfTheState) {
  const auto crank =
      std::make_shared<examples::SliderCrank>(Vec::Zero(3), Vec::Zero(3), examples::SliderCrankParameters{});
  const auto model = examples::make_slider_crank(guidance_for(GetParam()));
  for (const Row& row : rows_of_run(model, *make_scheme(GetParam()), 1e-4, 0.03))
    EXPECT_NEAR(row.report.kinetic_energy, kinetic(*crank, row.state.q, row.state.v), 1e-12);
}

class EnergyOfImpulses : public Energy {};

TEST_P(EnergyOfImpulses, TheirWorkIsExactlyTheJumpOfTheKineticEnergy) {
  // v⁻ = v⁺ - M⁻¹WΛ at q_i, rebuilt from the model itself.
  const examples::SliderCrankParameters p;
  const examples::SliderCrank crank(Vec::Zero(3), Vec::Zero(3), p);
  const auto model = examples::make_slider_crank(guidance_for(GetParam()));
  const int rows = model.links()[0].interaction->law().size();  // of each corner
  int impacts = 0;
  for (const Row& row : rows_of_run(model, *make_scheme(GetParam()), 1e-5, 0.03)) {
    if (!row.report.impulsive) {
      EXPECT_EQ(row.report.work_impulse, 0.0);
      continue;
    }
    Matrix M = Matrix::Zero(3, 3), W(4 * rows, 3);
    const In q(row.state.q.data(), 3);
    crank.mass(q, OutMatrix(M.data(), 3, 3));
    for (int k = 0; k < 4; ++k)
      examples::SliderCorner(k % 2 ? p.a : -p.a, k < 2 ? p.b : -p.b, rows, p)
          .jacobian(q, OutMatrix(W.row(rows * k).data(), rows, 3));
    const Vec before = row.state.v - Matrix(M.inverse()) * (W.transpose() * row.reactions.impulse);
    const double jump = kinetic(crank, row.state.q, row.state.v) - kinetic(crank, row.state.q, before);
    EXPECT_NEAR(row.report.work_impulse, jump, 1e-12) << row.state.t;
    EXPECT_LE(row.report.work_impulse, 0.0) << row.state.t;  // ε = 0.4 and friction only take
    impacts += row.report.work_impulse < 0.0;
  }
  EXPECT_GT(impacts, 3);
}

INSTANTIATE_TEST_SUITE_P(Schemes, Energy, testing::ValuesIn(with_fixed_steps(scheme_names())),
                         [](const auto& test) { return test.param; });
// Where Λ is one impulse at the end of the step
std::vector<std::string> single_impulse_schemes() {
  std::vector<std::string> names = explicit_schemes();
  std::erase(names, "TrapezoidalInTenParts");
  return names;
}

INSTANTIATE_TEST_SUITE_P(Schemes, EnergyOfImpulses,
                         testing::ValuesIn(with_fixed_steps(single_impulse_schemes())),
                         [](const auto& test) { return test.param; });
INSTANTIATE_TEST_SUITE_P(Schemes, EnergyOfFriction, testing::ValuesIn(with_fixed_steps(frictional_schemes())),
                         [](const auto& test) { return test.param; });

TEST(EnergyBalance, AnElasticImpactTakesNothingAPlasticOneTakesAll) {
  for (double e : {0.0, 0.5, 1.0}) {
    TimeStepping simulation(make_ball(0.01, -1.0, e), *make_integrator("HalfExplicitTrapezoidalOSI"), 1e-3);
    while (!simulation.step().impulsive) ASSERT_LT(simulation.steps(), 100);
    const double speed = 1.0 + gravity * simulation.state().t;
    EXPECT_NEAR(simulation.report().work_impulse, -0.5 * 2.0 * speed * speed * (1.0 - e * e), 1e-13);
  }
}

TEST(EnergyBalance, FrictionTakesTheWholeKineticEnergyOfASlidingBlock) {
  // 1/2 m v0² = work of friction; the normal force works nothing.
  double work = 0.0;
  for (const Row& row :
       rows_of_run(make_block(2.0, 0.4), *make_integrator("HalfExplicitTrapezoidalOSI"), 1e-3, 1.0))
    work += row.report.work_lambda;
  EXPECT_NEAR(work, -0.5 * 2.0 * 2.0 * 2.0, 5e-3);
}

TEST(EnergyBalance, PotentialEnergyOfALinearSystem) {
  const Vec q = vec({1.0, 2.0});
  const LagrangianLinearTIDS system(
      q, q, Matrix::Identity(2, 2),
      {.stiffness = (Matrix(2, 2) << 3.0, 1.0, 1.0, 5.0).finished(), .external_force = vec({7.0, -11.0})});
  EXPECT_DOUBLE_EQ(system.potential_energy(In(q.data(), 2)), 0.5 * (3.0 + 4.0 + 20.0) - (7.0 - 22.0));
  const NonSmoothDynamicalSystem model = make_double_pendulum();
  EXPECT_TRUE(std::isnan(model.systems()[0]->LagrangianDS::potential_energy(In(q.data(), 2))));
}

}  // namespace
}  // namespace saltus::test
