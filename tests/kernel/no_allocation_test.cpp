// A step allocates nothing: every malloc of the process is counted while steps are taken.
#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <new>
#include <random>

#include "rotor/rotor.hpp"
#include "saltus/kernel/first_order/first_order_time_stepping.hpp"
#include "saltus/kernel/model/distance.hpp"
#include "saltus/numerics/linear/sparse_factor.hpp"
#include "saltus/numerics/solvers/registry.hpp"
#include "slider_crank/slider_crank.hpp"
#include "support/bar.hpp"
#include "support/body_models.hpp"
#include "support/complementarity.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"
#include "support/spatial_models.hpp"

namespace {

std::atomic<bool> counting{false};
std::atomic<long> allocations{0};

void count() {
  if (counting.load(std::memory_order_relaxed)) allocations.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

// The C library's own names for what is replaced here.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  count();
  return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) {
  count();
  return __libc_calloc(number, size);
}
void* realloc(void* block, std::size_t size) {
  count();
  return __libc_realloc(block, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  count();
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  *out = memalign(alignment, size);
  return *out ? 0 : ENOMEM;
}
}

namespace saltus::test {
namespace {

using Terms = LagrangianLinearTIDS::Terms;

class NoAllocation : public testing::TestWithParam<std::string> {
 protected:
  struct Counted {
    long allocations, impacts, closed;
  };

  static Counted count_in(const NonSmoothDynamicalSystem& model, const OneStepIntegrator& scheme, double dt,
                          int warm_up, int steps) {
    TimeStepping simulation(model, scheme, dt);
    for (int k = 0; k < warm_up; ++k) simulation.step();
    Counted result{};
    allocations = 0;
    counting = true;
    for (int k = 0; k < steps; ++k) {
      const StepReport& report = simulation.step();
      result.impacts += report.impulsive;
      result.closed += report.closed > 0;
    }
    counting = false;
    result.allocations = allocations;
    return result;
  }
};

TEST_P(NoAllocation, SliderCrankInItsNotch) {
  const auto model = examples::make_slider_crank(guidance_for(GetParam()));
  const Counted counted = count_in(model, *make_scheme(GetParam()), 1e-4, 200, 2000);
  EXPECT_EQ(counted.allocations, 0);
  EXPECT_GT(counted.impacts, 5);  // else nothing of interest was counted
  EXPECT_GT(counted.closed, 5);
}

TEST_P(NoAllocation, SliderCrankOnItsGuide) {
  const auto model = examples::make_slider_crank(examples::Guidance::equality);
  EXPECT_EQ(count_in(model, *make_scheme(GetParam()), 1e-4, 0, 500).allocations, 0);
}

TEST_P(NoAllocation, TwoSystemsInContact) {
  const Counted counted = count_in(make_stack(0.1, 0.5), *make_scheme(GetParam()), 1e-3, 0, 2000);
  EXPECT_EQ(counted.allocations, 0);
  EXPECT_GT(counted.impacts, 2);
}

TEST_P(NoAllocation, TwoBalls) {
  const Counted counted =
      count_in(make_two_balls(1.0, 2.0, 1.0, -1.0, 0.8), *make_scheme(GetParam()), 1e-3, 0, 200);
  EXPECT_EQ(counted.allocations, 0);
  EXPECT_GE(counted.impacts, 1);
}

// So many contacts that G is made of sparse rows; each is a component of its own.
TEST_P(NoAllocation, DiscsOnAPlane) {
  if (scheme_properties(GetParam()).error_controlled) GTEST_SKIP() << "KLU factorises its changing equations";
  const int n = 80;
  const double radius = 0.1, dt = 1e-3;
  NonSmoothDynamicalSystem::Systems discs;
  Matrix M = Matrix::Identity(3, 3);
  M(2, 2) = 0.5 * radius * radius;
  for (int k = 0; k < n; ++k)
    discs.push_back(
        std::make_shared<LagrangianLinearTIDS>(vec({0.3 * k, radius + 1e-5 * k, 0.0}), vec({0.2, 0.0, 0.0}),
                                               M, Terms{.external_force = vec({0.0, -gravity, 0.0})}));
  NonSmoothDynamicalSystem model(discs);
  const Matrix H = (Matrix(2, 3) << 0.0, 1.0, 0.0, 1.0, 0.0, radius).finished();
  const NewtonImpactFrictionNSL law(0.0, 0.0, mu_taken_by(GetParam(), 0.2), 2);
  for (int k = 0; k < n; ++k) model.link(linear_contact(H, vec({-radius, 0.0}), law, ""), *discs[k]);
  const Counted counted = count_in(model, *make_scheme(GetParam()), dt, 40, 200);
  EXPECT_EQ(counted.allocations, 0);
  EXPECT_EQ(counted.closed, 200);
}

// Three contacts in one place: G has rank 2 of 6, which takes another decomposition.
TEST_P(NoAllocation, ContactsThatDependOnEachOther) {
  auto block = std::make_shared<LagrangianLinearTIDS>(
      vec({0.0, 0.05}), vec({1.0, 0.0}), Matrix::Identity(2, 2),
      LagrangianLinearTIDS::Terms{.external_force = vec({0.0, -gravity})});
  NonSmoothDynamicalSystem model({block});
  const Matrix H = (Matrix(2, 2) << 0.0, 1.0, 1.0, 0.0).finished();
  const NewtonImpactFrictionNSL law(0.3, 0.0, mu_taken_by(GetParam(), 0.2), 2);
  for (const char* name : {"left", "middle", "right"})
    model.link(linear_contact(H, vec({0.0, 0.0}), law, name), *block);
  const Counted counted = count_in(model, *make_scheme(GetParam()), 1e-3, 0, 1500);
  EXPECT_EQ(counted.allocations, 0);
  EXPECT_GT(counted.closed, 500);
}

// Twelve rows of rank six: sliding, sticking, impacts and the sharing of loads, all in space.
TEST_P(NoAllocation, ATableOnFourFeet) {
  if (GetParam() == "GalerkinChebyshev" || GetParam() == "Galerkin3Sticky")
    GTEST_SKIP() << "36 rows that depend on each other, of three stages together: more than 24 may allocate";
  const auto model = make_table(0.02, vec({1.0, 0.5, 0.0, 0.1, 0.2, 3.0}), mu_taken_by(GetParam(), 0.3), 0.3);
  const Counted counted = count_in(model, *make_scheme(GetParam()), 1e-3, 0, 1500);
  EXPECT_EQ(counted.allocations, 0);
  EXPECT_GT(counted.impacts, 5);
  EXPECT_GT(counted.closed, 500);
}

// A spring between points, a given force, and a linear spring that couples two systems in contact.
TEST_P(NoAllocation, ForceElements) {
  const Terms weight{.external_force = vec({0.0, -gravity})};
  const Matrix M = Matrix::Identity(2, 2);
  auto one = std::make_shared<LagrangianLinearTIDS>(vec({0.0, 0.1}), Vec::Zero(2), M, weight);
  auto two = std::make_shared<LagrangianLinearTIDS>(vec({0.5, 0.2}), vec({1.0, 0.0}), M, weight);
  NonSmoothDynamicalSystem model({one, two});
  const Matrix between = (Matrix(2, 4) << -1, 0, 1, 0, 0, -1, 0, 1).finished();
  auto add = [&](std::shared_ptr<const Relation> relation, ForceLaw law) {
    model.add_force(std::make_shared<ForceElement>(std::move(relation), std::move(law)), *one, two.get());
  };
  add(std::make_shared<Distance>(between, Vec::Zero(2)), SpringDamper(200.0, 1.0, 0.4));
  add(std::make_shared<LagrangianLinearTIR>(between.row(0)), SpringDamper(50.0));
  add(std::make_shared<LagrangianLinearTIR>(between.row(1)),
      Actuator([](double t, double l, double) { return t - l; }));
  for (const auto& ball : {one, two})
    model.link(linear_contact((Matrix(1, 2) << 0, 1).finished(), vec({0.0}), NewtonImpactNSL(0.5), ""),
               *ball);
  const Counted counted = count_in(model, *make_scheme(GetParam()), 1e-3, 0, 1500);
  EXPECT_EQ(counted.allocations, 0);
  EXPECT_GT(counted.impacts, 5);
}

// A quaternion, a joint, and friction in space whose direction turns.
TEST_P(NoAllocation, BodiesInSpace) {
  EXPECT_EQ(count_in(make_top(), *make_scheme(GetParam()), 1e-3, 0, 200).allocations, 0);
  const auto skid = make_skidding_body(mu_taken_by(GetParam(), 0.1));
  const Counted counted = count_in(skid, *make_scheme(GetParam()), 1e-3, 0, 50);
  EXPECT_EQ(counted.allocations, 0);
  EXPECT_GT(counted.closed, 45);
}

// Contact at the end of a bar with sparse matrices.
TEST_P(NoAllocation, ABarWithSparseMatrices) {
  const Bar bar{40, 1e-7};
  const Counted counted =
      count_in(bar.model(true, 1e-8), *make_scheme(GetParam()), 0.3 / bar.omega(), 2, 1000);
  EXPECT_EQ(counted.allocations, 0);
  EXPECT_GT(counted.impacts, 0);
  EXPECT_GT(counted.closed, 100);
}

INSTANTIATE_TEST_SUITE_P(Schemes, NoAllocation, testing::ValuesIn(and_accurate_ones(scheme_names())),
                         [](const auto& test) { return test.param; });

// A mass matrix of 30 rows that varies, welded bodies, and impacts in a ring.
TEST(NoAllocationOf, TheRotor) {
  const auto model = examples::make_rotor();
  const Options in_parts = {{"impulsive_substeps", 10.0}};
  const Options stabilised = {{"activity", "sticky"}, {"stabilization", "position"}};
  for (const auto& [scheme, options] : {std::pair("HalfExplicitTrapezoidalOSI", in_parts),
                                        {"HalfExplicitTrapezoidalOSI", stabilised},
                                        {"MoreauJeanOSI", Options{}}}) {
    TimeStepping simulation(model, *make_integrator(scheme, options), 5e-6);
    for (int k = 0; k < 890; ++k) simulation.step();  // it hits the ring in step 895
    allocations = 0;
    counting = true;
    int closed = 0;
    for (int k = 0; k < 60; ++k) closed += simulation.step().closed > 2;
    counting = false;
    EXPECT_EQ(allocations, 0) << scheme;
    EXPECT_GT(closed, 5) << scheme;
  }
}

TEST(NoAllocationOf, SparseFactors) {
  const int n = 400;
  SparseEntries band(n, n), ring(n, n), skew(n, n);
  for (int i = 0; i < n; ++i) {
    for (SparseEntries* A : {&band, &ring, &skew}) A->coeffRef(i, i) = 5.0;
    for (int k : {1, 2}) {
      if (i + k < n) band.coeffRef(i, i + k) = band.coeffRef(i + k, i) = -1.0;
      ring.coeffRef(i, (i + k) % n) = ring.coeffRef((i + k) % n, i) = -1.0;
    }
    skew.coeffRef(i, (i + 7) % n) = 2.0;
  }
  for (SparseEntries* A : {&band, &ring, &skew}) {
    A->makeCompressed();
    SparseFactor factor;
    ASSERT_TRUE(factor.factorise(*A));
    Vec x = Vec::Ones(n);
    allocations = 0;
    counting = true;
    factor.solve(x.data());
    counting = false;
    EXPECT_EQ(allocations, 0) << static_cast<int>(factor.method());
  }
}

TEST(Counting, SeesEveryKindOfAllocation) {
  // If the replacement did not work, the tests above would prove nothing. The volatile pointers keep the
  // compiler from removing the pairs.
  allocations = 0;
  counting = true;
  int* volatile a = new int;
  void* volatile b = std::malloc(8);
  double* volatile c = new double[100];
  void* volatile d = ::operator new(64, std::align_val_t(64));
  const Vec e = Vec::Zero(50);
  counting = false;
  EXPECT_EQ(allocations, 5);
  EXPECT_EQ(e.sum(), 0.0);
  delete a;
  std::free(b);
  delete[] c;
  ::operator delete(d, std::align_val_t(64));
}

// Two relays on a nonlinear system that slides, its derivatives by differences.
class Pendulum final : public FirstOrderDS {
 public:
  Pendulum() : FirstOrderDS(Vec::Constant(2, 1.0)) {}
  void f(double t, const In& x, Out f) const override {
    f[0] = x[1];
    f[1] = std::sin(t) - std::sin(x[0]);
  }
};

TEST(FirstOrder, AStepAllocatesNothing) {
  const auto pendulum = std::make_shared<Pendulum>();
  FirstOrderSystem nonlinear({pendulum});
  const Matrix feedback = Matrix::Identity(2, 2);
  nonlinear.link(std::make_shared<FirstOrderLinearTIR>(feedback, 2.0 * feedback, FirstOrderLinearR::Terms{}),
                 relay_laws(2), *pendulum);
  const auto bridge = std::make_shared<FirstOrderLinearTIDS>(
      Vec{{10.0, 0.0}}, FirstOrderLinearDS::Terms{Matrix{{0.0, -1e6}, {1e2, 0.0}}, {}, {}});
  FirstOrderSystem linear({bridge});
  const Matrix C{{0.0, 0.0}, {0.0, 0.0}, {-1.0, 0.0}, {1.0, 0.0}};
  const Matrix D{
      {1e-3, 1e-3, -1.0, 0.0}, {1e-3, 1e-3, 0.0, -1.0}, {1.0, 0.0, 0.0, 0.0}, {0.0, 1.0, 0.0, 0.0}};
  const Matrix B{{0.0, 0.0, -1e6, 1e6}, {0.0, 0.0, 0.0, 0.0}};
  linear.link(std::make_shared<FirstOrderLinearTIR>(C, B, FirstOrderLinearR::Terms{D, {}}),
              complementarity_laws(4), *bridge);
  for (const auto& [model, dt] : {std::pair{&nonlinear, 1e-2}, {&linear, 1e-6}}) {
    FirstOrderTimeStepping simulation(*model, {0.5}, dt, *make_contact_solver("auto"));
    simulation.step();  // makes the constant matrices
    allocations = 0;
    counting = true;
    for (int k = 0; k < 1000; ++k) simulation.step();
    counting = false;
    EXPECT_EQ(allocations, 0);
  }
}

TEST(Sweeps, AllocateNothingOnceTheyHaveTheirRows) {
  std::mt19937 random(3);
  long sweeps = 0;
  for (const char* name : {"pgs", "psor", "nsgs", "prox-fixed-point"}) {
    const auto solver = make_contact_solver(name);
    solver->reserve(20);
    for (int k = 0; k < 20; ++k) {
      const ContactProblem given = random_problem(random, {.dependent = k % 3, .space = 0.5});
      const ContactProblem problem = k % 2 == 1 && solver->takes_sparse() ? with_sparse_rows(given) : given;
      Vec P = Vec::Zero(problem.rows());
      allocations = 0;
      counting = true;
      sweeps += solver->solve(problem, P.data()).iterations;
      counting = false;
      ASSERT_EQ(allocations, 0) << name;
    }
  }
  EXPECT_GT(sweeps, 1000);
}

}  // namespace
}  // namespace saltus::test
