// Rigid bodies: every scheme on motions in space that are known, contacts and joints against their own gaps.
#include <gtest/gtest.h>

#include <cmath>

#include "saltus/kernel/model/bodies/contacts.hpp"
#include "saltus/kernel/model/bodies/joint.hpp"
#include "saltus/kernel/model/check.hpp"
#include "support/body_models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

constexpr double pi = 3.14159265358979323846;
const Vec identity = vec({1, 0, 0, 0});

Vec pose(std::initializer_list<double> x, const Vec& p) {
  Vec q(7);
  q << vec(x), p / p.norm();
  return q;
}

std::shared_ptr<NewtonEulerDS> body(const Vec& q, const Vec& v, BodyLoads loads = {}) {
  return std::make_shared<NewtonEulerDS>(q, v, 2.0, Mat3(Vec3(0.3, 0.4, 0.6).asDiagonal()), loads);
}

class BodyOrder : public testing::TestWithParam<std::string> {
 protected:
  void expect(const NonSmoothDynamicalSystem& model, const State& exact, int claimed, int coarsest) const {
    std::vector<double> steps;
    for (int k : {1, 2, 4}) steps.push_back(exact.t / (coarsest * k));
    const Orders orders = measure_orders(model, *make_scheme(GetParam()), exact, exact.t, steps);
    EXPECT_GE(orders.q, claimed - 0.2);
    EXPECT_GE(orders.v, claimed - 0.2);
  }
  SchemeProperties properties() const { return scheme_properties(GetParam()); }
};

TEST_P(BodyOrder, Tumbling) {
  const int order = properties().order_free;
  expect(make_tumbling_body(), exact_tumbling_body(1.0), order, order > 5 ? 8 : order > 3 ? 16 : 100);
}

TEST_P(BodyOrder, EnergyAndAngularMomentumOfATumblingBody) {
  const auto model = make_tumbling_body();
  const int order = properties().order_free, coarsest = order > 3 ? 16 : 100;
  const Vec3 inertia(1.0, 2.0, 3.5);
  const auto angular = [&](const State& s) {
    return Vec3(rotation_of(s.q.data() + 3) * inertia.cwiseProduct(Vec3(s.v.tail<3>())));
  };
  const auto energy = [&](const State& s) { return 0.5 * inertia.dot(Vec3(s.v.tail<3>()).cwiseAbs2()); };
  const State start{0.0, model.q0(), model.v0()};
  std::vector<double> steps, energies, momenta;
  for (int k : {1, 2, 4}) {
    steps.push_back(1.0 / (coarsest * k));
    const State end = run_to(model, *make_scheme(GetParam()), steps.back(), 1.0);
    energies.push_back(std::abs(energy(end) - energy(start)));
    momenta.push_back((angular(end) - angular(start)).norm());
  }
  EXPECT_GE(slope(steps, momenta), order - 0.2);
  if (energies.front() > 1e-11) {  // the theta rule keeps it
    EXPECT_GE(slope(steps, energies), order - 0.2);
  }
}

TEST_P(BodyOrder, ATopOnABallJoint) {
  const int order = properties().order_bilateral;
  expect(make_top(), exact_top(0.2), order, order > 5 ? 8 : order > 3 ? 60 : 200);
}

TEST_P(BodyOrder, SkiddingOnOnePoint) {
  const double mu = mu_taken_by(GetParam(), 0.1);
  const int order = properties().order_sliding;
  expect(make_skidding_body(mu), exact_skidding_body(mu, 0.05), order, order > 5 ? 3 : order > 3 ? 8 : 50);
}

INSTANTIATE_TEST_SUITE_P(Schemes, BodyOrder,
                         testing::ValuesIn(with_fixed_steps(and_accurate_ones(scheme_names()))),
                         [](const auto& test) { return test.param; });

TEST(NewtonEuler, TheQuaternionKeepsItsLength) {
  for (const std::string& name : scheme_names())
    for (const Row& row : rows_of_run(make_tumbling_body(), *make_scheme(name), 1e-2, 20.0))
      ASSERT_NEAR(row.state.q.tail(4).norm(), 1.0, 1e-15) << name;
}

// A quarter turn about z takes the body's x to the y of space: each load acts in its own frame.
TEST(NewtonEuler, LoadsActInTheirFrames) {
  const Vec quarter = vec({std::cos(pi / 4), 0.0, 0.0, std::sin(pi / 4)});
  const auto push = [&](BodyLoads loads) {
    const NewtonEulerDS ds(pose({0, 0, 0}, quarter), Vec::Zero(6), 2.0, Mat3::Identity(), loads);
    Vec h(6);
    ds.forces(0.0, {ds.q0().data(), 7}, {ds.v0().data(), 6}, {h.data(), 6});
    return h;
  };
  EXPECT_LT((push({.force = {1, 0, 0}}) - vec({1, 0, 0, 0, 0, 0})).norm(), 1e-15);
  EXPECT_LT((push({.body_force = {1, 0, 0}}) - vec({0, 1, 0, 0, 0, 0})).norm(), 1e-15);
  EXPECT_LT((push({.moment = {1, 0, 0}}) - vec({0, 0, 0, 0, -1, 0})).norm(), 1e-15);
  EXPECT_LT((push({.body_moment = {1, 0, 0}}) - vec({0, 0, 0, 1, 0, 0})).norm(), 1e-15);
}

// A force that is fixed in a body which spins at Ω about z: x(t) = f/(m Ω²) (1 − cos Ωt), ẋ = f/(m Ω) sin Ωt
TEST(NewtonEuler, AThrusterOnASpinningBodyFliesACircle) {
  const double omega = 2.0, force = 3.0, mass = 2.0, until = 1.0;
  const NonSmoothDynamicalSystem model(
      {body(pose({0, 0, 0}, identity), vec({0, 0, 0, 0, 0, omega}), {.body_force = {force, 0, 0}})});
  const State end = run_to(model, *make_scheme("Hem5Sticky"), 1e-2, until);
  EXPECT_NEAR(end.q[0], force / (mass * omega * omega) * (1.0 - std::cos(omega * until)), 1e-10);
  EXPECT_NEAR(end.v[0], force / (mass * omega) * std::sin(omega * until), 1e-10);
  EXPECT_NEAR(end.v[1], force / (mass * omega) * (1.0 - std::cos(omega * until)), 1e-10);
}

void expect_consistent(const NonSmoothDynamicalSystem& model) {
  for (const CheckItem& item : check(model))
    if (item.quantity != "bilateral velocity at t0") {  // the bodies move as they like
      EXPECT_TRUE(item.ok()) << item.subject << ": " << item.quantity << " " << item.deviation;
    }
}

void link(NonSmoothDynamicalSystem& model, std::shared_ptr<const Relation> relation, const NonSmoothLaw& law,
          bool both) {
  model.link(std::make_shared<Interaction>(std::move(relation), law, ""), *model.systems()[0],
             both ? model.systems()[1].get() : nullptr);
}

TEST(BodyRelations, InSpaceJacobiansAndCurvaturesAreThoseOfTheGaps) {
  NonSmoothDynamicalSystem model(
      {body(pose({0.1, 0.2, -0.5}, vec({1.0, 0.3, -0.2, 0.5})), vec({1, 2, 3, -1, 0.5, 2})),
       body(pose({0.3, 0.1, -1.2}, vec({0.2, 0.9, 0.4, -0.3})), vec({-2, 1, 0.3, 1, 2, -0.7}))});
  const Vec3 at(0.1, 0.2, -1.0), axis(0.1, 1.0, 0.3), zero = Vec3::Zero();
  for (bool both : {false, true}) {
    const LagrangianDS& a = *model.systems()[0];
    const LagrangianDS* b = both ? model.systems()[1].get() : nullptr;
    for (const Joint& joint : {Joint::weld(at, a, b), Joint::pivot(at, axis, a, b), Joint::ball(at, a, b),
                               Joint::slider(at, axis, a, b)})
      link(model, std::make_shared<Joint>(joint), EqualityConditionNSL(joint.size()), both);
    for (int size : {1, 3}) {
      const NonSmoothLaw law = size == 1 ? NonSmoothLaw(NewtonImpactNSL(0.0))
                                         : NonSmoothLaw(NewtonImpactFrictionNSL(0.0, 0.0, 0.3, 3));
      link(model, std::make_shared<SpherePlane>(size, 0.1, at, Vec3(0.0, 0.1, -2.0), axis), law, both);
      link(model, std::make_shared<SphereSphere>(size, 0.1, 0.2, Vec3(0.1, 0.2, 0.3), at), law, both);
      link(model, std::make_shared<SphereBox>(size, 0.1, at, Vec3(0.1, 0.2, 0.3), zero), law, both);
      link(model, std::make_shared<SphereBox>(size, 0.1, at, Vec3(5.0, 6.0, 7.0), zero), law, both);
    }
  }
  expect_consistent(model);
}

TEST(BodyRelations, InThePlaneLikewise) {
  const auto plane_body = [](const Vec& q, const Vec& v) {
    return std::make_shared<LagrangianLinearTIDS>(q, v, Matrix::Identity(3, 3));
  };
  NonSmoothDynamicalSystem model({plane_body(vec({0.1, 0.2, 0.3}), vec({1, 2, 3})),
                                  plane_body(vec({0.7, 0.9, -0.4}), vec({0.1, 2, -3}))});
  const Vec3 at(0.1, 0.25, 0.0), axis(0.4, 1.0, 0.0), zero = Vec3::Zero();
  for (bool both : {false, true}) {
    const LagrangianDS& a = *model.systems()[0];
    const LagrangianDS* b = both ? model.systems()[1].get() : nullptr;
    for (const Joint& joint :
         {Joint::weld(at, a, b), Joint::pivot(at, Vec3::UnitZ(), a, b), Joint::slider(at, axis, a, b)})
      link(model, std::make_shared<Joint>(joint), EqualityConditionNSL(joint.size()), both);
    const NewtonImpactFrictionNSL law(0.0, 0.0, 0.3, 2);
    link(model, std::make_shared<SpherePlane>(2, 0.1, at, Vec3(0.0, -2.0, 0.0), axis), law, both);
    link(model, std::make_shared<SphereSphere>(2, 0.1, 0.2, at, axis), law, both);
    link(model, std::make_shared<SphereBox>(2, 0.1, at, Vec3(0.1, 0.2, 1.0), zero), law, both);
  }
  expect_consistent(model);
}

// What a disc, a sphere and a corner say of the same things
TEST(BodyRelations, GapsAndRowsOfSimplePlaces) {
  const double radius = 0.1;
  const Vec q = pose({1.0, 2.0, 0.15}, identity), v = vec({1, 2, 3, 4, 5, 6});
  const SpherePlane floor(3, radius, Vec3::Zero(), Vec3::Zero(), Vec3::UnitZ());
  double gap = 0.0;
  floor.gap({q.data(), 7}, {&gap, 1});
  EXPECT_NEAR(gap, 0.05, 1e-16);
  Matrix J = Matrix::Zero(3, 6);
  floor.jacobian({q.data(), 7}, {J.data(), 3, 6});
  // the lowest point: ż, ẋ − r Ω_y, ẏ + r Ω_x
  EXPECT_LT((J * v - vec({3.0, 1.0 - radius * 5.0, 2.0 + radius * 4.0})).norm(), 1e-15);
  const Vec plane = vec({1.0, 0.15, 0.7});
  const SpherePlane line(2, radius, Vec3::Zero(), Vec3::Zero(), Vec3::UnitY());
  Matrix row = Matrix::Zero(2, 3);
  line.jacobian({plane.data(), 3}, {row.data(), 2, 3});
  EXPECT_LT((row - (Matrix(2, 3) << 0, 1, 0, 1, 0, radius).finished()).norm(), 1e-15);
  const SphereBox box(2, radius, Vec3::Zero(), Vec3(0.5, 0.05, 1.0), Vec3(1.2, 0.0, 0.0));
  box.gap({plane.data(), 3}, {&gap, 1});
  EXPECT_NEAR(gap, 0.0, 1e-16);  // on its upper face
}

TEST(Joints, AChainStaysTogether) {
  const auto model = make_chain(100);  // 300 rows that depend on each other like a chain
  const auto scheme =
      make_integrator("HalfExplicitTrapezoidalOSI", {{"activity", "sticky"}, {"stabilization", "position"}});
  TimeStepping simulation(model, *scheme, 1e-3);
  double open = 0.0, energy = simulation.report().kinetic_energy;
  const Layout layout(model);
  const double before = energy + potential_energy(layout, 0.0, model.q0());
  Configuration view(std::make_shared<Layout>(model));
  for (int k = 0; k < 500; ++k) {
    simulation.step();
    view.move_to(simulation.state().q, simulation.state().t);
    open = std::max(open, view.gaps().cwiseAbs().maxCoeff());
  }
  EXPECT_LT(open, 1e-10);
  energy = simulation.report().kinetic_energy;
  EXPECT_GT(energy, 1.0);
  EXPECT_NEAR(energy + potential_energy(layout, 0.5, simulation.state().q), before, 1e-3 * energy);
}

TEST(BodyRelations, BadInputIsRefused) {
  const Vec3 zero = Vec3::Zero(), x = Vec3::UnitX();
  expect_refusal([&] { body(vec({0, 0, 0, 2, 0, 0, 0}), Vec::Zero(6)); }, {"length 1", "got 2"});
  expect_refusal([&] { body(Vec::Zero(6), Vec::Zero(6)); }, {"7 entries", "got 6"});
  expect_refusal([&] { body(pose({0, 0, 0}, identity), Vec::Zero(7)); }, {"6 entries", "got 7"});
  expect_refusal([&] { SpherePlane(1, -1.0, zero, zero, x); }, {"radius", "-1"});
  expect_refusal([&] { SpherePlane(1, 0.1, zero, zero, zero); }, {"normal", "zero"});
  expect_refusal([&] { SpherePlane(4, 0.1, zero, zero, x); }, {"size", "got 4"});
  expect_refusal([&] { SpherePlane(2, 0.1, zero, zero, x).require_dimensions(7, 6); }, {"spatial", "got 2"});
  expect_refusal([&] { SpherePlane(3, 0.1, zero, zero, x).require_dimensions(3, 3); }, {"plane", "got 3"});
  expect_refusal([&] { SpherePlane(1, 0.1, zero, zero, x).require_dimensions(2, 2); }, {"plane bodies"});
  const auto one = body(pose({0, 0, 0}, identity), Vec::Zero(6));
  const LagrangianLinearTIDS plane(Vec::Zero(3), Vec::Zero(3), Matrix::Identity(3, 3));
  expect_refusal([&] { Joint::pivot(zero, zero, *one); }, {"axis"});
  expect_refusal([&] { Joint::ball(zero, *one, &plane); }, {"a joint", "got 10"});
  expect_refusal([&] { Joint::ball(Vec3::UnitZ(), plane); }, {"plane"});
  expect_refusal([&] { Joint::ball(zero, *one).require_dimensions(3, 3); }, {"made for other bodies"});
  expect_refusal([&] { LagrangianLinearTIR(Matrix::Ones(1, 6)).require_dimensions(7, 6); }, {"got 7 and 6"});
}

}  // namespace
}  // namespace saltus::test
