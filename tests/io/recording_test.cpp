// What a recording keeps of a run.
#include "saltus/io/recording.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "slider_crank/slider_crank.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

std::shared_ptr<Recording> record(const NonSmoothDynamicalSystem& model, long every, double dt,
                                  double until) {
  TimeStepping simulation(model, *make_integrator("HalfExplicitTrapezoidalOSI"), dt);
  auto recording = std::make_shared<Recording>(every);
  simulation.add_observer(recording);
  simulation.run(until);
  return recording;
}

NonSmoothDynamicalSystem crank() { return examples::make_slider_crank(examples::Guidance::frictional); }

TEST(Recording, RowZeroIsTheInitialState) {
  const auto r = record(crank(), 1, 1e-4, 1e-3);
  EXPECT_EQ(r->t[0], 0.0);
  EXPECT_EQ(r->step[0], 0);
  EXPECT_EQ(std::vector<double>(r->q.begin(), r->q.begin() + 3), (std::vector<double>{0.0, 0.0, 0.0}));
  EXPECT_EQ(std::vector<double>(r->v.begin(), r->v.begin() + 3), (std::vector<double>{150.0, -75.0, 0.0}));
  for (int k = 0; k < 8; ++k) EXPECT_EQ(r->lambda_plus[k] + r->lambda_minus[k] + r->impulse[k], 0.0);
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(r->gaps[k], 1e-3, 1e-15);  // the clearance on all sides
  EXPECT_NEAR(r->kinetic_energy[0] + r->potential_energy[0], 7.49554875, 1e-8);
  EXPECT_EQ(r->closed[0], 0);
  EXPECT_EQ(r->impulsive[0], 0);
  EXPECT_EQ(r->work_forces[0] + r->work_lambda[0] + r->work_impulse[0], 0.0);
}

TEST(Recording, EveryColumnHasItsSize) {
  const auto r = record(crank(), 3, 1e-4, 0.05);
  const std::size_t rows = r->rows();
  ASSERT_GT(rows, 100u);
  for (const auto* column : {&r->q, &r->v}) EXPECT_EQ(column->size(), 3 * rows);
  EXPECT_EQ(r->gaps.size(), 4 * rows);
  for (const auto* column : {&r->velocities, &r->lambda_plus, &r->lambda_minus, &r->impulse})
    EXPECT_EQ(column->size(), 8 * rows);
  for (const auto* column : {&r->residual, &r->penetration, &r->kinetic_energy, &r->potential_energy,
                             &r->work_forces, &r->work_lambda, &r->work_impulse})
    EXPECT_EQ(column->size(), rows);
  EXPECT_EQ(r->step.size(), rows);
  EXPECT_EQ(r->closed.size(), rows);
  EXPECT_EQ(r->impulsive.size(), rows);
}

TEST(Recording, KeepsEveryNthRowAndAllImpulsiveSteps) {
  const auto all = record(crank(), 1, 1e-4, 0.1), some = record(crank(), 7, 1e-4, 0.1);
  EXPECT_EQ(all->rows(), 1001);
  std::vector<long> expected;
  int off_beat = 0;
  for (long k = 0; k < all->rows(); ++k) {
    EXPECT_EQ(all->step[k], k);
    if (k % 7 != 0 && !all->impulsive[k]) continue;
    expected.push_back(k);
    off_beat += k % 7 != 0;
  }
  EXPECT_EQ(some->step, expected);
  EXPECT_GT(off_beat, 3);
  for (std::size_t row = 0; row < expected.size(); ++row) {
    const long k = expected[row];
    EXPECT_EQ(some->t[row], all->t[k]);
    EXPECT_EQ(some->q[3 * row + 1], all->q[3 * k + 1]);
    EXPECT_EQ(some->velocities[8 * row + 3], all->velocities[8 * k + 3]);
    EXPECT_EQ(some->impulse[8 * row], all->impulse[8 * k]);
    EXPECT_EQ(some->work_impulse[row], all->work_impulse[k]);
  }
}

TEST(Recording, ReactionsStandInTheRowsOfTheirContacts) {
  const auto r = record(crank(), 1, 1e-4, 0.1);
  int impacts = 0;
  for (long k = 1; k < r->rows(); ++k)
    for (int c = 0; c < 4; ++c) {
      const double normal = r->impulse[8 * k + 2 * c], tangential = r->impulse[8 * k + 2 * c + 1];
      if (r->gaps[4 * k + c] > 0.0) {
        EXPECT_EQ(normal, 0.0);
      }
      EXPECT_LE(std::abs(tangential), 0.01 * normal + 1e-15);
      impacts += normal > 0.0;
    }
  EXPECT_GT(impacts, 3);
}

TEST(Recording, RefusesAnIntervalBelowOne) {
  for (long every : {0L, -1L})
    expect_refusal([=] { Recording recording(every); }, {"record_every", "at least 1", "got"});
}

}  // namespace
}  // namespace saltus::test
