#include "saltus/siconos/run.hpp"

#include <NonSmoothDynamicalSystem.hpp>
#include <algorithm>
#include <optional>
#include <stdexcept>

#include "saltus/numerics/solvers/registry.hpp"
#include "saltus/numerics/text.hpp"
#include "saltus/siconos/live_model.hpp"
#include "saltus/siconos/scheme_name.hpp"

namespace saltus::siconos {
namespace {

struct Moment {
  State state;
  Reactions reactions;
};

bool same(const State& a, const State& b) { return a.t == b.t && a.q == b.q && a.v == b.v; }

}  // namespace

struct Run::Parts {
  std::unique_ptr<saltus::OneStepIntegrator> scheme;
  std::unique_ptr<ContactSolver> solver;
  std::optional<LiveModel> live;
  Moment now, start, end;  // what is remembered by the systems; start and end of the last step

  void adopt_model(::NonSmoothDynamicalSystem& nsds, double t);
  void recall(double t);
  void begin(double t);
  void write(const Moment& moment, double dt) const;
};

void Run::Parts::adopt_model(::NonSmoothDynamicalSystem& nsds, double t) {
  live = adopt(nsds, t);
  scheme->prepare(live->model, *solver);
  int rows = 0;
  for (const auto& interaction : live->interactions) rows += static_cast<int>(interaction->dimension());
  now = {{t, live->model.q0(), live->model.v0()}, {}};
  now.state.held.reserve(live->interactions.size());
  now.reactions.set_zero(rows);
  recall(t);
  start = end = now;
}

void Run::Parts::recall(double t) {
  now.state.t = t;
  double* q = now.state.q.data();
  double* v = now.state.v.data();
  for (const auto& ds : live->systems) {
    const int n = static_cast<int>(ds->dimension());
    q = std::copy_n(ds->qMemory().getSiconosVector(0).getArray(), n, q);
    v = std::copy_n(ds->velocityMemory().getSiconosVector(0).getArray(), n, v);
  }
}

// Goes on where the last step ended, or where it started: it is then taken again. From any other state
// nothing is known about contacts.
void Run::Parts::begin(double t) {
  recall(t);
  if (same(now.state, end.state))
    start = end;
  else if (!same(now.state, start.state))
    start = now;
  end = start;
}

void Run::Parts::write(const Moment& moment, double dt) const {
  const double* q = moment.state.q.data();
  const double* v = moment.state.v.data();
  for (const auto& ds : live->systems) {
    const int n = static_cast<int>(ds->dimension());
    std::copy_n(q, n, ds->q()->getArray());
    std::copy_n(v, n, ds->velocity()->getArray());
    q += n;
    v += n;
  }
  int row = 0;
  for (const auto& interaction : live->interactions)
    for (unsigned k = 0; k < interaction->dimension(); ++k, ++row)
      interaction->lambda(1)->setValue(k, moment.reactions.impulse[row] + dt * moment.reactions.force[row]);
}

Run::Run(const std::string& scheme, const std::string& solver) : parts_(std::make_unique<Parts>()) {
  parts_->scheme = make_scheme(scheme);
  parts_->solver = make_contact_solver(solver);
}

Run::~Run() = default;

void Run::forget_model() { parts_->live.reset(); }

std::string Run::step(::NonSmoothDynamicalSystem& nsds, double t, double end, double dt) {
  Parts& p = *parts_;
  if (!p.live || p.live->interactions.size() != nsds.getNumberOfInteractions()) p.adopt_model(nsds, t);
  p.begin(t);
  const StepReport report = p.scheme->step(dt, p.end.state, p.end.reactions);
  const bool done = report.status == StepStatus::ok;
  if (done)
    p.end.state.t = end;
  else
    p.end = p.start;
  p.write(p.end, dt);
  if (done) return "";
  const std::string about =
      report.contact < 0 ? "" : "'" + p.live->model.links()[report.contact].name + "': ";
  return "step from t = " + number(t) + " s failed: " + about + std::string(to_string(report.status)) +
         " (residual " + number(report.residual) + " m/s)";
}

ContactForces Run::contact_forces(const ::Interaction& interaction) const {
  int row = 0;
  if (parts_->live)
    for (const auto& known : parts_->live->interactions) {
      const int rows = static_cast<int>(known->dimension());
      const auto part = [&](const Vec& all) {
        return std::vector<double>(all.data() + row, all.data() + row + rows);
      };
      const Reactions& r = parts_->end.reactions;
      if (known.get() == &interaction)
        return {part(r.lambda_plus), part(r.lambda_minus), part(r.force), part(r.impulse)};
      row += rows;
    }
  throw std::invalid_argument("expected an interaction of the last step, got interaction " +
                              std::to_string(interaction.number()));
}

std::string Run::name() const { return parts_->scheme->name(); }

}  // namespace saltus::siconos
