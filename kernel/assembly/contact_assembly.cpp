#include "saltus/kernel/assembly/contact_assembly.hpp"

#include <algorithm>

namespace saltus {
namespace {

// Beyond this many rows the storage of G grows when it is first needed: all contacts at once are rare.
constexpr int reserved_rows = 256;

}  // namespace

ContactAssembly::ContactAssembly(std::shared_ptr<const Layout> layout)
    : layout_(std::move(layout)), touching_(layout_->systems.size()) {
  const int rows = std::min(layout_->rows, reserved_rows);
  problem_.G.reserve(rows, rows);
  problem_.b.reserve(layout_->rows);
  problem_.sets.reserve(layout_->rows);
  active_.reserve(layout_->contacts.size());
  minv_w_.resize(layout_->jacobian_entries);
  touched_.reserve(layout_->systems.size());
  std::vector<int> contacts_on(layout_->systems.size(), 0);
  for (const auto& contact : layout_->contacts)
    for (int side = 0; side < contact.sides; ++side) ++contacts_on[contact.system[side]];
  for (std::size_t k = 0; k < touching_.size(); ++k) touching_[k].reserve(contacts_on[k]);
}

void ContactAssembly::assemble(const std::vector<int>& active, Configuration& constraint,
                               Configuration& force, const BlockInverse& inverse) {
  const bool constant = inverse.constant() && !layout_->varying_jacobian;
  if (constant && constant_ && active == active_) return;  // G is still what it was
  constant_ = constant;
  active_ = active;
  problem_.sets.clear();
  for (int system : touched_) touching_[system].clear();
  touched_.clear();
  int row = 0;
  for (std::size_t index = 0; index < active_.size(); ++index) {
    const auto& contact = layout_->contacts[active_[index]];
    for (const ContactSet& set : contact.law->sets) problem_.sets.push_back(set);
    const double* W = force.jacobian(active_[index]);
    double* X = minv_w_.data() + contact.jacobian;
    std::copy_n(W, static_cast<std::size_t>(contact.rows) * contact.n, X);
    std::size_t column = 0;
    for (int side = 0; side < contact.sides; ++side) {
      const int system = contact.system[side];
      for (int i = 0; i < contact.rows; ++i)
        inverse.solve_block(system, X + static_cast<std::size_t>(i) * contact.n + column);
      if (touching_[system].empty()) touched_.push_back(system);
      touching_[system].push_back({static_cast<int>(index), row, column});
      column += layout_->systems[system].n;
    }
    row += contact.rows;
  }
  problem_.b.resize(row);
  problem_.G.resize(row, row);
  problem_.G.view().setZero();
  for (int system : touched_) assemble_shared(system, constraint);
}

void ContactAssembly::assemble_shared(int system, Configuration& constraint) {
  const int n = layout_->systems[system].n;
  for (const Touch& a : touching_[system]) {
    const auto& left = layout_->contacts[active_[a.index]];
    const double* Wa = constraint.jacobian(active_[a.index]) + a.column;
    for (const Touch& b : touching_[system]) {
      const auto& right = layout_->contacts[active_[b.index]];
      const double* Xb = minv_w_.data() + right.jacobian + b.column;
      for (int i = 0; i < left.rows; ++i)
        for (int j = 0; j < right.rows; ++j) {
          double sum = 0.0;
          for (int k = 0; k < n; ++k) sum += Wa[i * left.n + k] * Xb[j * right.n + k];
          problem_.G(a.row + i, b.row + j) += sum;
        }
    }
  }
}

void ContactAssembly::set_b(Configuration& constraint, const Vec& v) {
  int row = 0;
  for (int contact : active_) {
    constraint.relative_velocity(contact, v, problem_.b.data() + row);
    row += layout_->contacts[contact].rows;
  }
}

void ContactAssembly::set_b_of_acceleration(Configuration& constraint, const Vec& v, const Vec& a,
                                            double weight) {
  int row = 0;
  for (int contact : active_) {
    constraint.relative_acceleration(contact, v, a, problem_.b.data() + row);
    row += layout_->contacts[contact].rows;
  }
  problem_.b.view() *= weight;
}

void ContactAssembly::add_restitution(const Vec& gamma) {
  int row = 0;
  for (int contact : active_) {
    const auto& slot = layout_->contacts[contact];
    for (int i = 0; i < slot.rows; ++i) problem_.b[row++] += slot.law->restitution[i] * gamma[slot.row + i];
  }
}

double ContactAssembly::work(const PoolVec& P, const Vec& gamma) const {
  double sum = 0.0;
  int row = 0;
  for (int contact : active_) {
    const auto& slot = layout_->contacts[contact];
    for (int i = 0; i < slot.rows; ++i, ++row) {
      const double* G = problem_.G.row(row);
      double jump = 0.0;
      for (int j = 0; j < problem_.rows(); ++j) jump += G[j] * P[j];
      sum += P[row] * (gamma[slot.row + i] + 0.5 * jump);
    }
  }
  return sum;
}

void ContactAssembly::apply(double factor, const double* P, Vec& v) const {
  for (int contact : active_) {
    const auto& slot = layout_->contacts[contact];
    const double* X = minv_w_.data() + slot.jacobian;
    for (int i = 0; i < slot.rows; ++i) {
      const double p = factor * *P++;
      for (int side = 0; side < slot.sides; ++side) {
        const auto& system = layout_->systems[slot.system[side]];
        for (int j = 0; j < system.n; ++j) v[system.offset + j] += *X++ * p;
      }
    }
  }
}

void ContactAssembly::gather(const Vec& all, double factor, PoolVec& active) const {
  active.resize(problem_.rows());
  int row = 0;
  for (int contact : active_) {
    const auto& slot = layout_->contacts[contact];
    for (int i = 0; i < slot.rows; ++i) active[row++] = factor * all[slot.row + i];
  }
}

void ContactAssembly::scatter(const PoolVec& active, double factor, Vec& all) const {
  int row = 0;
  for (int contact : active_) {
    const auto& slot = layout_->contacts[contact];
    for (int i = 0; i < slot.rows; ++i) all[slot.row + i] = factor * active[row++];
  }
}

}  // namespace saltus
