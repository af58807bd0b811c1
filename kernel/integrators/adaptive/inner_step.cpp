#include "saltus/kernel/integrators/adaptive/inner_step.hpp"

#include <cmath>

#include "saltus/numerics/pool.hpp"

namespace saltus {
namespace {

constexpr double rounding = 1e-9;  // of friction that slides

}  // namespace

void InnerStep::reserve(const Layout& layout) {
  for (Vec* x : {&q0, &rate0, &q1, &rate1}) x->setZero(layout.coordinates);
  for (Vec* x : {&v0, &v1, &mean_v}) x->setZero(layout.n);
  for (Vec& x : lambda) x.setZero(layout.rows);
}

void InnerStep::motion_at(double time, Vec& q, Vec& v) const {
  const double s = (time - t) / dt, r = 1.0 - s;
  q = q0;
  for (Eigen::Index i = 0; i < q.size(); ++i)
    q[i] += s * s * (3.0 - 2.0 * s) * (q1[i] - q0[i]) + dt * s * r * (r * rate0[i] - s * rate1[i]);
  v = v0;
  for (Eigen::Index i = 0; i < v.size(); ++i)
    v[i] = r * (1.0 - 3.0 * s) * v0[i] + s * (3.0 * s - 2.0) * v1[i] + 6.0 * s * r * mean_v[i];
}

void InnerStep::keep_laws(const Layout& layout) {
  const auto at = [&](double part, int row) {
    const double along = (part - place[0]) / (place[1] - place[0]);
    return (1.0 - along) * lambda[0][row] + along * lambda[1][row];
  };
  for (const auto& contact : layout.contacts) {
    if (contact.law->bilateral) continue;
    const auto* law = std::get_if<Coulomb>(&contact.law->sets[0]);
    const auto keeps = [&](double part) {
      const double normal = at(part, contact.row);
      if (!law) return normal >= 0.0;
      const double tangential =
          std::hypot(at(part, contact.row + 1), law->dim == 3 ? at(part, contact.row + 2) : 0.0);
      return tangential <= law->mu * normal * (1.0 + rounding);
    };
    if (keeps(0.0) && keeps(1.0)) continue;
    for (int row = contact.row; row < contact.row + contact.rows; ++row)
      lambda[0][row] = lambda[1][row] = at(0.5, row);
  }
}

void InnerStep::lambda_at(double time, Vec& all) const {
  const double along = ((time - t) / dt - place[0]) / (place[1] - place[0]);
  all = lambda[0];
  all *= 1.0 - along;
  add_scaled(along, lambda[1], all);
}

// A straight line's mean is its value in the middle.
void InnerStep::add_impulse(double from, double to, Vec& sum) const {
  const double middle = (0.5 * (from + to) - t) / dt;
  const double along = (middle - place[0]) / (place[1] - place[0]);
  add_scaled((to - from) * (1.0 - along), lambda[0], sum);
  add_scaled((to - from) * along, lambda[1], sum);
}

double InnerStep::work_forces(double from, double to) const {
  return work(power_forces, from, to) + inertia_work * ((to - from) / dt);
}

double InnerStep::work_lambda(double from, double to) const { return work(power_lambda, from, to); }

// Of the parabola through the three powers, by Simpson's rule, which is exact for it
double InnerStep::work(const double (&power)[3], double from, double to) const {
  const auto at = [&](double time) {
    const double s = (time - t) / dt;
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
      double weight = 1.0;
      for (int j = 0; j < 3; ++j)
        if (j != i) weight *= (s - power_place[j]) / (power_place[i] - power_place[j]);
      sum += weight * power[i];
    }
    return sum;
  };
  return (to - from) / 6.0 * (at(from) + 4.0 * at(0.5 * (from + to)) + at(to));
}

}  // namespace saltus
