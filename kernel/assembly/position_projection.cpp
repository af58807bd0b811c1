#include "saltus/kernel/assembly/position_projection.hpp"

#include <algorithm>
#include <cmath>

namespace saltus {
namespace {

constexpr int most_iterations = 3;  // from a drift one brings the gaps to rounding

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
      assembly_(gap_rows_, one_block_a_system(*layout)),
      pulled_(layout->contacts.size(), 0),
      q_(Vec::Zero(layout->n)) {
  for (auto* contacts : {&violated_, &bilateral_}) contacts->reserve(layout->contacts.size());
  dense_.reserve(std::min(layout->gaps, 256));  // beyond, it grows when it is first needed
}

void PositionProjection::pull(const std::vector<int>& held, Configuration& at, const BlockInverse& inverse) {
  iterate(held, at, inverse);
  bilateral_.clear();
  for (int k : held)
    if (layout_->contacts[k].law->bilateral) bilateral_.push_back(k);
  if (bilateral_.size() < held.size()) iterate(bilateral_, at, inverse);  // they come first in a conflict
}

void PositionProjection::iterate(const std::vector<int>& held, Configuration& at,
                                 const BlockInverse& inverse) {
  std::fill(pulled_.begin(), pulled_.end(), 0);
  double before = INFINITY;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    const double largest = take_violated(held, at);
    if (largest == 0.0 || largest > 0.5 * before) return;  // nothing left, or nothing to be gained
    before = largest;
    assembly_.assemble(violated_, at, at, inverse);
    const PoolMatrix& G = assembly_.problem().G;
    dense_.resize(G.rows());
    std::copy_n(G.row(0), static_cast<std::size_t>(G.rows()) * G.cols(), dense_.A().row(0));
    assembly_.gather(at.gaps(), -1.0, dense_.y());
    aim_below_zero(at);
    dense_.start().view().setZero();
    q_ = at.q();
    assembly_.apply(1.0, dense_.solve(), q_);
    at.move_to(q_);
  }
}

// Unilateral contacts must be closed after it, g <= 0, in spite of rounding.
void PositionProjection::aim_below_zero(Configuration& at) {
  int row = 0;
  for (int k : violated_) {
    if (!layout_->contacts[k].law->bilateral) dense_.y()[row] -= at.gap_tolerance(k, 0);
    row += layout_->contacts[k].gaps;
  }
}

// Those out of place and those pulled before, which would open again otherwise.
// @return the largest gap among them, 0 if all are closed up to rounding [m]
double PositionProjection::take_violated(const std::vector<int>& held, Configuration& at) {
  violated_.clear();
  double largest = 0.0;
  for (int k : held) {
    const auto& contact = layout_->contacts[k];
    const bool bilateral = contact.law->bilateral;
    if (!bilateral && !pulled_[k] && !(at.gaps()[contact.gap] > 0.0)) continue;
    violated_.push_back(k);
    pulled_[k] = 1;
    for (int row = 0; row < contact.gaps; ++row) {
      const double gap = at.gaps()[contact.gap + row];
      const bool off = bilateral ? std::abs(gap) > at.gap_tolerance(k, row) : gap > 0.0;
      if (off) largest = std::max(largest, std::abs(gap));
    }
  }
  return largest;
}

}  // namespace saltus
