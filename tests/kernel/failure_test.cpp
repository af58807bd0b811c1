// Steps that cannot be taken: a status, nothing changed, and an error that says where.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "saltus/numerics/solvers/registry.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

// Solves like the default until told to fail; then it spoils P as well.
class Failing final : public ContactSolver {
 public:
  explicit Failing(std::shared_ptr<bool> fails) : fails_(std::move(fails)) {}
  std::string_view name() const override { return "failing"; }
  bool accepts(const ContactProblem& problem) const override { return solver_->accepts(problem); }
  void reserve(int rows) override { solver_->reserve(rows); }
  SolveReport solve(const ContactProblem& problem, double* P) override {
    SolveReport report = solver_->solve(problem, P);
    if (*fails_) {
      std::fill_n(P, problem.rows(), 1e300);
      report.status = SolveStatus::breakdown;
      report.certificate.residual = 0.125;
    }
    return report;
  }
  std::unique_ptr<ContactSolver> clone() const override { return std::make_unique<Failing>(fails_); }

 private:
  std::shared_ptr<bool> fails_;
  std::unique_ptr<ContactSolver> solver_ = make_contact_solver("auto");
};

// One freedom whose mass or force goes wrong beyond q = 1.
struct Breaking final : LagrangianDS {
  Breaking(double bad_mass, double bad_force)
      : LagrangianDS(Vec::Zero(1), Vec::Ones(1)), bad_mass_(bad_mass), bad_force_(bad_force) {}
  void mass(const In& q, OutMatrix M) const override { M(0, 0) = q[0] > 1.0 ? bad_mass_ : 1.0; }
  void forces(double, const In& q, const In&, Out h) const override { h[0] = q[0] > 1.0 ? bad_force_ : 0.0; }
  double bad_mass_, bad_force_;
};

class Failure : public testing::TestWithParam<std::string> {
 protected:
  // Runs until a step fails; expects this status and the state of the step before.
  void expect_failure(const NonSmoothDynamicalSystem& model, double dt, StepStatus status) {
    TimeStepping simulation(model, *make_scheme(GetParam()), dt);
    State last = simulation.state();
    bool failed = false;
    for (int k = 0; k < 100000 && !failed; ++k) {
      last = simulation.state();
      try {
        simulation.step();
      } catch (const SimulationError& error) {
        failed = true;
        EXPECT_EQ(error.report().status, status);
        EXPECT_EQ(error.time(), last.t);
        EXPECT_EQ(error.step(), simulation.steps() + 1);
        EXPECT_NE(std::string(error.what()).find(to_string(status)), std::string::npos) << error.what();
      }
    }
    ASSERT_TRUE(failed);
    EXPECT_EQ(simulation.state().t, last.t);
    EXPECT_TRUE(same_bits(simulation.state().q, last.q));
    EXPECT_TRUE(same_bits(simulation.state().v, last.v));
    EXPECT_TRUE(simulation.state().q.allFinite() && simulation.state().v.allFinite());
    EXPECT_THROW(simulation.run(simulation.state().t + 10.0 * dt), SimulationError);  // and it stays so
  }
};

TEST_P(Failure, AStepThatFailsLeavesStateAndReactionsUntouched) {
  if (scheme_properties(GetParam()).error_controlled && GetParam() != "EventDrivenOSI")
    GTEST_SKIP() << "it has computed beyond the state";
  const auto fails = std::make_shared<bool>(false);
  Failing solver(fails);
  const auto model = make_bowl(mu_taken_by(GetParam(), 0.3));
  const auto scheme = make_scheme(GetParam());
  scheme->prepare(model, solver);
  State state{0.0, model.q0(), model.v0()};
  Reactions reactions;
  reactions.set_zero(2);
  for (int k = 0; k < 10; ++k) ASSERT_EQ(scheme->step(1e-3, state, reactions).status, StepStatus::ok);
  const State before = state;
  const Reactions forces = reactions;
  *fails = true;
  const StepReport report = scheme->step(1e-3, state, reactions);
  EXPECT_EQ(report.status, StepStatus::solver_failed);
  EXPECT_DOUBLE_EQ(report.residual, 0.125);
  EXPECT_EQ(state.t, before.t);
  EXPECT_TRUE(same_bits(state.q, before.q) && same_bits(state.v, before.v));
  EXPECT_TRUE(same_bits(reactions.lambda_plus, forces.lambda_plus));
  EXPECT_TRUE(same_bits(reactions.lambda_minus, forces.lambda_minus));
  EXPECT_TRUE(same_bits(reactions.impulse, forces.impulse));
  // The step can be tried again and is then what it would have been without the failure.
  *fails = false;
  State undisturbed = before;
  Reactions others = forces;
  const auto fresh = make_scheme(GetParam());
  Failing working(std::make_shared<bool>(false));
  fresh->prepare(model, working);
  ASSERT_EQ(fresh->step(1e-3, undisturbed, others).status, StepStatus::ok);
  ASSERT_EQ(scheme->step(1e-3, state, reactions).status, StepStatus::ok);
  EXPECT_TRUE(same_bits(state.q, undisturbed.q) && same_bits(state.v, undisturbed.v));
}

// An implicit scheme does not diverge on a stiff spring.
class Divergence : public Failure {};

TEST_P(Divergence, ADivergingRunEndsInAnErrorAtTheLastFiniteState) {
  // Stages that are found together diverge within the first step.
  const bool iterates = GetParam() == "DMinusGalerkinOSI" || GetParam() == "GalerkinChebyshev";
  expect_failure(make_oscillator(1e4, 1.0, 0.0), 1e-2,
                 iterates ? StepStatus::iteration_failed : StepStatus::not_finite);
}

TEST_P(Divergence, ADivergingRunWithClosedContactsToo) {
  // The spring acts along the plane; the contact problem meets the infinite velocity first.
  expect_failure(make_friction_oscillator(1.0, mu_taken_by(GetParam(), 0.1), 1e12), 1e-2,
                 StepStatus::not_finite);
}

TEST_P(Failure, AMassThatIsNoLongerPositiveDefinite) {
  expect_failure(NonSmoothDynamicalSystem({std::make_shared<Breaking>(-1.0, 0.0)}), 0.1,
                 StepStatus::mass_not_positive_definite);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_failure(NonSmoothDynamicalSystem({std::make_shared<Breaking>(nan, 0.0)}), 0.1,
                 StepStatus::mass_not_positive_definite);
}

TEST_P(Failure, AForceThatIsNoNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_failure(NonSmoothDynamicalSystem({std::make_shared<Breaking>(1.0, nan)}), 0.1,
                 StepStatus::not_finite);
}

TEST_P(Failure, ADirectionThatIsNoNumberNamesItsContact) {
  auto point =
      std::make_shared<LagrangianLinearTIDS>(vec({0.0, 0.0}), vec({0.0, 1.0}), Matrix::Identity(2, 2));
  NonSmoothDynamicalSystem model({point});
  struct Losing final : Relation {  // its direction is lost once the second freedom has moved on
    Losing() : Relation(1) {}
    void gap(const In&, Out) const override {}
    void jacobian(const In& q, OutMatrix J) const override {
      J(0, 0) = 1.0;
      J(0, 1) = q[1] > 0.05 ? std::numeric_limits<double>::quiet_NaN() : 0.0;
    }
    void curvature(const In&, const In&, Out) const override {}
    bool has_curvature() const override { return true; }
  };
  model.link(std::make_shared<Interaction>(std::make_shared<Losing>(), EqualityConditionNSL(1), "rail"),
             *point);
  TimeStepping simulation(model, *make_scheme(GetParam()), 0.01);
  try {
    simulation.run(1.0);
    FAIL() << "a NaN in W went unnoticed";
  } catch (const SimulationError& error) {
    EXPECT_EQ(error.contacts(), std::vector<std::string>{"rail"});
    EXPECT_NE(std::string(error.what()).find("rail"), std::string::npos) << error.what();
    EXPECT_NEAR(error.time(), 0.05, 0.015);
  }
  EXPECT_TRUE(simulation.state().v.allFinite());
}

INSTANTIATE_TEST_SUITE_P(Schemes, Failure, testing::ValuesIn(and_accurate_ones(scheme_names())),
                         [](const auto& test) { return test.param; });
INSTANTIATE_TEST_SUITE_P(Schemes, Divergence, testing::ValuesIn(with_fixed_steps(explicit_schemes())),
                         [](const auto& test) { return test.param; });

TEST(StepStatus, HasASentenceEach) {
  EXPECT_EQ(to_string(StepStatus::ok), "ok");
  EXPECT_NE(to_string(StepStatus::solver_failed).find("solver"), std::string_view::npos);
  EXPECT_NE(to_string(StepStatus::mass_not_positive_definite).find("mass"), std::string_view::npos);
  EXPECT_NE(to_string(StepStatus::not_finite).find("finite"), std::string_view::npos);
}

}  // namespace
}  // namespace saltus::test
