// Roots of angle polynomials: constructed ones, double ones, and all that a fine grid sees.
#include "saltus/numerics/solvers/angle_polynomial.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace saltus::test {
namespace {

Direction at(double angle) { return {std::cos(angle), std::sin(angle)}; }

// scale Π sin(½(α − root)): every angle polynomial with four real roots has this form
AnglePolynomial with_roots(const std::array<double, 4>& r, double scale) {
  // sin ½(α−p) sin ½(α−q) = ½ (cos ½(p−q) − cos(α − ½(p+q)))
  const double A = std::cos(0.5 * (r[0] - r[1])), a = 0.5 * (r[0] + r[1]);
  const double B = std::cos(0.5 * (r[2] - r[3])), b = 0.5 * (r[2] + r[3]);
  const double k = 0.25 * scale;
  return {k * (A * B + 0.5 * std::cos(a - b)), -k * (A * std::cos(b) + B * std::cos(a)),
          -k * (A * std::sin(b) + B * std::sin(a)), 0.5 * k * std::cos(a + b), 0.5 * k * std::sin(a + b)};
}

double distance_to_nearest(const Angles& angles, double root) {
  double nearest = 2.0;
  for (int k = 0; k < angles.count; ++k) {
    const Direction e = angles.directions[k], r = at(root);
    nearest = std::min(nearest, std::hypot(e.cosine - r.cosine, e.sine - r.sine));
  }
  return nearest;
}

TEST(AnglePolynomial, ItsSlopeIsItsDerivative) {
  const AnglePolynomial f{0.3, -1.2, 0.7, 2.1, -0.4};
  for (double angle : {0.0, 1.0, 2.5, 4.0}) {
    const double difference = (f.value(at(angle + 1e-6)) - f.value(at(angle - 1e-6))) / 2e-6;
    EXPECT_NEAR(f.slope(at(angle)), difference, 1e-8);
  }
}

TEST(AnglePolynomial, FourRootsAnywhere) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> angle(-M_PI, M_PI), decade(-6.0, 6.0);
  for (int k = 0; k < 2000; ++k) {
    const std::array<double, 4> roots = {angle(random), angle(random), angle(random), angle(random)};
    double apart = 1.0;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < i; ++j) apart = std::min(apart, std::abs(std::sin(0.5 * (roots[i] - roots[j]))));
    if (apart < 0.02) continue;  // closer ones are known less well
    const Angles angles = candidate_angles(with_roots(roots, std::pow(10.0, decade(random))));
    for (double root : roots) EXPECT_LT(distance_to_nearest(angles, root), 1e-10) << k;
  }
}

TEST(AnglePolynomial, ADoubleRootIsAmongTheCandidates) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> angle(-M_PI, M_PI);
  for (int k = 0; k < 1000; ++k) {
    const double twice = angle(random);
    const Angles angles = candidate_angles(with_roots({twice, twice, angle(random), angle(random)}, 1.0));
    // known to the root of rounding, which is enough for f to vanish to rounding
    EXPECT_LT(distance_to_nearest(angles, twice), 1e-6) << k;
  }
}

TEST(AnglePolynomial, EverySignChangeOfAFineGridIsFound) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> decade(-4.0, 0.0);
  auto coefficient = [&] { return normal(random) * std::pow(10.0, decade(random)); };
  const int grid = 2000;
  for (int k = 0; k < 500; ++k) {
    const AnglePolynomial f{coefficient(), coefficient(), coefficient(), coefficient(), coefficient()};
    const Angles angles = candidate_angles(f);
    EXPECT_LE(angles.count, 7);
    for (int i = 0; i < grid; ++i) {
      const double left = 2.0 * M_PI * i / grid, right = 2.0 * M_PI * (i + 1) / grid;
      if ((f.value(at(left)) < 0.0) == (f.value(at(right)) < 0.0)) continue;
      EXPECT_LT(distance_to_nearest(angles, 0.5 * (left + right)), 2.0 * M_PI / grid) << k;
    }
  }
}

TEST(AnglePolynomial, ZeroHasNoRootsOfItsOwn) { EXPECT_EQ(candidate_angles({}).count, 0); }

}  // namespace
}  // namespace saltus::test
