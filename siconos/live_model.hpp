#pragma once
// The model of a simulation of Siconos as one of Saltus.
#include <Interaction.hpp>
#include <LagrangianDS.hpp>
#include <vector>

#include "saltus/kernel/model/nonsmooth_dynamical_system.hpp"

namespace saltus::siconos {

/// A model whose every term asks the objects that it was made of: M, F and H are what they compute.
struct LiveModel {
  saltus::NonSmoothDynamicalSystem model;
  std::vector<SP::LagrangianDS> systems;      ///< in the order of model.systems()
  std::vector<SP::Interaction> interactions;  ///< in the order of model.links()
};

/// The Lagrangian systems, their relations and laws, as they are linked now:
///   LagrangianDS and all that derive from it: M(q) v̇ = F(t, q, v) + Hᵀ λ
///   LagrangianScleronomousR, LagrangianRheonomousR, LagrangianLinearTIR and what derives from these
///   NewtonImpactNSL, NewtonImpactFrictionNSL, EqualityConditionNSL
/// An evaluation leaves its position in q() of the systems, and its time and velocity where F needs them.
/// @param t0  where the model starts [s]
/// @throws std::invalid_argument naming what is something else
LiveModel adopt(::NonSmoothDynamicalSystem& nsds, double t0);

}  // namespace saltus::siconos
