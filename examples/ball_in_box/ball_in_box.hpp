#pragma once
// The bouncing ball in a box of Section 5.2 in C++. ball_in_box.py explains it.
#include "saltus/kernel/model/nonsmooth_dynamical_system.hpp"

namespace saltus::examples {

/// Table 4.
struct BallInBoxParameters {
  double a = 4.0, b = 4.0;    ///< width and height of the box [m]
  double R = 1.0;             ///< radius of the ball [m]
  double m = 1.0;             ///< [kg]
  double gravity = 9.81;      ///< [m/s²]
  double restitution = 0.3;   ///< of all four contacts
  double x0 = 2.0, y0 = 2.0;  ///< start, at rest [m]
};

/// Its direction.
enum class Gravity {
  oblique,  ///< −(cos π/6, sin π/6), as in the text of the paper
  down,     ///< (0, −1), as in Table 4
};

/// The whole model, q = (x, y) [m]; contacts "left", "right", "bottom", "top".
NonSmoothDynamicalSystem make_ball_in_box(Gravity gravity);

}  // namespace saltus::examples
