// The certificate against residuals worked out by hand, and that it does not depend on units.
#include "saltus/numerics/certificate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/complementarity.hpp"

namespace saltus::test {
namespace {

Certificate certificate_of(const ContactProblem& problem, std::vector<double> P) {
  std::vector<double> xi(P.size());
  return certify(problem, P.data(), xi.data());
}

TEST(Certificate, EqualityIsTheVelocityItself) {
  const auto problem = problem_of(Matrix::Constant(1, 1, 2.0), Vec::Constant(1, -3.0), {Equality{}});
  const Certificate c = certificate_of(problem, {2.0});
  EXPECT_DOUBLE_EQ(c.residual, 1.0);  // 2·2 - 3
  EXPECT_DOUBLE_EQ(c.scale, 7.0);     // 3 + 4
}

TEST(Certificate, NonNegativeIsTheSmallerOfBoth) {
  const auto problem = problem_of(Matrix::Constant(1, 1, 2.0), Vec::Constant(1, -3.0), {NonNegative{}});
  EXPECT_DOUBLE_EQ(certificate_of(problem, {2.0}).residual, 1.0);   // xi = 1, dP = 4
  EXPECT_DOUBLE_EQ(certificate_of(problem, {1.0}).residual, 1.0);   // xi = -1
  EXPECT_DOUBLE_EQ(certificate_of(problem, {-0.5}).residual, 4.0);  // xi = -4 is worse than dP = -1
  EXPECT_DOUBLE_EQ(certificate_of(problem, {1.5}).residual, 0.0);
  const auto open = problem_of(Matrix::Constant(1, 1, 2.0), Vec::Constant(1, 3.0), {NonNegative{}});
  EXPECT_DOUBLE_EQ(certificate_of(open, {-0.25}).residual, 0.5);  // dP = -0.5 pulls
}

TEST(Certificate, CoulombPlane) {
  // G = diag(1, 2): d = 2. P = (1, p): xi = (0, 2p + b_T), radius mu d P_N = 0.5·2·1 = 1.
  const Matrix G = (Matrix(2, 2) << 1.0, 0.0, 0.0, 2.0).finished();
  auto residual = [&](double b_T, double p) {
    const auto problem = problem_of(G, (Vec(2) << -1.0, b_T).finished(), {Coulomb{0.5, 2}});
    return certificate_of(problem, {1.0, p}).residual;
  };
  EXPECT_DOUBLE_EQ(residual(0.5, -0.25), 0.0);  // sticks: xi_T = 0, |P_T| = 0.25 < 0.5
  EXPECT_DOUBLE_EQ(residual(3.0, -0.5), 0.0);   // slips: xi_T = 2, P_T = -mu P_N
  EXPECT_DOUBLE_EQ(residual(3.0, 0.5), 2.0);    // friction that drives: dP_T = 1, projection -1
  EXPECT_DOUBLE_EQ(residual(3.0, 0.0), 1.0);    // friction missing: 0 against -1
  EXPECT_DOUBLE_EQ(residual(2.0, -1.0), 1.0);   // xi_T = 0 but outside the cone: -2 against -1
}

TEST(Certificate, CoulombInSpaceProjectsOnADisc) {
  // Isotropic contact, sliding along (3, 4)/5: friction must be -mu P_N (3, 4)/5.
  const Matrix G = Matrix::Identity(3, 3);
  const auto problem = problem_of(G, (Vec(3) << -1.0, 3.0, 4.0).finished(), {Coulomb{0.5, 3}});
  EXPECT_NEAR(certificate_of(problem, {1.0, -0.3, -0.4}).residual, 0.0, 1e-15);
  // Without friction the projection is (-0.3, -0.4): its length is the residual.
  EXPECT_NEAR(certificate_of(problem, {1.0, 0.0, 0.0}).residual, 0.5, 1e-15);
}

TEST(Certificate, WritesTheRelativeVelocities) {
  const Matrix G = (Matrix(2, 2) << 1.0, 2.0, 3.0, 4.0).finished();
  const auto problem = problem_of(G, (Vec(2) << 0.5, -0.5).finished(), {NonNegative{}, NonNegative{}});
  const double P[] = {1.0, 10.0};
  double xi[2];
  const Certificate c = certify(problem, P, xi);
  EXPECT_DOUBLE_EQ(xi[0], 21.5);
  EXPECT_DOUBLE_EQ(xi[1], 42.5);
  EXPECT_DOUBLE_EQ(c.scale, 43.5);  // 0.5 + 3 + 40
}

TEST(Certificate, DoesNotDependOnUnits) {
  // Masses in g instead of kg (G·1e-3, P·1e3), velocities in mm/s (G·1e3, b·1e3): residual/scale stays.
  std::mt19937 random(7);
  for (int k = 0; k < 200; ++k) {
    const ContactProblem problem = random_problem(random, {.moved = 1e-2});
    std::vector<double> P(problem.rows());
    std::normal_distribution<double> normal;
    for (double& p : P) p = normal(random);
    const Certificate here = certificate_of(problem, P);
    ContactProblem grams = problem;
    grams.G.view() *= 1e-3;
    std::vector<double> P_grams = P;
    for (double& p : P_grams) p *= 1e3;
    EXPECT_NEAR(certificate_of(grams, P_grams).residual, here.residual, 1e-12 * here.scale);
    ContactProblem millimetres = problem;
    millimetres.G.view() *= 1e3;
    millimetres.b.view() *= 1e3;
    const Certificate there = certificate_of(millimetres, P);
    EXPECT_NEAR(there.residual, 1e3 * here.residual, 1e-9 * here.scale);
    EXPECT_NEAR(there.scale, 1e3 * here.scale, 1e-9 * here.scale);
  }
}

TEST(Certificate, ANaNIsNeverWithinTolerance) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const ContactSet& set : {ContactSet(Equality{}), ContactSet(NonNegative{})}) {
    const auto problem = problem_of(Matrix::Constant(1, 1, 1.0), Vec::Constant(1, -1.0), {set});
    EXPECT_FALSE(certificate_of(problem, {nan}).within(1e-12));
  }
  const auto friction =
      problem_of(Matrix::Identity(2, 2), (Vec(2) << -1.0, 0.0).finished(), {Coulomb{0.5, 2}});
  EXPECT_FALSE(certificate_of(friction, {1.0, nan}).within(1e-12));
  EXPECT_FALSE(certificate_of(friction, {nan, 0.0}).within(1e-12));
}

TEST(Certificate, ALargeCoefficientOfFrictionIsNoForceWhereNothingPresses) {
  // mu d overflows: at P_N = 0 the disc is a point all the same, and xi_T is the residual where P_T = xi_T/d
  Matrix G = Matrix::Zero(2, 2);
  G(1, 1) = 1e180;
  const auto problem = problem_of(G, (Vec(2) << 0.0, 1e180).finished(), {Coulomb{1e200, 2}});
  EXPECT_DOUBLE_EQ(certificate_of(problem, {0.0, -1.0}).residual, 1e180);
}

TEST(Certificate, ScaleOfAContact) {
  const Matrix G = (Matrix(3, 3) << 1.0, 9.0, 9.0, 9.0, -4.0, 9.0, 9.0, 9.0, 0.0).finished();
  const ContactProblem problem{G, Vec(Vec::Zero(3)), {Coulomb{}, NonNegative{}}};
  EXPECT_DOUBLE_EQ(contact_scale(problem, 0, 2), 4.0);
  EXPECT_DOUBLE_EQ(contact_scale(problem, 2, 1), 1.0);  // a contact that moves nothing
}

}  // namespace
}  // namespace saltus::test
