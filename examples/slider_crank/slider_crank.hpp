#pragma once
// The slider crank of Section 2.1 in C++. The Python document slider_crank.py explains the formulas;
// both models compute the same numbers.
#include "saltus/kernel/model/nonsmooth_dynamical_system.hpp"

namespace saltus::examples {

/// Table 1. The clearance c is that of the notch, 0 for the bilateral case.
struct SliderCrankParameters {
  double l1 = 0.1530, l2 = 0.3060;               ///< lengths of crank and rod [m]
  double a = 0.0500, b = 0.0250, c = 0.0010;     ///< half-length and half-height of the slider, clearance [m]
  double m1 = 0.0380, m2 = 0.0380, m3 = 0.0760;  ///< [kg]
  double J1 = 7.4e-5, J2 = 5.9e-4, J3 = 2.7e-6;  ///< [kg m²]
  double gravity = 9.81;                         ///< [m/s²]
};

/// Crank, rod and slider, q = (θ1, θ2, θ3) [rad].
class SliderCrank final : public LagrangianDS {
 public:
  SliderCrank(Vec q0, Vec v0, const SliderCrankParameters& parameters);
  void mass(const In& q, OutMatrix M) const override;
  void forces(double t, const In& q, const In& v, Out h) const override;
  double potential_energy(const In& q) const override;

 private:
  SliderCrankParameters p_;
  double k_;  // (m2/2 + m3) l1 l2
};

/// A corner (ξ, η) of the slider in the notch: η > 0 meets the upper wall, η < 0 the lower one.
class SliderCorner final : public Relation {
 public:
  /// @param size  1: normal row; 2: normal and tangential row
  SliderCorner(double xi, double eta, int size, const SliderCrankParameters& parameters);
  void require_dimensions(int coordinates, int freedoms) const override;
  void gap(const In& q, Out g) const override;
  void jacobian(const In& q, OutMatrix J) const override;
  void curvature(const In& q, const In& v, Out c) const override;
  bool has_curvature() const override { return true; }

 private:
  SliderCrankParameters p_;
  double xi_, eta_, sign_;  // sign of the wall's normal
};

/// The slider on a straight guide without clearance: y = 0 and θ3 = 0.
class SliderGuide final : public Relation {
 public:
  explicit SliderGuide(const SliderCrankParameters& parameters);
  void require_dimensions(int coordinates, int freedoms) const override;
  void gap(const In& q, Out g) const override;
  void jacobian(const In& q, OutMatrix J) const override;
  void curvature(const In& q, const In& v, Out c) const override;
  bool has_curvature() const override { return true; }

 private:
  SliderCrankParameters p_;
};

/// How the slider is led.
enum class Guidance {
  frictional,    ///< clearance c, four corners with friction μ = 0.01 and ε_N = 0.4
  frictionless,  ///< clearance c, four corners, ε = 0.4
  no_clearance,  ///< c = 0, four corners, ε = 0.4
  equality,      ///< two equality constraints
};

/// The whole model with the initial conditions of Table 1.
NonSmoothDynamicalSystem make_slider_crank(Guidance guidance);

}  // namespace saltus::examples
