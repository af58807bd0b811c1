// Siconos's names over the classes of Saltus, against runs of these and exact motions.
#include "saltus/siconos/kernel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "saltus/kernel/model/lagrangian_linear_tids.hpp"
#include "siconos/native_run.hpp"
#include "slider_crank/siconos_model.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

namespace sk = saltus::siconos::kernel;

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

std::shared_ptr<sk::NonSmoothDynamicalSystem> model_of(std::initializer_list<SP::DynamicalSystem> systems,
                                                       double until) {
  const auto nsds = std::make_shared<sk::NonSmoothDynamicalSystem>(0.0, until);
  for (const auto& ds : systems) nsds->insertDynamicalSystem(ds);
  return nsds;
}

std::shared_ptr<sk::TimeStepping> simulate(SP::NonSmoothDynamicalSystem nsds, SP::OneStepIntegrator osi,
                                           double dt) {
  return std::make_shared<sk::TimeStepping>(nsds, std::make_shared<sk::TimeDiscretisation>(0.0, dt), osi,
                                            std::make_shared<sk::LCP>());
}

void run(sk::TimeStepping& simulation, const std::function<void()>& look = [] {}) {
  while (simulation.hasNextEvent()) {
    simulation.computeOneStep();
    look();
    simulation.nextStep();
  }
}

TEST(SiconosNames, TheCrankOfAProgramForSiconosIsThatOfSaltus) {
  const double dt = 1e-5, until = 0.1;
  const auto nsds = make_siconos_slider_crank(until);
  const auto& crank = *nsds->systems().front();
  const auto expected = native_slider_crank("HalfExplicitTrapezoidalOSI", dt, until);
  std::size_t step = 0;
  run(*simulate(nsds, std::make_shared<sk::HalfExplicitTrapezoidalOSI>(), dt), [&] {
    const NativeStep& native = expected.at(step++);
    for (int i = 0; i < 3; ++i) {
      ASSERT_NEAR((*crank.q())(i), native.q[i], 1e-10) << step;
      ASSERT_NEAR((*crank.velocity())(i), native.v[i], 1e-8) << step;
    }
    for (int k = 0; k < 4; ++k) {
      const auto& corner = *nsds->links()[k].interaction;
      ASSERT_NEAR((*corner.y(0))(0), native.gaps[k], 1e-11) << step;
      for (int row = 0; row < 2; ++row) {
        ASSERT_NEAR((*corner.y(1))(row), native.velocities[2 * k + row], 1e-9) << step;
        ASSERT_NEAR((*corner.lambda(1))(row), native.impulses[2 * k + row], 1e-11) << step;
      }
    }
  });
  EXPECT_EQ(step, expected.size());
}

// Two oscillators that hit each other
TEST(SiconosNames, LinearSystemsMoveAsThoseOfSaltus) {
  const std::initializer_list<double> K = {40, -10, 5, 30}, C = {0.3, 0.1, 0.2, 0.2};
  const auto first = std::make_shared<sk::LagrangianLinearTIDS>(
      vector({0.3, -0.1}), vector({0, 1}), matrix(2, 2, {2, 0.5, 0.5, 1}), matrix(2, 2, K), matrix(2, 2, C));
  const auto second = std::make_shared<sk::LagrangianLinearTIDS>(vector({1}), vector({-1}), matrix(1, 1, {2}),
                                                                 matrix(1, 1, {20}));
  second->setFExtPtr(vector({-3}));
  const auto contact = std::make_shared<sk::Interaction>(
      std::make_shared<sk::NewtonImpactNSL>(0.5),
      std::make_shared<sk::LagrangianLinearTIR>(matrix(1, 3, {0, -1, 1}), vector({-0.2})));
  const auto nsds = model_of({first, second}, 3.0);
  nsds->link(contact, first, second);

  Matrix M1(2, 2), K1(2, 2), C1(2, 2), M2(1, 1), K2(1, 1), H(1, 3);
  M1 << 2, 0.5, 0.5, 1;
  std::copy(K.begin(), K.end(), K1.data());
  std::copy(C.begin(), C.end(), C1.data());
  M2 << 2;
  K2 << 20;
  H << 0, -1, 1;
  const auto one = std::make_shared<saltus::LagrangianLinearTIDS>(
      vec({0.3, -0.1}), vec({0, 1}), M1, saltus::LagrangianLinearTIDS::Terms{K1, C1, std::nullopt});
  const auto two = std::make_shared<saltus::LagrangianLinearTIDS>(
      vec({1}), vec({-1}), M2, saltus::LagrangianLinearTIDS::Terms{K2, std::nullopt, vec({-3})});
  saltus::NonSmoothDynamicalSystem model({one, two});
  model.link(std::make_shared<saltus::Interaction>(
                 std::make_shared<saltus::LagrangianLinearTIR>(H, vec({-0.2})), saltus::NewtonImpactNSL(0.5)),
             *one, two.get());
  const auto rows = rows_of_run(model, *make_integrator("MoreauJeanOSI", {{"theta", 1.0 / 3.0}}), 5e-3, 3.0);

  std::size_t step = 0;
  int impacts = 0;
  run(*simulate(nsds, std::make_shared<sk::MoreauJeanOSI>(1.0 / 3.0), 5e-3), [&] {
    const Row& row = rows.at(++step);
    const double impulse = (*contact->lambda(1))(0);
    ASSERT_NEAR((*first->q())(1), row.state.q[1], 1e-13) << step;
    ASSERT_NEAR((*second->velocity())(0), row.state.v[2], 1e-12) << step;
    ASSERT_NEAR(impulse, row.reactions.impulse[0], 1e-13) << step;
    ASSERT_EQ((*first->p(1))(0), 0.0);
    ASSERT_EQ((*first->p(1))(1), -impulse);
    ASSERT_EQ((*second->p(1))(0), impulse);
    impacts += impulse > 0.0;
  });
  EXPECT_EQ(step + 1, rows.size());
  EXPECT_GT(impacts, 3);
}

std::string plugin(const std::string& function) { return SALTUS_PENDULUM_PLUGIN ":" + function; }

TEST(SiconosNames, PluginsMoveAsThoseOfSaltus) {
  const auto ds = std::make_shared<sk::LagrangianDS>(vector({1.0, 0.2}), vector({0.0, 0.5}), plugin("mass"));
  ds->setComputeFIntFunction(SALTUS_PENDULUM_PLUGIN, "internal_force");
  ds->setComputeFGyrFunction(SALTUS_PENDULUM_PLUGIN, "gyroscopic_force");
  ds->setComputeFExtFunction(SALTUS_PENDULUM_PLUGIN, "external_force");
  const auto circle = std::make_shared<sk::Interaction>(
      std::make_shared<sk::NewtonImpactNSL>(0.5),
      std::make_shared<sk::LagrangianScleronomousR>(plugin("distance"), plugin("gradient")));
  const auto floor = std::make_shared<sk::Interaction>(
      std::make_shared<sk::NewtonImpactNSL>(0.5),
      std::make_shared<sk::LagrangianRheonomousR>(plugin("height"), plugin("height_gradient"),
                                                  plugin("height_rate")));
  const auto nsds = model_of({ds}, 2.0);
  nsds->link(circle, ds);
  nsds->link(floor, ds);

  PluggedDS::Terms terms;
  terms.mass = plugin("mass");
  terms.internal_force = plugin("internal_force");
  terms.gyroscopic_force = plugin("gyroscopic_force");
  terms.external_force = plugin("external_force");
  const auto native = std::make_shared<PluggedDS>(vec({1.0, 0.2}), vec({0.0, 0.5}), terms);
  saltus::NonSmoothDynamicalSystem model({native});
  const auto link = [&](std::shared_ptr<const saltus::Relation> relation) {
    model.link(std::make_shared<saltus::Interaction>(relation, saltus::NewtonImpactNSL(0.5)), *native);
  };
  link(std::make_shared<PluggedRelation>(1, plugin("distance"), plugin("gradient")));
  link(std::make_shared<PluggedRheonomousRelation>(1, plugin("height"), plugin("height_gradient"),
                                                   plugin("height_rate")));
  const auto rows = rows_of_run(model, *make_integrator("HalfExplicitTrapezoidalOSI"), 1e-3, 2.0);
  std::size_t step = 0;
  run(*simulate(nsds, std::make_shared<sk::HalfExplicitTrapezoidalOSI>(), 1e-3), [&] {
    const Vec& q = rows.at(++step).state.q;
    ASSERT_NEAR((*ds->q())(0), q[0], 1e-12);
    ASSERT_NEAR((*ds->q())(1), q[1], 1e-12);
  });
  EXPECT_EQ(step, 2000u);
  const auto still =
      std::make_shared<sk::LagrangianDS>(vector({1.0, 0.2}), vector({0.4, 0.5}), plugin("mass"));
  const double energy = 0.5 * ((2.0 + 0.5 * std::sin(0.2)) * 0.16 + 2.0 * 0.3 * 0.2 + 2.0 * 0.25);
  EXPECT_NEAR(still->computeKineticEnergy(), energy, 1e-15);
}

// Of an implicit scheme, which asks for derivatives
TEST(SiconosNames, JacobiansOfPluginsAreTaken) {
  double ends[3];
  for (int given = 0; given < 3; ++given) {
    const auto ds =
        std::make_shared<sk::LagrangianDS>(vector({1.0, 0.2}), vector({0.0, 0.5}), plugin("mass"));
    ds->setComputeFIntFunction(SALTUS_PENDULUM_PLUGIN, "internal_force");
    if (given > 0) {
      ds->setComputeJacobianFIntqFunction(SALTUS_PENDULUM_PLUGIN, "internal_force_dq");
      ds->setComputeJacobianFIntqDotFunction(SALTUS_PENDULUM_PLUGIN, "internal_force_dv");
    }
    Eigen::MatrixXd by_q(2, 2), by_v(2, 2);
    EXPECT_EQ(ds->computeJacobians(0.0, by_q, by_v), given > 0);
    if (given > 0) {
      EXPECT_EQ(by_q, (Eigen::MatrixXd(2, 2) << 45, 0, 0, 20).finished());
      EXPECT_EQ(by_v, (Eigen::MatrixXd(2, 2) << 0, 0.1, 0, 0.2).finished());
    }
    if (given == 2) {  // a force without derivatives: all are found by differences
      ds->setFGyrPtr(vector({0, 0}));
      EXPECT_FALSE(ds->computeJacobians(0.0, by_q, by_v));
    }
    const auto simulation = simulate(model_of({ds}, 1.0), std::make_shared<sk::MoreauJeanOSI>(), 1e-2);
    simulation->setNewtonTolerance(1e-8);
    for (int step = 0; step < 100; ++step) {
      simulation->advanceToEvent();
      simulation->processEvents();
    }
    ends[given] = (*ds->q())(0);
  }
  EXPECT_NEAR(ends[0], ends[1], 1e-11);
  EXPECT_NEAR(ends[0], ends[2], 1e-11);
}

// y = q − u(t), u = 0.5 t − 1
class RisingFloor : public sk::LagrangianRheonomousR {
 public:
  void computeh(double t, const BlockVector& q, BlockVector&, SiconosVector& y) override {
    y.setValue(0, q(0) - (0.5 * t - 1.0));
  }
  void computehDot(double, const BlockVector&, BlockVector&) override { _hDot->setValue(0, -0.5); }
  void computeJachq(double, const BlockVector&, BlockVector&) override { _jachq->setValue(0, 0, 1.0); }
};

TEST(SiconosNames, AFloorThatRisesLiftsTheBall) {
  const auto ball = std::make_shared<sk::LagrangianLinearTIDS>(vector({0}), vector({0}), matrix(1, 1, {2}));
  ball->setFExtPtr(vector({-20}));
  const auto contact = std::make_shared<sk::Interaction>(std::make_shared<sk::NewtonImpactNSL>(0.0),
                                                         std::make_shared<RisingFloor>());
  const auto nsds = model_of({ball}, 2.0);
  nsds->link(contact, ball);
  const auto simulation = simulate(nsds, nullptr, 1e-3);
  simulation->insertIntegrator(std::make_shared<sk::HalfExplicitTrapezoidalOSI>("activity=sticky"));
  simulation->run();
  EXPECT_NEAR((*ball->velocity())(0), 0.5, 1e-13);
  EXPECT_NEAR((*contact->lambda(1))(0), 20.0 * 1e-3, 1e-14);
  EXPECT_NEAR(simulation->startingTime(), 2.0, 1e-12);
  EXPECT_FALSE(simulation->hasNextEvent());
}

TEST(SiconosNames, MatricesAreWrittenWithEveryDigit) {
  const auto file = std::filesystem::temp_directory_path() / "saltus_names.dat";
  const auto numbers = matrix(2, 2, {0.1, -1.0 / 3.0, 1e-300, 5});
  numbers->resize(3, 2);
  sk::ioMatrix::write(file.string(), "ascii", *numbers);
  std::ifstream in(file);
  std::vector<double> read;
  for (double value; in >> value;) read.push_back(value);
  EXPECT_EQ(read, (std::vector<double>{3, 2, 0.1, -1.0 / 3.0, 1e-300, 5, 0, 0}));
  sk::ioMatrix::write(file.string(), "ascii", *numbers, "noDim");
  EXPECT_EQ(sk::ioMatrix::compareRefFile(*numbers, file.string()), 0.0);
  numbers->setValue(1, 1, 4.5);
  EXPECT_EQ(sk::ioMatrix::compareRefFile(*numbers, file.string()), 0.5);
  numbers->resize(4, 2);
  EXPECT_EQ(sk::ioMatrix::compareRefFile(*numbers, file.string()), -1.0);
  std::filesystem::remove(file);
  EXPECT_EQ(sk::ioMatrix::compareRefFile(*numbers, file.string()), -1.0);
  expect_refusal([&] { sk::ioMatrix::write("x", "binary", *numbers); }, {"'ascii'", "'binary'"});
  expect_refusal([&] { sk::ioMatrix::write("/nowhere/x", "ascii", *numbers); }, {"/nowhere/x"});
}

TEST(SiconosNames, MisuseSaysWhatWasExpected) {
  const auto ball = std::make_shared<sk::LagrangianDS>(vector({1}), vector({0}));
  const auto floor =
      std::make_shared<sk::Interaction>(std::make_shared<sk::NewtonImpactNSL>(0.5),
                                        std::make_shared<sk::LagrangianLinearTIR>(matrix(1, 2, {1, 0})));
  const auto nsds = model_of({}, 1.0);
  expect_refusal([&] { nsds->link(floor, ball); }, {"inserted"});
  nsds->insertDynamicalSystem(ball);
  expect_refusal([&] { nsds->link(floor, ball); }, {"H must be (1, 1)", "got (1, 2)"});
  expect_refusal([&] { simulate(nsds, nullptr, 1e-3)->computeOneStep(); }, {"expected an integrator"});
  expect_refusal([&] { sk::LagrangianDS(vector({1}), vector({0, 1})); }, {"v0 must have 1", "got 2"});
  expect_refusal([&] { ball->p(2); }, {"p(1)", "p(2)"});
  expect_refusal([&] { floor->y(2); }, {"y(2)"});
  expect_refusal([&] { floor->lambda(0); }, {"lambda(0)"});
  expect_refusal([] { sk::FrictionContact(4); }, {"2 or 3", "got 4"});
  expect_refusal([&] { simulate(nsds, nullptr, 1e-3)->setNewtonTolerance(1e-14); }, {"1e-12", "1e-14"});
  ball->setFExtPtr(vector({1, 2}));
  const auto simulation = simulate(nsds, std::make_shared<sk::MoreauJeanOSI>(), 1e-3);
  expect_refusal([&] { simulation->computeOneStep(); }, {"fExt must have 1 entries, got 2"});
  ball->setFExtPtr(vector({1}));
  EXPECT_THROW(simulation->nextStep(), std::logic_error);
  simulation->computeOneStep();
  EXPECT_THROW(simulation->computeOneStep(), std::logic_error);

  const auto undefined = std::make_shared<sk::Interaction>(std::make_shared<sk::NewtonImpactNSL>(0.5),
                                                           std::make_shared<sk::LagrangianScleronomousR>());
  const auto other = model_of({ball}, 1.0);
  other->link(undefined, ball);
  EXPECT_THROW(simulate(other, std::make_shared<sk::MoreauJeanOSI>(), 1e-3)->computeOneStep(),
               std::logic_error);
}

}  // namespace
}  // namespace saltus::test
