#include "saltus/kernel/model/lagrangian_linear_tids.hpp"

#include <stdexcept>
#include <string>

#include "saltus/kernel/model/requirements.hpp"

namespace saltus {
LagrangianLinearTIDS::LagrangianLinearTIDS(Vec q0, Vec v0, Matrix mass, Terms terms)
    : LagrangianDS(std::move(q0), std::move(v0)), mass_(std::move(mass)), terms_(std::move(terms)) {
  const int n = dimension();
  require_mass(mass_, n, "mass");
  if (terms_.stiffness) require_square(*terms_.stiffness, n, "stiffness");
  if (terms_.damping) require_square(*terms_.damping, n, "damping");
  if (!terms_.external_force) return;
  if (terms_.external_force->size() != n)
    throw std::invalid_argument("external_force must have " + std::to_string(n) + " entries as q0 has, got " +
                                std::to_string(terms_.external_force->size()));
  if (!terms_.external_force->allFinite())
    throw std::invalid_argument("external_force must be finite, got NaN or infinity");
}

void LagrangianLinearTIDS::mass(const In&, OutMatrix M) const { M = mass_; }

void LagrangianLinearTIDS::forces(double, const In& q, const In& v, Out h) const {
  if (terms_.external_force) h = *terms_.external_force;
  if (terms_.stiffness) h.noalias() -= *terms_.stiffness * q;
  if (terms_.damping) h.noalias() -= *terms_.damping * v;
}

bool LagrangianLinearTIDS::force_jacobians(double, const In&, const In&, OutMatrix dh_dq,
                                           OutMatrix dh_dv) const {
  if (terms_.stiffness) dh_dq = -*terms_.stiffness;
  if (terms_.damping) dh_dv = -*terms_.damping;
  return true;
}

double LagrangianLinearTIDS::potential_energy(const In& q) const {
  double energy = 0.0;
  if (terms_.external_force) energy -= terms_.external_force->dot(q);
  if (terms_.stiffness) energy += 0.5 * q.dot(*terms_.stiffness * q);
  return energy;
}

}  // namespace saltus
