#include "saltus/kernel/assembly/configuration.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "saltus/kernel/assembly/force_elements.hpp"
#include "saltus/kernel/model/requirements.hpp"
#include "saltus/numerics/contact_solver.hpp"

namespace saltus {
namespace {

constexpr double rounding = 1e-15;  // relative, of a sum of a few terms

// Factorises a constant M, which must be a mass matrix.
template <class AnyMatrix, class Factorise>
void require_factor(const AnyMatrix& M, const std::string& what, Factorise factorise) {
  require_mass(M, static_cast<int>(M.rows()), what);
  if (!factorise(M)) throw std::invalid_argument(what + " is too small to be inverted");
}

}  // namespace

Configuration::Configuration(std::shared_ptr<const Layout> layout) : layout_(std::move(layout)) {
  q_.setZero(layout_->coordinates);
  gaps_.setZero(layout_->gaps);
  for (Vec* x : {&local_q_, &local_v_}) x->setZero(layout_->largest_contact);
  curvature_.setZero(layout_->most_rows);
  mass_.assign(layout_->mass_entries, 0.0);
  jacobians_.assign(layout_->jacobian_entries, 0.0);
  for (const auto& contact : layout_->contacts) columns_.insert(columns_.end(), contact.rows, {0, contact.n});
  has_jacobian_.assign(layout_->contacts.size(), 0);
  has_motion_.assign(layout_->contacts.size(), 0);
  motions_.setZero(layout_->rows);
  closed_.assign(layout_->contacts.size(), 0);
  factors_.resize(layout_->systems.size());
  auto constant = std::make_shared<std::vector<SpdFactor>>(layout_->systems.size());
  auto sparse = std::make_shared<std::vector<SparseFactor>>(layout_->systems.size());
  for (std::size_t k = 0; k < layout_->systems.size(); ++k) {
    const auto& system = layout_->systems[k];
    if (!system.constant_mass) {
      factors_[k].reserve(system.n);
      continue;
    }
    const std::string what = "mass of system " + std::to_string(k);
    if (system.sparse) {
      require_factor(system.sparse->mass.entries(), what,
                     [&](const SparseEntries& M) { return (*sparse)[k].factorise_positive(M); });
      continue;
    }
    OutMatrix M(mass_.data() + system.block, system.n, system.n);
    system.model->mass({q_.data() + system.first, system.coordinates}, M);
    require_factor(Matrix(M), what, [&](const Matrix& own) {
      return (*constant)[k].factorise_constant({own.data(), system.n, system.n});
    });
  }
  constant_factors_ = std::move(constant);
  sparse_factors_ = std::move(sparse);
}

void Configuration::move_without_gaps(const Vec& q, double t) {
  q_ = q;
  t_ = t;
  placed_ = false;
  factorised_ = !layout_->varying_mass;
  for (std::size_t k = 0; k < has_jacobian_.size(); ++k)
    has_jacobian_[k] = has_jacobian_[k] && layout_->contacts[k].constant_jacobian;
  if (layout_->rheonomous) std::fill(has_motion_.begin(), has_motion_.end(), 0);
}

void Configuration::move_to(const Vec& q, double t) {
  move_without_gaps(q, t);
  gaps_.setZero();
  closed_count_ = 0;
  for (int k = 0; k < static_cast<int>(layout_->contacts.size()); ++k) {
    const auto& contact = layout_->contacts[k];
    const Out gap(gaps_.data() + contact.gap, contact.gaps);
    if (contact.rheonomous)  // not always gap_at(), which costs another call
      contact.relation->gap_at(t, local_position(contact), gap);
    else
      contact.relation->gap(local_position(contact), gap);
    if (closed(k)) closed_[closed_count_++] = k;
  }
  placed_ = true;  // no gap has thrown
}

bool Configuration::factorise() {
  if (factorised_) return true;
  for (std::size_t k = 0; k < layout_->systems.size(); ++k) {
    const auto& system = layout_->systems[k];
    if (system.constant_mass) continue;
    double* block = mass_.data() + system.block;
    std::fill_n(block, static_cast<std::size_t>(system.n) * system.n, 0.0);
    system.model->mass({q_.data() + system.first, system.coordinates}, {block, system.n, system.n});
    if (!factors_[k].factorise({block, system.n, system.n})) return false;
  }
  factorised_ = true;
  return true;
}

void Configuration::solve_mass(Vec& x) const {
  for (std::size_t k = 0; k < layout_->systems.size(); ++k)
    solve_block(static_cast<int>(k), x.data() + layout_->systems[k].offset);
}

void Configuration::multiply_mass(const Vec& x, Vec& y) const {
  for (const auto& system : layout_->systems) {
    if (system.sparse) {
      y.segment(system.offset, system.n).setZero();
      system.sparse->mass.add_product(1.0, x.data() + system.offset, y.data() + system.offset);
      continue;
    }
    const InMatrix M(mass_.data() + system.block, system.n, system.n);
    y.segment(system.offset, system.n).noalias() = M * x.segment(system.offset, system.n);
  }
}

InMatrix Configuration::mass(int system) const {
  const auto& slot = layout_->systems[system];
  return {mass_.data() + slot.block, slot.n, slot.n};
}

double Configuration::kinetic_energy(const Vec& v, bool only_varying) const {
  double twice = 0.0;
  for (const auto& system : layout_->systems) {
    if (only_varying && system.constant_mass) continue;
    const double* M = mass_.data() + system.block;
    const double* w = v.data() + system.offset;
    if (system.sparse) {
      twice += system.sparse->mass.form(w);
      continue;
    }
    for (int i = 0; i < system.n; ++i, M += system.n) {
      double sum = 0.0;
      for (int j = 0; j < system.n; ++j) sum += M[j] * w[j];
      twice += w[i] * sum;
    }
  }
  return 0.5 * twice;
}

bool Configuration::finite(int contact) const {
  const auto& slot = layout_->contacts[contact];
  return gaps_.segment(slot.gap, slot.gaps).allFinite();
}

double Configuration::penetration() const {
  double deepest = 0.0;
  for (int k : closed_contacts())
    if (!layout_->contacts[k].law->bilateral) deepest = std::max(deepest, -gaps_[layout_->contacts[k].gap]);
  return deepest;
}

void Configuration::evaluate_jacobian(int contact) {
  const auto& slot = layout_->contacts[contact];
  double* J = jacobians_.data() + slot.jacobian;
  std::fill_n(J, static_cast<std::size_t>(slot.rows) * slot.n, 0.0);
  const OutMatrix rows(J, slot.rows, slot.n);
  if (slot.rheonomous)
    slot.relation->jacobian_at(t_, local_position(slot), rows);
  else
    slot.relation->jacobian(local_position(slot), rows);
  has_jacobian_[contact] = 1;
  if (!slot.constant_jacobian) return;
  for (int i = 0; i < slot.rows; ++i, J += slot.n) {
    Columns& columns = columns_[slot.row + i];
    while (columns.last > 0 && J[columns.last - 1] == 0.0) --columns.last;
    while (columns.first < columns.last && J[columns.first] == 0.0) ++columns.first;
  }
}

// Calls function(entry, freedom) for a row of Wᵀ. A contact of a bar moves a few of its freedoms.
template <class Function>
void Configuration::for_jacobian(int contact, int row, Function function) {
  const auto& slot = layout_->contacts[contact];
  const double* J = jacobian(contact) + static_cast<std::size_t>(row) * slot.n;
  const Columns columns = columns_[slot.row + row];
  int start = 0;  // column of the side
  for (int side = 0; side < slot.sides; ++side) {
    const auto& system = layout_->systems[slot.system[side]];
    const int last = std::min(columns.last, start + system.n);
    for (int j = std::max(columns.first, start); j < last; ++j) function(J[j], system.offset + j - start);
    start += system.n;
  }
}

const double* Configuration::motion(int contact) {
  const auto& slot = layout_->contacts[contact];
  double* w = motions_.data() + slot.row;
  if (!has_motion_[contact]) {
    std::fill_n(w, slot.rows, 0.0);
    slot.relation->motion_at(t_, local_position(slot), {w, slot.rows});
    has_motion_[contact] = 1;
  }
  return w;
}

void Configuration::relative_velocity(int contact, const Vec& v, double* gamma) {
  velocity_of_work(contact, v, gamma);
  const auto& slot = layout_->contacts[contact];
  if (!slot.rheonomous) return;
  const double* w = motion(contact);
  for (int i = 0; i < slot.rows; ++i) gamma[i] += w[i];
}

void Configuration::velocity_of_work(int contact, const Vec& v, double* gamma) {
  for (int i = 0; i < layout_->contacts[contact].rows; ++i) {
    double sum = 0.0;
    for_jacobian(contact, i, [&](double entry, int freedom) { sum += entry * v[freedom]; });
    gamma[i] = sum;
  }
}

void Configuration::add_forces(int contact, const double* lambda, Vec& x) {
  for (int i = 0; i < layout_->contacts[contact].rows; ++i)
    for_jacobian(contact, i, [&](double entry, int freedom) { x[freedom] += entry * lambda[i]; });
}

double Configuration::velocity_tolerance(int contact, const Vec& v, const Vec& a, double dt) {
  double size = 0.0;
  const auto& slot = layout_->contacts[contact];
  for (int row = 0; row < slot.gaps; ++row) {  // of a joint the largest: nothing may move along the others
    double own = slot.rheonomous ? std::abs(motion(contact)[row]) : 0.0;
    for_jacobian(contact, row, [&](double entry, int freedom) {
      own += std::abs(entry) * (std::abs(v[freedom]) + dt * std::abs(a[freedom]));
    });
    size = std::max(size, own);
  }
  return layout_->tolerance * size;
}

double Configuration::velocity_tolerance(int contact, const Vec& v) {
  double size = 0.0;
  const auto& slot = layout_->contacts[contact];
  for (int row = 0; row < slot.rows; ++row) {
    const double own = slot.rheonomous ? std::abs(motion(contact)[row]) : 0.0;
    size = std::max(size, own + term_size(contact, row, v));
  }
  return layout_->tolerance * size;
}

// Of systems with a velocity map, as if their entries were those of q̇ = v: W has the size of ∂g/∂q, as Y is
// about 1.
double Configuration::gap_tolerance(int contact, int row) {
  if (!layout_->mapped) return rounding * term_size(contact, row, q_);
  const auto& slot = layout_->contacts[contact];
  const double* J = jacobian(contact) + static_cast<std::size_t>(row) * slot.n;
  const double largest = Eigen::Map<const Vec>(J, slot.n).cwiseAbs().maxCoeff();
  return rounding * largest * local_position(slot).lpNorm<1>();
}

// Sum of |W_ij v_i| in one row of Wᵀ
double Configuration::term_size(int contact, int row, const Vec& x) {
  double size = 0.0;
  for_jacobian(contact, row, [&](double entry, int freedom) { size += std::abs(entry * x[freedom]); });
  return size;
}

void Configuration::relative_acceleration(int contact, const Vec& v, const Vec& a, double* gamma_dot) {
  const auto& slot = layout_->contacts[contact];
  velocity_of_work(contact, a, gamma_dot);
  curvature_.head(slot.rows).setZero();
  slot.relation->curvature_at(t_, local_position(slot), layout_->local(slot, v, local_v_.data()),
                              {curvature_.data(), slot.rows});
  for (int i = 0; i < slot.rows; ++i) gamma_dot[i] += curvature_[i];
}

double inertia_work(const Configuration& start, const Configuration& end, const Vec& v_start,
                    const Vec& v_end) {
  if (!start.has_varying_mass()) return 0.0;
  auto change = [&](const Vec& v) { return end.kinetic_energy(v, true) - start.kinetic_energy(v, true); };
  return 0.5 * (change(v_start) + change(v_end));
}

void evaluate_forces(const Layout& layout, double t, const Vec& q, const Vec& v, Vec& h) {
  h.setZero();
  for (const auto& system : layout.systems)
    system.model->forces(t, {q.data() + system.first, system.coordinates},
                         {v.data() + system.offset, system.n}, {h.data() + system.offset, system.n});
  if (!layout.forces.empty()) add_element_forces(layout, t, q, v, h);
}

double potential_energy(const Layout& layout, double t, const Vec& q) {
  double energy = layout.forces.empty() ? 0.0 : element_energy(layout, t, q);
  for (const auto& system : layout.systems)
    energy += system.model->potential_energy({q.data() + system.first, system.coordinates});
  return energy;
}

void position_rates(const Layout& layout, const Vec& q, const Vec& v, Vec& rate) {
  for (const auto& system : layout.systems) {
    const In own(v.data() + system.offset, system.n);
    Out to(rate.data() + system.first, system.coordinates);
    to.setZero();
    if (system.mapped)
      system.model->position_rate({q.data() + system.first, system.coordinates}, own, to);
    else
      to = own;
  }
}

void advance(const Layout& layout, const Vec& at, const Vec& v, double dt, Vec& rate, Vec& q) {
  if (!layout.mapped) return add_scaled(dt, v, q);
  position_rates(layout, at, v, rate);
  add_scaled(dt, rate, q);
  normalise(layout, q);
}

void normalise(const Layout& layout, Vec& q) {
  for (const auto& system : layout.systems)
    if (system.mapped) system.model->normalise({q.data() + system.first, system.coordinates});
}

}  // namespace saltus
