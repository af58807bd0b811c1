#pragma once
// The elastic bar of Section 6.1 in C++. elastic_bar.py explains it.
#include <numbers>

#include "saltus/kernel/model/nonsmooth_dynamical_system.hpp"

namespace saltus::examples {

/// Table 5, with its Young modulus in N/m², and the gap from which the bar starts.
struct ElasticBarParameters {
  double length = 1.0;                       ///< L [m]
  double section = 1e-4 * std::numbers::pi;  ///< S [m²]
  double density = 7800.0;                   ///< ρ [kg/m³]
  double modulus = 2.1e11;                   ///< E [N/m²]
  double speed = 0.1;                        ///< v0 [m/s]
  double gap = 5.0005e-5;                    ///< between the bar and the obstacle at the start [m]

  /// ρSl of one of so many elements [kg]
  double element_mass(int elements) const { return density * section * length / elements; }
  /// ES/l of one of so many elements [N/m]
  double element_stiffness(int elements) const { return modulus * section * elements / length; }
};

/// The whole model, q (elements + 1) the displacements of the nodes [m]; contact "obstacle" at the first one.
/// @param elements  N > 0
/// @param damping  δ >= 0 of C = δK [s]
/// @throws std::invalid_argument if one of them is something else
NonSmoothDynamicalSystem make_elastic_bar(int elements, double damping = 0.0,
                                          const ElasticBarParameters& parameters = {});

}  // namespace saltus::examples
