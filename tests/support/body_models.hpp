#pragma once
// Rigid bodies in space whose motion is known.
#include "saltus/kernel/model/bodies/newton_euler_ds.hpp"
#include "support/models.hpp"

namespace saltus::test {

/// A free body that tumbles, without loads.
NonSmoothDynamicalSystem make_tumbling_body();
State exact_tumbling_body(double until);

/// A heavy top that spins on its tip, which a ball joint holds at the origin.
NonSmoothDynamicalSystem make_top();
State exact_top(double until);

/// A body that slides on the plane z = 0 on one of its points, 0.1 mm below it, and turns meanwhile.
NonSmoothDynamicalSystem make_skidding_body(double mu);
State exact_skidding_body(double mu, double until);

/// Links under ball joints that hang from the origin at an angle.
NonSmoothDynamicalSystem make_chain(int links);

}  // namespace saltus::test
