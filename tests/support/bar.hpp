#pragma once
// An elastic bar that flies against a wall: dense or sparse, for models of any size.
#include "saltus/kernel/model/lagrangian_linear_tids.hpp"
#include "saltus/kernel/model/nonsmooth_dynamical_system.hpp"

namespace saltus::test {

/// A bar of linear elements, free at both ends, with the consistent mass matrix ρSl/6·[2 1; 1 2] and the
/// stiffness ES/l·[1 −1; −1 1] of each; steel, 1 m long.
struct Bar {
  static constexpr double E = 210e9, S = 1e-4, rho = 7800.0, length = 1.0;  // [Pa], [m²], [kg/m³], [m]
  static constexpr double speed = 0.1;                                      // [m/s]

  int elements;
  double gap = 5.0005e-5;  // [m]
  int nodes() const { return elements + 1; }
  /// Highest frequency: that of the shape 1, −1, 1, −1... [rad/s]
  double omega() const;
  Eigen::SparseMatrix<double> mass() const;
  Eigen::SparseMatrix<double> stiffness() const;
  /// Moving with −speed towards a wall at the first node, in contact law e = 0.
  /// @param damping  C = damping · K [s]
  NonSmoothDynamicalSystem model(bool sparse, double damping = 0.0) const;
};

}  // namespace saltus::test
