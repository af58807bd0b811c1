#include "saltus/kernel/integrators/adaptive/trial.hpp"

namespace saltus {
namespace {

// All rows with the same contacts, and positions pulled back before the last multiplier.
bool take_rows(Rows& rows, PositionProjection& projection, const Layout& layout, const Vec& level,
               std::vector<int>& pulled, double dt, const std::vector<int>& closed, StepReport& report) {
  const int s = rows.s();
  for (int l = 1; l <= s; ++l) {
    rows.free_velocity(l, dt);
    rows.assemble(l, closed, rows.constraint(l, dt, false));
    if (!rows.finish(l, dt, closed, report) || !rows.stage(l, dt, report)) return false;
  }
  rows.move_to_end(dt);
  pulled.clear();
  const Vec& lambda = rows.at_stage(s - 1).lambda;
  for (int k : closed)
    if (layout.contacts[k].law->bilateral || lambda[layout.contacts[k].row] > 0.0) pulled.push_back(k);
  Configuration& end = rows.end();
  if (end.finite()) projection.pull(pulled, end, rows.t() + dt, rows.at(s), &level);
  if (!end.finite()) report.status = StepStatus::gap_not_finite;
  if (!end.factorise()) report.status = StepStatus::mass_not_positive_definite;
  if (report.status != StepStatus::ok) return false;
  rows.free_velocity(s + 1, dt);
  rows.assemble(s + 1, closed, rows.constraint(s + 1, dt, false));
  if (!rows.finish(s + 1, dt, closed, report)) return false;
  if (!all_finite(rows.output().v) || !all_finite(end.q())) report.status = StepStatus::not_finite;
  return report.status == StepStatus::ok;
}

class ThirdOrder final : public Trial {
 public:
  ThirdOrder() : rows_(third_order_tableau()), embedded_(3) { embedded_ << 0.5, 0.0, 0.5; }

  void prepare(const std::shared_ptr<const Layout>& layout, const NonSmoothDynamicalSystem& model,
               ContactSolver& solver, const Vec& level) override {
    layout_ = layout;
    level_ = &level;
    rows_.prepare(layout, model, solver);
    projection_ = std::make_unique<PositionProjection>(layout);
    pulled_.reserve(layout->contacts.size());
    warm_.set_zero(layout->rows);
    error_q_.setZero(layout->coordinates);
    error_v_.setZero(layout->n);
  }

  bool begin(double t, const Vec& q, const Vec& v, const Reactions& warm, StepReport& report) override {
    warm_ = warm;
    rows_.begin(t, q, v, warm_);
    return rows_.stage(0, 0.0, report);
  }

  bool take(double dt, const std::vector<int>& closed, StepReport& report) override {
    rows_.warm_start(warm_);  // what contacts did before, not what they did in a longer step
    if (!take_rows(rows_, *projection_, *layout_, *level_, pulled_, dt, closed, report)) return false;
    error_q_.setZero();
    for (int k = 0; k <= rows_.s(); ++k) {
      const Rows::Stage& stage = rows_.at_stage(k);
      const double weight = dt * (rows_.tableau().Aq(rows_.s(), k) - embedded_[k]);
      add_scaled(weight, layout_->mapped ? stage.rate : stage.v, error_q_);
    }
    if (!rows_.embedded_velocity(embedded_, dt, closed, error_v_, report)) return false;
    error_v_ -= rows_.output().v;
    return true;
  }

  void accept() override { rows_.advance(); }

  void describe(InnerStep& step) override {
    const Rows::Stage &first = rows_.at_stage(0), &output = rows_.output();
    step.q0 = start().q();
    step.v0 = first.v;
    step.q1 = end().q();
    step.v1 = output.v;
    position_rates(*layout_, step.q0, step.v0, step.rate0);
    position_rates(*layout_, step.q1, step.v1, step.rate1);
    step.mean_v.setZero();
    for (int k = 0; k <= 2; ++k) {
      Rows::Stage& stage = rows_.at_stage(k);
      add_scaled(rows_.tableau().Aq(2, k), stage.v, step.mean_v);
      step.power_place[k] = rows_.tableau().c[k];
      step.power_forces[k] = dot(stage.h, stage.v);
      step.power_lambda[k] = stage.loaded ? rows_.lambda_power(k) : 0.0;
      // λ_1 and λ_2 are of second order where they act, λ_0 at a sixth of the step.
      if (k > 0) step.place[k - 1] = rows_.tableau().c[k], step.lambda[k - 1] = stage.lambda;
    }
    step.inertia_work = inertia_work(start(), end(), step.v0, step.v1);
  }

  Configuration& start() override { return rows_.at(0); }
  Configuration& middle() override { return rows_.at(1); }
  double middle_place() const override { return rows_.tableau().c[1]; }
  Configuration& last_stage() override { return rows_.at(2); }
  Configuration& end() override { return rows_.end(); }
  const Vec& v_start() const override { return rows_.at_stage(0).v; }
  const Vec& v_middle() const override { return rows_.at_stage(1).v; }
  Vec& v_end() override { return rows_.output().v; }
  const Vec& last_acceleration() const override { return rows_.at_stage(2).acceleration; }
  const Vec& first_lambda() const override { return rows_.at_stage(0).lambda; }
  const Vec& last_lambda() const override { return rows_.at_stage(2).lambda; }
  ContactStage& contacts() override { return rows_.contacts(); }

 private:
  Rows rows_;
  Vec embedded_;  // weights of the trapezoidal rule
  Reactions warm_;
  std::shared_ptr<const Layout> layout_;
  std::unique_ptr<PositionProjection> projection_;
  const Vec* level_ = nullptr;
  std::vector<int> pulled_;
};

constexpr double most_by_extrapolation = 10.0;  // change of v, in estimated errors

class Trapezoidal final : public Trial {
 public:
  Trapezoidal() : whole_(trapezoidal_tableau()), halves_(trapezoidal_tableau()) {}

  void prepare(const std::shared_ptr<const Layout>& layout, const NonSmoothDynamicalSystem& model,
               ContactSolver& solver, const Vec& level) override {
    layout_ = layout;
    level_ = &level;
    whole_.prepare(layout, model, solver);
    halves_.prepare(layout, model, solver);
    end_ = std::make_unique<Configuration>(layout);
    projection_ = std::make_unique<PositionProjection>(layout);
    pulled_.reserve(layout->contacts.size());
    for (Vec* x : {&error_q_, &q_end_}) x->setZero(layout->coordinates);
    for (Vec* x : {&error_v_, &v_middle_, &v_end_}) x->setZero(layout->n);
    for (Vec* x : {&lambda_first_, &lambda_last_, &mean_[0], &mean_[1]}) x->setZero(layout->rows);
    warm_.set_zero(layout->rows);
  }

  bool begin(double t, const Vec& q, const Vec& v, const Reactions& warm, StepReport& report) override {
    warm_ = warm;
    whole_.begin(t, q, v, warm_);
    return whole_.stage(0, 0.0, report);
  }

  bool take(double dt, const std::vector<int>& closed, StepReport& report) override {
    whole_.warm_start(warm_);
    if (!rows(whole_, dt, closed, report)) return false;
    const double half = 0.5 * dt, t = whole_.t();
    halves_.begin(t, start().q(), whole_.at_stage(0).v, warm_);
    if (!halves_.stage(0, half, report) || !rows(halves_, half, closed, report)) return false;
    lambda_first_ = halves_.at_stage(0).lambda;
    keep_half(0, half);
    v_middle_ = halves_.output().v;
    halves_.advance();
    halves_.begin(t + half, middle().q(), v_middle_, warm_);
    if (!halves_.stage(0, half, report) || !rows(halves_, half, closed, report)) return false;
    keep_half(1, half);
    return extrapolate(dt, closed, report);
  }

  void accept() override {}

  void describe(InnerStep& step) override {
    step.q0 = start().q();
    step.v0 = whole_.at_stage(0).v;
    step.q1 = end_->q();
    step.v1 = v_end_;
    position_rates(*layout_, step.q0, step.v0, step.rate0);
    position_rates(*layout_, step.q1, step.v1, step.rate1);
    step.mean_v = (step.v0 + 4.0 * v_middle_ + step.v1) / 6.0;
    for (int half : {0, 1}) {  // means, which belong to the middle of each half
      step.place[half] = 0.25 + 0.5 * half;
      step.lambda[half] = mean_[half];
    }
    for (int k : {0, 1, 2}) {
      step.power_place[k] = 0.25 * (k + 1);
      step.power_forces[k] = 0.5 * ((2 - k) * power_forces_[0] + k * power_forces_[1]);
      step.power_lambda[k] = 0.5 * ((2 - k) * power_lambda_[0] + k * power_lambda_[1]);
    }
    step.inertia_work = 0.0;  // in the power of h
  }

  Configuration& start() override { return whole_.at(0); }
  Configuration& middle() override { return halves_.at(0); }
  double middle_place() const override { return 0.5; }
  Configuration& last_stage() override { return halves_.end(); }
  Configuration& end() override { return *end_; }
  const Vec& v_start() const override { return whole_.at_stage(0).v; }
  const Vec& v_middle() const override { return v_middle_; }
  Vec& v_end() override { return v_end_; }
  const Vec& last_acceleration() const override { return halves_.at_stage(1).acceleration; }
  const Vec& first_lambda() const override { return lambda_first_; }
  const Vec& last_lambda() const override { return lambda_last_; }
  ContactStage& contacts() override { return halves_.contacts(); }

 private:
  bool rows(Rows& rows, double dt, const std::vector<int>& closed, StepReport& report) {
    return take_rows(rows, *projection_, *layout_, *level_, pulled_, dt, closed, report);
  }

  void keep_half(int half, double dt) {
    StepReport work;
    halves_.mean_force(mean_[half]);
    halves_.take_work(dt, halves_.output().v, work);
    power_forces_[half] = work.work_forces / dt;
    power_lambda_[half] = work.work_lambda / dt;
  }

  // The halves' error is a third of the difference. Of v it is taken before the last multiplier, which then
  // keeps the constraint where the end is.
  bool extrapolate(double dt, const std::vector<int>& closed, StepReport& report) {
    Configuration& of_halves = halves_.end();
    error_q_ = (of_halves.q() - whole_.end().q()) / 3.0;
    error_v_ = (halves_.output().v - whole_.output().v) / 3.0;
    q_end_ = of_halves.q() + error_q_;
    if (layout_->mapped) normalise(*layout_, q_end_);
    end_->move_to(q_end_, whole_.t() + dt);
    if (!end_->finite()) {
      report.status = StepStatus::gap_not_finite;
      return false;
    }
    projection_->pull(pulled_, *end_, whole_.t() + dt, of_halves, level_);
    const Vec& v = halves_.output().v;
    const Rows::Stage& last = halves_.at_stage(1);
    v_end_ = v + error_v_;
    lambda_last_ = last.lambda;
    if (last.loaded) add_scaled(-0.5 * dt * halves_.tableau().Av(1, 1), last.reaction, v_end_);
    if (!halves_.redo_last(0.5 * dt, closed, *end_, v_end_, lambda_last_, report)) return false;
    // Contacts that depend on each other can have several velocities: this is to be the one of the halves.
    const double most = most_by_extrapolation * (error_v_.cwiseAbs().maxCoeff() + layout_->tolerance);
    if ((v_end_ - v).cwiseAbs().maxCoeff() > most) {
      v_end_ = v;
      lambda_last_ = last.lambda;
    }
    if (!all_finite(v_end_)) report.status = StepStatus::not_finite;
    return report.status == StepStatus::ok;
  }

  Rows whole_, halves_;
  std::shared_ptr<const Layout> layout_;
  std::unique_ptr<PositionProjection> projection_;
  std::unique_ptr<Configuration> end_;
  const Vec* level_ = nullptr;
  std::vector<int> pulled_;
  Reactions warm_;
  Vec q_end_, v_middle_, v_end_, lambda_first_, lambda_last_;
  Vec mean_[2];  // of λ in each half [N]
  double power_forces_[2] = {}, power_lambda_[2] = {};
};

}  // namespace

std::unique_ptr<Trial> trapezoidal_trial() { return std::make_unique<Trapezoidal>(); }

std::unique_ptr<Trial> third_order_trial() { return std::make_unique<ThirdOrder>(); }

}  // namespace saltus
