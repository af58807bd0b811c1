#include "saltus/kernel/model/function_models.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "saltus/kernel/model/requirements.hpp"

namespace saltus {

FunctionDS::FunctionDS(Incomplete, Vec q0, Vec v0, Functions functions, Vec parameters)
    : LagrangianDS(WithVelocityMap{}, std::move(q0), std::move(v0)),
      functions_(std::move(functions)),
      arguments_(std::move(parameters)) {
  if (functions_.constant_mass) require_mass(*functions_.constant_mass, dimension(), "mass");
  if (functions_.mass && functions_.constant_mass)
    throw std::invalid_argument("mass must be a function or constant, got both");
}

FunctionDS::FunctionDS(Vec q0, Vec v0, Functions functions, Vec parameters)
    : FunctionDS(Incomplete{}, std::move(q0), std::move(v0), std::move(functions), std::move(parameters)) {
  if (coordinates() != dimension())
    throw std::invalid_argument("v0 must have " + std::to_string(coordinates()) + " entries as q0 has, got " +
                                std::to_string(dimension()));
  if (!functions_.forces) throw std::invalid_argument("forces must be a function, got none");
  if (!functions_.mass && !functions_.constant_mass)
    throw std::invalid_argument("mass must be a function or constant, got none");
}

void FunctionDS::mass(const In& q, OutMatrix M) const {
  if (functions_.constant_mass)
    M = *functions_.constant_mass;
  else
    arguments_.call(functions_.mass, q, M.data());
}

void FunctionDS::forces(double t, const In& q, const In& v, Out h) const {
  arguments_.call(functions_.forces, t, q, v, h.data());
}

bool FunctionDS::force_jacobians(double t, const In& q, const In& v, OutMatrix dh_dq, OutMatrix dh_dv) const {
  if (!functions_.force_jacobians) return false;
  thread_local std::vector<double> both;  // a model may be shared by simulations in several threads
  both.assign(2 * dh_dq.size(), 0.0);
  arguments_.call(functions_.force_jacobians, t, q, v, both.data());
  std::copy_n(both.data(), dh_dq.size(), dh_dq.data());
  std::copy_n(both.data() + dh_dq.size(), dh_dv.size(), dh_dv.data());
  return true;
}

double FunctionDS::potential_energy(const In& q) const {
  if (!functions_.potential_energy) return LagrangianDS::potential_energy(q);
  double energy = 0.0;
  arguments_.call(functions_.potential_energy, q, &energy);
  return energy;
}

FunctionRelation::FunctionRelation(Incomplete, int size, Functions functions, Vec parameters)
    : Relation(size), functions_(std::move(functions)), arguments_(std::move(parameters)) {}

FunctionRelation::FunctionRelation(int size, Functions functions, Vec parameters)
    : FunctionRelation(Incomplete{}, size, std::move(functions), std::move(parameters)) {
  if (!functions_.gap) throw std::invalid_argument("gap must be a function, got none");
  if (!functions_.jacobian) throw std::invalid_argument("jacobian must be a function, got none");
}

void FunctionRelation::require_dimensions(int coordinates, int freedoms) const {
  const bool functions = functions_.gap || functions_.jacobian || functions_.curvature;
  if (functions && coordinates != freedoms)
    throw std::invalid_argument(
        "compiled and C functions of a relation take systems with as many coordinates "
        "as freedoms, got " +
        std::to_string(coordinates) + " and " + std::to_string(freedoms));
}

void FunctionRelation::gap(const In& q, Out g) const { arguments_.call(functions_.gap, q, g.data()); }

void FunctionRelation::jacobian(const In& q, OutMatrix J) const {
  arguments_.call(functions_.jacobian, q, J.data());
}

void FunctionRelation::curvature(const In& q, const In& v, Out c) const {
  if (!functions_.curvature) return Relation::curvature(q, v, c);
  arguments_.call(functions_.curvature, q, v, c.data());
}

}  // namespace saltus
