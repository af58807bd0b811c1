// Every refusal of the kernel: bad input is a std::invalid_argument that names what was expected and
// what came.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "saltus/kernel/model/distance.hpp"
#include "saltus/numerics/solvers/registry.hpp"
#include "slider_crank/slider_crank.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

const double nan = std::numeric_limits<double>::quiet_NaN();
const double inf = std::numeric_limits<double>::infinity();
const Matrix one = Matrix::Identity(1, 1);

TEST(Refused, StatesOfASystem) {
  auto make = [](Vec q0, Vec v0) { return [=] { DoublePendulum(q0, v0); }; };
  expect_refusal(make(Vec(), Vec()), {"q0", "at least one"});
  expect_refusal(make(vec({0, 0}), vec({0})), {"v0 must have 2", "got 1"});
  expect_refusal(make(vec({0, nan}), vec({0, 0})), {"q0 must be finite"});
  expect_refusal(make(vec({0, inf}), vec({0, 0})), {"q0 must be finite"});
  expect_refusal(make(vec({0, 0}), vec({-inf, 0})), {"v0 must be finite"});
}

TEST(Refused, TermsOfALinearSystem) {
  auto make = [](Matrix M, LagrangianLinearTIDS::Terms terms) {
    return [=] { LagrangianLinearTIDS(vec({0, 0}), vec({0, 0}), M, terms); };
  };
  const Matrix I = Matrix::Identity(2, 2);
  EXPECT_NO_THROW(make(I, {.stiffness = I, .damping = I, .external_force = vec({1, 2})})());
  expect_refusal(make(one, {}), {"mass must be (2, 2)", "got (1, 1)"});
  expect_refusal(make(nan * I, {}), {"mass must be finite"});
  expect_refusal(make((Matrix(2, 2) << 1, 0.5, 0.4, 1).finished(), {}), {"mass must be symmetric", "0.1"});
  expect_refusal(make((Matrix(2, 2) << 1, 2, 2, 1).finished(), {}), {"mass must be positive definite", "-1"});
  expect_refusal(make(Matrix::Zero(2, 2), {}), {"mass must be positive definite"});
  expect_refusal(make(I, {.stiffness = one}), {"stiffness must be (2, 2)", "got (1, 1)"});
  expect_refusal(make(I, {.stiffness = inf * I}), {"stiffness must be finite"});
  expect_refusal(make(I, {.damping = Matrix::Zero(2, 3)}), {"damping must be (2, 2)", "got (2, 3)"});
  expect_refusal(make(I, {.damping = nan * I}), {"damping must be finite"});
  expect_refusal(make(I, {.external_force = vec({1})}), {"external_force must have 2", "got 1"});
  expect_refusal(make(I, {.external_force = vec({1, nan})}), {"external_force must be finite"});
}

TEST(Refused, LawsOutOfRange) {
  for (double e : {-0.1, 1.1, nan, inf}) {
    expect_refusal([=] { NewtonImpactNSL law(e); }, {"restitution e", "[0, 1]", "got"});
    expect_refusal([=] { NewtonImpactFrictionNSL(e, 0.0, 0.1, 2); }, {"restitution en", "[0, 1]"});
    expect_refusal([=] { NewtonImpactFrictionNSL(0.0, e, 0.1, 2); }, {"restitution et", "[0, 1]"});
  }
  for (double mu : {-0.1, nan, inf})
    expect_refusal([=] { NewtonImpactFrictionNSL(0.0, 0.0, mu, 2); }, {"mu", ">= 0", "got"});
  for (int dim : {0, 1, 4})
    expect_refusal([=] { NewtonImpactFrictionNSL(0.0, 0.0, 0.1, dim); }, {"dim", "2", "3", "got"});
  expect_refusal([] { EqualityConditionNSL law(0); }, {"n >= 1", "got 0"});
  EXPECT_NO_THROW(NewtonImpactFrictionNSL(1.0, 1.0, 0.0, 3));
}

// A system and a relation that are not finite where they are told.
struct Sick final : LagrangianDS {
  Sick(Matrix M, double h) : LagrangianDS(Vec::Zero(2), Vec::Zero(2)), M_(M), h_(h) {}
  void mass(const In&, OutMatrix M) const override { M = M_; }
  void forces(double, const In&, const In&, Out h) const override { h[1] = h_; }
  Matrix M_;
  double h_;
};
struct SickRelation final : Relation {
  SickRelation(double g, double j) : Relation(1), g_(g), j_(j) {}
  void gap(const In&, Out g) const override { g[0] = g_; }
  void jacobian(const In&, OutMatrix J) const override { J(0, 0) = j_; }
  double g_, j_;
};

TEST(Refused, RelationsOfTheWrongShape) {
  expect_refusal([] { Circle(0, 1.0); }, {"size must be at least 1", "got 0"});
  expect_refusal([] { LagrangianLinearTIR(Matrix::Zero(0, 2)); }, {"size must be at least 1"});
  expect_refusal([] { LagrangianLinearTIR(one, vec({1, 2})); }, {"b must have 1", "got 2"});
  expect_refusal([] { LagrangianLinearTIR(nan * one, vec({1})); }, {"H must be finite"});
  expect_refusal([] { LagrangianLinearTIR(one, vec({inf})); }, {"b must be finite"});
  const auto plane = std::make_shared<LagrangianLinearTIR>(one);
  expect_refusal([] { Interaction(nullptr, NewtonImpactNSL(0.0)); }, {"needs a relation"});
  expect_refusal([&] { Interaction(plane, NewtonImpactFrictionNSL(0.0, 0.0, 0.1, 2), "floor"); },
                 {"same number of rows", "1 and 2", "'floor'"});
  const Vec q = vec({1.0, 0.0});
  double c[1];
  const SickRelation flat(1.0, 1.0);
  EXPECT_FALSE(flat.has_curvature());
  EXPECT_THROW(flat.curvature(In(q.data(), 2), In(q.data(), 2), Out(c, 1)), std::logic_error);
}

TEST(Refused, ForceLawsOutOfRange) {
  for (double bad : {nan, inf}) {
    expect_refusal([=] { SpringDamper law(bad); }, {"stiffness must be finite", "got"});
    expect_refusal([=] { SpringDamper(1.0, bad); }, {"damping must be finite", "got"});
    expect_refusal([=] { SpringDamper(1.0, 0.0, bad); }, {"rest_length must be finite", "got"});
    expect_refusal([=] { Actuator law(bad); }, {"force must be finite", "got"});
  }
  expect_refusal([] { SpringDamper(1.0, -0.5); }, {"damping must be >= 0", "got -0.5"});
  EXPECT_NO_THROW(SpringDamper(-1.0, 0.0, -2.0));  // away from a negative angle
  expect_refusal([] { Actuator{ForceLaw::Function{}}; }, {"force must be a function", "none"});
  expect_refusal([] { Actuator{ModelFunction{}}; }, {"force must be a function", "none"});
}

TEST(Refused, ForceElementsThatDoNotFit) {
  const auto ball = std::make_shared<LagrangianLinearTIDS>(vec({0}), vec({0}), one);
  const auto other = std::make_shared<LagrangianLinearTIDS>(vec({0}), vec({0}), one);
  const auto element = [](Matrix H, std::string name = "spring") {
    return std::make_shared<ForceElement>(std::make_shared<LagrangianLinearTIR>(H), SpringDamper(1.0), name);
  };
  expect_refusal([] { ForceElement(nullptr, SpringDamper(1.0), "spring"); },
                 {"needs a relation", "'spring'"});
  expect_refusal([&] { element(Matrix::Ones(2, 1)); }, {"1 row", "got 2", "'spring'"});
  NonSmoothDynamicalSystem model({ball});
  expect_refusal([&] { model.add_force(nullptr, *ball); }, {"needs a force element"});
  expect_refusal([&] { model.add_force(element(one), *other); }, {"not part"});
  expect_refusal([&] { model.add_force(element(one), *ball, ball.get()); }, {"two different systems"});
  expect_refusal([&] { model.add_force(element(Matrix::Ones(1, 2)), *ball); }, {"1 columns", "got 2"});
  model.link(linear_contact(one, vec({0}), NewtonImpactNSL(0.0), "floor"), *ball);
  expect_refusal([&] { model.add_force(element(one, "floor"), *ball); }, {"unique", "'floor'"});
  EXPECT_TRUE(model.forces().empty());  // what was refused left nothing behind
  model.add_force(element(one), *ball);
  expect_refusal([&] { model.add_force(element(one), *ball); }, {"unique", "'spring'"});
}

TEST(Refused, DistancesOfTheWrongShape) {
  expect_refusal([] { Distance(Matrix::Ones(4, 2), Vec::Zero(4)); }, {"1 to 3 rows", "got 4"});
  expect_refusal([] { Distance(Matrix::Ones(2, 2), Vec::Zero(1)); }, {"b must have 2", "got 1"});
  expect_refusal([] { Distance(nan * Matrix::Ones(2, 2), Vec::Zero(2)); }, {"H must be finite"});
  expect_refusal([] { Distance(Matrix::Ones(2, 2), vec({0, inf})); }, {"b must be finite"});
  expect_refusal([] { Distance(Matrix::Ones(2, 2), Vec::Zero(2), nan); }, {"length must be finite"});
  expect_refusal([] { Distance(Matrix::Ones(2, 2), Vec::Zero(2)).require_dimensions(3, 3); },
                 {"H must have 3 columns", "got 2"});
}

TEST(Refused, ForceElementsThatAreNotFiniteAtTheStart) {
  const auto ball = std::make_shared<LagrangianLinearTIDS>(vec({0}), vec({0}), one);
  const auto start = [&](std::shared_ptr<const Relation> relation, ForceLaw law) {
    NonSmoothDynamicalSystem model({ball});
    model.add_force(std::make_shared<ForceElement>(relation, law, "spring"), *ball);
    TimeStepping(model, *make_integrator("HalfExplicitTrapezoidalOSI"), 1e-3);
  };
  const SpringDamper law(1.0);
  expect_refusal([&] { start(std::make_shared<SickRelation>(nan, 1.0), law); }, {"length", "'spring'"});
  expect_refusal([&] { start(std::make_shared<SickRelation>(1.0, inf), law); }, {"jacobian", "'spring'"});
  expect_refusal([&] { start(std::make_shared<Distance>(one, vec({0})), law); }, {"jacobian", "'spring'"});
  expect_refusal(
      [&] {
        start(std::make_shared<SickRelation>(1.0, 1.0), Actuator([](double, double, double) { return nan; }));
      },
      {"force of force element 'spring'", "finite"});
}

TEST(Refused, ModelsThatDoNotFitTogether) {
  using Model = NonSmoothDynamicalSystem;
  const auto ball = std::make_shared<LagrangianLinearTIDS>(vec({0}), vec({0}), one);
  const auto other = std::make_shared<LagrangianLinearTIDS>(vec({0}), vec({0}), one);
  expect_refusal([] { Model({}); }, {"at least one dynamical system"});
  expect_refusal([] { Model({nullptr}); }, {"system 0 is null"});
  expect_refusal([&] { Model({ball, other, ball}); }, {"system 2 stands twice"});
  expect_refusal([&] { Model({ball}, nan); }, {"t0 must be finite"});
  Model model({ball});
  const auto floor = linear_contact(one, vec({0}), NewtonImpactNSL(0.0), "floor");
  expect_refusal([&] { model.link(nullptr, *ball); }, {"needs an interaction"});
  expect_refusal([&] { model.link(floor, *other); }, {"not part"});
  expect_refusal([&] { model.link(floor, *ball, other.get()); }, {"not part"});
  expect_refusal([&] { model.link(floor, *ball, ball.get()); }, {"two different systems"});
  const auto wide = linear_contact(Matrix::Ones(1, 2), vec({0}), NewtonImpactNSL(0.0), "wide");
  expect_refusal([&] { model.link(wide, *ball); }, {"H must have 1 columns", "got 2"});
  EXPECT_TRUE(model.links().empty());  // what was refused left nothing behind
  model.link(floor, *ball);
  expect_refusal([&] { model.link(floor, *ball); }, {"unique", "'floor'"});
}

TEST(Refused, SimulationsThatCannotStart) {
  const auto model = make_ball(1.0, 0.0, 0.5);
  const auto scheme = make_integrator("HalfExplicitTrapezoidalOSI");
  for (double dt : {0.0, -1e-3, nan, inf})
    expect_refusal([&, dt] { TimeStepping(model, *scheme, dt); },
                   {"time_step", "positive and finite", "got"});
  TimeStepping simulation(model, *scheme, 1e-3);
  for (double until : {nan, inf})
    expect_refusal([&, until] { simulation.run(until); }, {"until must be finite", "got"});
  expect_refusal([&] { simulation.add_observer(nullptr); }, {"needs an observer"});
  EXPECT_EQ(simulation.steps(), 0);
}

TEST(Refused, ModelsThatAreNotFiniteAtTheStart) {
  const auto scheme = make_integrator("HalfExplicitTrapezoidalOSI");
  auto start = [&](Matrix M, double h, double g, double j) {
    return [=, &scheme] {
      auto first = std::make_shared<DoublePendulum>(vec({0, 0}), vec({0, 0}));
      auto sick = std::make_shared<Sick>(M, h);
      NonSmoothDynamicalSystem model({first, sick});
      model.link(
          std::make_shared<Interaction>(std::make_shared<SickRelation>(g, j), NewtonImpactNSL(0.0), "joint"),
          *sick);
      TimeStepping(model, *scheme, 1e-3);
    };
  };
  const Matrix I = Matrix::Identity(2, 2);
  EXPECT_NO_THROW(start(I, 0.0, 0.0, 1.0)());
  expect_refusal(start(-I, 0.0, 0.0, 1.0), {"mass of system 1", "positive definite"});
  expect_refusal(start((Matrix(2, 2) << 1, 0.5, 0, 1).finished(), 0.0, 0.0, 1.0),
                 {"mass of system 1", "symmetric"});
  expect_refusal(start(nan * I, 0.0, 0.0, 1.0), {"mass of system 1", "finite"});
  expect_refusal(start(I, inf, 0.0, 1.0), {"forces of system 1", "finite"});
  expect_refusal(start(I, 0.0, nan, 1.0), {"gap of 'joint'", "finite"});
  expect_refusal(start(I, 0.0, 0.0, nan), {"jacobian of 'joint'", "finite"});
}

TEST(Refused, LawsThatTheSolverDoesNotTake) {
  auto ball = std::make_shared<LagrangianLinearTIDS>(vec({0, 0, 1}), vec({0, 0, 0}), Matrix::Identity(3, 3));
  for (const IntegratorEntry& entry : integrators()) {
    const double mu = mu_taken_by(entry.name, 0.1);  // else the scheme refuses first
    NonSmoothDynamicalSystem model({ball});
    model.link(linear_contact(Matrix::Identity(3, 3), Vec::Zero(3), NewtonImpactFrictionNSL(0.0, 0.0, mu, 3),
                              "floor"),
               *ball);
    for (const SolverEntry& solver : contact_solvers()) {
      ContactProblem space;
      space.G = Matrix(Matrix::Identity(3, 3));
      space.b = Vec(Vec::Zero(3));
      space.sets = {Coulomb{mu, 3}};
      if (solver.make()->accepts(space)) continue;
      expect_refusal([&] { TimeStepping(model, *make_integrator(entry.name), 1e-3, *solver.make()); },
                     {solver.name, "3 rows", "friction in space"});
    }
  }
}

TEST(Refused, FrictionBySchemesThatTakeNone) {
  auto start = [](const std::string& scheme, double mu) {
    return [=] { TimeStepping(make_block(1.0, mu), *make_integrator(scheme), 1e-3); };
  };
  for (const IntegratorEntry& entry : integrators()) {
    EXPECT_NO_THROW(start(entry.name, 0.0)()) << entry.name;
    if (entry.properties.friction)
      EXPECT_NO_THROW(start(entry.name, 0.25)()) << entry.name;
    else
      expect_refusal(start(entry.name, 0.25), {entry.name, "no friction", "mu = 0.25", "'plane'"});
  }
}

TEST(Refused, RelationsWithoutCurvatureOnAccelerationLevel) {
  auto point = std::make_shared<LagrangianLinearTIDS>(vec({0, 0}), vec({0, 0}), Matrix::Identity(2, 2));
  NonSmoothDynamicalSystem model({point});
  model.link(linear_contact(Matrix::Ones(1, 2), vec({0}), NewtonImpactNSL(0.0), "plane"), *point);
  model.link(
      std::make_shared<Interaction>(std::make_shared<SickRelation>(1.0, 1.0), NewtonImpactNSL(0.0), "joint"),
      *point);
  for (const std::string& name : scheme_names()) {
    const auto start = [&] { TimeStepping(model, *make_scheme(name), 1e-3); };
    if (keeps_velocity_constraints(name))
      EXPECT_NO_THROW(start()) << name;
    else
      expect_refusal(start, {name, "curvature", "'joint'"});
  }
}

TEST(Refused, UnknownNamesInTheRegistry) {
  std::vector<std::string> words = {"'Euler'"};
  for (const IntegratorEntry& entry : integrators()) words.push_back(entry.name);
  expect_refusal([] { make_integrator("Euler"); }, words);
  expect_refusal([] { make_integrator("HalfExplicitTrapezoidalOSI", {{"theta", "0.5"}}); },
                 {"HalfExplicitTrapezoidalOSI", "'theta'", "activity"});
  expect_refusal([] { make_integrator("HalfExplicitTrapezoidalOSI", {{"activity", "guessed"}}); },
                 {"activity", "start, sticky, predicted", "'guessed'"});
  expect_refusal([] { make_integrator("ExplicitMoreauJeanOSI", {{"activity", "start"}}); },
                 {"'activity'", "none"});
}

TEST(Registry, EveryEntryMakesTheSchemeOfItsName) {
  for (const IntegratorEntry& entry : integrators()) {
    EXPECT_EQ(make_integrator(entry.name)->name(), entry.name);
    EXPECT_EQ(make_integrator(entry.name)->clone()->name(), entry.name);
    EXPECT_FALSE(entry.summary.empty());
    for (const SchemeOption& option : entry.options)
      for (const std::string& choice : option.choices)
        EXPECT_NO_THROW(make_integrator(entry.name, {{option.name, choice}})) << entry.name << " " << choice;
  }
}

TEST(Refused, TheSliderCranksOwn) {
  using namespace examples;
  const SliderCrankParameters p;
  expect_refusal([&] { SliderCrank(Vec::Zero(2), Vec::Zero(2), p); }, {"3 freedoms", "got 2"});
  expect_refusal([&] { SliderCorner(p.a, p.b, 3, p); }, {"1 or 2 rows", "got 3"});
  expect_refusal([&] { SliderGuide(p).require_dimensions(4, 4); }, {"3 freedoms", "got 4"});
}

}  // namespace
}  // namespace saltus::test
