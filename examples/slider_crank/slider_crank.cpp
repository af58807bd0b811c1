#include "slider_crank/slider_crank.hpp"

#include <cmath>
#include <stdexcept>

namespace saltus::examples {
namespace {

void require_three(int n) {
  if (n != 3) throw std::invalid_argument("the slider acts on 3 freedoms, got " + std::to_string(n));
}

}  // namespace

SliderCrank::SliderCrank(Vec q0, Vec v0, const SliderCrankParameters& parameters)
    : LagrangianDS(std::move(q0), std::move(v0)), p_(parameters), k_((p_.m2 / 2 + p_.m3) * p_.l1 * p_.l2) {
  require_three(dimension());
}

void SliderCrank::mass(const In& q, OutMatrix M) const {
  const double coupling = k_ * std::cos(q[0] - q[1]);
  M(0, 0) = p_.J1 + (p_.m1 / 4 + p_.m2 + p_.m3) * p_.l1 * p_.l1;
  M(0, 1) = coupling;
  M(1, 0) = coupling;
  M(1, 1) = p_.J2 + (p_.m2 / 4 + p_.m3) * p_.l2 * p_.l2;
  M(2, 2) = p_.J3;
}

void SliderCrank::forces(double, const In& q, const In& v, Out h) const {
  const double coupling = k_ * std::sin(q[0] - q[1]);
  h[0] = -coupling * v[1] * v[1] - (p_.m1 / 2 + p_.m2 + p_.m3) * p_.gravity * p_.l1 * std::cos(q[0]);
  h[1] = coupling * v[0] * v[0] - (p_.m2 / 2 + p_.m3) * p_.gravity * p_.l2 * std::cos(q[1]);
}

double SliderCrank::potential_energy(const In& q) const {
  return p_.gravity * ((p_.m1 / 2 + p_.m2 + p_.m3) * p_.l1 * std::sin(q[0]) +
                       (p_.m2 / 2 + p_.m3) * p_.l2 * std::sin(q[1]));
}

SliderCorner::SliderCorner(double xi, double eta, int size, const SliderCrankParameters& parameters)
    : Relation(size), p_(parameters), xi_(xi), eta_(eta), sign_(eta > 0 ? -1.0 : 1.0) {
  if (size > 2) throw std::invalid_argument("a corner has 1 or 2 rows, got " + std::to_string(size));
}

void SliderCorner::require_dimensions(int, int freedoms) const { require_three(freedoms); }

void SliderCorner::gap(const In& q, Out g) const {
  const double y = p_.l1 * std::sin(q[0]) + p_.l2 * std::sin(q[1]);
  const double y_corner = y + xi_ * std::sin(q[2]) + eta_ * std::cos(q[2]);
  g[0] = (p_.b + p_.c) + sign_ * y_corner;
}

void SliderCorner::jacobian(const In& q, OutMatrix J) const {
  const double s3 = std::sin(q[2]);
  const double c3 = std::cos(q[2]);
  J(0, 0) = sign_ * p_.l1 * std::cos(q[0]);
  J(0, 1) = sign_ * p_.l2 * std::cos(q[1]);
  J(0, 2) = sign_ * (xi_ * c3 - eta_ * s3);
  if (size() == 1) return;
  J(1, 0) = -p_.l1 * std::sin(q[0]);
  J(1, 1) = -p_.l2 * std::sin(q[1]);
  J(1, 2) = -xi_ * s3 - eta_ * c3;
}

void SliderCorner::curvature(const In& q, const In& v, Out c) const {
  const double s3 = std::sin(q[2]);
  const double c3 = std::cos(q[2]);
  const double w1 = v[0] * v[0], w2 = v[1] * v[1], w3 = v[2] * v[2];
  c[0] = sign_ * (-p_.l1 * std::sin(q[0]) * w1 - p_.l2 * std::sin(q[1]) * w2 - (xi_ * s3 + eta_ * c3) * w3);
  if (size() == 1) return;
  c[1] = -p_.l1 * std::cos(q[0]) * w1 - p_.l2 * std::cos(q[1]) * w2 - (xi_ * c3 - eta_ * s3) * w3;
}

SliderGuide::SliderGuide(const SliderCrankParameters& parameters) : Relation(2), p_(parameters) {}

void SliderGuide::require_dimensions(int, int freedoms) const { require_three(freedoms); }

void SliderGuide::gap(const In& q, Out g) const {
  g[0] = p_.l1 * std::sin(q[0]) + p_.l2 * std::sin(q[1]);
  g[1] = q[2];
}

void SliderGuide::jacobian(const In& q, OutMatrix J) const {
  J(0, 0) = p_.l1 * std::cos(q[0]);
  J(0, 1) = p_.l2 * std::cos(q[1]);
  J(1, 2) = 1.0;
}

void SliderGuide::curvature(const In& q, const In& v, Out c) const {
  c[0] = -p_.l1 * std::sin(q[0]) * v[0] * v[0] - p_.l2 * std::sin(q[1]) * v[1] * v[1];
}

NonSmoothDynamicalSystem make_slider_crank(Guidance guidance) {
  SliderCrankParameters p;
  if (guidance == Guidance::no_clearance) p.c = 0.0;
  const bool friction = guidance == Guidance::frictional;
  const Vec q0 = Vec::Zero(3);
  Vec v0(3);
  v0 << 150.0, -75.0, 0.0;
  auto crank = std::make_shared<SliderCrank>(q0, v0, p);
  NonSmoothDynamicalSystem model({crank});
  if (guidance == Guidance::equality) {
    model.link(
        std::make_shared<Interaction>(std::make_shared<SliderGuide>(p), EqualityConditionNSL(2), "guide"),
        *crank);
    return model;
  }
  NonSmoothLaw law = NewtonImpactNSL(0.4);
  if (friction) law = NewtonImpactFrictionNSL(0.4, 0.0, 0.01, 2);
  const struct {
    const char* name;
    double xi, eta;
  } corners[] = {{"upper left", -p.a, p.b},
                 {"upper right", p.a, p.b},
                 {"lower left", -p.a, -p.b},
                 {"lower right", p.a, -p.b}};
  for (const auto& corner : corners)
    model.link(std::make_shared<Interaction>(
                   std::make_shared<SliderCorner>(corner.xi, corner.eta, law.size(), p), law, corner.name),
               *crank);
  return model;
}

}  // namespace saltus::examples
