#include "saltus/kernel/assembly/position_projection.hpp"

#include <algorithm>
#include <cmath>

namespace saltus {
namespace {

constexpr int most_iterations = 3;   // from a drift one brings the gaps to rounding
constexpr int most_dense_gaps = 64;  // beyond, most of them do not share a body

// The same contacts with the rows of their gaps alone, which come first in Wᵀ.
std::shared_ptr<const Layout> rows_of_gaps(Layout layout) {
  for (auto& contact : layout.contacts) {
    contact.row = contact.gap;
    contact.rows = contact.gaps;
  }
  layout.rows = layout.gaps;
  return std::make_shared<const Layout>(std::move(layout));
}

}  // namespace

PositionProjection::PositionProjection(const std::shared_ptr<const Layout>& layout)
    : layout_(layout),
      gap_rows_(rows_of_gaps(*layout)),
      assembly_(gap_rows_, one_block_a_system(*layout), layout->gaps > most_dense_gaps),
      pulled_(layout->contacts.size(), 0),
      q_(Vec::Zero(layout->coordinates)),
      rate_(Vec::Zero(layout->coordinates)),
      change_(Vec::Zero(layout->n)) {
  for (auto* contacts : {&violated_, &bilateral_}) contacts->reserve(layout->contacts.size());
  if (layout->gaps <= most_dense_gaps) dense_.reserve(layout->gaps);
  aim_.reserve(layout->gaps);
}

void PositionProjection::pull(const std::vector<int>& held, Configuration& at, double t,
                              const BlockInverse& inverse, const Vec* level) {
  level_ = level;
  iterate(held, at, t, inverse);
  bilateral_.clear();
  for (int k : held)
    if (layout_->contacts[k].law->bilateral) bilateral_.push_back(k);
  if (bilateral_.size() < held.size()) iterate(bilateral_, at, t, inverse);  // they come first in a conflict
}

void PositionProjection::iterate(const std::vector<int>& held, Configuration& at, double t,
                                 const BlockInverse& inverse) {
  std::fill(pulled_.begin(), pulled_.end(), 0);
  double before = INFINITY;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    const double largest = take_violated(held, at);
    if (largest == 0.0 || largest > 0.5 * before) return;  // nothing left, or nothing to be gained
    before = largest;
    assembly_.assemble(violated_, at, at, inverse);
    assembly_.gather(at.gaps(), -1.0, aim_);
    aim(at);
    change_.setZero();
    assembly_.apply(1.0, solve(), change_);
    position_rates(*layout_, at.q(), change_, rate_);
    q_ = at.q() + rate_;
    if (layout_->mapped) normalise(*layout_, q_);
    at.move_to(q_, t);
  }
}

// (Wᵀ M⁻¹ W)⁺ of the aim
const double* PositionProjection::solve() {
  const ContactProblem& problem = assembly_.problem();
  const int rows = problem.rows();
  if (problem.is_sparse()) {
    sparse_.A() = problem.sparse;
    sparse_.y().assign(aim_.data(), aim_.data() + rows);
    if (const double* x = sparse_.solve()) return x;
  }
  dense_.resize(rows);  // constraints that depend on each other: the solution of minimum norm
  dense_.A().view().setZero();
  for (int i = 0; i < rows; ++i) for_row(problem, i, [&](int j, double entry) { dense_.A()(i, j) = entry; });
  dense_.y().view() = aim_.view();
  dense_.start().view().setZero();
  return dense_.solve();
}

// Unilateral contacts to their level; without one they must be closed after it, g <= 0, in spite of rounding.
void PositionProjection::aim(Configuration& at) {
  int row = 0;
  for (int k : violated_) {
    const auto& contact = layout_->contacts[k];
    if (!contact.law->bilateral) aim_[row] += level_ ? (*level_)[contact.gap] : -at.gap_tolerance(k, 0);
    row += contact.gaps;
  }
}

// Those out of place and those pulled before, which would open again otherwise.
// @return the largest gap among them, 0 if all are closed up to rounding [m]
double PositionProjection::take_violated(const std::vector<int>& held, Configuration& at) {
  violated_.clear();
  double largest = 0.0;
  for (int k : held) {
    const auto& contact = layout_->contacts[k];
    const bool both_ways = level_ || contact.law->bilateral;
    if (!both_ways && !pulled_[k] && !(at.gaps()[contact.gap] > 0.0)) continue;
    violated_.push_back(k);
    pulled_[k] = 1;
    for (int row = 0; row < contact.gaps; ++row) {
      const double gap =
          at.gaps()[contact.gap + row] - (level_ && !contact.law->bilateral ? (*level_)[contact.gap] : 0.0);
      const bool off = both_ways ? std::abs(gap) > at.gap_tolerance(k, row) : gap > 0.0;
      if (off) largest = std::max(largest, std::abs(gap));
    }
  }
  return largest;
}

}  // namespace saltus
