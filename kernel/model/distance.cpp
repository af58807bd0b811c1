#include "saltus/kernel/model/distance.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "saltus/kernel/model/requirements.hpp"
#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

constexpr int space = 3;
using Arrow = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, space, 1>;  // never on the heap

}  // namespace

Distance::Distance(Matrix H, Vec b, double length)
    : Relation(1), H_(std::move(H)), b_(std::move(b)), length_(length) {
  if (H_.rows() < 1 || H_.rows() > space)
    throw std::invalid_argument("H must have 1 to 3 rows, the coordinates of a point, got " +
                                std::to_string(H_.rows()));
  if (b_.size() != H_.rows())
    throw std::invalid_argument("b must have " + std::to_string(H_.rows()) + " entries as H has rows, got " +
                                std::to_string(b_.size()));
  if (!H_.allFinite()) throw std::invalid_argument("H must be finite, got NaN or infinity");
  if (!b_.allFinite()) throw std::invalid_argument("b must be finite, got NaN or infinity");
  if (!std::isfinite(length)) throw std::invalid_argument("length must be finite, got " + number(length));
}

void Distance::require_dimensions(int coordinates, int freedoms) const {
  require_columns(H_, coordinates, freedoms);
}

void Distance::gap(const In& q, Out g) const {
  Arrow d = b_;
  d.noalias() += H_ * q;
  g[0] = d.norm() - length_;
}

void Distance::jacobian(const In& q, OutMatrix J) const {
  Arrow d = b_;
  d.noalias() += H_ * q;
  d /= d.norm();
  J.row(0).noalias() = d.transpose() * H_;
}

void Distance::curvature(const In& q, const In& v, Out c) const {
  Arrow d = b_, velocity = Arrow::Zero(b_.size());
  d.noalias() += H_ * q;
  velocity.noalias() += H_ * v;
  const double distance = d.norm(), rate = d.dot(velocity) / distance;
  c[0] = (velocity.squaredNorm() - rate * rate) / distance;
}

}  // namespace saltus
