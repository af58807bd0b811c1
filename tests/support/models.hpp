#pragma once
// Small models whose motion is known: in closed form, or as an ordinary differential equation.
#include <memory>

#include "saltus/kernel/integrators/one_step_integrator.hpp"
#include "saltus/kernel/model/lagrangian_linear_tids.hpp"
#include "saltus/kernel/model/nonsmooth_dynamical_system.hpp"
#include "slider_crank/slider_crank.hpp"

namespace saltus::test {

inline constexpr double gravity = 9.81;  // [m/s²]

Vec vec(std::initializer_list<double> values);
std::shared_ptr<const Interaction> linear_contact(Matrix H, Vec b, NonSmoothLaw law, std::string name);

/// Ball of mass m falling on a floor at 0: q is its gap.
NonSmoothDynamicalSystem make_ball(double height, double velocity, double restitution, double mass = 2.0);

/// Block of 2 kg on a plane inclined by `angle` with friction, q = (down the plane, gap).
NonSmoothDynamicalSystem make_block(double velocity, double mu, double angle = 0.0, double gap = -1e-4);

/// Block of 2 kg on a horizontal plane with friction, pulled to 0 by a spring k = 50 N/m.
NonSmoothDynamicalSystem make_friction_oscillator(double x0, double mu, double stiffness = 50.0);

/// Disc in the plane over a floor, q = (x, gap, φ), I = 2/5 m r², the inertia of a sphere: the
/// tangential row is the velocity of the contact point, ẋ + r φ̇.
NonSmoothDynamicalSystem make_sphere(Vec q0, Vec v0, double restitution, double mu, double radius = 0.1);

/// Two balls on a line, q = (x1, x2) in two systems, a contact between them, no gravity.
NonSmoothDynamicalSystem make_two_balls(double m1, double m2, double v1, double v2, double restitution,
                                        double distance = 0.1);

/// Two blocks of 1 and 3 kg dropped on each other and on the floor: two systems, two contacts.
NonSmoothDynamicalSystem make_stack(double height, double restitution);

/// Oscillator m = 1 kg, k = ω² N/m without any contact.
NonSmoothDynamicalSystem make_oscillator(double omega, double x0, double v0, double damping = 0.0);

/// Double pendulum with unit masses and lengths: the mass matrix depends on the position.
class DoublePendulum final : public LagrangianDS {
 public:
  DoublePendulum(Vec q0, Vec v0) : LagrangianDS(std::move(q0), std::move(v0)) {}
  void mass(const In& q, OutMatrix M) const override;
  void forces(double t, const In& q, const In& v, Out h) const override;
  double potential_energy(const In& q) const override;
};
NonSmoothDynamicalSystem make_double_pendulum();
/// Its state at `until` by an independent integration.
State exact_double_pendulum(double until);

/// Point in the plane on a circle around the origin: inside of a bowl (gap R - |q|, rows normal and, if
/// size is 2, tangential), or on a rod (equality R - |q|).
class Circle final : public Relation {
 public:
  Circle(int size, double radius) : Relation(size), radius_(radius) {}
  void gap(const In& q, Out g) const override;
  void jacobian(const In& q, OutMatrix J) const override;
  void curvature(const In& q, const In& v, Out c) const override;
  bool has_curvature() const override { return true; }

 private:
  double radius_;
};

/// Pendulum of 2 kg on a rod of 0.8 m, in cartesian coordinates.
NonSmoothDynamicalSystem make_pendulum();
State exact_pendulum(double until);
/// Tension of the rod at `t` [N].
double pendulum_tension(double t);

/// Point sliding with friction in a bowl, from g = -1e-4 so that drift opens no contact. It slides on the
/// circle on which it started: velocity-level constraints do not return it to g = 0.
NonSmoothDynamicalSystem make_bowl(double mu);
State exact_bowl(double mu, double until);

/// The same from the bottom and from g = 0 to the last bit, with restitution: whether the gap drifts open or
/// shut is left to the scheme.
NonSmoothDynamicalSystem make_touching_bowl(double mu, double restitution);
State exact_touching_bowl(double mu, double until);

/// Block of 2 kg, q = (gap of the wall, gap of the floor), that slides on the floor against a wall, without
/// friction: it hits the wall after 10.5 steps of `dt`. It lies a little below g = 0, so that rounding opens
/// nothing.
NonSmoothDynamicalSystem make_block_before_wall(double dt, double restitution);

/// How the slider is led in a model for this scheme: with friction if the scheme takes it.
examples::Guidance guidance_for(const std::string& scheme);

}  // namespace saltus::test
