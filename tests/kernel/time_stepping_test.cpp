// The loop: how many steps, which rows observers see, the energy of the first row.
#include <gtest/gtest.h>

#include <cmath>

#include "saltus/numerics/solvers/registry.hpp"
#include "slider_crank/slider_crank.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

const char* const scheme_name = "HalfExplicitTrapezoidalOSI";

TimeStepping falling(double dt, double t0 = 0.0) {
  const auto ball = make_ball(1.0, 0.0, 0.5);
  return TimeStepping(NonSmoothDynamicalSystem(ball.systems(), t0), *make_integrator(scheme_name), dt);
}

long steps_of(double dt, double until, double t0 = 0.0) {
  TimeStepping simulation = falling(dt, t0);
  simulation.run(until);
  return simulation.steps();
}

TEST(Run, TakesAllStepsUpToTheEndAndNoShortenedOne) {
  EXPECT_EQ(steps_of(0.005, 10.0), 2000);
  EXPECT_EQ(steps_of(0.1, 1.0), 10);  // 10 · 0.1 is above 1 when summed up
  EXPECT_EQ(steps_of(0.1, 0.3), 3);   // 3 · 0.1 > 0.3 in binary
  EXPECT_EQ(steps_of(0.1, 0.7), 7);
  EXPECT_EQ(steps_of(1e-5, 0.1), 10000);
  EXPECT_EQ(steps_of(0.3, 1.0), 3);
  EXPECT_EQ(steps_of(0.1, 0.0), 0);
  EXPECT_EQ(steps_of(0.1, -1.0), 0);
  EXPECT_EQ(steps_of(0.1, 0.0, -1.0), 10);  // negative times count like others
  EXPECT_EQ(steps_of(0.1, 5.0, 4.0), 10);
}

TEST(Run, TimesAreMultiplesOfTheStep) {
  TimeStepping simulation = falling(0.1);
  simulation.run(100.0);
  EXPECT_EQ(simulation.steps(), 1000);
  EXPECT_EQ(simulation.state().t, 1000 * 0.1);  // a sum of roundings would be 1e-12 off
}

TEST(Run, ASecondRunContinuesTheFirst) {
  TimeStepping simulation = falling(0.1);
  simulation.run(0.5);
  EXPECT_EQ(simulation.steps(), 5);
  simulation.run(0.5);
  EXPECT_EQ(simulation.steps(), 5);
  simulation.run(1.0);
  EXPECT_EQ(simulation.steps(), 10);
  EXPECT_NEAR(simulation.state().v[0], -gravity, 1e-13);
}

struct Listener final : Observer {
  bool wants(long number, const StepReport&) const override { return number % every == 0; }
  void observe(const StepView& view) override {
    steps.push_back(view.step);
    gaps.push_back(view.gaps[0]);
    velocities.push_back(view.velocities[0]);
    energies.push_back(view.report.kinetic_energy + view.potential_energy);
    impulses.push_back(view.reactions.impulse[0]);
  }
  long every = 1;
  std::vector<long> steps;
  std::vector<double> gaps, velocities, energies, impulses;
};

TEST(Observers, SeeRowZeroAndTheRowsTheyWant) {
  TimeStepping simulation(make_ball(1.0, -0.5, 0.5), *make_integrator(scheme_name), 0.01);
  auto all = std::make_shared<Listener>(), some = std::make_shared<Listener>();
  some->every = 5;
  simulation.add_observer(all);
  simulation.add_observer(some);
  simulation.run(0.1);
  EXPECT_EQ(all->steps, (std::vector<long>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
  EXPECT_EQ(some->steps, (std::vector<long>{0, 5, 10}));
  EXPECT_EQ(some->gaps[1], all->gaps[5]);
  for (std::size_t k = 0; k < all->steps.size(); ++k) {
    const double t = 0.01 * all->steps[k];
    EXPECT_NEAR(all->gaps[k], 1.0 - 0.5 * t - 0.5 * gravity * t * t, 1e-14);
    EXPECT_NEAR(all->velocities[k], -0.5 - gravity * t, 1e-14);
    // ½ m v² + m g q: exact for the trapezoidal rule in a constant field
    EXPECT_NEAR(all->energies[k], 0.25 + 2.0 * gravity, 1e-13);
    EXPECT_EQ(all->impulses[k], 0.0);
  }
}

TEST(Observers, AddedLateSeeOnlyWhatFollows) {
  TimeStepping simulation(make_ball(1.0, 0.0, 0.5), *make_integrator(scheme_name), 0.01);
  simulation.step();
  auto listener = std::make_shared<Listener>();
  simulation.add_observer(listener);
  EXPECT_TRUE(listener->steps.empty());
  simulation.step();
  EXPECT_EQ(listener->steps, std::vector<long>{2});
}

TEST(Progress, IsReportedAndMayEndTheRun) {
  TimeStepping simulation = falling(1e-3);
  int calls = 0;
  simulation.set_progress([&](double t) {
    ++calls;
    EXPECT_EQ(t, simulation.state().t);
  });
  simulation.run(10.0);
  EXPECT_GE(calls, 10);
  EXPECT_LE(calls, 100);
  struct Stop {};
  simulation.set_progress([](double) { throw Stop{}; });
  EXPECT_THROW(simulation.run(20.0), Stop);
  const long stopped = simulation.steps();
  EXPECT_LT(stopped, 11000);
  simulation.set_progress(nullptr);
  simulation.run(20.0);
  EXPECT_EQ(simulation.steps(), 20000);
  EXPECT_NEAR(simulation.state().v[0], -gravity * 20.0, 1e-10);
}

TEST(Links, LaterOnesAreNotSeen) {
  auto model = make_ball(1.0, 0.0, 0.5);
  TimeStepping simulation(model, *make_integrator(scheme_name), 0.01);
  model.link(linear_contact(Matrix::Identity(1, 1), vec({-0.9}), NewtonImpactNSL(0.0), "higher"),
             *model.systems()[0]);
  simulation.run(0.2);
  EXPECT_EQ(simulation.reactions().impulse.size(), 1);
  EXPECT_NEAR(simulation.state().v[0], -gravity * 0.2, 1e-13);
}

TEST(Links, NamesAreGivenWhereNoneIs) {
  auto model = make_ball(1.0, 0.0, 0.5);
  for (int k = 0; k < 2; ++k)
    model.link(linear_contact(Matrix::Identity(1, 1), vec({1.0}), NewtonImpactNSL(0.0), ""),
               *model.systems()[0]);
  EXPECT_EQ(model.links()[0].name, "floor");
  EXPECT_EQ(model.links()[1].name, "contact1");
  EXPECT_EQ(model.links()[2].name, "contact2");
}

TEST(Start, ReportsTheInitialStateAndItsContacts) {
  TimeStepping simulation(make_ball(-1e-3, 3.0, 0.5), *make_integrator(scheme_name), 0.01);
  EXPECT_DOUBLE_EQ(simulation.report().kinetic_energy, 9.0);
  EXPECT_DOUBLE_EQ(simulation.report().penetration, 1e-3);
  EXPECT_EQ(simulation.report().closed, 1);
  EXPECT_EQ(simulation.reactions().impulse, Vec::Zero(1));
  EXPECT_EQ(simulation.steps(), 0);
}

TEST(Start, TheSolverCanBeChosen) {
  for (const char* name : {"auto", "enumeration", "nsgs", "semismooth-newton"}) {
    TimeStepping simulation(examples::make_slider_crank(examples::Guidance::frictional),
                            *make_integrator(scheme_name), 1e-4, *make_contact_solver(name));
    EXPECT_EQ(simulation.solver().name(), name);
  }
}

}  // namespace
}  // namespace saltus::test
