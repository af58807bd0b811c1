#include "support/spatial_models.hpp"

#include <cmath>

#include "support/runs.hpp"

namespace saltus::test {
namespace {

constexpr double mass = 2.0;

NonSmoothDynamicalSystem one_body(const Vec& q0, const Vec& v0, const Vec& masses, const Vec& force,
                                  const Vec& stiffness) {
  return NonSmoothDynamicalSystem({std::make_shared<LagrangianLinearTIDS>(
      q0, v0, Matrix(masses.asDiagonal()),
      LagrangianLinearTIDS::Terms{.stiffness = Matrix(stiffness.asDiagonal()), .external_force = force})});
}

}  // namespace

NonSmoothDynamicalSystem make_sledge(const Sledge& s) {
  const double weight = mass * gravity;
  auto model =
      one_body(vec({s.position[0], s.position[1], s.height}), vec({s.velocity[0], s.velocity[1], -s.falling}),
               Vec::Constant(3, mass), weight * vec({std::sin(s.incline), 0.0, -std::cos(s.incline)}),
               vec({s.stiffness[0], s.stiffness[1], 0.0}));
  const double c = std::cos(s.turned), d = std::sin(s.turned);
  const Matrix H = (Matrix(3, 3) << 0.0, 0.0, 1.0, c, d, 0.0, -d, c, 0.0).finished();
  model.link(
      linear_contact(H, Vec::Zero(3), NewtonImpactFrictionNSL(s.restitution, s.tangential, s.mu, 3), "plane"),
      *model.systems()[0]);
  return model;
}

State exact_sliding(const Sledge& s, double until) {
  auto f = [&](double, const Vec& y) {
    const Vec v = y.tail(2);
    const Vec force = vec({gravity * std::sin(s.incline), 0.0}) - s.stiffness.cwiseProduct(y.head(2)) / mass -
                      s.mu * gravity * std::cos(s.incline) * v / v.norm();
    return vec({v[0], v[1], force[0], force[1]});
  };
  const Vec y =
      integrate_ode(f, vec({s.position[0], s.position[1], s.velocity[0], s.velocity[1]}), until, 20000);
  return {until, vec({y[0], y[1], s.height}), vec({y[2], y[3], 0.0})};
}

NonSmoothDynamicalSystem make_rolling_sphere(const Vec& v0, double mu) {
  const double r = sphere_radius, inertia = 0.4 * mass * r * r;
  Vec q0 = Vec::Zero(6);
  q0[2] = -1e-4;
  auto model = one_body(q0, v0, vec({mass, mass, mass, inertia, inertia, inertia}),
                        vec({0.0, 0.0, -mass * gravity, 0.0, 0.0, 0.0}), Vec::Zero(6));
  Matrix H = Matrix::Zero(3, 6);
  H(0, 2) = H(1, 0) = H(2, 1) = 1.0;
  H(1, 4) = -r;
  H(2, 3) = r;
  model.link(linear_contact(H, Vec::Zero(3), NewtonImpactFrictionNSL(0.0, 0.0, mu, 3), "floor"),
             *model.systems()[0]);
  return model;
}

NonSmoothDynamicalSystem make_table(double height, const Vec& v0, double mu, double restitution) {
  Vec q0 = Vec::Zero(6);
  q0[2] = height;
  const double I = table_inertia;
  auto model = one_body(q0, v0, vec({mass, mass, mass, I, I, I}),
                        vec({0.0, 0.0, -mass * gravity, 0.0, 0.0, 0.0}), Vec::Zero(6));
  for (int k = 0; k < 4; ++k) {
    const double x = k % 2 ? 0.3 : -0.3, y = k < 2 ? 0.4 : -0.4, z = -0.2;
    Matrix H(3, 6);                  // velocity of the foot, v + φ̇ × r
    H << 0.0, 0.0, 1.0, y, -x, 0.0,  //
        1.0, 0.0, 0.0, 0.0, z, -y,   //
        0.0, 1.0, 0.0, -z, 0.0, x;
    model.link(linear_contact(H, Vec::Zero(3), NewtonImpactFrictionNSL(restitution, 0.0, mu, 3),
                              "foot " + std::to_string(k)),
               *model.systems()[0]);
  }
  return model;
}

}  // namespace saltus::test
