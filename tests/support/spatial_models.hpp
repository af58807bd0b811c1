#pragma once
// Small models with friction in space whose motion is known.
#include "support/models.hpp"

namespace saltus::test {

/// A point of 2 kg, q = (x, y, z), over the plane z = 0, contact rows (normal, two tangents). It starts at
/// z = -1e-4, where drift opens no contact.
struct Sledge {
  Vec position = vec({0.0, 0.0});  ///< in the plane [m]
  Vec velocity = vec({0.0, 0.0});  ///< in the plane [m/s]
  double mu = 0.0;
  double incline = 0.0;                        ///< angle, downhill is +x [rad]
  double turned = 0.0;                         ///< angle between x and the first tangent [rad]
  Vec stiffness = vec({0.0, 0.0});             ///< of springs to the origin along x and y [N/m]
  double height = -1e-4, falling = 0.0;        ///< z [m] and -ż [m/s]
  double restitution = 0.0, tangential = 0.0;  ///< ε_N, ε_T
};
NonSmoothDynamicalSystem make_sledge(const Sledge& sledge);
/// Its state at `until` by an independent integration, if it slides until then.
State exact_sliding(const Sledge& sledge, double until);

/// Sphere of 2 kg and radius 0.1 m on the floor, q = (x, y, z, φx, φy, φz): the tangential rows are the
/// velocity of its lowest point, (ẋ - r φ̇y, ẏ + r φ̇x).
NonSmoothDynamicalSystem make_rolling_sphere(const Vec& v0, double mu);
inline constexpr double sphere_radius = 0.1;

/// Table of 2 kg on four feet at (±0.3, ±0.4, -0.2) m with rotations linearised, q as the sphere's: 12 rows
/// that depend on each other.
NonSmoothDynamicalSystem make_table(double height, const Vec& v0, double mu, double restitution = 0.0);
inline constexpr double table_inertia = 0.5;  // [kg m²] around each axis
inline constexpr double foot_radius = 0.5;    // of the feet around the vertical axis [m]

}  // namespace saltus::test
