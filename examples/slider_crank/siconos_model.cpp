#include "slider_crank/siconos_model.hpp"

#include <cmath>

namespace {

// Table 1
constexpr double l1 = 0.1530, l2 = 0.3060;               // lengths of crank and rod [m]
constexpr double a = 0.0500, b = 0.0250, c = 0.0010;     // half-length, half-height, clearance [m]
constexpr double m1 = 0.0380, m2 = 0.0380, m3 = 0.0760;  // [kg]
constexpr double J1 = 7.4e-5, J2 = 5.9e-4, J3 = 2.7e-6;  // [kg m²]
constexpr double gravity = 9.81;                         // [m/s²]
constexpr double k = (m2 / 2 + m3) * l1 * l2;

/// q = (θ1, θ2, θ3) [rad]
class Crank : public LagrangianDS {
 public:
  Crank(SP::SiconosVector q0, SP::SiconosVector v0)
      : LagrangianDS(q0, v0, std::make_shared<SimpleMatrix>(3, 3)) {
    _fGyr = std::make_shared<SiconosVector>(3);
  }

  void computeMass(SP::SiconosVector q) override {
    const double coupling = k * std::cos((*q)(0) - (*q)(1));
    _mass->setValue(0, 0, J1 + (m1 / 4 + m2 + m3) * l1 * l1);
    _mass->setValue(0, 1, coupling);
    _mass->setValue(1, 0, coupling);
    _mass->setValue(1, 1, J2 + (m2 / 4 + m3) * l2 * l2);
    _mass->setValue(2, 2, J3);
  }

  void computeFGyr(SP::SiconosVector q, SP::SiconosVector v) override {
    const double coupling = k * std::sin((*q)(0) - (*q)(1));
    _fGyr->setValue(0, coupling * (*v)(1) * (*v)(1) + (m1 / 2 + m2 + m3) * gravity * l1 * std::cos((*q)(0)));
    _fGyr->setValue(1, -coupling * (*v)(0) * (*v)(0) + (m2 / 2 + m3) * gravity * l2 * std::cos((*q)(1)));
  }
};

/// A corner (ξ, η) of the slider: η > 0 meets the upper wall, η < 0 the lower one.
class Corner : public LagrangianScleronomousR {
 public:
  Corner(double xi, double eta) : xi_(xi), eta_(eta), sign_(eta > 0 ? -1.0 : 1.0) {}

  void computeh(const BlockVector& q, BlockVector&, SiconosVector& y) override {
    const double s3 = std::sin(q(2)), c3 = std::cos(q(2));
    y.setValue(0, (b + c) + sign_ * (l1 * std::sin(q(0)) + l2 * std::sin(q(1)) + xi_ * s3 + eta_ * c3));
  }

  void computeJachq(const BlockVector& q, BlockVector&) override {
    const double s3 = std::sin(q(2)), c3 = std::cos(q(2));
    _jachq->setValue(0, 0, sign_ * l1 * std::cos(q(0)));
    _jachq->setValue(0, 1, sign_ * l2 * std::cos(q(1)));
    _jachq->setValue(0, 2, sign_ * (xi_ * c3 - eta_ * s3));
    _jachq->setValue(1, 0, -l1 * std::sin(q(0)));
    _jachq->setValue(1, 1, -l2 * std::sin(q(1)));
    _jachq->setValue(1, 2, -xi_ * s3 - eta_ * c3);
  }

 private:
  double xi_, eta_, sign_;
};

}  // namespace

SP::NonSmoothDynamicalSystem make_siconos_slider_crank(double until) {
  const auto q0 = std::make_shared<SiconosVector>(3), v0 = std::make_shared<SiconosVector>(3);
  v0->setValue(0, 150.0);
  v0->setValue(1, -75.0);
  const auto crank = std::make_shared<Crank>(q0, v0);
  const auto nsds = std::make_shared<NonSmoothDynamicalSystem>(0.0, until);
  nsds->insertDynamicalSystem(crank);
  const auto law = std::make_shared<NewtonImpactFrictionNSL>(0.4, 0.0, 0.01, 2);
  for (const double eta : {b, -b})
    for (const double xi : {-a, a})
      nsds->link(std::make_shared<Interaction>(law, std::make_shared<Corner>(xi, eta)), crank);
  return nsds;
}
