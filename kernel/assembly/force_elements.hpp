#pragma once
#include "saltus/kernel/assembly/layout.hpp"

namespace saltus {

/// A force element at one state of the systems that it acts on.
struct Stretch {
  In q, v;              ///< (coordinates), (n) of these systems
  double length, rate;  ///< l [m], l̇ = Wᵀv + ∂l/∂t [m/s]
  double* W;            ///< (n) ∂l/∂q
};

/// @param q, v     (coordinates), (n) of all systems
/// @param storage  (3 times the largest_force of the layout), which the result refers to
Stretch stretch(const Layout& layout, const Layout::Force& force, double t, const Vec& q, const Vec& v,
                double* storage);

/// h <- h + W f of all force elements. @param[in,out] h (n)
void add_element_forces(const Layout& layout, double t, const Vec& q, const Vec& v, Vec& h);

/// Potential energy of all force elements [J]
double element_energy(const Layout& layout, double t, const Vec& q);

}  // namespace saltus
