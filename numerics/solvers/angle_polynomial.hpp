#pragma once
#include <array>

namespace saltus {

/// A unit vector in the tangent plane.
struct Direction {
  double cosine = 1.0;
  double sine = 0.0;
};

/// f(α) = a0 + a1 cos α + b1 sin α + a2 cos 2α + b2 sin 2α
struct AnglePolynomial {
  double a0 = 0.0, a1 = 0.0, b1 = 0.0, a2 = 0.0, b2 = 0.0;

  double value(Direction e) const;
  double slope(Direction e) const;
};

/// Where an angle polynomial may vanish: up to four roots, and up to three places where it turns.
struct Angles {
  std::array<Direction, 7> directions;
  int count = 0;
};

/// All roots of f, each polished to rounding, then the turning points between them: a double root that
/// rounding has lifted off zero is one of these, so the caller has to look at f there.
/// With t = tan(½(α − α₀)), (1 + t²)² f is a quartic in t. α₀ is chosen such that |f| is large at t = ∞,
/// so all roots are of moderate size; they are separated by the roots of the derivatives and bracketed.
Angles candidate_angles(const AnglePolynomial& f);

}  // namespace saltus
