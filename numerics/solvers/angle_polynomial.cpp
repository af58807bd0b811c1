#include "saltus/numerics/solvers/angle_polynomial.hpp"

#include <algorithm>
#include <cmath>

namespace saltus {
namespace {

// A bracket is halved at worst.
constexpr int most_bisections = 60;
// Roots in t only have to be near: f itself polishes them, and its turning points are candidates too, so that
// roots this close to each other are not missed.
constexpr double near = 1e-8;
constexpr int polishing_steps = 2;
// The corners of a pentagon: these values determine f, so it is large at one of them.
constexpr Direction corners[] = {{1.0, 0.0},
                                 {0.30901699437494742, 0.95105651629515357},
                                 {-0.80901699437494742, 0.58778525229247313},
                                 {-0.80901699437494742, -0.58778525229247313},
                                 {0.30901699437494742, -0.95105651629515357}};

// p(t) = c[0] + c[1] t + ... + c[n] tⁿ
double evaluate(const double* c, int n, double t) {
  double sum = c[n];
  for (int k = n - 1; k >= 0; --k) sum = sum * t + c[k];
  return sum;
}

// The root between low and high, where p has different signs: Newton's method inside the bracket
double bracketed_root(const double* c, const double* derivative, int n, double low, double high) {
  const bool rising = evaluate(c, n, low) < 0.0;
  double t = 0.5 * (low + high);
  for (int k = 0; k < most_bisections; ++k) {
    const double p = evaluate(c, n, t);
    if (p == 0.0) return t;
    ((p < 0.0) == rising ? low : high) = t;
    double next = t - p / evaluate(derivative, n - 1, t);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - t) <= near * (1.0 + std::abs(t))) return next;
    t = next;
  }
  return t;
}

// Roots with a change of sign in [-bound, bound], ascending. Between the turning points, which are the
// roots of the derivative, p is monotone.
template <int n>
int real_roots(const double* c, double bound, double* roots, double* turning, int& turns) {
  double derivative[n];
  for (int k = 0; k < n; ++k) derivative[k] = (k + 1) * c[k + 1];
  turns = 0;
  if constexpr (n > 1) {
    double unused[n];
    int none;
    turns = real_roots<n - 1>(derivative, bound, turning, unused, none);
  }
  int found = 0;
  double low = -bound;
  for (int k = 0; k <= turns; ++k) {
    const double high = k < turns ? turning[k] : bound;
    if ((evaluate(c, n, low) < 0.0) != (evaluate(c, n, high) < 0.0))
      roots[found++] = bracketed_root(c, derivative, n, low, high);
    low = high;
  }
  return found;
}

Direction turned(Direction e, Direction by) {
  return {e.cosine * by.cosine - e.sine * by.sine, e.sine * by.cosine + e.cosine * by.sine};
}

// f(α) as a polynomial in α − α₀
AnglePolynomial seen_from(const AnglePolynomial& f, Direction start) {
  const Direction twice = turned(start, start);
  return {f.a0, f.a1 * start.cosine + f.b1 * start.sine, f.b1 * start.cosine - f.a1 * start.sine,
          f.a2 * twice.cosine + f.b2 * twice.sine, f.b2 * twice.cosine - f.a2 * twice.sine};
}

Direction at_tangent(double t, Direction start) {
  const double length = 1.0 + t * t;
  return turned({(1.0 - t * t) / length, 2.0 * t / length}, start);
}

Direction polished(const AnglePolynomial& f, Direction e) {
  for (int k = 0; k < polishing_steps; ++k) {
    const double value = f.value(e), step = -value / f.slope(e);
    if (!(std::abs(step) < 1.0)) return e;
    const double length = std::hypot(1.0, step);
    const Direction next = turned(e, {1.0 / length, step / length});
    if (!(std::abs(f.value(next)) < std::abs(value))) return e;
    e = next;
  }
  return e;
}

}  // namespace

double AnglePolynomial::value(Direction e) const {
  return a0 + a1 * e.cosine + b1 * e.sine + a2 * (e.cosine * e.cosine - e.sine * e.sine) +
         b2 * 2.0 * e.cosine * e.sine;
}

double AnglePolynomial::slope(Direction e) const {
  return -a1 * e.sine + b1 * e.cosine - a2 * 4.0 * e.cosine * e.sine +
         b2 * 2.0 * (e.cosine * e.cosine - e.sine * e.sine);
}

Angles candidate_angles(const AnglePolynomial& f) {
  Direction infinity;
  for (const Direction e : corners)
    if (std::abs(f.value(e)) > std::abs(f.value(infinity))) infinity = e;
  const Direction start{-infinity.cosine, -infinity.sine};
  const AnglePolynomial g = seen_from(f, start);
  const double c[5] = {g.a0 + g.a1 + g.a2, 2.0 * g.b1 + 4.0 * g.b2, 2.0 * g.a0 - 6.0 * g.a2,
                       2.0 * g.b1 - 4.0 * g.b2, g.a0 - g.a1 + g.a2};
  Angles angles;
  if (c[4] == 0.0) return angles;  // f vanishes everywhere
  double largest = 0.0;
  for (int k = 0; k < 4; ++k) largest = std::max(largest, std::abs(c[k]));
  const double bound = 1.0 + largest / std::abs(c[4]);  // Cauchy's, of the derivatives' roots as well
  double roots[4], turning[4];
  int turns = 0;
  const int found = real_roots<4>(c, bound, roots, turning, turns);
  for (int k = 0; k < found; ++k)
    angles.directions[angles.count++] = polished(f, at_tangent(roots[k], start));
  for (int k = 0; k < turns; ++k) angles.directions[angles.count++] = at_tangent(turning[k], start);
  return angles;
}

}  // namespace saltus
