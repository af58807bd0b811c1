// Systems with sparse matrices move as those with dense ones, at a cost that grows with their non-zeros.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <Eigen/LU>

#include "saltus/kernel/assembly/contact_assembly.hpp"
#include "saltus/kernel/model/check.hpp"
#include "saltus/kernel/model/distance.hpp"
#include "saltus/kernel/simulation/modes.hpp"
#include "saltus/kernel/simulation/stability.hpp"
#include "support/bar.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Terms = LagrangianLinearTIDS::Terms;

// Largest difference of two runs, relative to the largest value
void expect_same_runs(const NonSmoothDynamicalSystem& a, const NonSmoothDynamicalSystem& b,
                      const OneStepIntegrator& scheme, double dt, int steps, double tolerance) {
  const auto left = rows_of_run(a, scheme, dt, steps * dt), right = rows_of_run(b, scheme, dt, steps * dt);
  ASSERT_EQ(left.size(), right.size());
  double q = 0.0, v = 0.0, impulse = 0.0, largest_q = 0.0, largest_v = 0.0, largest_impulse = 0.0;
  auto compare = [](const Vec& x, const Vec& y, double& difference, double& largest) {
    if (x.size() == 0) return;
    difference = std::max(difference, (x - y).cwiseAbs().maxCoeff());
    largest = std::max(largest, x.cwiseAbs().maxCoeff());
  };
  int impacts = 0;
  for (std::size_t k = 0; k < left.size(); ++k) {
    compare(left[k].state.q, right[k].state.q, q, largest_q);
    compare(left[k].state.v, right[k].state.v, v, largest_v);
    compare(left[k].reactions.impulse, right[k].reactions.impulse, impulse, largest_impulse);
    impacts += left[k].report.impulsive;
    EXPECT_EQ(left[k].report.impulsive, right[k].report.impulsive) << k;
    EXPECT_EQ(left[k].report.closed, right[k].report.closed) << k;
    const double energy = left[k].report.kinetic_energy;
    EXPECT_NEAR(right[k].report.kinetic_energy, energy, 10 * tolerance * std::abs(energy)) << k;
  }
  EXPECT_LE(q, tolerance * largest_q);
  EXPECT_LE(v, tolerance * largest_v);
  EXPECT_LE(impulse, tolerance * largest_impulse);
  EXPECT_EQ(impacts > 0, !a.links().empty());
}

class SparseSystems : public testing::TestWithParam<std::string> {};

// Long enough for a wave to run to the free end and back twice. On acceleration level the contact is followed
// until that moves it: whether it separates is then left to the last bits of its velocity.
TEST_P(SparseSystems, ABarInContactMovesAsTheDenseOne) {
  const Bar bar{8, 2e-6};
  const int steps = GetParam().starts_with("DMinus") ? 150 : 400;
  for (double damping : {0.0, 1e-7})
    expect_same_runs(bar.model(false, damping), bar.model(true, damping), *make_scheme(GetParam()),
                     0.3 / bar.omega(), steps, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Schemes, SparseSystems, testing::ValuesIn(and_accurate_ones(scheme_names())),
                         [](const auto& test) { return test.param; });

TEST(SparseSystem, OneSparseMatrixMakesAllOfThemSparse) {
  const Bar bar{8};
  const Vec q = Vec::LinSpaced(9, 0.1, 0.7).array().sin(), v = q.array().cos();
  const Sparse K = bar.stiffness(), C = 1e-3 * K, M = bar.mass();
  const Vec force = Vec::LinSpaced(9, -1.0, 2.0);
  const LagrangianLinearTIDS dense(q, v, Matrix(M), Terms{Matrix(K), Matrix(C), force});
  EXPECT_EQ(dense.sparse_terms(), nullptr);
  auto in = [](const Vec& x) { return In(x.data(), x.size()); };
  Vec expected(9), h(9);
  dense.forces(0.0, in(q), in(v), {expected.data(), 9});
  for (const auto& mixed : {LagrangianLinearTIDS(q, v, M, Terms{Matrix(K), Matrix(C), force}),
                            LagrangianLinearTIDS(q, v, Matrix(M), Terms{K, Matrix(C), force}),
                            LagrangianLinearTIDS(q, v, Matrix(M), Terms{Matrix(K), C, force})}) {
    ASSERT_NE(mixed.sparse_terms(), nullptr);
    h.setZero();
    mixed.forces(0.0, in(q), in(v), {h.data(), 9});
    EXPECT_LT((h - expected).norm(), 1e-14 * expected.norm());
    EXPECT_NEAR(mixed.potential_energy(in(q)), dense.potential_energy(in(q)),
                1e-13 * dense.potential_energy(in(q)));
    EXPECT_EQ(Matrix(mixed.sparse_terms()->mass.entries()), Matrix(M));
  }
}

// Its blocks in the theta scheme: alone, with another system, with a spring whose direction turns.
TEST(SparseSystem, ForceElementsCoupleItToOthers) {
  const Bar bar{8};
  auto model = [&](bool sparse, bool turns) {
    NonSmoothDynamicalSystem all = bar.model(sparse, 1e-7);
    auto point = std::make_shared<LagrangianLinearTIDS>(vec({1e-3, 0.2}), vec({0.0, 3.0}),
                                                        0.05 * Matrix::Identity(2, 2));
    NonSmoothDynamicalSystem both({all.systems()[0], point});
    Matrix H = Matrix::Zero(turns ? 2 : 1, 11);  // from the last node of the bar to the point
    H(0, 8) = -1.0;
    H(0, 9) = 1.0;
    if (turns) H(1, 10) = 1.0;
    std::shared_ptr<const Relation> relation;
    if (turns)
      relation = std::make_shared<Distance>(H, Vec::Zero(2));
    else
      relation = std::make_shared<LagrangianLinearTIR>(H);
    both.add_force(std::make_shared<ForceElement>(relation, SpringDamper(4e5, 20.0, 0.1)), *both.systems()[0],
                   point.get());
    return both;
  };
  for (bool turns : {false, true})
    for (const char* scheme : {"MoreauJeanOSI", "HalfExplicitTrapezoidalOSI"})
      expect_same_runs(model(false, turns), model(true, turns), *make_scheme(scheme), 0.3 / bar.omega(), 200,
                       1e-11);
}

// A travelling load: C has a part that is not symmetric, and so has the matrix of the theta scheme.
TEST(SparseSystem, DampingMayBeUnsymmetric) {
  const Bar bar{8};
  const int n = bar.nodes();
  Sparse C(n, n);
  for (int i = 0; i + 1 < n; ++i) {
    C.insert(i, i + 1) = 30.0;
    C.insert(i + 1, i) = -30.0;
  }
  auto model = [&](bool sparse) {
    Terms terms{.stiffness = Matrix(bar.stiffness()), .damping = Matrix(C)};
    if (sparse) terms.damping = C;
    return NonSmoothDynamicalSystem({std::make_shared<LagrangianLinearTIDS>(
        Vec::Zero(n), Vec(Vec::LinSpaced(n, -0.1, 0.1)), Matrix(bar.mass()), terms)});
  };
  expect_same_runs(model(false), model(true), *make_scheme("MoreauJeanOSI"), 1.0 / bar.omega(), 200, 1e-12);
}

TEST(SparseSystem, BadMatricesAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  auto with = [](const Bar& bar, int i, int j, double value) {
    Sparse M = bar.mass();
    M.coeffRef(i, j) = value;
    return M;
  };
  const Bar bar{8};
  const Vec zero = Vec::Zero(9);
  auto mass = [&](const Sparse& M) { return [=] { LagrangianLinearTIDS(zero, zero, M); }; };
  auto terms = [&](Terms all) { return [=] { LagrangianLinearTIDS(zero, zero, bar.mass(), all); }; };
  expect_refusal(mass(Bar{9}.mass()), {"mass must be (9, 9) as q0 has 9 entries, got (10, 10)"});
  expect_refusal(mass(with(bar, 3, 3, nan)), {"mass must be finite"});
  expect_refusal(mass(with(bar, 3, 4, 0.0)), {"mass must be symmetric", "differ by"});
  expect_refusal(mass(with(bar, 3, 3, -1.0)), {"mass must be positive definite", "diagonal entry is -1"});
  expect_refusal(mass(with(bar, 3, 3, 1e-6)), {"mass must be positive definite", "pivot of -"});
  expect_refusal(mass(Sparse(9, 9)), {"mass must be positive definite", "diagonal entry is 0"});
  const Sparse singular = bar.stiffness();
  expect_refusal(mass(singular), {"mass must be positive definite", "pivot of"});
  expect_refusal(terms({.stiffness = Bar{9}.stiffness()}), {"stiffness must be (9, 9)", "(10, 10)"});
  expect_refusal(terms({.stiffness = Sparse(9, 8)}), {"stiffness must be (9, 9)", "(9, 8)"});
  expect_refusal(terms({.damping = with(bar, 0, 8, nan)}), {"damping must be finite"});
  expect_refusal(terms({.stiffness = Matrix(Matrix::Zero(3, 3))}), {"stiffness must be (9, 9)", "(3, 3)"});
  expect_refusal(terms({.external_force = vec({1.0})}), {"external_force must have 9 entries"});
}

TEST(SparseSystem, TheStabilityLimitIsThatOfTheBar) {
  for (int elements : {8, 1000}) {
    const Bar bar{elements};
    const double ratio = 5e-9;  // C = ratio K
    const auto model = bar.model(true, ratio);
    const auto scheme = make_scheme("HalfExplicitTrapezoidalOSI");
    const double too_large = 10.0 / bar.omega();
    const auto fastest = make_oscillator(bar.omega(), 0.0, 0.0, ratio * bar.omega() * bar.omega());
    const auto expected = find_instability(fastest, *scheme, too_large);
    ASSERT_TRUE(expected);
    ASSERT_GT(expected->largest_stable, 0.0);
    const auto found = find_instability(model, *scheme, too_large);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->omega, bar.omega(), 1e-3 * bar.omega());
    EXPECT_NEAR(found->largest_stable, expected->largest_stable, 2e-3 * expected->largest_stable);
    EXPECT_FALSE(find_instability(model, *scheme, 0.99 * expected->largest_stable));
  }
}

TEST(SparseSystem, IsChecked) {
  const auto items = check(Bar{8}.model(true));
  ASSERT_GE(items.size(), 3u);
  for (const CheckItem& item : items) EXPECT_TRUE(item.ok()) << item.subject << ": " << item.quantity;
}

// A dense matrix of this size takes 3.2 GB.
TEST(SparseSystem, ALargeOneTakesLittleMemory) {
  auto peak = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss / 1024;  // [MB]
  };
  const long before = peak();
  const Bar bar{20000, 1e-9};
  const auto model = bar.model(true);
  for (const char* scheme : {"HalfExplicitTrapezoidalOSI", "MoreauJeanOSI"}) {
    find_instability(model, *make_scheme(scheme), 1.0 / bar.omega());
    TimeStepping simulation(model, *make_scheme(scheme), 1.0 / bar.omega());
    int impacts = 0;
    for (int k = 0; k < 20; ++k) impacts += simulation.step().impulsive;
    EXPECT_GE(impacts, 1);
    EXPECT_GT(simulation.state().v[0], -0.5 * bar.speed);       // the end has been stopped
    EXPECT_EQ(simulation.state().v[bar.elements], -bar.speed);  // the wave is far from the other one
  }
  EXPECT_LT(peak() - before, 200);
}

// M⁻¹ of unit masses, which counts how often it is asked.
class Counted final : public BlockInverse {
 public:
  void solve_block(int, double*) const override { ++solutions; }
  long revision() const override { return current; }
  mutable int solutions = 0;
  long current = 1;
};

TEST(SparseSystem, AResponseIsTakenOnceWhicheverContactsAreActive) {
  auto body = std::make_shared<LagrangianLinearTIDS>(Vec::Zero(2), Vec::Zero(2), Matrix::Identity(2, 2));
  NonSmoothDynamicalSystem model({body});
  for (int k : {0, 1})
    model.link(linear_contact(Matrix(Vec::Unit(2, k).transpose()), vec({0.0}), NewtonImpactNSL(0.0), ""),
               *body);
  const auto layout = std::make_shared<const Layout>(model);
  Configuration position(layout);
  position.move_to(model.q0(), model.t0());
  ContactAssembly assembly(layout, one_block_a_system(*layout));
  Counted inverse;
  auto solutions_for = [&](const std::vector<int>& active) {
    inverse.solutions = 0;
    assembly.assemble(active, position, position, inverse);
    EXPECT_EQ(assembly.problem().rows(), static_cast<int>(active.size()));
    return inverse.solutions;
  };
  EXPECT_EQ(solutions_for({0}), 1);
  EXPECT_EQ(solutions_for({0, 1}), 1);  // that of the second one
  EXPECT_EQ(solutions_for({1}), 0);
  EXPECT_EQ(solutions_for({0, 1}), 0);
  inverse.current = 2;  // another matrix
  EXPECT_EQ(solutions_for({0, 1}), 2);
  EXPECT_EQ(solutions_for({0}), 0);
  inverse.current = 0;  // unknown
  EXPECT_EQ(solutions_for({0, 1}), 2);
  EXPECT_EQ(solutions_for({0, 1}), 2);
}

}  // namespace
}  // namespace saltus::test
