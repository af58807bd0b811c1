// The slider crank of Section 2.1: what Table 1 and the geometry imply. The tables of Section 5 are
// reproduced in Python.
#include "slider_crank/slider_crank.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <cmath>

#include "support/half_explicit_family.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

using examples::Guidance;

TEST(SliderCrank, InitialEnergyOfTableOne) {
  const auto model = examples::make_slider_crank(Guidance::frictional);
  TimeStepping simulation(model, *make_integrator("HalfExplicitTrapezoidalOSI"), 1e-4);
  const Vec q0 = model.q0();
  const double energy =
      simulation.report().kinetic_energy + model.systems()[0]->potential_energy(In(q0.data(), 3));
  EXPECT_NEAR(energy, 7.49554875, 1e-8);
}

class SliderCrankRun : public testing::TestWithParam<std::string> {};

TEST_P(SliderCrankRun, TheSliderDoesNotTurnBySymmetry) {
  // Corners hit in pairs and share the load equally; θ3 = 0 is unstable, so an uneven share would grow.
  const auto model = examples::make_slider_crank(guidance_for(GetParam()));
  int impacts = 0;
  for (const Row& row : rows_of_run(model, *make_scheme(GetParam()), 1e-5, 0.1)) {
    ASSERT_LT(std::abs(row.state.q[2]), 1e-9) << row.state.t;
    ASSERT_LT(row.report.penetration, 1e-3) << row.state.t;
    impacts += row.report.impulsive;
  }
  EXPECT_GT(impacts, 10);
}

INSTANTIATE_TEST_SUITE_P(Schemes, SliderCrankRun, testing::ValuesIn(and_accurate_ones(scheme_names())),
                         [](const auto& test) { return test.param; });

TEST(SliderCrank, FreeFlightKeepsTheEnergy) {
  const auto model = examples::make_slider_crank(Guidance::frictional);
  const auto rows = rows_of_run(model, *make_integrator("HalfExplicitTrapezoidalOSI"), 1e-6, 1e-3);
  for (const Row& row : rows) {
    if (row.report.impulsive) break;
    const double potential = model.systems()[0]->potential_energy(In(row.state.q.data(), 3));
    ASSERT_NEAR(row.report.kinetic_energy + potential, 7.49554875, 1e-6) << row.state.t;
  }
}

TEST(SliderCrank, JacobiansAreTheGradientsOfTheGaps) {
  const examples::SliderCrankParameters p;
  const Vec q = vec({0.7, -0.3, 0.2});
  const double step = 1e-6;
  for (double xi : {-p.a, p.a})
    for (double eta : {-p.b, p.b}) {
      const examples::SliderCorner corner(xi, eta, 2, p);
      Matrix J = Matrix::Zero(2, 3);
      corner.jacobian(In(q.data(), 3), OutMatrix(J.data(), 2, 3));
      for (int k = 0; k < 3; ++k) {
        double gap[2];
        for (int side : {0, 1}) {
          Vec moved = q;
          moved[k] += side ? step : -step;
          corner.gap(In(moved.data(), 3), Out(gap + side, 1));
        }
        EXPECT_NEAR(J(0, k), (gap[1] - gap[0]) / (2.0 * step), 1e-9);
      }
    }
}

TEST(SliderCrank, CurvaturesAreTheRatesOfTheJacobians) {
  // (38): (dWᵀ/dt) v along q + t v
  const examples::SliderCrankParameters p;
  const Vec q = vec({0.7, -0.3, 0.2}), v = vec({3.0, -2.0, 5.0});
  const double step = 1e-5;
  const examples::SliderGuide guide(p);
  const examples::SliderCorner upper(p.a, p.b, 2, p), lower(-p.a, -p.b, 2, p);
  for (const Relation* relation : {static_cast<const Relation*>(&guide), static_cast<const Relation*>(&upper),
                                   static_cast<const Relation*>(&lower)}) {
    ASSERT_TRUE(relation->has_curvature());
    Matrix before = Matrix::Zero(2, 3), after = Matrix::Zero(2, 3);
    const Vec q_before = q - step * v, q_after = q + step * v;
    relation->jacobian(In(q_before.data(), 3), OutMatrix(before.data(), 2, 3));
    relation->jacobian(In(q_after.data(), 3), OutMatrix(after.data(), 2, 3));
    Vec c = Vec::Zero(2);
    relation->curvature(In(q.data(), 3), In(v.data(), 3), Out(c.data(), 2));
    EXPECT_LT((c - (after - before) * v / (2.0 * step)).norm(), 1e-6);
  }
}

class BilateralCrank : public testing::TestWithParam<std::string> {};

// q and v at all steps
Matrix crank_run(const OneStepIntegrator& scheme, double dt, double until) {
  Matrix states(std::lround(until / dt), 6);
  TimeStepping simulation(examples::make_slider_crank(Guidance::equality), scheme, dt);
  for (Eigen::Index k = 0; k < states.rows(); ++k) {
    simulation.step();
    states.row(k) << simulation.state().q.transpose(), simulation.state().v.transpose();
  }
  return states;
}

// Differences of the coarser run from the finer one at its own times
Matrix differences(Matrix coarse, const Matrix& fine) {
  const auto every = fine.rows() / coarse.rows();
  for (Eigen::Index k = 0; k < coarse.rows(); ++k) coarse.row(k) -= fine.row((k + 1) * every - 1);
  return coarse;
}

TEST_P(BilateralCrank, HasTheOrderOfTheTableau) {
  const double until = 0.02;
  const int order = family_order(GetParam()).constrained;
  const Matrix exact = crank_run(*family("HEM5", "start"), 1e-5, until);
  const std::vector<double> dt = {2e-4, 1e-4, 5e-5};
  for (const char* activity : {"start", "stabilised"}) {
    std::vector<double> error_q, error_v;  // largest over the run: at single times errors may vanish
    for (double h : dt) {
      const Matrix error = differences(crank_run(*family(GetParam(), activity), h, until), exact);
      error_q.push_back(error.leftCols(3).rowwise().norm().maxCoeff());
      error_v.push_back(error.rightCols(3).rowwise().norm().maxCoeff());
    }
    if (GetParam() == "RK4") {  // its third-order part is so small that it only shows at smaller Δt
      EXPECT_GE(slope(dt, error_q), order - 0.2) << activity;
      EXPECT_GE(slope(dt, error_v), order - 0.2) << activity;
    } else {
      EXPECT_NEAR(slope(dt, error_q), order, 0.2) << activity;
      EXPECT_NEAR(slope(dt, error_v), order, 0.2) << activity;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Tableaux, BilateralCrank, testing::ValuesIn(family_names()), family_test_name);

TEST(BilateralCrank, ThirdOrderInTheNormOfTableTwo) {
  // The spectral norm of all differences of q
  const Matrix exact = crank_run(*family("HEM5", "start"), 1e-5, 0.1);
  const std::pair<double, double> bounds[] = {{1e-3, 4e-2}, {1e-4, 1e-5}, {1e-5, 1e-7}};
  for (const auto& [dt, bound] : bounds) {
    const Matrix difference =
        differences(crank_run(*family("third-order", "start"), dt, 0.1), exact).leftCols(3);
    const Matrix squares = difference.transpose() * difference;
    const double norm = std::sqrt(Eigen::SelfAdjointEigenSolver<Matrix>(squares).eigenvalues().maxCoeff());
    EXPECT_LT(norm, bound) << dt;
  }
}

}  // namespace
}  // namespace saltus::test
