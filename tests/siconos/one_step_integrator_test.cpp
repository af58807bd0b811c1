// Integrators of Saltus in simulations of Siconos: against runs without Siconos, against Siconos's own
// Moreau-Jean scheme, and against exact motions.
#include "saltus/siconos/one_step_integrator.hpp"

#include <gtest/gtest.h>

#include <SiconosKernel.hpp>
#include <cmath>
#include <functional>

#include "siconos/native_run.hpp"
#include "slider_crank/siconos_model.hpp"

namespace saltus::test {
namespace {

using saltus::siconos::HalfExplicitTrapezoidal;
using Integrator = saltus::siconos::OneStepIntegrator;

SP::SiconosVector vector(std::initializer_list<double> values) {
  return std::make_shared<SiconosVector>(std::vector<double>(values));
}

SP::SimpleMatrix matrix(unsigned rows, unsigned columns, std::initializer_list<double> values) {
  const auto result = std::make_shared<SimpleMatrix>(rows, columns);
  auto value = values.begin();
  for (unsigned i = 0; i < rows; ++i)
    for (unsigned j = 0; j < columns; ++j) result->setValue(i, j, *value++);
  return result;
}

SP::LagrangianLinearTIDS mass_point(double q, double v, double m, double force) {
  const auto ds = std::make_shared<LagrangianLinearTIDS>(vector({q}), vector({v}), matrix(1, 1, {m}));
  ds->setFExtPtr(vector({force}));
  return ds;
}

SP::NonSmoothDynamicalSystem model_of(std::initializer_list<SP::DynamicalSystem> systems, double until) {
  const auto nsds = std::make_shared<NonSmoothDynamicalSystem>(0.0, until);
  for (const auto& ds : systems) nsds->insertDynamicalSystem(ds);
  return nsds;
}

SP::Interaction floor_with(double restitution) {
  return std::make_shared<Interaction>(std::make_shared<NewtonImpactNSL>(restitution),
                                       std::make_shared<LagrangianLinearTIR>(matrix(1, 1, {1.0})));
}

SP::TimeStepping simulate(SP::NonSmoothDynamicalSystem nsds, SP::OneStepIntegrator osi, double dt,
                          SP::OneStepNSProblem problem = std::make_shared<LCP>()) {
  return std::make_shared<TimeStepping>(nsds, std::make_shared<TimeDiscretisation>(0.0, dt), osi, problem);
}

void run(TimeStepping& simulation, const std::function<void()>& look = [] {}) {
  while (simulation.hasNextEvent()) {
    simulation.computeOneStep();
    look();
    simulation.nextStep();
  }
}

// The message of what the call throws
std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

class SliderCrankInSiconos : public testing::TestWithParam<std::string> {};

TEST_P(SliderCrankInSiconos, IsThatWithoutSiconos) {
  const double dt = 1e-5, until = 0.1;
  const auto expected = native_slider_crank(GetParam(), dt, until);
  const auto nsds = make_siconos_slider_crank(until);
  const auto crank = std::static_pointer_cast<LagrangianDS>(nsds->dynamicalSystemsVector().front());
  std::vector<SP::Interaction> corners;
  InteractionsGraph::VIterator vertex, end;
  for (std::tie(vertex, end) = nsds->interactions()->vertices(); vertex != end; ++vertex)
    corners.push_back(nsds->interactions()->bundle(*vertex));
  ASSERT_EQ(corners.size(), 4u);
  const auto simulation =
      simulate(nsds, std::make_shared<Integrator>(GetParam()), dt, std::make_shared<FrictionContact>(2));
  std::size_t step = 0;
  int pressed = 0;
  run(*simulation, [&] {
    ASSERT_LT(step, expected.size());
    const NativeStep& native = expected[step++];
    std::vector<double> p(3, 0.0);
    for (int i = 0; i < 3; ++i) {
      ASSERT_NEAR((*crank->q())(i), native.q[i], 1e-10) << step;
      ASSERT_NEAR((*crank->velocity())(i), native.v[i], 1e-8) << step;
    }
    for (int k = 0; k < 4; ++k) {
      ASSERT_NEAR((*corners[k]->y(0))(0), native.gaps[k], 1e-11) << step;
      for (int row = 0; row < 2; ++row) {
        const double impulse = (*corners[k]->lambda(1))(row);
        ASSERT_NEAR((*corners[k]->y(1))(row), native.velocities[2 * k + row], 1e-9) << step;
        ASSERT_NEAR(impulse, native.impulses[2 * k + row], 1e-11) << step;
        pressed += row == 0 && impulse > 0.0;
        corners[k]->relation()->computeJach(0.0, *corners[k]);
        const SimpleMatrix& H = *std::static_pointer_cast<LagrangianR>(corners[k]->relation())->jachq();
        for (int i = 0; i < 3; ++i) p[i] += H.getValue(row, i) * impulse;
      }
    }
    for (int i = 0; i < 3; ++i) ASSERT_NEAR((*crank->p(1))(i), p[i], 1e-15) << step;
  });
  EXPECT_EQ(step, expected.size());
  EXPECT_GT(pressed, 50);
}

INSTANTIATE_TEST_SUITE_P(Schemes, SliderCrankInSiconos,
                         testing::Values("HalfExplicitTrapezoidalOSI", "MoreauJeanOSI", "DMinusGalerkinOSI"),
                         [](const auto& test) { return test.param; });

// A model, and a system and an interaction of it to look at
struct Watched {
  SP::NonSmoothDynamicalSystem nsds;
  SP::LagrangianDS ds;
  SP::Interaction interaction;
};

Watched bouncing_ball() {
  const auto ball = mass_point(1.0, 0.0, 2.0, -2.0 * 9.81);
  const auto floor = floor_with(0.9);
  const auto nsds = model_of({ball}, 3.0);
  nsds->link(floor, ball);
  return {nsds, ball, floor};
}

Watched damped_oscillators() {
  const auto first = std::make_shared<LagrangianLinearTIDS>(
      vector({0.3, -0.1}), vector({0.0, 1.0}), matrix(2, 2, {2, 0.5, 0.5, 1}),
      matrix(2, 2, {40, -10, -10, 30}), matrix(2, 2, {0.3, 0.1, 0.1, 0.2}));
  const auto second = std::make_shared<LagrangianLinearDiagonalDS>(vector({1.0, 0.0}), vector({-1.0, 0.5}),
                                                                   vector({20, 50}), vector({0.1, 0.4}));
  // They hit each other: first[1] stays below second[0].
  const auto contact = std::make_shared<Interaction>(
      std::make_shared<NewtonImpactNSL>(0.5),
      std::make_shared<LagrangianLinearTIR>(matrix(1, 4, {0, -1, 1, 0}), vector({-0.2})));
  const auto nsds = model_of({first, second}, 3.0);
  nsds->link(contact, first, second);
  return {nsds, second, contact};
}

class MoreauJeanOfBoth : public testing::TestWithParam<std::function<Watched()>> {};

TEST_P(MoreauJeanOfBoth, GivesTheSameNumbers) {
  std::vector<std::vector<double>> rows[2];
  int impacts = 0;
  for (int ours = 0; ours < 2; ++ours) {
    const Watched model = GetParam()();
    SP::OneStepIntegrator osi = std::make_shared<MoreauJeanOSI>(0.5);
    if (ours) osi = std::make_shared<Integrator>("MoreauJeanOSI(theta=0.5)");
    run(*simulate(model.nsds, osi, 5e-3), [&] {
      const auto& i = *model.interaction;
      rows[ours].push_back({(*model.ds->q())(0), (*model.ds->velocity())(0), (*i.y(0))(0), (*i.y(1))(0),
                            (*i.lambda(1))(0), (*model.ds->p(1))(0)});
      impacts += rows[ours].back()[4] > 0.0;
    });
  }
  ASSERT_EQ(rows[0].size(), 600u);
  ASSERT_EQ(rows[1].size(), 600u);
  EXPECT_GT(impacts, 4);
  for (std::size_t k = 0; k < 600; ++k)
    for (std::size_t column = 0; column < 6; ++column)
      ASSERT_NEAR(rows[0][k][column], rows[1][k][column], 1e-12) << k << ", " << column;
}

INSTANTIATE_TEST_SUITE_P(Models, MoreauJeanOfBoth, testing::Values(bouncing_ball, damped_oscillators));

TEST(InSiconos, TwoBodiesOnARigidRodMoveAsOne) {
  const auto first = mass_point(0.0, 1.0, 1.0, 3.0), second = mass_point(-1.0, 1.0, 2.0, 0.0);
  const auto rod = std::make_shared<Interaction>(
      std::make_shared<EqualityConditionNSL>(1),
      std::make_shared<LagrangianLinearTIR>(matrix(1, 2, {1, -1}), vector({-1.0})));
  const auto nsds = model_of({first, second}, 1.0);
  nsds->link(rod, first, second);
  const auto osi = std::make_shared<HalfExplicitTrapezoidal>();
  run(*simulate(nsds, osi, 1e-2, std::make_shared<Equality>()), [&] {
    // a = F / (m1 + m2) = 1; the rod pulls the second body with m2 a and the first one back
    ASSERT_NEAR((*rod->lambda(1))(0), -2.0 * 1e-2, 1e-14);
    ASSERT_NEAR(osi->contact_forces(*rod).lambda_plus[0], -2.0, 1e-12);
  });
  EXPECT_NEAR((*first->velocity())(0), 2.0, 1e-12);
  EXPECT_NEAR((*second->q())(0), -1.0 + 1.0 + 0.5, 1e-12);
}

// y = q − u(t), u = 0.5 t − 1
class RisingFloor : public LagrangianRheonomousR {
 public:
  RisingFloor() { _hDot = std::make_shared<SiconosVector>(1); }
  void computeh(double t, const BlockVector& q, BlockVector&, SiconosVector& y) override {
    y.setValue(0, q(0) - (0.5 * t - 1.0));
  }
  void computehDot(double, const BlockVector&, BlockVector&) override { _hDot->setValue(0, -0.5); }
  void computeJachq(double, const BlockVector&, BlockVector&) override { _jachq->setValue(0, 0, 1.0); }
};

TEST(InSiconos, AFloorThatRisesLiftsTheBall) {
  const auto ball = mass_point(0.0, 0.0, 2.0, -2.0 * 9.81);
  const auto contact =
      std::make_shared<Interaction>(std::make_shared<NewtonImpactNSL>(0.0), std::make_shared<RisingFloor>());
  const auto nsds = model_of({ball}, 2.0);
  nsds->link(contact, ball);
  const auto osi = std::make_shared<HalfExplicitTrapezoidal>();
  const auto simulation = simulate(nsds, osi, 1e-3);
  run(*simulation);
  EXPECT_NEAR((*ball->velocity())(0), 0.5, 1e-13);
  EXPECT_NEAR((*contact->y(1))(0), 0.0, 1e-13);
  EXPECT_NEAR(osi->contact_forces(*contact).lambda_plus[0], 2.0 * 9.81, 1e-11);
  EXPECT_NEAR(osi->contact_forces(*contact).lambda_minus[0], 2.0 * 9.81, 1e-11);
  EXPECT_EQ(osi->contact_forces(*contact).impulse[0], 0.0);
  EXPECT_NEAR((*ball->p(1))(0), 2.0 * 9.81 * 1e-3, 1e-13);
}

// A point on a circle: y = 1 − |q|, and d/dt(∂h/∂q)
class InsideOfACircle : public LagrangianScleronomousR {
 public:
  InsideOfACircle() { _dotjachq = std::make_shared<SimpleMatrix>(1, 2); }
  void computeh(const BlockVector& q, BlockVector&, SiconosVector& y) override {
    y.setValue(0, 1.0 - std::hypot(q(0), q(1)));
  }
  void computeJachq(const BlockVector& q, BlockVector&) override {
    const double r = std::hypot(q(0), q(1));
    for (int i = 0; i < 2; ++i) _jachq->setValue(0, i, -q(i) / r);
  }
  void computeDotJachq(const BlockVector& q, BlockVector&, const BlockVector& v) override {
    const double r = std::hypot(q(0), q(1)), radial = (q(0) * v(0) + q(1) * v(1)) / r;
    for (int i = 0; i < 2; ++i) _dotjachq->setValue(0, i, -v(i) / r + q(i) * radial / (r * r));
  }
};

TEST(InSiconos, AccelerationLevelAsksForTheRateOfTheJacobian) {
  const auto point =
      std::make_shared<LagrangianDS>(vector({1.0, 0.0}), vector({0.0, 3.0}), matrix(2, 2, {2, 0, 0, 2}));
  const auto contact = std::make_shared<Interaction>(std::make_shared<NewtonImpactNSL>(0.0),
                                                     std::make_shared<InsideOfACircle>());
  const auto nsds = model_of({point}, 0.1);
  nsds->link(contact, point);
  const auto osi = std::make_shared<Integrator>("DMinusAccelerationOSI");
  const auto simulation = simulate(nsds, osi, 1e-4);
  simulation->computeOneStep();
  EXPECT_NEAR(osi->contact_forces(*contact).lambda_plus[0], 2.0 * 3.0 * 3.0 / 1.0, 1e-12);  // m v²/r
}

TEST(InSiconos, AStepThatIsTakenAgainStartsWhereItStarted) {
  const Watched model = bouncing_ball();
  const auto simulation = simulate(model.nsds, std::make_shared<HalfExplicitTrapezoidal>(), 5e-3);
  double q = 0.0, v = 0.0;
  run(*simulation, [&] {
    q = (*model.ds->q())(0);
    v = (*model.ds->velocity())(0);
    simulation->computeOneStep();
    ASSERT_EQ((*model.ds->q())(0), q);
    ASSERT_EQ((*model.ds->velocity())(0), v);
  });
}

TEST(InSiconos, NoProblemIsNeeded) {
  double heights[2];
  for (int given = 0; given < 2; ++given) {
    const Watched model = bouncing_ball();
    const auto td = std::make_shared<TimeDiscretisation>(0.0, 5e-3);
    const auto simulation = std::make_shared<TimeStepping>(model.nsds, td, 0);
    simulation->insertIntegrator(std::make_shared<HalfExplicitTrapezoidal>());
    if (given) simulation->insertNonSmoothProblem(nullptr);
    run(*simulation);
    heights[given] = (*model.ds->q())(0) + 100.0 * (*model.interaction->y(0))(0);
  }
  EXPECT_EQ(heights[0], heights[1]);
}

TEST(InSiconos, InteractionsCanComeAndGo) {
  const auto ball = mass_point(1.0, 0.0, 1.0, -10.0);
  const auto nsds = model_of({ball}, 1.0);
  const auto simulation = simulate(nsds, std::make_shared<HalfExplicitTrapezoidal>(), 1e-3);
  const auto floor = floor_with(0.0);
  for (int step = 1; simulation->hasNextEvent(); ++step) {
    simulation->computeOneStep();
    simulation->nextStep();
    if (step == 100) nsds->link(floor, ball);
    if (step != 700) continue;
    EXPECT_EQ((*ball->velocity())(0), 0.0);  // since t = sqrt(0.2)
    EXPECT_EQ(simulation->indexSet(1)->size(), 1u);
    nsds->removeInteraction(floor);
  }
  EXPECT_NEAR((*ball->velocity())(0), -10.0 * 0.3, 1e-12);
}

TEST(InSiconos, WhatCannotBeTakenIsNamed) {
  EXPECT_EQ(refusal([] { Integrator("MoreauJeanOSI(theta)"); }),
            "expected an integrator as NAME or NAME(option=value, ...), got 'MoreauJeanOSI(theta)'");
  EXPECT_NE(refusal([] { Integrator("MoreauOSI"); }).find("'MoreauOSI'"), std::string::npos);
  EXPECT_NE(refusal([] { Integrator("MoreauJeanOSI(theta=2)"); }).find("theta"), std::string::npos);
  EXPECT_NE(refusal([] { HalfExplicitTrapezoidal("activity=never"); }).find("never"), std::string::npos);
  EXPECT_NE(refusal([] { HalfExplicitTrapezoidal("", "none"); }).find("'none'"), std::string::npos);

  const auto refused = [](SP::NonSmoothDynamicalSystem nsds, SP::OneStepIntegrator osi) {
    const auto simulation = simulate(nsds, osi, 1e-3);
    return refusal([&] { simulation->computeOneStep(); });
  };
  const auto body = std::make_shared<NewtonEulerDS>(vector({0, 0, 0, 1, 0, 0, 0}), vector({0, 0, 0, 0, 0, 0}),
                                                    1.0, matrix(3, 3, {1, 0, 0, 0, 1, 0, 0, 0, 1}));
  EXPECT_EQ(refused(model_of({body}, 1.0), std::make_shared<HalfExplicitTrapezoidal>()),
            "a system must be a LagrangianDS, got a NewtonEulerDS");
  const auto ball = mass_point(1.0, 0.0, 1.0, 0.0);
  const auto nsds = model_of({ball}, 1.0);
  nsds->link(std::make_shared<Interaction>(std::make_shared<RelayNSL>(1),
                                           std::make_shared<LagrangianLinearTIR>(matrix(1, 1, {1.0}))),
             ball);
  EXPECT_EQ(
      refused(nsds, std::make_shared<HalfExplicitTrapezoidal>()),
      "a law must be a NewtonImpactNSL of one row, a NewtonImpactFrictionNSL or an EqualityConditionNSL, "
      "got a RelayNSL of 1 rows");
  const Watched other = bouncing_ball();
  const auto two = simulate(other.nsds, std::make_shared<HalfExplicitTrapezoidal>(), 1e-3);
  two->insertIntegrator(std::make_shared<MoreauJeanOSI>(0.5));
  EXPECT_EQ(refusal([&] { two->computeOneStep(); }),
            "a simulation must have an integrator of Saltus alone, got 2 integrators");
}

// An external force that is no longer finite
class Diverging : public LagrangianDS {
 public:
  Diverging() : LagrangianDS(vector({1.0}), vector({0.0}), matrix(1, 1, {1.0})) { allocateFExt(); }
  void computeFExt(double t) override { _fExt->setValue(0, t > 5e-3 ? NAN : -1.0); }
};

TEST(InSiconos, AStepThatFailsLeavesTheStateBeforeIt) {
  const auto ds = std::make_shared<Diverging>();
  const auto simulation = simulate(model_of({ds}, 1.0), std::make_shared<HalfExplicitTrapezoidal>(), 1e-3);
  for (int step = 0; step < 5; ++step) {
    simulation->computeOneStep();
    simulation->nextStep();
  }
  const double q = (*ds->q())(0), v = (*ds->velocity())(0);
  EXPECT_NEAR(v, -5e-3, 1e-15);
  EXPECT_EQ(refusal([&] { simulation->computeOneStep(); }).rfind("step from t = 0.005 s failed: ", 0), 0u);
  EXPECT_EQ((*ds->q())(0), q);
  EXPECT_EQ((*ds->velocity())(0), v);
}

}  // namespace
}  // namespace saltus::test
