#include "saltus/kernel/integrators/half_explicit/rows.hpp"

namespace saltus {

Rows::Rows(Tableau tableau, bool on_velocity_level) : tableau_(std::move(tableau)) {
  validate(tableau_);
  s_ = tableau_.stages() - 1;
  explicit_.assign(s_ + 2, true);
  same_as_last_.assign(s_ + 2, false);
  is_end_.assign(s_ + 2, false);
  for (int l = 1; l <= s_ + 1; ++l) {
    explicit_[l] = l == s_ + 1 || (on_velocity_level && tableau_.Ac.row(l - 1) == tableau_.Aq.row(l - 1));
    same_as_last_[l] = l > 1 && tableau_.Aq.row(l - 1) == tableau_.Aq.row(l - 2);
    is_end_[l] = tableau_.Aq.row(l - 1) == tableau_.Aq.row(s_);
  }
}

void Rows::prepare(std::shared_ptr<const Layout> layout, const NonSmoothDynamicalSystem& model,
                   ContactSolver& solver) {
  layout_ = std::move(layout);
  slot_.assign(1, 0);
  for (int l = 1; l <= s_ + 1; ++l) slot_.push_back(slot_.back() + (same_as_last_[l] ? 0 : 1));
  const Configuration blank(layout_);
  configurations_.assign(slot_.back() + 1, blank);
  for (auto& configuration : configurations_) configuration.move_to(model.q0(), model.t0());
  predicted_ = std::make_unique<Configuration>(blank);
  contacts_ = std::make_unique<ContactStage>(layout_, solver);
  sliding_ = std::make_unique<Sliding>(layout_);
  stages_.resize(s_ + 2);
  for (Stage& stage : stages_) {
    for (Vec* x : {&stage.v, &stage.h, &stage.acceleration, &stage.reaction}) x->setZero(layout_->n);
    if (layout_->mapped) stage.rate.setZero(layout_->coordinates);
    stage.lambda.setZero(layout_->rows);
  }
  q_.setZero(layout_->coordinates);
  gamma_.setZero(layout_->rows);
}

void Rows::begin(double t, const Vec& q, const Vec& v, const Reactions& warm) {
  t_ = t;
  if (!at(0).is_at(q, t_)) at(0).move_to(q, t_);
  stages_[0].v = v;
  if (layout_->mapped) position_rates(*layout_, q, v, stages_[0].rate);
  warm_start(warm);
}

void Rows::warm_start(const Reactions& before) {
  stages_[0].lambda = before.lambda_plus;
  stages_[s_].lambda = s_ > 0 ? before.lambda_minus : before.lambda_plus;
}

void Rows::locate(int l, double dt) {
  position(tableau_.Aq, l, dt);
  if (is_end_[l])
    move(at(l), l, dt);
  else
    at(l).move_without_gaps(q_, time(l, dt));
}

void Rows::move_to_end(double dt) {
  if (same_as_last_[s_ + 1]) return;
  position(tableau_.Aq, s_ + 1, dt);
  move(end(), s_ + 1, dt);
}

// q_ <- q_0 + Δt Σ_k A_lk q̇_k
void Rows::position(const Matrix& A, int l, double dt) {
  q_ = at(0).q();
  const double* weight = &A(l - 1, 0);
  for (int k = 0; k <= s_; ++k)
    if (weight[k] != 0.0) add_scaled(dt * weight[k], layout_->mapped ? stages_[k].rate : stages_[k].v, q_);
}

// To q_ at the time of row l. Only the end is brought back to allowed coordinates: rates of stages that were
// would not belong together.
void Rows::move(Configuration& configuration, int l, double dt) {
  if (layout_->mapped && is_end_[l]) normalise(*layout_, q_);
  configuration.move_to(q_, time(l, dt));
}

bool Rows::stage(int l, double dt, StepReport& report) {
  Stage& stage = stages_[l];
  if (!at(l).factorise()) {
    report.status = StepStatus::mass_not_positive_definite;
    return false;
  }
  evaluate_forces(*layout_, t_ + tableau_.c[l] * dt, at(l).q(), stage.v, stage.h);
  stage.acceleration = stage.h;
  at(l).solve_mass(stage.acceleration);
  return true;
}

void Rows::free_velocity(int l, double dt) {
  Vec& v = stages_[l].v;
  v = stages_[0].v;
  for (int k = 0; k < l - 1; ++k) {
    add_scaled(dt * tableau_.Av(l - 1, k), stages_[k].acceleration, v);
    if (stages_[k].loaded) add_scaled(dt * tableau_.Av(l - 1, k), stages_[k].reaction, v);
  }
  add_scaled(dt * tableau_.Av(l - 1, l - 1), stages_[l - 1].acceleration, v);
}

Configuration& Rows::constraint(int l, double dt, bool gaps) {
  // A constant W needs no prediction, unless gaps are wanted there.
  const bool foreseen = !explicit_[l] && !layout_->varying_jacobian && !layout_->rheonomous && !gaps;
  Configuration& constraint = explicit_[l] ? at(l) : foreseen ? at(0) : *predicted_;
  if (l <= s_ && !foreseen && !(explicit_[l] && same_as_last_[l])) {
    position(tableau_.Ac, l, dt);
    if (explicit_[l] || gaps)
      move(constraint, l, dt);
    else
      constraint.move_without_gaps(q_, time(l, dt));
  }
  return constraint;
}

void Rows::assemble(int l, const std::vector<int>& active, Configuration& constraint) {
  if (active.empty()) return;
  contacts_->assembly().assemble(active, constraint, at(l - 1), at(l - 1));
  contacts_->assembly().set_b(constraint, stages_[l].v);
}

void Rows::assemble_acceleration(int l, double dt, const std::vector<int>& active) {
  if (active.empty()) return;
  const Stage& force = stages_[l - 1];
  contacts_->assembly().assemble(active, at(l - 1), at(l - 1), at(l - 1));
  contacts_->assembly().set_b_of_acceleration(at(l - 1), force.v, force.acceleration,
                                              dt * tableau_.Av(l - 1, l - 1));
}

bool Rows::finish(int l, double dt, const std::vector<int>& active, StepReport& report) {
  Stage& force = stages_[l - 1];
  Stage& next = stages_[l];
  const double weight = dt * tableau_.Av(l - 1, l - 1);
  force.loaded = !active.empty();
  if (!force.loaded) {
    force.lambda.setZero();
  } else {
    ContactAssembly& assembly = contacts_->assembly();
    // Warm start: the first and the last multiplier from the step before, the others from the row before.
    const bool inner = l > 1 && l <= s_;
    sliding_->clear();
    sliding_->add(active, at(l - 1), force.v);
    if (!solve(inner ? stages_[l - 2].lambda : force.lambda, weight, report)) return false;
    force.lambda.setZero();
    assembly.scatter(contacts_->P(), 1.0 / weight, force.lambda);
    force.reaction.setZero();
    assembly.apply(1.0 / weight, contacts_->P().data(), force.reaction);
    add_scaled(weight, force.reaction, next.v);
  }

  if (l <= s_ && layout_->mapped) {  // Y where v_l is not needed to get there
    if (!explicit_[l]) position(tableau_.Ac, l, dt);
    position_rates(*layout_, explicit_[l] ? at(l).q() : q_, next.v, next.rate);
  }
  if (l <= s_ && !explicit_[l] && !same_as_last_[l]) {
    position(tableau_.Aq, l, dt);
    move(at(l), l, dt);
  }
  return true;
}

bool Rows::solve(const Vec& lambda, double weight, StepReport& report) {
  const ContactAssembly& assembly = contacts_->assembly();
  assembly.gather(lambda, weight, contacts_->P());
  return sliding_->any() ? sliding_->solve(*contacts_, assembly.problem(), contacts_->P(), report)
                         : contacts_->solve(report);
}

bool Rows::embedded_velocity(const Vec& b, double dt, const std::vector<int>& active, Vec& v,
                             StepReport& report) {
  v = stages_[0].v;
  for (int k = 0; k <= s_; ++k) {
    add_scaled(dt * b[k], stages_[k].acceleration, v);
    if (k < s_ && stages_[k].loaded) add_scaled(dt * b[k], stages_[k].reaction, v);
  }
  if (active.empty()) return true;
  contacts_->assembly().set_b(end(), v);
  if (!solve(stages_[s_].lambda, dt * b[s_], report)) return false;
  contacts_->assembly().apply(1.0, contacts_->P().data(), v);
  return true;
}

bool Rows::redo_last(double dt, const std::vector<int>& active, Configuration& end, Vec& v, Vec& lambda,
                     StepReport& report) {
  if (active.empty()) return true;
  ContactAssembly& assembly = contacts_->assembly();
  const double weight = dt * tableau_.Av(s_, s_);
  assembly.assemble(active, end, at(s_), at(s_));
  assembly.set_b(end, v);
  if (!solve(lambda, weight, report)) return false;
  lambda.setZero();
  assembly.scatter(contacts_->P(), 1.0 / weight, lambda);
  assembly.apply(1.0, contacts_->P().data(), v);
  return true;
}

void Rows::take_work(double dt, const Vec& v_end, StepReport& report) {
  report.work_forces = inertia_work(at(0), end(), stages_[0].v, v_end);
  for (int k = 0; k <= s_; ++k) {
    const double weight = dt * tableau_.Av(s_, k);
    report.work_forces += weight * dot(stages_[k].h, stages_[k].v);
    if (stages_[k].loaded) report.work_lambda += weight * lambda_power(k);
  }
}

double Rows::lambda_power(int k) {
  double power = 0.0;
  for (int contact = 0; contact < static_cast<int>(layout_->contacts.size()); ++contact) {
    const auto& slot = layout_->contacts[contact];
    const double* lambda = stages_[k].lambda.data() + slot.row;
    if (lambda[0] == 0.0 && !slot.law->bilateral) continue;
    double* gamma = gamma_.data() + slot.row;
    at(k).velocity_of_work(contact, stages_[k].v, gamma);
    for (int i = 0; i < slot.rows; ++i) power += lambda[i] * gamma[i];
  }
  return power;
}

void Rows::mean_force(Vec& force) const {
  force.setZero();
  for (int k = 0; k <= s_; ++k) add_scaled(tableau_.Av(s_, k), stages_[k].lambda, force);
}

void Rows::advance() {
  std::swap(slot_[0], slot_[s_ + 1]);
  for (int l = s_; l > 0 && same_as_last_[l + 1]; --l) slot_[l] = slot_[l + 1];
}

}  // namespace saltus
