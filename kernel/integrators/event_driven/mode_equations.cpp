#include "saltus/kernel/integrators/event_driven/mode_equations.hpp"

#include <algorithm>
#include <cmath>

namespace saltus {
namespace {

constexpr int reserved_rows = 64;  // of a dense G; beyond, it grows when it is first needed

}  // namespace

ModeEquations::ModeEquations(std::shared_ptr<const Layout> layout) : layout_(std::move(layout)) {
  const int rows = layout_->rows, dense = std::min(rows, reserved_rows);
  reduced_.tolerance = layout_->tolerance;
  reduced_.G.reserve(dense, dense);
  reduced_.b.reserve(rows);
  reduced_.sets.reserve(rows);
  reduced_P_.reserve(rows);
  dense_.reserve(dense);
  for (auto* indices : {&equation_, &column_}) indices->reserve(rows);
  factor_.reserve(rows);
  line_.reserve(rows);
}

void ModeEquations::reduce(Level level, const std::vector<int>& active,
                           const std::vector<ContactState>& contacts, const ContactProblem& problem,
                           const Vec& b, double weight) {
  const int rows = problem.rows();
  equation_.assign(rows, -1);
  column_.assign(rows, -1);
  factor_.assign(rows, 1.0);
  reduced_.sets.clear();
  size_ = 0;
  int row = 0;
  for (int k : active) {
    number(level, row, layout_->contacts[k], contacts[k]);
    row += layout_->contacts[k].rows;
  }
  reduced_.b.resize(size_);
  reduced_P_.resize(size_);
  reduced_P_.view().setZero();
  reduced_.sparse.clear();
  reduced_.G.resize(problem.is_sparse() ? 0 : size_, problem.is_sparse() ? 0 : size_);
  row = 0;
  for (int k : active) {
    const auto& slot = layout_->contacts[k];
    for (int i = 0; i < slot.rows; ++i, ++row) {
      if (equation_[row] < 0) continue;
      reduced_.b[equation_[row]] = weight * b[slot.row + i];
      add_row(problem, row);
    }
  }
}

// Equations and unknowns of a contact, and its law
void ModeEquations::number(Level level, int row, const Layout::Contact& slot, const ContactState& contact) {
  const bool holds_all = contact.mode == ContactMode::bilateral;
  const bool sticks = contact.mode == ContactMode::sticking && level != Level::position;
  const int held = holds_all ? (level == Level::position ? slot.gaps : slot.rows) : sticks ? contact.dim : 1;
  for (int i = 0; i < held; ++i) equation_[row + i] = column_[row + i] = size_ + i;
  if (contact.mode == ContactMode::sliding && level == Level::acceleration)
    for (int i = 1; i < contact.dim; ++i) {
      column_[row + i] = size_;
      factor_[row + i] = -contact.mu * contact.direction[i - 1];
    }
  size_ += held;
  if (holds_all)
    reduced_.sets.insert(reduced_.sets.end(), held, Equality{});
  else if (sticks)
    reduced_.sets.push_back(Coulomb{contact.mu, contact.dim});
  else
    reduced_.sets.push_back(NonNegative{});
}

void ModeEquations::add_row(const ContactProblem& problem, int row) {
  line_.assign(size_, 0.0);
  if (!problem.is_sparse()) {
    for_row(problem, row, [&](int j, double entry) {
      if (column_[j] >= 0) line_[column_[j]] += factor_[j] * entry;
    });
    std::copy(line_.begin(), line_.end(), reduced_.G.row(equation_[row]));
    return;
  }
  SparseRows& G = reduced_.sparse;  // rows of a contact follow each other, and so do their columns
  int last = -1;
  for_row(problem, row, [&](int j, double entry) {
    if (column_[j] < 0) return;
    if (column_[j] == last)
      G.value.back() += factor_[j] * entry;
    else
      G.add(last = column_[j], factor_[j] * entry);
  });
  G.end_row();
}

bool ModeEquations::solve() {
  if (size_ == 0) return true;
  if (reduced_.is_sparse()) {
    sparse_.A() = reduced_.sparse;
    sparse_.y().assign(reduced_.b.data(), reduced_.b.data() + size_);
    for (double& y : sparse_.y()) y = -y;
    if (const double* x = sparse_.solve()) {
      std::copy_n(x, size_, reduced_P_.data());
      return true;
    }
  }
  dense_.resize(size_);
  dense_.A().view().setZero();
  for (int i = 0; i < size_; ++i)
    for_row(reduced_, i, [&](int j, double entry) { dense_.A()(i, j) = entry; });
  dense_.y().view() = -reduced_.b.view();
  dense_.start().view().setZero();
  std::copy_n(dense_.solve(), size_, reduced_P_.data());
  return reduced_P_.view().allFinite();
}

void ModeEquations::expand(PoolVec& P) const {
  P.resize(static_cast<int>(column_.size()));
  for (int row = 0; row < P.size(); ++row)
    P[row] = column_[row] < 0 ? 0.0 : factor_[row] * reduced_P_[column_[row]];
}

}  // namespace saltus
