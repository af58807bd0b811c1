// Same input, same bits: no run depends on another one, on how it was cut, or on what ran before.
#include <gtest/gtest.h>

#include "saltus/kernel/assembly/layout.hpp"
#include "saltus/numerics/solvers/registry.hpp"
#include "slider_crank/slider_crank.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

class Determinism : public testing::TestWithParam<std::string> {
 protected:
  NonSmoothDynamicalSystem crank_ = examples::make_slider_crank(guidance_for(GetParam()));
};

void expect_same(const TimeStepping& a, const TimeStepping& b) {
  EXPECT_EQ(a.steps(), b.steps());
  EXPECT_EQ(a.state().t, b.state().t);
  EXPECT_TRUE(same_bits(a.state().q, b.state().q));
  EXPECT_TRUE(same_bits(a.state().v, b.state().v));
  EXPECT_TRUE(same_bits(a.reactions().lambda_plus, b.reactions().lambda_plus));
  EXPECT_TRUE(same_bits(a.reactions().lambda_minus, b.reactions().lambda_minus));
  EXPECT_TRUE(same_bits(a.reactions().force, b.reactions().force));
  EXPECT_TRUE(same_bits(a.reactions().impulse, b.reactions().impulse));
  EXPECT_EQ(a.report().residual, b.report().residual);
}

TEST_P(Determinism, TwoRunsAreEqualToTheBit) {
  const auto scheme = make_scheme(GetParam());
  TimeStepping first(crank_, *scheme, 1e-4), second(crank_, *make_scheme(GetParam()), 1e-4);
  first.run(0.1);
  second.run(0.1);
  expect_same(first, second);
}

TEST_P(Determinism, ARunThatGoesOnFromACheckpointIsTheRunInOnePiece) {
  TimeStepping whole(crank_, *make_scheme(GetParam()), 1e-4);
  Checkpoint reached;
  for (double until : {0.0021, 0.0133, 0.04}) {
    TimeStepping part(crank_, *make_scheme(GetParam()), 1e-4);
    if (reached.step > 0) part.restore(reached);
    part.run(until);
    reached = part.checkpoint();
  }
  TimeStepping last(crank_, *make_scheme(GetParam()), 1e-4);
  last.restore(reached);
  whole.run(0.06);
  last.run(0.06);
  expect_same(whole, last);
}

TEST_P(Determinism, ARunInPiecesIsTheRunInOnePiece) {
  const auto scheme = make_scheme(GetParam());
  TimeStepping whole(crank_, *scheme, 1e-4), pieces(crank_, *scheme, 1e-4);
  whole.run(0.1);
  for (double until : {0.013, 0.01301, 0.05, 0.1}) pieces.run(until);
  expect_same(whole, pieces);
}

TEST_P(Determinism, SimulationsFromOneIntegratorAreIndependent) {
  // Interleaved step by step, with different models, from one integrator object and one solver.
  const auto scheme = make_scheme(GetParam());
  const auto bowl = make_bowl(mu_taken_by(GetParam(), 0.3));
  TimeStepping crank_alone(crank_, *scheme, 1e-4), bowl_alone(bowl, *scheme, 1e-3);
  for (int k = 0; k < 500; ++k) crank_alone.step();
  for (int k = 0; k < 500; ++k) bowl_alone.step();
  TimeStepping crank(crank_, *scheme, 1e-4), slider(bowl, *scheme, 1e-3);
  for (int k = 0; k < 500; ++k) {
    crank.step();
    slider.step();
  }
  expect_same(crank_alone, crank);
  expect_same(bowl_alone, slider);
}

TEST_P(Determinism, APreparedIntegratorCanBeCloned) {
  const auto scheme = make_scheme(GetParam());
  TimeStepping first(crank_, *scheme, 1e-4);
  first.run(0.01);
  TimeStepping second(crank_, first.integrator(), 1e-4, first.solver());
  TimeStepping fresh(crank_, *scheme, 1e-4);
  second.run(0.05);
  fresh.run(0.05);
  expect_same(second, fresh);
}

TEST_P(Determinism, StateAndReactionsAreAllThatAStepNeeds) {
  if (scheme_properties(GetParam()).error_controlled && GetParam() != "EventDrivenOSI")
    GTEST_SKIP() << "it has computed beyond the state";
  // A copy of the integrator that has taken no step goes on from them: what a checkpoint has to keep.
  const auto one = make_scheme(GetParam()), two = make_scheme(GetParam());
  const auto solver = make_contact_solver("auto"), other = make_contact_solver("auto");
  one->prepare(crank_, *solver);
  State state{0.0, crank_.q0(), crank_.v0()};
  Reactions reactions;
  reactions.set_zero(Layout(crank_).rows);
  for (int k = 0; k < 471; ++k) one->step(1e-4, state, reactions);
  State kept = state;
  Reactions kept_reactions = reactions;
  two->prepare(crank_, *other);
  for (int k = 0; k < 300; ++k) {
    one->step(1e-4, state, reactions);
    two->step(1e-4, kept, kept_reactions);
    ASSERT_TRUE(same_bits(state.q, kept.q)) << k;
    ASSERT_TRUE(same_bits(state.v, kept.v)) << k;
    ASSERT_TRUE(same_bits(reactions.force, kept_reactions.force)) << k;
  }
}

TEST_P(Determinism, SystemsWithoutContactDoNotDisturbEachOther) {
  // Two double pendulums in one model move as one alone.
  const auto scheme = make_scheme(GetParam());
  const auto single = make_double_pendulum();
  const NonSmoothDynamicalSystem both(
      {single.systems()[0], std::make_shared<DoublePendulum>(single.q0(), single.v0())});
  const State alone = run_to(single, *scheme, 1e-3, 1.0), together = run_to(both, *scheme, 1e-3, 1.0);
  EXPECT_TRUE(same_bits(alone.q, together.q.head(2)));
  EXPECT_TRUE(same_bits(alone.v, together.v.tail(2)));
}

INSTANTIATE_TEST_SUITE_P(Schemes, Determinism, testing::ValuesIn(and_accurate_ones(scheme_names())),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace saltus::test
