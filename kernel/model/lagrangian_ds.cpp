#include "saltus/kernel/model/lagrangian_ds.hpp"

#include <limits>
#include <stdexcept>
#include <string>

namespace saltus {

LagrangianDS::LagrangianDS(Vec q0, Vec v0) : LagrangianDS(WithVelocityMap{}, std::move(q0), std::move(v0)) {
  if (v0_.size() != q0_.size())
    throw std::invalid_argument("v0 must have " + std::to_string(q0_.size()) + " entries as q0 has, got " +
                                std::to_string(v0_.size()));
}

LagrangianDS::LagrangianDS(WithVelocityMap, Vec q0, Vec v0) : q0_(std::move(q0)), v0_(std::move(v0)) {
  if (q0_.size() == 0) throw std::invalid_argument("q0 must have at least one entry, got none");
  if (v0_.size() == 0) throw std::invalid_argument("v0 must have at least one entry, got none");
  if (!q0_.allFinite()) throw std::invalid_argument("q0 must be finite, got NaN or infinity");
  if (!v0_.allFinite()) throw std::invalid_argument("v0 must be finite, got NaN or infinity");
}

void LagrangianDS::position_rate(const In&, const In& v, Out rate) const { rate = v; }

bool LagrangianDS::force_jacobians(double, const In&, const In&, OutMatrix, OutMatrix) const { return false; }

double LagrangianDS::potential_energy(const In&) const { return std::numeric_limits<double>::quiet_NaN(); }

}  // namespace saltus
