// The elastic bar of Section 6.1: the kernel against a loop that knows this bar alone, and momentum.
// Figures 13 to 15 are reproduced in Python.
#include "elastic_bar/elastic_bar.hpp"

#include <gtest/gtest.h>

#include "elastic_bar/bare_loop.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

constexpr double dt = 1e-7, damping = 4.762e-9;  // [s]

TEST(ElasticBar, MovesAsTheLoopWrittenByHand) {
  const examples::ElasticBarParameters p;
  for (int elements : {2, 50, 200})
    for (double delta : {0.0, damping}) {
      const State end = run_to(examples::make_elastic_bar(elements, delta),
                               *make_integrator("HalfExplicitTrapezoidalOSI"), dt, 1e-3);
      examples::BareElasticBar bare(elements, delta);
      bare.run(dt, 10000);
      EXPECT_LT((end.q - bare.q()).cwiseAbs().maxCoeff(), 1e-12 * p.gap) << elements;
      EXPECT_LT((end.v - bare.v()).cwiseAbs().maxCoeff(), 1e-10 * p.speed) << elements;
      EXPECT_GT(end.v[0], 0.0) << elements;  // it has left
    }
}

TEST(ElasticBar, ItsMomentumComesFromTheObstacle) {
  const examples::ElasticBarParameters p;
  const auto model = examples::make_elastic_bar(50, damping);
  const double mass = p.density * p.section * p.length;
  Matrix M(51, 51);
  const Vec q0 = model.q0();
  model.systems()[0]->mass(In(q0.data(), 51), {M.data(), 51, 51});
  EXPECT_NEAR(M.sum(), mass, 1e-13 * mass);
  double pressed = 0.0;  // [N s]
  int impacts = 0;
  for (const Row& row : rows_of_run(model, *make_integrator("HalfExplicitTrapezoidalOSI"), dt, 1e-3)) {
    pressed += row.reactions.impulse[0] + dt * row.reactions.force[0];
    impacts += row.report.impulsive;
    EXPECT_NEAR((M * row.state.v).sum(), pressed - mass * p.speed, 1e-11 * mass * p.speed) << row.state.t;
  }
  EXPECT_EQ(impacts, 1);
}

TEST(ElasticBar, RefusesWhatIsNoBar) {
  expect_refusal([] { examples::make_elastic_bar(0); }, {"elements must be at least 1, got 0"});
  expect_refusal([] { examples::make_elastic_bar(5, -1.0); },
                 {"damping must be finite and at least 0, got -1"});
  expect_refusal([] { examples::BareElasticBar(5); }, {"elements must be even and positive, got 5"});
}

}  // namespace
}  // namespace saltus::test
