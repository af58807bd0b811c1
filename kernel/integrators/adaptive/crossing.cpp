#include "saltus/kernel/integrators/adaptive/crossing.hpp"

#include <cmath>
#include <utility>

namespace saltus {
namespace {

constexpr int most_bisections = 60;  // of a double's digits

// p(s) = g0 + s (c1 + s (c2 + s c3)), s in [0, 1]
struct Cubic {
  explicit Cubic(const GapCurve& curve) : c1(curve.dt * curve.rate0) {
    const double jump = curve.g1 - curve.g0, end = curve.dt * curve.rate1;
    c2 = 3.0 * jump - 2.0 * c1 - end;
    c3 = c1 + end - 2.0 * jump;
  }
  double change(double s) const { return s * (c1 + s * (c2 + s * c3)); }  // p(s) - g0
  double c1, c2, c3;
};

// Zeros of p' inside (0, 1), in ascending order; those that are not there are 1.
std::pair<double, double> turning_points(const Cubic& p) {
  const double root = p.c2 * p.c2 - 3.0 * p.c1 * p.c3;
  if (!(root > 0.0)) return {1.0, 1.0};
  const double sum = -(p.c2 + std::copysign(std::sqrt(root), p.c2));  // no digits cancel
  double a = p.c3 != 0.0 ? sum / (3.0 * p.c3) : 1.0, b = sum != 0.0 ? p.c1 / sum : 1.0;
  if (a > b) std::swap(a, b);
  const auto inside = [](double s) { return s > 0.0 && s < 1.0; };
  if (!inside(a)) a = inside(b) ? std::exchange(b, 1.0) : 1.0;
  return {a, inside(b) ? b : 1.0};
}

}  // namespace

std::optional<double> first_fall(const GapCurve& curve, double level) {
  const Cubic p(curve);
  const double depth = level - curve.g0;  // at most 0
  const auto [first, second] = turning_points(p);
  double from = 0.0;
  for (double to : {first, second, 1.0}) {  // monotonous in between
    if (to <= from) continue;
    if (p.change(from) >= depth && p.change(to) < depth) {
      for (int k = 0; k < most_bisections && from < to; ++k) {
        const double middle = 0.5 * (from + to);
        if (middle == from || middle == to) break;
        (p.change(middle) < depth ? to : from) = middle;
      }
      return to * curve.dt;
    }
    from = to;
  }
  return std::nullopt;
}

}  // namespace saltus
