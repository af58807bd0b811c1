#include "saltus/kernel/model/driven.hpp"

#include <stdexcept>

namespace saltus {
namespace {

const Relation& require_relation(const std::shared_ptr<const Relation>& relation) {
  if (!relation) throw std::invalid_argument("a driven relation needs a relation, got none");
  if (relation->rheonomous())
    throw std::invalid_argument("a driven relation needs one that does not depend on the time itself");
  return *relation;
}

}  // namespace

Driven::Driven(std::shared_ptr<const Relation> relation, Function motion)
    : RheonomousRelation(require_relation(relation).size()),
      relation_(std::move(relation)),
      motion_(std::move(motion)) {
  if (!motion_) throw std::invalid_argument("a driven relation needs a motion, got none");
}

void Driven::require_dimensions(int coordinates, int freedoms) const {
  relation_->require_dimensions(coordinates, freedoms);
}

void Driven::gap_at(double t, const In& q, Out g) const {
  relation_->gap(q, g);
  g[0] -= motion_(t).position;
}

void Driven::motion_at(double t, const In&, Out w) const { w[0] = -motion_(t).velocity; }

void Driven::curvature_at(double t, const In& q, const In& v, Out c) const {
  relation_->curvature(q, v, c);
  c[0] -= motion_(t).acceleration;
}

}  // namespace saltus
