#pragma once
#include <functional>
#include <memory>

#include "saltus/kernel/model/relation.hpp"

namespace saltus {

/// A given motion, with its derivatives.
struct Motion {
  double position, velocity, acceleration;  ///< [m or rad], [m/s], [m/s²]
};

/// A relation whose first gap is driven, g = g_r(q) − p(t): a freedom that follows p if g_r is linear in q, a
/// rod that changes its length, a floor that moves along its normal. As an equality it makes the freedom move
/// so, and its force is what that takes.
class Driven final : public RheonomousRelation {
 public:
  using Function = std::function<Motion(double t)>;
  /// @param relation  g_r, which does not depend on the time itself
  /// @param motion    p(t), ṗ(t), p̈(t); the last is for schemes on acceleration level
  /// @throws std::invalid_argument if one of them is missing, or the relation depends on the time
  Driven(std::shared_ptr<const Relation> relation, Function motion);

  void require_dimensions(int coordinates, int freedoms) const override;
  void gap_at(double t, const In& q, Out g) const override;
  void jacobian_at(double, const In& q, OutMatrix J) const override { relation_->jacobian(q, J); }
  void motion_at(double t, const In& q, Out w) const override;
  void curvature_at(double t, const In& q, const In& v, Out c) const override;
  bool has_curvature() const override { return relation_->has_curvature(); }
  bool constant_jacobian() const override { return relation_->constant_jacobian(); }
  ContactPlace place(const In& q) const override { return relation_->place(q); }

 private:
  std::shared_ptr<const Relation> relation_;
  Function motion_;
};

}  // namespace saltus
