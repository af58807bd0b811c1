#include "rotor/rotor.hpp"

namespace saltus::examples {
namespace {

std::shared_ptr<NewtonEulerDS> attached(const Axle& axle, double s, double mass, const Vec3& inertia) {
  auto [q, v] = AxleWeld::held(axle, s);
  BodyLoads weight;
  weight.force = Vec3(0.0, 0.0, -mass * axle.parameters().gravity);
  return std::make_shared<NewtonEulerDS>(q, v, mass, Mat3(inertia.asDiagonal()), weight);
}

void weld(NonSmoothDynamicalSystem& model, const Axle& axle, double s, const NewtonEulerDS& body,
          const char* name) {
  model.link(
      std::make_shared<Interaction>(std::make_shared<AxleWeld>(axle, s), EqualityConditionNSL(6), name), axle,
      &body);
}

}  // namespace

NonSmoothDynamicalSystem make_rotor() {
  const AxleParameters p;
  const double flywheel_at = 0.18, half_length = 19e-3;  // [m]
  const double mass_of_bearing = 2.3, mount = 1e6, damping = 10.0, mu = 0.01;
  const Vec zero = Vec::Zero(5 * (p.elements + 1));
  auto axle = std::make_shared<Axle>(zero, zero, p);
  auto flywheel = attached(*axle, flywheel_at, 4.98, {0.01, 0.003, 0.003});
  auto frustum = attached(*axle, 0.0, 1e-3, {1e-6, 1e-6, 1e-6});
  const Vec origin = (Vec(7) << 0, 0, 0, 1, 0, 0, 0).finished();
  const Mat3 inertia = Vec3(0.007, 1e-4, 1e-4).asDiagonal();
  auto bearing = std::make_shared<MountedBody>(origin, Vec::Zero(6), mass_of_bearing, inertia, mount, damping,
                                               p.gravity);
  NonSmoothDynamicalSystem model({axle, flywheel, frustum, bearing});
  weld(model, *axle, flywheel_at, *flywheel, "flywheel weld");
  weld(model, *axle, 0.0, *frustum, "frustum weld");
  auto journal = std::make_shared<JournalContact>(3, 1e-2, 1.01e-2, 0.5 * half_length);
  model.link(std::make_shared<Interaction>(journal, NewtonImpactFrictionNSL(0.0, 0.0, mu, 3), "journal"),
             *frustum, bearing.get());
  return model;
}

}  // namespace saltus::examples
