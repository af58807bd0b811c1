#pragma once
// One beam element of the axle: what generate_element.py derives and writes into axle_element.cpp.

namespace saltus::examples {

/// Constants of an element.
struct AxleElement {
  double l;       ///< length [m]
  double rho_A;   ///< ρA, mass of a length [kg/m]
  double rho_Ip;  ///< ρI_p, its inertia about the axis [kg m]
  double EI;      ///< E I_b, against bending [N m²]
  double GIp;     ///< G I_p, against torsion [N m²]
  double weight;  ///< ρAγ, its weight [N/m]
  double d1;      ///< damping forces d1 M v [1/s]
  double d2;      ///< torsional damping [kg m²/s]

  static constexpr int freedoms = 10;  ///< α, w, w', u, u' of the first node, then of the second
};

/// @param[out] M  (10, 10) row by row
void element_mass(const AxleElement& e, const double* q, double* M);
/// h = −(Ṁ v − ∂T/∂q) − ∂V/∂q − ∂D/∂v. @param[out] h (10) [N, N m]
void element_forces(const AxleElement& e, const double* q, const double* v, double* h);
/// V, gravity included [J]
double element_potential(const AxleElement& e, const double* q);
/// ∂h/∂q and ∂h/∂v. @param[out] dh_dq, dh_dv (10, 10) row by row
void element_force_jacobians(const AxleElement& e, const double* q, const double* v, double* dh_dq,
                             double* dh_dv);

}  // namespace saltus::examples
