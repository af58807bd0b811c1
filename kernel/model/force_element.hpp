#pragma once
#include <memory>
#include <string>

#include "saltus/kernel/model/force_law.hpp"
#include "saltus/kernel/model/relation.hpp"

namespace saltus {

/// A spring, damper or actuator between two systems, or between a system and the ground. The relation's gap
/// is its length (or angle) l(q), its Jacobian the gradient Wᵀ = ∂l/∂q; W f is part of the forces h.
class ForceElement {
 public:
  /// @param name  may be empty: the system then gives it one when it is added
  /// @throws std::invalid_argument if there is no relation, or it has more than one row
  ForceElement(std::shared_ptr<const Relation> relation, ForceLaw law, std::string name = "");
  const Relation& relation() const { return *relation_; }
  const ForceLaw& law() const { return law_; }
  const std::string& name() const { return name_; }
  /// Are ∂(W f)/∂q and ∂(W f)/∂v constant?
  bool time_invariant() const { return relation_->constant_jacobian() && law_.time_invariant(); }

 private:
  std::shared_ptr<const Relation> relation_;
  ForceLaw law_;
  std::string name_;
};

}  // namespace saltus
