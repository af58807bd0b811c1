// Springs, dampers and actuators between systems: motions in closed form, identities, energy.
#include <gtest/gtest.h>

#include <cmath>

#include "saltus/kernel/model/check.hpp"
#include "saltus/kernel/model/distance.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

class ForceElements : public testing::TestWithParam<std::string> {};
using Terms = LagrangianLinearTIDS::Terms;

Matrix row(std::initializer_list<double> values) { return vec(values).transpose(); }
Matrix one(double value) { return Matrix::Constant(1, 1, value); }

std::shared_ptr<const LagrangianLinearTIDS> mass(double m, double x0, double v0, Terms terms = {}) {
  return std::make_shared<LagrangianLinearTIDS>(vec({x0}), vec({v0}), one(m), std::move(terms));
}

std::shared_ptr<const ForceElement> element(Matrix H, ForceLaw law, std::string name = "") {
  return std::make_shared<ForceElement>(std::make_shared<LagrangianLinearTIR>(std::move(H)), std::move(law),
                                        std::move(name));
}

// Three masses on a line: a spring and damper from the third to the first, stiff, a spring to the ground and
// a constant pull on the second; contacts with the ground and between two of them, in either order.
constexpr double k = 4e3, c = 3.0, l0 = 0.3, k_ground = 90.0, pull = 2.5;
const NewtonImpactNSL bounce(0.6);

void link_contacts(NonSmoothDynamicalSystem& model, const std::vector<const LagrangianDS*>& on,
                   const std::vector<Matrix>& H) {
  const double gaps[] = {0.0, -0.1, -0.05};
  const char* names[] = {"ground", "outer", "inner"};
  for (int i = 0; i < 3; ++i)
    model.link(linear_contact(H[i], vec({gaps[i]}), bounce, names[i]), *on[2 * i], on[2 * i + 1]);
}

NonSmoothDynamicalSystem three_systems(bool contacts) {
  const auto a = mass(1.0, 0.1, 0.3, {.external_force = vec({-9.0})});
  const auto b = mass(2.0, 0.2, 0.0), d = mass(0.5, 0.45, -0.2, {.damping = one(0.1)});
  NonSmoothDynamicalSystem model({a, b, d});
  model.add_force(element(row({1.0, -1.0}), SpringDamper(k, c, l0)), *d, a.get());
  model.add_force(element(one(1.0), SpringDamper(k_ground)), *b);
  model.add_force(element(one(-1.0), Actuator(pull)), *b);
  if (contacts)
    link_contacts(model, {a.get(), nullptr, d.get(), a.get(), a.get(), b.get()},
                  {one(1.0), row({1.0, -1.0}), row({-1.0, 1.0})});
  return model;
}

NonSmoothDynamicalSystem one_system(bool contacts) {
  Matrix M = Matrix(vec({1.0, 2.0, 0.5}).asDiagonal()), K(3, 3), C(3, 3);
  K << k, 0, -k, 0, k_ground, 0, -k, 0, k;
  C << c, 0, -c, 0, 0, 0, -c, 0, c + 0.1;
  const auto all = std::make_shared<LagrangianLinearTIDS>(
      vec({0.1, 0.2, 0.45}), vec({0.3, 0.0, -0.2}), M,
      Terms{.stiffness = K, .damping = C, .external_force = vec({-9.0 - k * l0, -pull, k * l0})});
  NonSmoothDynamicalSystem model({all});
  if (contacts)
    link_contacts(model, {all.get(), nullptr, all.get(), nullptr, all.get(), nullptr},
                  {row({1, 0, 0}), row({-1, 0, 1}), row({-1, 1, 0})});
  return model;
}

TEST_P(ForceElements, CoupleSystemsAsAStiffnessMatrixDoes) {
  for (const bool contacts : {false, true}) {
    const auto apart = rows_of_run(three_systems(contacts), *make_scheme(GetParam()), 1e-3, 1.0);
    const auto joined = rows_of_run(one_system(contacts), *make_scheme(GetParam()), 1e-3, 1.0);
    int impacts = 0;
    for (std::size_t i = 0; i < apart.size(); ++i) {
      ASSERT_LE((apart[i].state.q - joined[i].state.q).cwiseAbs().maxCoeff(), 1e-12) << i;
      ASSERT_LE((apart[i].state.v - joined[i].state.v).cwiseAbs().maxCoeff(), 1e-11) << i;
      ASSERT_NEAR(apart[i].report.work_forces, joined[i].report.work_forces, 1e-11) << i;
      if (!contacts) continue;
      ASSERT_LE((apart[i].reactions.impulse - joined[i].reactions.impulse).cwiseAbs().maxCoeff(), 1e-11) << i;
      impacts += apart[i].report.impulsive;
    }
    EXPECT_EQ(impacts > 3, contacts);
  }
}

// Two free masses on a spring: ω = √(k/μ) with the reduced mass μ; their centre moves uniformly.
struct Pair {
  static constexpr double m1 = 1.0, m2 = 3.0, k = 60.0, l0 = 0.5, stretch = 0.1, v = 0.7;
  double omega = std::sqrt(k * (m1 + m2) / (m1 * m2));
  NonSmoothDynamicalSystem model() const {
    const auto first = mass(m1, 0.0, v), second = mass(m2, l0 + stretch, v);
    NonSmoothDynamicalSystem model({first, second});
    model.add_force(element(row({-1.0, 1.0}), SpringDamper(k, 0.0, l0), "spring"), *first, second.get());
    return model;
  }
  State exact(double t) const {
    const double s = stretch * std::cos(omega * t), rate = -omega * stretch * std::sin(omega * t);
    const double centre = m2 / (m1 + m2) * (l0 + stretch) + v * t, a = m2 / (m1 + m2), b = m1 / (m1 + m2);
    return {t, vec({centre - a * (l0 + s), centre + b * (l0 + s)}), vec({v - a * rate, v + b * rate})};
  }
};

TEST_P(ForceElements, TwoMassesOnASpringOscillateWithTheOrderOfTheScheme) {
  const int order = scheme_properties(GetParam()).order_free;
  const std::vector<double> steps =
      order > 3 ? std::vector{1e-2, 5e-3, 2.5e-3} : std::vector{4e-4, 2e-4, 1e-4};
  const Orders orders =
      measure_orders(Pair().model(), *make_scheme(GetParam()), Pair().exact(1.0), 1.0, steps);
  EXPECT_NEAR(orders.q, order, 0.15);
  EXPECT_NEAR(orders.v, order, 0.15);
}

TEST_P(ForceElements, KeepTheMomentum) {
  const double momentum = (Pair::m1 + Pair::m2) * Pair::v;
  for (const Row& row : rows_of_run(Pair().model(), *make_scheme(GetParam()), 1e-2, 1.0))
    ASSERT_NEAR(Pair::m1 * row.state.v[0] + Pair::m2 * row.state.v[1], momentum, 1e-13);
}

// One mass between a damper to the ground and an actuator: m v̇ = −c v + F sin(a t), and x0 e^{−ct/m} alone.
TEST_P(ForceElements, ADamperAndAnActuatorThatDependsOnTime) {
  const double m = 2.0, damping = 3.0, F = 5.0, a = 4.0, until = 0.8, rate = damping / m;
  const auto body = mass(m, 0.0, 1.0);
  NonSmoothDynamicalSystem model({body});
  model.add_force(element(one(1.0), SpringDamper(0.0, damping)), *body);
  model.add_force(element(one(1.0), Actuator([=](double t, double, double) { return F * std::sin(a * t); })),
                  *body);
  const double size = F / m / (rate * rate + a * a), t = until;
  const double v =
      (1.0 + size * a) * std::exp(-rate * t) + size * (rate * std::sin(a * t) - a * std::cos(a * t));
  const double q = (m * (1.0 - v) + F / a * (1.0 - std::cos(a * t))) / damping;  // momentum
  const int order = scheme_properties(GetParam()).order_free;
  const std::vector<double> steps = order > 3 ? std::vector{0.04, 0.02, 0.01} : std::vector{4e-3, 2e-3, 1e-3};
  const Orders orders =
      measure_orders(model, *make_scheme(GetParam()), {t, vec({q}), vec({v})}, until, steps);
  EXPECT_NEAR(orders.q, order, 0.15);
  EXPECT_NEAR(orders.v, order, 0.15);
}

// A point on a spring in the plane, under gravity: nonlinear geometry.
NonSmoothDynamicalSystem spring_pendulum(double stiffness, double damping = 0.0) {
  const auto point =
      std::make_shared<LagrangianLinearTIDS>(vec({0.6, -0.8}), vec({1.0, 0.5}), 2.0 * Matrix::Identity(2, 2),
                                             Terms{.external_force = vec({0, -19.62})});
  NonSmoothDynamicalSystem model({point});
  model.add_force(
      std::make_shared<ForceElement>(std::make_shared<Distance>(Matrix::Identity(2, 2), Vec::Zero(2)),
                                     SpringDamper(stiffness, damping, 0.9), "spring"),
      *point);
  return model;
}

TEST_P(ForceElements, WorksOfElementsExplainTheKineticEnergy) {
  const std::vector<double> dt = {1e-3, 5e-4, 2.5e-4};
  std::vector<double> errors;
  for (double h : dt) {
    double work = 0.0;
    const auto rows = rows_of_run(spring_pendulum(300.0, 4.0), *make_scheme(GetParam()), h, 0.5);
    for (const Row& row : rows) work += row.report.work_forces;
    errors.push_back(std::abs(rows.back().report.kinetic_energy - rows.front().report.kinetic_energy - work));
  }
  const bool identity = *std::max_element(errors.begin(), errors.end()) < 1e-11;  // implicit schemes
  const int order = scheme_properties(GetParam()).order_free;
  EXPECT_TRUE(identity || slope(dt, errors) >= order - 0.2) << errors.back();
}

struct Energies final : Observer {
  void observe(const StepView& view) override {
    total.push_back(view.potential_energy + view.report.kinetic_energy);
  }
  std::vector<double> total;
};

TEST(SpringPendulum, KeepsItsEnergy) {
  for (const char* name : {"HalfExplicitTrapezoidalOSI", "MoreauJeanOSI"}) {
    std::vector<double> drift;
    for (double dt : {1e-3, 5e-4}) {
      TimeStepping simulation(spring_pendulum(300.0), *make_scheme(name), dt);
      const auto energies = std::make_shared<Energies>();
      simulation.add_observer(energies);
      simulation.run(5.0);
      const auto [low, high] = std::minmax_element(energies->total.begin(), energies->total.end());
      EXPECT_NEAR(energies->total[0], 0.5 * 2.0 * 1.25 - 19.62 * 0.8 + 0.5 * 300.0 * 0.01, 1e-12);
      drift.push_back(*high - *low);
    }
    EXPECT_LE(drift[0], 0.02) << name;  // of 2.8 J, over 10 periods: it oscillates, of second order
    EXPECT_NEAR(drift[0] / drift[1], 4.0, 0.4) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, ForceElements, testing::ValuesIn(with_fixed_steps(scheme_names())),
                         [](const auto& test) { return test.param; });

// Counts how often a step asks for the length: twice an iteration, and at the start and the end of a step.
class CountedDistance final : public Relation {
 public:
  CountedDistance() : Relation(1), distance_(Matrix::Identity(2, 2), Vec::Zero(2)) {}
  void gap(const In& q, Out g) const override {
    ++count;
    distance_.gap(q, g);
  }
  void jacobian(const In& q, OutMatrix J) const override { distance_.jacobian(q, J); }
  mutable int count = 0;

 private:
  Distance distance_;
};

// A taut spring whose own stiffness and whose tension are both stiff: (Δt/2)² k/m = 2500. Without the turning
// of W the iteration does not converge at all.
TEST(MoreauJeanWithElements, NewtonConvergesQuadraticallyAlsoInStiffSprings) {
  const auto point =
      std::make_shared<LagrangianLinearTIDS>(vec({0.6, -0.8}), vec({1.0, 0.5}), Matrix::Identity(2, 2));
  const auto relation = std::make_shared<CountedDistance>();
  NonSmoothDynamicalSystem model({point});
  model.add_force(std::make_shared<ForceElement>(relation, SpringDamper(1e8, 0.0, 0.5)), *point);
  TimeStepping simulation(model, *make_integrator("MoreauJeanOSI"), 1e-2);
  relation->count = 0;
  for (int i = 0; i < 100; ++i) simulation.step();
  EXPECT_LE((relation->count - 200) / 2, 6.5 * 100);
}

// Everything linear and time-invariant: one factorisation, however many steps.
TEST(MoreauJeanWithElements, AFactorisationServesAllSteps) {
  struct Counted final : LagrangianDS {
    explicit Counted(double x) : LagrangianDS(vec({x}), vec({0.0})) {}
    void mass(const In&, OutMatrix M) const override { M(0, 0) = 1.0; }
    void forces(double, const In&, const In&, Out) const override {}
    bool constant_mass() const override { return true; }
    bool time_invariant() const override { return true; }
    bool force_jacobians(double, const In&, const In&, OutMatrix, OutMatrix) const override {
      ++count;
      return true;
    }
    mutable int count = 0;
  };
  const auto a = std::make_shared<Counted>(0.0), b = std::make_shared<Counted>(1.0);
  NonSmoothDynamicalSystem model({a, b});
  model.add_force(element(row({-1.0, 1.0}), SpringDamper(1e6)), *a, b.get());
  TimeStepping simulation(model, *make_integrator("MoreauJeanOSI"), 1e-2);
  for (int i = 0; i < 100; ++i) simulation.step();
  EXPECT_EQ(a->count, 1);
  EXPECT_EQ(b->count, 1);
}

// The length of one element is found by a simulation that has elements of its own.
TEST(ForceElementsInside, ARelationMayRunASimulation) {
  struct Nested final : Relation {
    Nested() : Relation(1) {}
    void gap(const In& q, Out g) const override {
      run_to(Pair().model(), *make_integrator("HalfExplicitTrapezoidalOSI"), 1e-2, 0.1);
      g[0] = q[0];
    }
    void jacobian(const In&, OutMatrix J) const override { J(0, 0) = 1.0; }
  };
  const auto body = mass(1.0, 1.0, 0.0);
  auto end = [&](std::shared_ptr<const Relation> relation) {
    NonSmoothDynamicalSystem model({body});
    model.add_force(std::make_shared<ForceElement>(relation, SpringDamper(40.0, 1.0)), *body);
    return run_to(model, *make_integrator("HalfExplicitTrapezoidalOSI"), 1e-2, 0.5).q[0];
  };
  EXPECT_EQ(end(std::make_shared<Nested>()), end(std::make_shared<LagrangianLinearTIR>(one(1.0))));
}

TEST(ForceElementsInside, CheckComparesTheLengthWithItsGradient) {
  struct Wrong final : Relation {
    Wrong() : Relation(1) {}
    void gap(const In& q, Out g) const override { g[0] = q[0] * q[1]; }
    void jacobian(const In& q, OutMatrix J) const override { J << q[1], 2.0 * q[0]; }
  };
  const auto a = mass(1.0, 0.5, 0.0), b = mass(1.0, 0.7, 0.0);
  NonSmoothDynamicalSystem model({a, b});
  model.add_force(element(row({-1.0, 1.0}), SpringDamper(3.0), "right"), *a, b.get());
  model.add_force(std::make_shared<ForceElement>(std::make_shared<Wrong>(), SpringDamper(3.0), "wrong"), *a,
                  b.get());
  int wrong = 0;
  for (const CheckItem& item : check(model)) {
    if (item.ok()) continue;
    ++wrong;
    EXPECT_EQ(item.subject, "wrong");
    EXPECT_EQ(item.quantity, "jacobian against length");
  }
  EXPECT_EQ(wrong, 1);
}

TEST(Distances, AreRelationsOfContactsAndRodsAsWell) {
  const auto point =
      std::make_shared<LagrangianLinearTIDS>(vec({0.3, 0.4}), vec({0.8, -0.6}), Matrix::Identity(2, 2));
  NonSmoothDynamicalSystem model({point});
  model.link(
      std::make_shared<Interaction>(std::make_shared<Distance>(Matrix::Identity(2, 2), Vec::Zero(2), 0.5),
                                    EqualityConditionNSL(1), "rod"),
      *point);
  for (const CheckItem& item : check(model)) EXPECT_TRUE(item.ok()) << item.quantity;
  for (const std::string& name : scheme_names()) {  // uniform rotation: λ = m v²/r
    TimeStepping simulation(model, *make_scheme(name), 1e-4);
    for (int i = 0; i < 100; ++i) simulation.step();
    const Reactions& reactions = simulation.reactions();
    const double force =
        reactions.impulse[0] / 1e-4 + 0.5 * (reactions.lambda_plus + reactions.lambda_minus)[0];
    EXPECT_NEAR(force, -2.0, 1e-3) << name;
  }
}

}  // namespace
}  // namespace saltus::test
