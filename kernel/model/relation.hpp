#pragma once
#include "saltus/numerics/pool.hpp"

namespace saltus {

/// Geometry of a contact or joint on the positions of one or two systems, q = [q1; q2]:
/// the gap g(q) and the force directions Wᵀ(q), (14)-(15). Holonomic and scleronomous.
class Relation {
 public:
  /// @param size  number of rows of Wᵀ: for a contact the normal one, then 0-2 tangential ones
  /// @throws std::invalid_argument if size < 1
  explicit Relation(int size);
  virtual ~Relation() = default;
  int size() const { return size_; }

  /// @throws std::invalid_argument if the relation cannot act on positions of this size
  virtual void require_dimension(int) const {}
  /// @param q        (n) positions of the linked systems
  /// @param[out] g   (1) [m] for a contact, (size) for an equality; starts as zero
  virtual void gap(const In& q, Out g) const = 0;
  /// @param[out] J   (size, n): γ = J v [m/s]; normal rows are the gradient of the gap; starts as zero
  virtual void jacobian(const In& q, OutMatrix J) const = 0;
  /// (dWᵀ/dt) v of (38), which only schemes on acceleration level need.
  /// @param[out] c   (size) [m/s²]; starts as zero
  /// @throws std::logic_error unless a derived class implements it
  virtual void curvature(const In& q, const In& v, Out c) const;
  /// Is curvature() implemented?
  virtual bool has_curvature() const { return false; }
  /// True if Wᵀ does not depend on q: implicit schemes then need not iterate for it.
  virtual bool constant_jacobian() const { return false; }

 private:
  int size_;
};

/// g = (H q + b)_N, Wᵀ = H.
class LagrangianLinearTIR final : public Relation {
 public:
  /// @param H  (size, n)
  /// @param b  (size) [m]
  /// @throws std::invalid_argument if shapes disagree or a value is not finite
  LagrangianLinearTIR(Matrix H, Vec b);
  explicit LagrangianLinearTIR(Matrix H);
  void require_dimension(int n) const override;
  void gap(const In& q, Out g) const override;
  void jacobian(const In& q, OutMatrix J) const override;
  void curvature(const In& q, const In& v, Out c) const override;
  bool has_curvature() const override { return true; }
  bool constant_jacobian() const override { return true; }

 private:
  struct Columns {
    Eigen::Index first, last;
  };
  Matrix H_;
  Vec b_;
  std::vector<Columns> columns_;  // of each row: beyond these it is zero
};

}  // namespace saltus
