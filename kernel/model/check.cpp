#include "saltus/kernel/model/check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "saltus/kernel/model/requirements.hpp"

namespace saltus {
namespace {

constexpr double relative_tolerance = 1e-6;  // far above the error of differences, far below any wrong term
constexpr double relative_step = 1e-5;       // of differences, for coordinates of size 1 and more
constexpr double eps = std::numeric_limits<double>::epsilon();
constexpr double broken = std::numeric_limits<double>::infinity();

In view(const Vec& x) { return {x.data(), x.size()}; }

Matrix mass_at(const LagrangianDS& system, const Vec& q) {
  Matrix M = Matrix::Zero(system.dimension(), system.dimension());
  system.mass(view(q), {M.data(), M.rows(), M.cols()});
  return M;
}

Vec forces_at(const LagrangianDS& system, double t, const Vec& q, const Vec& v) {
  Vec h = Vec::Zero(v.size());
  system.forces(t, view(q), view(v), {h.data(), h.size()});
  return h;
}

Vec gap_at(const Relation& relation, int gaps, double t, const Vec& q) {
  Vec g = Vec::Zero(gaps);
  relation.gap_at(t, view(q), {g.data(), g.size()});
  return g;
}

Matrix jacobian_at(const Relation& relation, Eigen::Index freedoms, double t, const Vec& q) {
  Matrix J = Matrix::Zero(relation.size(), freedoms);
  relation.jacobian_at(t, view(q), {J.data(), J.rows(), J.cols()});
  return J;
}

Vec motion_at(const Relation& relation, double t, const Vec& q) {
  Vec w = Vec::Zero(relation.size());
  relation.motion_at(t, view(q), {w.data(), w.size()});
  return w;
}

// q̇ = Y(q) v
Vec rate_at(const LagrangianDS& system, const Vec& q, const Vec& v) {
  if (!system.has_velocity_map()) return v;
  Vec rate = Vec::Zero(q.size());
  system.position_rate(view(q), view(v), {rate.data(), rate.size()});
  return rate;
}

// The one or two systems that something acts on, at the initial state
struct Place {
  const LagrangianDS& first;
  const LagrangianDS* second;
  double t0;
  Vec q, v;

  Place(const NonSmoothDynamicalSystem& model, const NonSmoothDynamicalSystem::Ends& ends)
      : first(*model.systems()[ends.first]),
        second(ends.second < 0 ? nullptr : model.systems()[ends.second].get()),
        t0(model.t0()),
        q(joined(first.q0(), second ? second->q0() : Vec())),
        v(joined(first.v0(), second ? second->v0() : Vec())) {}

  Vec rate(const Vec& at, const Vec& velocity) const {
    const Vec left = rate_at(first, at.head(first.coordinates()), velocity.head(first.dimension()));
    if (!second) return left;
    return joined(left, rate_at(*second, at.tail(second->coordinates()), velocity.tail(second->dimension())));
  }

 private:
  static Vec joined(const Vec& a, const Vec& b) {
    Vec both(a.size() + b.size());
    both << a, b;
    return both;
  }
};

// A derivative by central differences, and what it may be wrong by.
struct Difference {
  Matrix value;
  double error = 0.0;
};

// f along x + s·direction, with two steps: their difference tells the error of truncation, the size of f that
// of rounding.
template <class Function>
Difference slope(Function f, const Vec& x, const Vec& direction, double step) {
  auto central = [&](double s) { return Matrix((f(x + s * direction) - f(x - s * direction)) / (2 * s)); };
  const Matrix coarse = central(step), fine = central(step / 4);
  const double size = Matrix(f(x)).cwiseAbs().maxCoeff();
  return {fine, 2 * (fine - coarse).cwiseAbs().maxCoeff() + 16 * eps * size / step};
}

// Column j is the derivative of f along freedom j, in which q̇ = rate(unit vector).
template <class Function, class Rate>
Difference gradient(Function f, const Vec& q, Eigen::Index freedoms, Rate rate) {
  Difference all;
  for (Eigen::Index j = 0; j < freedoms; ++j) {
    const Vec direction = rate(Vec(Vec::Unit(freedoms, j)));
    const double step = relative_step * std::max(1.0, q.cwiseProduct(direction).cwiseAbs().maxCoeff());
    const Difference column = slope(f, q, direction, step);
    if (j == 0) all.value.resize(column.value.size(), freedoms);
    all.value.col(j) = column.value;
    all.error = std::max(all.error, column.error);
  }
  return all;
}

template <class Function>
Difference gradient(Function f, const LagrangianDS& system, const Vec& q) {
  return gradient(f, q, system.dimension(), [&](const Vec& v) { return rate_at(system, q, v); });
}

template <class Function>
Difference gradient(Function f, const Place& place) {
  return gradient(f, place.q, place.v.size(), [&](const Vec& v) { return place.rate(place.q, v); });
}

CheckItem compare(const std::string& subject, const std::string& quantity, const Matrix& got,
                  const Difference& expected, const std::string& note = "") {
  if (!got.allFinite() || !expected.value.allFinite()) return {subject, quantity, broken, 0.0, note, false};
  if (got.size() == 0) return {subject, quantity, 0.0, 0.0, note, false};
  const double size = std::max(got.cwiseAbs().maxCoeff(), expected.value.cwiseAbs().maxCoeff());
  return {subject,
          quantity,
          (got - expected.value).cwiseAbs().maxCoeff(),
          relative_tolerance * size + expected.error,
          note,
          false};
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
Difference gyroscopic(const LagrangianDS& system, const Vec& q, const Vec& v) {
  const double step = relative_step * std::max(1.0, q.cwiseAbs().maxCoeff()) / v.cwiseAbs().maxCoeff();
  const Difference rate = slope([&](const Vec& x) { return Vec(mass_at(system, x) * v); }, q, v, step);
  const Difference energy = gradient(
      [&](const Vec& x) { return Vec(Vec::Constant(1, 0.5 * v.dot(mass_at(system, x) * v))); }, system, q);
  return {energy.value.transpose() - rate.value, rate.error + energy.error};
}

// A velocity that moves every freedom, of the size of the initial one.
Vec test_velocity(const Vec& v0) {
  const double size = std::max(1.0, v0.cwiseAbs().maxCoeff());
  Vec v = v0;
  for (Eigen::Index i = 0; i < v.size(); ++i)
    if (v[i] == 0.0) v[i] = size * (0.3 + 0.1 * std::cos(1.0 + 2.0 * static_cast<double>(i)));
  return v / size;
}

// Forces against the potential along one direction: for a large system a gradient would take too long.
CheckItem check_potential_along(const LagrangianDS& system, double t0, const Vec& v, const std::string& who) {
  const Vec& q = system.q0();
  const double step = relative_step * std::max(1.0, q.cwiseAbs().maxCoeff());
  auto potential = [&](const Vec& x) { return Vec(Vec::Constant(1, -system.potential_energy(view(x)))); };
  const Vec power = Vec::Constant(1, forces_at(system, t0, q, Vec::Zero(v.size())).dot(v));
  CheckItem item = compare(who, "forces against potential_energy", power, slope(potential, q, v, step),
                           "power of h at v = 0 along one direction; forces without potential are no error");
  item.advisory = true;
  return item;
}

// The matrices were looked at when the system was made.
void check_sparse_system(const LagrangianDS& system, double t0, const std::string& who,
                         std::vector<CheckItem>& items) {
  const Vec v = test_velocity(system.v0());
  const bool finite = forces_at(system, t0, system.q0(), v).allFinite();
  items.push_back({who, "forces finite", finite ? 0.0 : broken, 0.0, "", false});
  if (!std::isnan(system.potential_energy(view(system.q0()))))
    items.push_back(check_potential_along(system, t0, v, who));
}

void check_system(const LagrangianDS& system, double t0, const std::string& who,
                  std::vector<CheckItem>& items) {
  const Vec& q = system.q0();
  const Matrix M = mass_at(system, q);
  items.push_back(compare(who, "mass symmetric", M, {M.transpose(), 0.0}));
  const double lowest = smallest_eigenvalue(M);
  items.push_back({who, "mass positive definite", lowest > 0.0 ? 0.0 : broken, 0.0,
                   text("smallest eigenvalue", Vec::Constant(1, lowest)), false});
  const Vec v = test_velocity(system.v0());
  const Vec rest = forces_at(system, t0, q, Vec::Zero(v.size()));
  const Vec ahead = forces_at(system, t0, q, v), back = forces_at(system, t0, q, -v);
  items.push_back(
      {who, "forces finite", ahead.allFinite() && back.allFinite() ? 0.0 : broken, 0.0, "", false});
  if (!system.constant_mass() &&
      !system.has_velocity_map()) {  // there the terms are those of Boltzmann, Hamel
    Difference demanded = gyroscopic(system, q, v);
    demanded.error += 16 * eps * std::max(ahead.cwiseAbs().maxCoeff(), rest.cwiseAbs().maxCoeff());
    items.push_back(compare(who, "velocity-dependent forces against mass", 0.5 * (ahead + back) - rest,
                            demanded, "part of h that is even in v"));
  }
  if (std::isnan(system.potential_energy(view(q)))) return;
  Difference potential = gradient(
      [&](const Vec& x) { return Vec(Vec::Constant(1, system.potential_energy(view(x)))); }, system, q);
  potential.value = -potential.value.transpose().eval();
  CheckItem item = compare(who, "forces against potential_energy", rest, potential,
                           "h at v = 0; forces without potential are no error");
  item.advisory = true;
  items.push_back(item);
}

// d/dt (Wᵀ v + w) at constant v, along q̇ = Y v
void check_curvature(const Relation& relation, const Place& place, const std::string& who,
                     std::vector<CheckItem>& items) {
  const Vec v = test_velocity(place.v);
  const double step = relative_step * std::max(1.0, place.q.cwiseAbs().maxCoeff());
  Vec c = Vec::Zero(relation.size());
  relation.curvature_at(place.t0, view(place.q), view(v), {c.data(), c.size()});
  Vec state(place.q.size() + 1), direction(place.q.size() + 1);
  state << place.q, place.t0;
  direction << place.rate(place.q, v), 1.0;
  const auto velocity = [&](const Vec& x) {
    const Vec q = x.head(place.q.size());
    const double t = x[place.q.size()];
    return Vec(jacobian_at(relation, v.size(), t, q) * v + motion_at(relation, t, q));
  };
  Difference expected = slope(velocity, state, direction, step);
  const Matrix J = jacobian_at(relation, v.size(), place.t0, place.q);
  expected.error += 16 * eps * (J.cwiseAbs() * v.cwiseAbs()).maxCoeff() / step;  // its terms may cancel
  items.push_back(compare(who, "curvature against jacobian", c, expected));
}

void check_interaction(const Relation& relation, const NonSmoothLaw& law, const Place& place,
                       const std::string& who, std::vector<CheckItem>& items) {
  const Vec &q = place.q, &v = place.v;
  const double t0 = place.t0;
  const Matrix J = jacobian_at(relation, v.size(), t0, q);
  const Vec g = gap_at(relation, law.gaps, t0, q), w = motion_at(relation, t0, q);
  const Vec velocity = J * v + w;
  items.push_back(compare(who, "jacobian against gap", J.topRows(law.gaps),
                          gradient([&](const Vec& x) { return gap_at(relation, law.gaps, t0, x); }, place),
                          text("gap at t0 [m]:", g) + text(", velocity [m/s]:", velocity)));
  items.push_back({who, "jacobian finite", J.allFinite() ? 0.0 : broken, 0.0, "", false});
  const Vec t = Vec::Constant(1, t0), ahead = Vec::Ones(1);
  const double instant = relative_step * std::max(1.0, std::abs(t0));
  if (relation.rheonomous())
    items.push_back(compare(
        who, "motion against gap", w.head(law.gaps),
        slope([&](const Vec& time) { return gap_at(relation, law.gaps, time[0], q); }, t, ahead, instant)));
  if (law.bilateral) {
    const double length = std::max(1.0, q.cwiseAbs().maxCoeff());
    const double speed = std::max(1.0, v.cwiseAbs().maxCoeff());
    items.push_back({who, "bilateral gap at t0", g.cwiseAbs().maxCoeff(), relative_tolerance * length,
                     text("gap [m]:", g), false});
    items.push_back({who, "bilateral velocity at t0", velocity.cwiseAbs().maxCoeff(),
                     relative_tolerance * speed, text("velocity [m/s]:", velocity), false});
  }
  if (relation.has_curvature()) check_curvature(relation, place, who, items);
}

void check_element(const ForceElement& element, const Place& place, const std::string& who,
                   std::vector<CheckItem>& items) {
  const Relation& relation = element.relation();
  const Matrix J = jacobian_at(relation, place.v.size(), place.t0, place.q);
  const double length = gap_at(relation, 1, place.t0, place.q)[0];
  const double rate = J.row(0).dot(place.v) + motion_at(relation, place.t0, place.q)[0];
  const double force = element.law().force(place.t0, length, rate);
  const std::string note =
      text("length at t0 [m]:", Vec::Constant(1, length)) + text(", force [N]:", Vec::Constant(1, force));
  items.push_back(compare(who, "jacobian against length", J,
                          gradient([&](const Vec& x) { return gap_at(relation, 1, place.t0, x); }, place),
                          note));
  items.push_back({who, "force finite", std::isfinite(force) ? 0.0 : broken, 0.0, "", false});
}

}  // namespace

std::vector<CheckItem> check(const NonSmoothDynamicalSystem& model) {
  std::vector<CheckItem> items;
  for (std::size_t k = 0; k < model.systems().size(); ++k)
    (model.systems()[k]->sparse_terms() ? check_sparse_system : check_system)(
        *model.systems()[k], model.t0(), "system " + std::to_string(k), items);
  for (const auto& link : model.links())
    check_interaction(link.interaction->relation(), link.interaction->law(), Place(model, link), link.name,
                      items);
  for (const auto& force : model.forces())
    check_element(*force.element, Place(model, force), force.name, items);
  return items;
}

}  // namespace saltus
