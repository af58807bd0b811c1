#include "saltus/kernel/integrators/event_driven/runge_kutta.hpp"

#include <arkode/arkode_erkstep.h>
#include <nvector/nvector_serial.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <sundials/sundials_context.hpp>
#include <utility>

namespace saltus {
namespace {

constexpr double ulp = std::numeric_limits<double>::epsilon();
constexpr double smallest_unit = 1e-3;   // entries smaller than this have this size: 1 mm, 1 mm/s...
constexpr double reduction = 0.1;        // of a step at which f is not finite
constexpr double smallest_step = 1e-12;  // relative to the first that was tried: f is singular
constexpr long most_rejections = 50;     // of a step by its error; SUNDIALS counts from 7 on as a failure

struct FreeVector {
  void operator()(N_Vector x) const { N_VDestroy(x); }
};
using Vector = std::unique_ptr<_generic_N_Vector, FreeVector>;

Vector make_vector(int size, SUNContext context) {
  Vector x(N_VNew_Serial(size, context));
  if (!x) throw std::bad_alloc();
  return x;
}

// In the place of the root mean square, in which many systems hide the error of one.
double largest(N_Vector x, N_Vector weight) {
  const double *a = N_VGetArrayPointer(x), *w = N_VGetArrayPointer(weight);
  double size = 0.0;
  for (sunindextype k = 0, n = N_VGetLength(x); k < n; ++k) {
    const double own = std::abs(a[k] * w[k]);
    if (!(own <= size)) size = own;  // or NaN
  }
  return std::isfinite(size) ? size : 1e30;  // far too large: the step is tried again
}

void be_silent(int, const char*, const char*, char*, void*) {}

}  // namespace

struct RungeKutta::Sundials {
  struct Callbacks {
    Ode* ode;
    std::exception_ptr* error;
    int controlled;
    double rtol;
    bool idle;  // the storage is made, f is not asked yet
  };

  Sundials(int size, Callbacks own) : callbacks(own), state(make_vector(size, context)) {
    state->ops->nvwrmsnorm = largest;  // its clones have it as well
    memory = ERKStepCreate(rate, 0.0, state.get(), context);
    if (!memory) throw std::bad_alloc();
  }
  ~Sundials() { ERKStepFree(&memory); }
  Sundials(const Sundials&) = delete;
  Sundials& operator=(const Sundials&) = delete;

  // 0: done, 1: try a smaller step, -1: give up
  template <class Call>
  static int guarded(Callbacks& own, Call call) noexcept {
    try {
      return call() ? 0 : 1;
    } catch (...) {
      *own.error = std::current_exception();
      return -1;
    }
  }
  static int rate(double t, N_Vector y, N_Vector dydt, void* data) {
    auto& own = *static_cast<Callbacks*>(data);
    double* to = N_VGetArrayPointer(dydt);
    if (own.idle) {
      std::fill_n(to, N_VGetLength(dydt), 0.0);
      return 0;
    }
    return guarded(own, [&] { return own.ode->rate(t, N_VGetArrayPointer(y), to); });
  }
  static int project(double t, N_Vector y, void* data) {
    auto& own = *static_cast<Callbacks*>(data);
    if (own.idle) return 0;
    return guarded(own, [&] { return own.ode->project(t, N_VGetArrayPointer(y)); });
  }
  static int weigh(N_Vector y, N_Vector weight, void* data) {
    const auto& own = *static_cast<Callbacks*>(data);
    const double* from = N_VGetArrayPointer(y);
    double* to = N_VGetArrayPointer(weight);
    for (sunindextype k = 0, n = N_VGetLength(y); k < n; ++k)
      to[k] = k < own.controlled ? 1.0 / (own.rtol * std::max(std::abs(from[k]), smallest_unit)) : 0.0;
    return 0;
  }

  sundials::Context context;
  Callbacks callbacks;
  Vector state;
  void* memory = nullptr;
};

RungeKutta::RungeKutta(Ode& ode, int size, int controlled, double rtol)
    : ode_(ode),
      sundials_(
          std::make_unique<Sundials>(size, Sundials::Callbacks{&ode_, &error_, controlled, rtol, true})),
      y_(Vec::Zero(size)) {
  void* memory = sundials_->memory;
  ERKStepSetErrHandlerFn(memory, be_silent, nullptr);
  ERKStepSetUserData(memory, &sundials_->callbacks);
  ERKStepWFtolerances(memory, Sundials::weigh);
  ERKStepSetTableNum(memory, ARKODE_VERNER_8_5_6);
  ERKStepSetPostprocessStepFn(memory, Sundials::project);
  ERKStepSetMaxErrTestFails(memory, most_rejections);
  ERKStepSetMaxHnilWarns(memory, -1);
  start(0.0, y_, 1.0);  // a step without f: SUNDIALS makes its storage in the first one
  try_step(1.0);
  sundials_->callbacks.idle = false;
}

RungeKutta::~RungeKutta() = default;

void RungeKutta::start(double t, const Vec& y, double h) {
  t_ = t;
  y_ = y;
  h_ = h;
  std::copy_n(y.data(), y.size(), N_VGetArrayPointer(sundials_->state.get()));
  ERKStepReset(sundials_->memory, t, sundials_->state.get());
  ERKStepSetInitStep(sundials_->memory, h);
}

bool RungeKutta::step(double until) {
  const double least = smallest_step * std::min(h_, until - t_);
  for (double h = std::min(h_, until - t_);; h *= reduction) {
    if (try_step(until)) return true;
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
    if (!(h * reduction > std::max(least, 4.0 * ulp * std::abs(t_)))) return false;
    start(t_, y_, h * reduction);
    ++rejected_;
  }
}

bool RungeKutta::try_step(double until) {
  if (until - t_ <= 4.0 * ulp * std::max(std::abs(t_), std::abs(until))) {  // SUNDIALS takes no such step
    t_ = until;
    return true;
  }
  void* memory = sundials_->memory;
  N_Vector y = sundials_->state.get();
  ERKStepSetStopTime(memory, until);
  long failures_before = 0, failures = 0;
  ERKStepGetNumErrTestFails(memory, &failures_before);
  double reached = t_;
  const int status = ERKStepEvolve(memory, until, y, &reached, ARK_ONE_STEP);
  if (status < 0) return false;
  ERKStepGetNumErrTestFails(memory, &failures);
  rejected_ += failures - failures_before;
  t_ = status == ARK_TSTOP_RETURN ? until : reached;
  std::copy_n(N_VGetArrayPointer(y), y_.size(), y_.data());
  ERKStepGetCurrentStep(memory, &h_);
  return true;
}

}  // namespace saltus
