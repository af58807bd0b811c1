#include "saltus/kernel/model/relation.hpp"

#include <stdexcept>
#include <string>

#include "saltus/kernel/model/requirements.hpp"

namespace saltus {

Relation::Relation(int size) : size_(size) {
  if (size < 1) throw std::invalid_argument("relation size must be at least 1, got " + std::to_string(size));
}

void Relation::require_dimensions(int, int) const {}

void Relation::require_start(const In&) const {}

void RheonomousRelation::gap(const In&, Out) const {
  throw std::logic_error("the gap of this relation depends on the time");
}

void RheonomousRelation::jacobian(const In&, OutMatrix) const {
  throw std::logic_error("the Jacobian of this relation depends on the time");
}

void RheonomousRelation::curvature_at(double, const In& q, const In& v, Out c) const { curvature(q, v, c); }

void Relation::curvature(const In&, const In&, Out) const {
  throw std::logic_error("this relation has no curvature term, which schemes on acceleration level need");
}

LagrangianLinearTIR::LagrangianLinearTIR(Matrix H, Vec b)
    : Relation(static_cast<int>(H.rows())), H_(std::move(H)), b_(std::move(b)) {
  if (b_.size() != H_.rows())
    throw std::invalid_argument("b must have " + std::to_string(H_.rows()) + " entries as H has rows, got " +
                                std::to_string(b_.size()));
  if (!H_.allFinite()) throw std::invalid_argument("H must be finite, got NaN or infinity");
  if (!b_.allFinite()) throw std::invalid_argument("b must be finite, got NaN or infinity");
  for (Eigen::Index i = 0; i < H_.rows(); ++i) {
    Eigen::Index first = 0, last = H_.cols();
    while (last > 0 && H_(i, last - 1) == 0.0) --last;
    while (first < last && H_(i, first) == 0.0) ++first;
    columns_.push_back({first, last});
  }
}

LagrangianLinearTIR::LagrangianLinearTIR(Matrix H) : LagrangianLinearTIR(H, Vec::Zero(H.rows())) {}

void LagrangianLinearTIR::require_dimensions(int coordinates, int freedoms) const {
  require_columns(H_, coordinates, freedoms);
}

void LagrangianLinearTIR::gap(const In& q, Out g) const {
  const double* row = H_.data();  // a plain loop: contacts have few rows
  for (Eigen::Index i = 0; i < g.size(); ++i, row += H_.cols()) {
    double sum = b_[i];
    for (Eigen::Index j = columns_[i].first; j < columns_[i].last; ++j) sum += row[j] * q[j];
    g[i] = sum;
  }
}

void LagrangianLinearTIR::jacobian(const In&, OutMatrix J) const { J = H_; }

void LagrangianLinearTIR::curvature(const In&, const In&, Out) const {}

}  // namespace saltus
