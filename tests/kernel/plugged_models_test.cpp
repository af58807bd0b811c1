// Models of functions with the signatures of Siconos's plugins, against formulas and differences.
#include "saltus/kernel/model/plugged_models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "saltus/kernel/model/check.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

std::string function(const std::string& name) { return SALTUS_PENDULUM_PLUGIN ":" + name; }

PluggedDS::Terms pendulum() {
  PluggedDS::Terms terms;
  terms.mass = function("mass");
  terms.internal_force = function("internal_force");
  terms.internal_dq = function("internal_force_dq");
  terms.internal_dv = function("internal_force_dv");
  terms.external_force = function("external_force");
  return terms;
}

Matrix matrix(std::initializer_list<double> values) {
  Matrix result(2, 2);
  std::copy(values.begin(), values.end(), result.data());
  return result;
}

Vec forces(const LagrangianDS& ds, double t, const Vec& q, const Vec& v) {
  Vec h = Vec::Zero(2);
  ds.forces(t, {q.data(), 2}, {v.data(), 2}, {h.data(), 2});
  return h;
}

TEST(PluggedModels, TermsAreThoseOfTheFunctions) {
  PluggedDS::Terms terms = pendulum();
  terms.gyroscopic_force = function("gyroscopic_force");
  terms.stiffness = matrix({1.0, 2.0, 3.0, 4.0});
  terms.damping = matrix({0.5, 0.6, 0.7, 0.8});
  terms.constant_force = vec({100.0, 200.0});
  const PluggedDS ds(vec({1.0, 0.2}), vec({0.0, 0.5}), terms);
  const Vec q = vec({0.7, -0.4}), v = vec({0.3, 1.1});
  const double t = 0.9;
  Matrix M = Matrix::Zero(2, 2);
  ds.mass({q.data(), 2}, {M.data(), 2, 2});
  EXPECT_TRUE(M.isApprox(matrix({2.0 + 0.5 * std::sin(-0.4), 0.3, 0.3, 1.49}), 1e-15));
  const Vec expected = vec({4.0 * std::cos(2.7) - (21.0 + 5.0 * 0.343 + 0.11) + 2.0 * 1.1 * 0.3 -
                                (0.7 - 0.8) - (0.15 + 0.66) + 100.0,
                            -1.0 - (-8.0 + 0.22) - 2.0 * 0.09 - (2.1 - 1.6) - (0.21 + 0.88) + 200.0});
  EXPECT_NEAR((forces(ds, t, q, v) - expected).norm(), 0.0, 1e-12);
  EXPECT_FALSE(ds.constant_mass());
  EXPECT_FALSE(ds.time_invariant());
}

TEST(PluggedModels, JacobiansAreTheDerivativesOfTheForces) {
  PluggedDS::Terms terms = pendulum();
  terms.stiffness = matrix({1.0, 2.0, 3.0, 4.0});
  terms.damping = matrix({0.5, 0.6, 0.7, 0.8});
  const PluggedDS ds(vec({1.0, 0.2}), vec({0.0, 0.5}), terms);
  const Vec q = vec({0.7, -0.4}), v = vec({0.3, 1.1});
  Matrix dq = Matrix::Zero(2, 2), dv = Matrix::Zero(2, 2);
  ASSERT_TRUE(ds.force_jacobians(0.9, {q.data(), 2}, {v.data(), 2}, {dq.data(), 2, 2}, {dv.data(), 2, 2}));
  const double step = 1e-6;
  for (int j = 0; j < 2; ++j) {
    const Vec shift = step * Vec::Unit(2, j);
    const Vec by_q = (forces(ds, 0.9, q + shift, v) - forces(ds, 0.9, q - shift, v)) / (2 * step);
    const Vec by_v = (forces(ds, 0.9, q, v + shift) - forces(ds, 0.9, q, v - shift)) / (2 * step);
    EXPECT_NEAR((by_q - dq.col(j)).norm(), 0.0, 1e-7);
    EXPECT_NEAR((by_v - dv.col(j)).norm(), 0.0, 1e-7);
  }
  PluggedDS::Terms incomplete = pendulum();
  incomplete.internal_dv = {};
  const PluggedDS other(vec({1.0, 0.2}), vec({0.0, 0.5}), incomplete);
  EXPECT_FALSE(
      other.force_jacobians(0.9, {q.data(), 2}, {v.data(), 2}, {dq.data(), 2, 2}, {dv.data(), 2, 2}));
}

TEST(PluggedModels, RelationsAreThoseOfTheFunctions) {
  const auto ds = std::make_shared<PluggedDS>(vec({1.0, 0.2}), vec({0.0, 0.5}), pendulum());
  NonSmoothDynamicalSystem model({ds});
  const auto circle = std::make_shared<PluggedRelation>(1, function("distance"), function("gradient"));
  const auto floor = std::make_shared<PluggedRheonomousRelation>(
      1, function("height"), function("height_gradient"), function("height_rate"));
  model.link(std::make_shared<Interaction>(circle, NewtonImpactNSL(0.5), "circle"), *ds);
  model.link(std::make_shared<Interaction>(floor, NewtonImpactNSL(0.5), "floor"), *ds);
  for (const CheckItem& item : check(model)) {
    if (item.subject == "system 0") continue;  // its forces are not those of this mass
    EXPECT_TRUE(item.ok()) << item.subject << " " << item.quantity;
  }
  const Vec q = vec({0.7, -0.4});
  double value = 0.0;
  circle->gap({q.data(), 2}, {&value, 1});
  EXPECT_NEAR(value, std::hypot(0.7, 0.4) - 0.4, 1e-15);
  floor->gap_at(0.3, {q.data(), 2}, {&value, 1});
  EXPECT_NEAR(value, 0.7 - 0.3 * std::sin(1.5), 1e-15);
  floor->motion_at(0.3, {q.data(), 2}, {&value, 1});
  EXPECT_NEAR(value, -1.5 * std::cos(1.5), 1e-15);
  EXPECT_FALSE(circle->has_curvature());
}

TEST(PluggedModels, ALinearSystemUnderAnExternalForceIsTimeInvariant) {
  PluggedDS::Terms terms;
  terms.constant_mass = matrix({1.0, 0.0, 0.0, 1.0});
  terms.external_force = function("external_force");
  EXPECT_TRUE(PluggedDS(vec({0.0, 0.0}), vec({0.0, 0.0}), terms).time_invariant());
}

TEST(PluggedModels, ALibraryIsFoundWithAndWithoutItsPrefix) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / "saltus_plugged_models";
  for (const char* file : {"plain.so", "libwrapped.so"}) {
    fs::create_directories(folder);
    fs::copy_file(SALTUS_PENDULUM_PLUGIN, folder / file, fs::copy_options::overwrite_existing);
  }
  for (const char* name : {"plain", "plain.so", "wrapped", "libwrapped.so"}) {
    const PluggedFunction<PluggedDS::OfPosition> mass((folder / name).string() + ":mass");
    EXPECT_TRUE(mass) << name;
  }
  fs::remove_all(folder);
}

TEST(PluggedModels, WhatIsMissingIsNamed) {
  const Vec q = vec({1.0, 0.2}), v = vec({0.0, 0.5});
  expect_refusal([&] { PluggedFunction<PluggedDS::OfPosition>("nowhere/ball:mass"); },
                 {"nowhere/ball", "loaded"});
  expect_refusal([&] { PluggedFunction<PluggedDS::OfPosition>(function("none")); }, {"exports no 'none'"});
  expect_refusal([&] { PluggedDS(q, v, {}); }, {"mass", "got none"});
  PluggedDS::Terms both = pendulum();
  both.constant_mass = matrix({1.0, 0.0, 0.0, 1.0});
  expect_refusal([&] { PluggedDS(q, v, both); }, {"mass", "got both"});
  PluggedDS::Terms wide = pendulum();
  wide.stiffness = Matrix::Zero(2, 3);
  expect_refusal([&] { PluggedDS(q, v, wide); }, {"stiffness"});
  PluggedDS::Terms no_z = pendulum();
  no_z.z = Vec();
  expect_refusal([&] { PluggedDS(q, v, no_z); }, {"z", "got 0 entries"});
  expect_refusal([&] { PluggedRelation(1, function("distance"), {}); }, {"h and H", "got none"});
  expect_refusal(
      [&] { PluggedRelation(1, function("distance"), function("gradient")).require_dimensions(7, 6); },
      {"7 and 6"});
}

}  // namespace
}  // namespace saltus::test
