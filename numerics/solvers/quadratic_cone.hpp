#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

namespace saltus {

/// The cone |x_T| <= x_0 of x = (x_0, x_T) in space; in the plane x_2 is 0 and stays so. Its product
///   x∘y = (x·y, x_0 y_T + y_0 x_T)
/// is to it what the product of numbers is to x >= 0: of x and y in the cone, x∘y = 0 exactly where x ⟂ y.
/// Alizadeh, Goldfarb, Math. Program. 95 (2003) 3-51, Section 4.
using ConeVec = Eigen::Vector3d;

inline ConeVec cone_product(const ConeVec& x, const ConeVec& y) {
  return {x.dot(y), x[0] * y[1] + y[0] * x[1], x[0] * y[2] + y[0] * x[2]};
}

/// z with x∘z = v, x inside the cone.
inline ConeVec cone_quotient(const ConeVec& v, const ConeVec& x) {
  const double length = std::hypot(x[1], x[2]);
  const double z = (x[0] * v[0] - x[1] * v[1] - x[2] * v[2]) / ((x[0] - length) * (x[0] + length));
  return {z, (v[1] - z * x[1]) / x[0], (v[2] - z * x[2]) / x[0]};
}

/// The largest step for which x + step·dx stays in the cone, x inside it.
inline double cone_reach(const ConeVec& x, const ConeVec& dx) {
  // |x_T + s dx_T|² = (x_0 + s dx_0)² is a s² + 2 b s + c = 0, c > 0: its smallest positive root
  const double length = std::hypot(x[1], x[2]), change = std::hypot(dx[1], dx[2]);
  const double a = (dx[0] - change) * (dx[0] + change);
  const double b = x[0] * dx[0] - x[1] * dx[1] - x[2] * dx[2];
  const double c = (x[0] - length) * (x[0] + length);
  const double root = std::sqrt(std::max(b * b - a * c, 0.0));
  if (b > 0.0) return a < 0.0 ? (b + root) / -a : std::numeric_limits<double>::infinity();
  return a > 0.0 && b * b < a * c ? std::numeric_limits<double>::infinity() : c / (root - b);
}

}  // namespace saltus
