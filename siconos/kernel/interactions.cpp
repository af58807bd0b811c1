#include "saltus/siconos/kernel/interactions.hpp"

#include <algorithm>
#include <stdexcept>

namespace saltus::siconos::kernel {
namespace {

std::logic_error undefined(const char* method) {
  return std::logic_error(std::string("a relation must define ") + method + " or have a plugin, got neither");
}

// Asks the program's relation; a contact's gap is the first entry of y. What is written is copied, so that
// the program can make it anew.
class LiveRelation final : public saltus::Relation {
 public:
  LiveRelation(kernel::LagrangianScleronomousR& relation, unsigned rows)
      : Relation(static_cast<int>(rows)), relation_(relation), q_(0), z_(1), y_(rows) {}

  void gap(const In& q, Out g) const override {
    q_.values() = q;
    relation_.computeh(q_, z_, y_);
    g = y_.values().head(g.size());
  }

  void jacobian(const In& q, OutMatrix J) const override {
    q_.values() = q;
    relation_.computeJachq(q_, z_);
    J = relation_.jachq()->values();
  }

 private:
  kernel::LagrangianScleronomousR& relation_;
  mutable SiconosVector q_, z_, y_;
};

class LiveRheonomousRelation final : public saltus::RheonomousRelation {
 public:
  LiveRheonomousRelation(kernel::LagrangianRheonomousR& relation, unsigned rows)
      : RheonomousRelation(static_cast<int>(rows)), relation_(relation), q_(0), z_(1), y_(rows) {}

  void gap_at(double t, const In& q, Out g) const override {
    q_.values() = q;
    relation_.computeh(t, q_, z_, y_);
    g = y_.values().head(g.size());
  }

  void jacobian_at(double t, const In& q, OutMatrix J) const override {
    q_.values() = q;
    relation_.computeJachq(t, q_, z_);
    J = relation_.jachq()->values();
  }

  void motion_at(double t, const In& q, Out w) const override {
    q_.values() = q;
    relation_.computehDot(t, q_, z_);
    w = relation_.hDot()->values();
  }

 private:
  kernel::LagrangianRheonomousR& relation_;
  mutable SiconosVector q_, z_, y_;
};

}  // namespace

void Relation::resize(unsigned rows, unsigned freedoms) {
  if (!_jachq) _jachq = std::make_shared<SimpleMatrix>(rows, freedoms);
  if (_jachq->size(0) != rows || _jachq->size(1) != freedoms)
    throw std::invalid_argument("H must be (" + std::to_string(rows) + ", " + std::to_string(freedoms) +
                                "), got (" + std::to_string(_jachq->size(0)) + ", " +
                                std::to_string(_jachq->size(1)) + ")");
}

std::shared_ptr<const saltus::Relation> LagrangianLinearTIR::native(unsigned) {
  if (!b_) return std::make_shared<saltus::LagrangianLinearTIR>(Matrix(_jachq->values()));
  return std::make_shared<saltus::LagrangianLinearTIR>(Matrix(_jachq->values()), b_->values());
}

void LagrangianScleronomousR::computeh(const BlockVector& q, BlockVector& z, SiconosVector& y) {
  if (!h_) throw undefined("computeh(q, z, y)");
  h_.call(q.size(), q.values().data(), y.size(), y.getArray(), z.size(), z.getArray());
}

void LagrangianScleronomousR::computeJachq(const BlockVector& q, BlockVector& z) {
  if (!jacobian_) throw undefined("computeJachq(q, z)");
  jacobian_.call(q.size(), q.values().data(), _jachq->size(0), _jachq->getArray(), z.size(), z.getArray());
}

std::shared_ptr<const saltus::Relation> LagrangianScleronomousR::native(unsigned rows) {
  return std::make_shared<LiveRelation>(*this, rows);
}

void LagrangianRheonomousR::resize(unsigned rows, unsigned freedoms) {
  Relation::resize(rows, freedoms);
  if (!_hDot) _hDot = std::make_shared<SiconosVector>(rows);
}

void LagrangianRheonomousR::computeh(double time, const BlockVector& q, BlockVector& z, SiconosVector& y) {
  if (!h_) throw undefined("computeh(time, q, z, y)");
  h_.call(q.size(), q.values().data(), time, y.size(), y.getArray(), z.size(), z.getArray());
}

void LagrangianRheonomousR::computehDot(double time, const BlockVector& q, BlockVector& z) {
  if (!motion_) throw undefined("computehDot(time, q, z)");
  motion_.call(q.size(), q.values().data(), time, _hDot->size(), _hDot->getArray(), z.size(), z.getArray());
}

void LagrangianRheonomousR::computeJachq(double time, const BlockVector& q, BlockVector& z) {
  if (!jacobian_) throw undefined("computeJachq(time, q, z)");
  jacobian_.call(q.size(), q.values().data(), time, _jachq->size(0), _jachq->getArray(), z.size(),
                 z.getArray());
}

std::shared_ptr<const saltus::Relation> LagrangianRheonomousR::native(unsigned rows) {
  return std::make_shared<LiveRheonomousRelation>(*this, rows);
}

Interaction::Interaction(SP::NonSmoothLaw law, SP::Relation relation)
    : law_(law),
      relation_(relation),
      gaps_(std::make_shared<SiconosVector>(law->native().gaps)),
      velocities_(std::make_shared<SiconosVector>(law->size())),
      lambda_(std::make_shared<SiconosVector>(law->size())) {}

SP::SiconosVector Interaction::y(unsigned level) const {
  if (level > 1)
    throw std::invalid_argument("y(0), the gap, and y(1), the velocities, are there, got y(" +
                                std::to_string(level) + ")");
  return level == 0 ? gaps_ : velocities_;
}

SP::SiconosVector Interaction::lambda(unsigned level) const {
  if (level != 1)
    throw std::invalid_argument("lambda(1), the impulse, is there, got lambda(" + std::to_string(level) +
                                ")");
  return lambda_;
}

}  // namespace saltus::siconos::kernel
