#pragma once
#include "saltus/numerics/pool.hpp"

namespace saltus {

/// Where a contact or joint is in space, for pictures.
struct ContactPlace {
  Vec3 point = Vec3::Zero();  ///< [m]
  /// Of these, `forces` in number: what λ of the first rows pushes the first system along. Without any the
  /// relation does not know where it is.
  Vec3 directions[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  int forces = 0;
};

/// Geometry of a contact or joint on the positions of one or two systems, q = [q1; q2]: the gap g(q) and the
/// force directions Wᵀ(q), (14)-(15), so that γ = Wᵀ v [m/s]. v has as many entries as there are freedoms, q
/// as there are coordinates. Holonomic and scleronomous; see RheonomousRelation.
class Relation {
 public:
  /// @param size  number of rows of Wᵀ: for a contact the normal one, then 0-2 tangential ones
  /// @throws std::invalid_argument if size < 1
  explicit Relation(int size);
  virtual ~Relation() = default;
  int size() const { return size_; }

  /// @throws std::invalid_argument if the relation cannot act on systems of these sizes
  virtual void require_dimensions(int coordinates, int freedoms) const;
  /// @param q0  (coordinates) initial positions of the linked systems
  /// @throws std::invalid_argument if the relation was made for others
  virtual void require_start(const In& q0) const;
  /// @param q        (coordinates) positions of the linked systems
  /// @param[out] g   (1) [m] for a contact, (size) for an equality; starts as zero
  virtual void gap(const In& q, Out g) const = 0;
  /// @param[out] J   (size, freedoms): γ = J v [m/s]; normal rows are ∂g/∂q Y; starts as zero
  virtual void jacobian(const In& q, OutMatrix J) const = 0;
  /// (dWᵀ/dt) v of (38), which only schemes on acceleration level need.
  /// @param[out] c   (size) [m/s²]; starts as zero
  /// @throws std::logic_error unless a derived class implements it
  virtual void curvature(const In& q, const In& v, Out c) const;
  /// Is curvature() implemented?
  virtual bool has_curvature() const { return false; }
  /// Where it is at these positions.
  virtual ContactPlace place(const In&) const { return {}; }
  /// True if Wᵀ depends neither on q nor on t: implicit schemes then need not iterate for it.
  virtual bool constant_jacobian() const { return false; }

  /// Does the geometry move by itself? Then γ = Wᵀ v + w.
  virtual bool rheonomous() const { return false; }
  /// What the simulation asks for: the functions above unless the geometry moves.
  virtual void gap_at(double, const In& q, Out g) const { gap(q, g); }
  virtual void jacobian_at(double, const In& q, OutMatrix J) const { jacobian(q, J); }
  virtual void curvature_at(double, const In& q, const In& v, Out c) const { curvature(q, v, c); }
  /// w(t, q) (size) [m/s], in normal rows ∂g/∂t; starts as zero.
  virtual void motion_at(double, const In&, Out) const {}

 private:
  int size_;
};

/// A relation that depends on the time as well: a moving wall, a belt, a driven joint. Derived classes
/// implement gap_at(), jacobian_at() and motion_at(), and for schemes on acceleration level
/// curvature_at(): γ̇ − Wᵀ v̇.
class RheonomousRelation : public Relation {
 public:
  using Relation::Relation;
  bool rheonomous() const final { return true; }
  void gap_at(double t, const In& q, Out g) const override = 0;
  void jacobian_at(double t, const In& q, OutMatrix J) const override = 0;
  void motion_at(double t, const In& q, Out w) const override = 0;
  void curvature_at(double t, const In& q, const In& v, Out c) const override;
  /// @throws std::logic_error: there is no gap without the time
  void gap(const In& q, Out g) const final;
  void jacobian(const In& q, OutMatrix J) const final;
};

/// g = (H q + b)_N, Wᵀ = H.
class LagrangianLinearTIR final : public Relation {
 public:
  /// @param H  (size, n)
  /// @param b  (size) [m]
  /// @throws std::invalid_argument if shapes disagree or a value is not finite
  LagrangianLinearTIR(Matrix H, Vec b);
  explicit LagrangianLinearTIR(Matrix H);
  void require_dimensions(int coordinates, int freedoms) const override;
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
