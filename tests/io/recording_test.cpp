// What a recording keeps of a run.
#include "saltus/io/recording.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

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

// What a run leaves in its chunks, put together again.
std::vector<long> steps_of_chunks(std::shared_ptr<Recording> recording, long rows, double seconds,
                                  std::vector<long>& sizes) {
  TimeStepping simulation(crank(), *make_integrator("HalfExplicitTrapezoidalOSI"), 1e-4);
  simulation.add_observer(recording);
  std::vector<long> steps;
  recording->stream(
      [&](const Recording& chunk) {
        EXPECT_EQ(chunk.handed_on(), static_cast<long>(steps.size()));
        EXPECT_EQ(chunk.q.size(), 3 * chunk.step.size());
        steps.insert(steps.end(), chunk.step.begin(), chunk.step.end());
        sizes.push_back(chunk.rows());
      },
      rows, seconds);
  simulation.run(0.1);
  recording->flush();
  return steps;
}

TEST(Recording, HandsItsRowsOnInChunksAndForgetsThem) {
  const auto whole = record(crank(), 3, 1e-4, 0.1);
  const auto streamed = std::make_shared<Recording>(3);
  std::vector<long> sizes;
  EXPECT_EQ(steps_of_chunks(streamed, 100, 1e9, sizes), whole->step);
  for (std::size_t k = 0; k + 1 < sizes.size(); ++k) EXPECT_EQ(sizes[k], 100);
  EXPECT_LE(sizes.back(), 100);
  EXPECT_EQ(streamed->rows(), 0);
  EXPECT_EQ(streamed->handed_on(), whole->rows());
  EXPECT_LE(streamed->q.capacity(), 3u * 256);  // memory is that of a chunk
}

TEST(Recording, HandsItsRowsOnWhenTimeHasPassed) {
  std::vector<long> sizes;
  EXPECT_EQ(steps_of_chunks(std::make_shared<Recording>(), 1000000, 1e-12, sizes).size(), 1001u);
  EXPECT_GT(sizes.size(), 900u);
}

TEST(Recording, KeepsTheRowsThatTheSinkDidNotTake) {
  TimeStepping simulation(crank(), *make_integrator("HalfExplicitTrapezoidalOSI"), 1e-4);
  const auto recording = std::make_shared<Recording>();
  simulation.add_observer(recording);
  bool full = true;
  std::vector<long> taken;
  recording->stream(
      [&](const Recording& chunk) {
        if (full) throw std::runtime_error("disk full");
        taken = chunk.step;
      },
      10, 1e9);
  EXPECT_THROW(simulation.run(0.1), std::runtime_error);
  EXPECT_EQ(simulation.steps(), 9);
  EXPECT_EQ(recording->rows(), 10);
  full = false;
  recording->flush();
  EXPECT_EQ(taken.size(), 10u);
  EXPECT_EQ(recording->rows(), 0);
}

TEST(Recording, RefusesChunksWithoutRowsTimeOrSink) {
  Recording recording;
  const Recording::Sink sink = [](const Recording&) {};
  expect_refusal([&] { recording.stream(nullptr, 1, 1.0); }, {"stream", "sink", "got none"});
  expect_refusal([&] { recording.stream(sink, 0, 1.0); }, {"rows", "at least 1", "got 0"});
  for (double seconds : {0.0, -1.0, std::nan("")})
    expect_refusal([&] { recording.stream(sink, 1, seconds); }, {"seconds", "positive", "got"});
}

TEST(Recording, EveryColumnIsListedOnce) {
  const auto r = record(crank(), 1, 1e-3, 1e-2);
  std::set<std::string_view> names;
  for (const Column& column : run_columns()) {
    names.insert(column.name);
    const long size =
        std::visit([&](auto member) { return static_cast<long>(((*r).*member).size()); }, column.values);
    const std::map<Column::Width, long> width = {{Column::Width::one, 1},
                                                 {Column::Width::coordinates, 3},
                                                 {Column::Width::freedoms, 3},
                                                 {Column::Width::gaps, 4},
                                                 {Column::Width::rows, 8}};
    EXPECT_EQ(size, r->rows() * width.at(column.width)) << column.name;
  }
  EXPECT_EQ(names.size(), run_columns().size());
}

TEST(Recording, RefusesAnIntervalBelowOne) {
  for (long every : {0L, -1L})
    expect_refusal([=] { Recording recording(every); }, {"record_every", "at least 1", "got"});
}

}  // namespace
}  // namespace saltus::test
