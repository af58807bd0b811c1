#include "saltus/kernel/model/check.hpp"

#include <cmath>
#include <cstdio>
#include <limits>

#include "saltus/kernel/model/requirements.hpp"

namespace saltus {
namespace {

constexpr double difference_step = 1e-5;       // of central differences: their error is about 1e-10
constexpr double difference_tolerance = 1e-6;  // far above that, far below any wrong term
constexpr double broken = std::numeric_limits<double>::infinity();

In view(const Vec& x) { return {x.data(), x.size()}; }

Matrix mass_at(const LagrangianDS& system, const Vec& q) {
  Matrix M = Matrix::Zero(q.size(), q.size());
  system.mass(view(q), {M.data(), M.rows(), M.cols()});
  return M;
}

Vec forces_at(const LagrangianDS& system, double t, const Vec& q, const Vec& v) {
  Vec h = Vec::Zero(q.size());
  system.forces(t, view(q), view(v), {h.data(), h.size()});
  return h;
}

Vec gap_at(const Relation& relation, int gaps, const Vec& q) {
  Vec g = Vec::Zero(gaps);
  relation.gap(view(q), {g.data(), g.size()});
  return g;
}

Matrix jacobian_at(const Relation& relation, const Vec& q) {
  Matrix J = Matrix::Zero(relation.size(), q.size());
  relation.jacobian(view(q), {J.data(), J.rows(), J.cols()});
  return J;
}

// Column j of the result is the central difference of f along freedom j.
template <class Function>
Matrix gradient(Function f, const Vec& q) {
  Matrix all;
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    Vec ahead = q, behind = q;
    ahead[j] += difference_step;
    behind[j] -= difference_step;
    const Vec slope = (f(ahead) - f(behind)) / (2 * difference_step);
    if (j == 0) all.resize(slope.size(), q.size());
    all.col(j) = slope;
  }
  return all;
}

double deviation(const Matrix& got, const Matrix& expected) {
  if (!got.allFinite() || !expected.allFinite()) return broken;
  if (got.size() == 0) return 0.0;
  const double scale = std::max(1.0, std::max(got.cwiseAbs().maxCoeff(), expected.cwiseAbs().maxCoeff()));
  return (got - expected).cwiseAbs().maxCoeff() / scale;
}

std::string text(const char* label, const Vec& values) {
  std::string all = label;
  for (double value : values) {
    char number[32];
    std::snprintf(number, sizeof number, " %.6g", value);
    all += number;
  }
  return all;
}

// −(Ṁv − ½ ∂(vᵀMv)/∂q)
Vec gyroscopic(const LagrangianDS& system, const Vec& q, const Vec& v) {
  const double eps = difference_step;
  const Matrix rate = (mass_at(system, q + eps * v) - mass_at(system, q - eps * v)) / (2 * eps);
  const Matrix energy =
      gradient([&](const Vec& x) { return Vec(Vec::Constant(1, 0.5 * v.dot(mass_at(system, x) * v))); }, q);
  return -(rate * v) + energy.transpose().col(0);
}

// A velocity that moves every freedom, of the size of the initial one.
Vec test_velocity(const Vec& v0) {
  const double size = std::max(1.0, v0.cwiseAbs().maxCoeff());
  Vec v = v0;
  for (Eigen::Index i = 0; i < v.size(); ++i)
    if (v[i] == 0.0) v[i] = size * (0.3 + 0.1 * std::cos(1.0 + 2.0 * static_cast<double>(i)));
  return v / size;
}

void check_system(const LagrangianDS& system, double t0, const std::string& who,
                  std::vector<CheckItem>& items) {
  const Vec& q = system.q0();
  const Matrix M = mass_at(system, q);
  items.push_back({who, "mass symmetric", deviation(M, M.transpose()), 1e-9, ""});
  const double lowest = smallest_eigenvalue(M);
  items.push_back({who, "mass positive definite", lowest > 0.0 ? 0.0 : broken, 0.0,
                   text("smallest eigenvalue", Vec::Constant(1, lowest))});

  const Vec v = test_velocity(system.v0());
  const Vec rest = forces_at(system, t0, q, Vec::Zero(q.size()));
  const Vec even = 0.5 * (forces_at(system, t0, q, v) + forces_at(system, t0, q, -v)) - rest;
  items.push_back({who, "velocity-dependent forces against mass", deviation(even, gyroscopic(system, q, v)),
                   difference_tolerance, "part of h that is even in v"});
  if (std::isnan(system.potential_energy(view(q)))) return;
  const Matrix slope =
      gradient([&](const Vec& x) { return Vec(Vec::Constant(1, system.potential_energy(view(x)))); }, q);
  items.push_back({who, "forces against potential_energy", deviation(rest, -slope.transpose()),
                   difference_tolerance, "h at v = 0"});
}

void check_interaction(const Relation& relation, int gaps, const Vec& q, const Vec& v, const std::string& who,
                       std::vector<CheckItem>& items) {
  const Matrix J = jacobian_at(relation, q);
  const Matrix expected = gradient([&](const Vec& x) { return gap_at(relation, gaps, x); }, q);
  const Vec velocity = J * v;
  items.push_back({who, "jacobian against gap", deviation(J.topRows(gaps), expected), difference_tolerance,
                   text("gap at t0 [m]:", gap_at(relation, gaps, q)) + text(", velocity [m/s]:", velocity)});
  if (!J.allFinite()) items.push_back({who, "jacobian finite", broken, 0.0, ""});
  if (!relation.has_curvature()) return;
  const Vec w = test_velocity(v);
  const double eps = difference_step;
  const Vec rate = (jacobian_at(relation, q + eps * w) - jacobian_at(relation, q - eps * w)) * w / (2 * eps);
  Vec c = Vec::Zero(relation.size());
  relation.curvature(view(q), view(w), {c.data(), c.size()});
  items.push_back({who, "curvature against jacobian", deviation(c, rate), difference_tolerance, ""});
}

}  // namespace

std::vector<CheckItem> check(const NonSmoothDynamicalSystem& model) {
  std::vector<CheckItem> items;
  for (std::size_t k = 0; k < model.systems().size(); ++k)
    check_system(*model.systems()[k], model.t0(), "system " + std::to_string(k), items);
  for (const auto& link : model.links()) {
    const LagrangianDS& first = *model.systems()[link.first];
    Vec q = first.q0(), v = first.v0();
    if (link.second >= 0) {
      const LagrangianDS& second = *model.systems()[link.second];
      q.conservativeResize(q.size() + second.dimension());
      v.conservativeResize(q.size());
      q.tail(second.dimension()) = second.q0();
      v.tail(second.dimension()) = second.v0();
    }
    check_interaction(link.interaction->relation(), link.interaction->law().gaps, q, v, link.name, items);
  }
  return items;
}

}  // namespace saltus
