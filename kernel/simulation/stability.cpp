#include "saltus/kernel/simulation/stability.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "saltus/kernel/model/lagrangian_linear_tids.hpp"
#include "saltus/kernel/simulation/modes.hpp"
#include "saltus/numerics/solvers/registry.hpp"
#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

constexpr double harmless = 0.01;  // growth in a period: over a few of them it does not show
constexpr double rounding = 1e-7;  // growth in a period of the smallest steps below
constexpr double smallest = 1e-6;  // step where a scheme must be stable if it ever is, times the rate
constexpr int halvings = 60;

// One freedom with unit mass
NonSmoothDynamicalSystem oscillator(const Mode& mode) {
  LagrangianLinearTIDS::Terms terms{.stiffness = Matrix::Constant(1, 1, mode.stiffness),
                                    .damping = Matrix::Constant(1, 1, mode.damping)};
  return NonSmoothDynamicalSystem({std::make_shared<LagrangianLinearTIDS>(
      Vec::Zero(1), Vec::Zero(1), Matrix::Identity(1, 1), std::move(terms))});
}

// A mode under a copy of the scheme
class TestOscillator {
 public:
  TestOscillator(const Mode& mode, const OneStepIntegrator& scheme)
      : model_(oscillator(mode)), solver_(make_contact_solver("auto")), scheme_(scheme.clone()) {
    const double half = 0.5 * mode.damping;
    rate_ = half + std::sqrt(std::max(half * half - mode.stiffness, 0.0));  // of its fastest part
    rate_ = std::max(rate_, std::sqrt(mode.stiffness));
    scheme_->prepare(model_, *solver_);
  }
  double rate() const { return rate_; }

  // Logarithm of the growth in a period [-]; NaN if a step fails
  double growth(double dt) const {
    Eigen::Matrix2d A;
    for (int column : {0, 1}) {
      State state{0.0, Vec::Constant(1, column == 0), Vec::Constant(1, column == 1 ? rate_ : 0.0)};
      Reactions reactions;
      reactions.set_zero(0);
      const StepReport report = scheme_->step(dt, state, reactions);
      if (report.status != StepStatus::ok) return std::numeric_limits<double>::quiet_NaN();
      A.col(column) << state.q[0], state.v[0] / rate_;
    }
    const double half_trace = 0.5 * A.trace(), determinant = A.determinant();
    // Not half_trace² − determinant, whose digits cancel near a double eigenvalue.
    const double half_difference = 0.5 * (A(0, 0) - A(1, 1));
    const double discriminant = half_difference * half_difference + A(0, 1) * A(1, 0);
    const double radius =
        discriminant < 0.0 ? std::sqrt(determinant) : std::abs(half_trace) + std::sqrt(discriminant);
    return std::log(radius) * std::max(1.0, 2.0 * std::numbers::pi / (rate_ * dt));
  }

 private:
  NonSmoothDynamicalSystem model_;
  std::unique_ptr<ContactSolver> solver_;
  std::unique_ptr<OneStepIntegrator> scheme_;
  double rate_;
};

// Largest Δt up to which it grows by at most `bound` in a period, below one where it grows by more
double largest_within(const TestOscillator& oscillator, double bound, double unstable) {
  double stable = smallest / oscillator.rate();
  if (stable >= unstable || !(oscillator.growth(stable) <= bound)) return 0.0;
  for (int k = 0; k < halvings && unstable / stable > 1.0 + 1e-12; ++k) {
    const double middle = std::sqrt(stable * unstable);
    (oscillator.growth(middle) <= bound ? stable : unstable) = middle;
  }
  return stable;
}

// 0 if it grows at every Δt: if little enough, a small one hides it, but not half of that beyond rounding
double largest_stable(const TestOscillator& oscillator, double unstable) {
  const double limit = largest_within(oscillator, rounding, unstable), half = 0.5 * limit;
  const double noise = 2.0 * std::numbers::pi * 2e-15 / (oscillator.rate() * half);
  return limit > 0.0 && oscillator.growth(half) <= noise ? limit : 0.0;
}

}  // namespace

std::string Instability::message(const std::string& scheme) const {
  std::string text = "time_step = " + number(time_step) + " s is too large for " + scheme +
                     ": the free motion of system " + std::to_string(system) +
                     " with omega = " + number(omega) + " rad/s";
  if (decay > 0.0) text += ", damped with 2 zeta omega = " + number(decay) + " 1/s,";
  text += " grows by a factor of " + number(growth) + " in a period";
  if (largest_stable > 0.0)
    return text + "; the largest stable time_step is " + number(largest_stable) + " s";
  text += "; without more damping it grows at every small time_step";
  if (largest_harmless > 0.0)
    text += ", up to " + number(largest_harmless) + " s by less than 1 % in a period";
  return text;
}

std::optional<Instability> find_instability(const NonSmoothDynamicalSystem& model,
                                            const OneStepIntegrator& scheme, double time_step) try {
  std::optional<Instability> worst;
  double largest = std::log1p(harmless);
  for (const Mode& mode : fastest_modes(model)) {
    const TestOscillator oscillator(mode, scheme);
    const double growth = oscillator.growth(time_step);
    if (!(growth > largest)) continue;
    largest = growth;
    worst = {time_step,
             std::sqrt(std::max(mode.stiffness, 0.0)),
             mode.damping,
             mode.system,
             std::exp(growth),
             largest_stable(oscillator, time_step),
             largest_within(oscillator, std::log1p(harmless), time_step)};
  }
  return worst;
} catch (const std::exception&) {
  return std::nullopt;  // a scheme made for other models: its own run will tell
}

}  // namespace saltus
