#pragma once
#include "saltus/kernel/model/relation.hpp"

namespace saltus {

/// Distance of two points that depend linearly on q, or of one and the ground: g = |H q + b| − length.
/// The length of a spring, a rod if it is an equality, the contact of two discs or spheres.
/// Where the points meet, its gradient is not defined and comes out as NaN.
class Distance final : public Relation {
 public:
  /// @param H       (1 to 3, n): H q + b leads from one point to the other
  /// @param b       (rows of H) [m]
  /// @param length  of a rod, or the sum of the radii [m]
  /// @throws std::invalid_argument if shapes disagree or a value is not finite
  Distance(Matrix H, Vec b, double length = 0.0);
  void require_dimensions(int coordinates, int freedoms) const override;
  void gap(const In& q, Out g) const override;
  void jacobian(const In& q, OutMatrix J) const override;
  /// (|H v|² − ġ²) / |H q + b|
  void curvature(const In& q, const In& v, Out c) const override;
  bool has_curvature() const override { return true; }

 private:
  Matrix H_;
  Vec b_;
  double length_;
};

}  // namespace saltus
