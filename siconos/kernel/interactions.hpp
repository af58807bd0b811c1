#pragma once
// Relations, laws and interactions as C++ programs written for Siconos make them.
#include "saltus/kernel/model/interaction.hpp"
#include "saltus/siconos/kernel/systems.hpp"

namespace saltus::siconos::kernel {

/// A law of Saltus.
class NonSmoothLaw {
 public:
  unsigned size() const { return static_cast<unsigned>(native_.size()); }
  const saltus::NonSmoothLaw& native() const { return native_; }

 protected:
  explicit NonSmoothLaw(saltus::NonSmoothLaw law) : native_(std::move(law)) {}

 private:
  saltus::NonSmoothLaw native_;
};

/// Each throws std::invalid_argument if a value is outside its range.
class NewtonImpactNSL : public NonSmoothLaw {
 public:
  explicit NewtonImpactNSL(double e) : NonSmoothLaw(saltus::NewtonImpactNSL(e)) {}
};

class NewtonImpactFrictionNSL : public NonSmoothLaw {
 public:
  NewtonImpactFrictionNSL(double en, double et, double mu, unsigned dim)
      : NonSmoothLaw(saltus::NewtonImpactFrictionNSL(en, et, mu, static_cast<int>(dim))) {}
};

class EqualityConditionNSL : public NonSmoothLaw {
 public:
  explicit EqualityConditionNSL(unsigned n)
      : NonSmoothLaw(saltus::EqualityConditionNSL(static_cast<int>(n))) {}
};

/// What relations have in common: H (rows, n), which computeJachq() writes into _jachq.
class Relation {
 public:
  virtual ~Relation() = default;
  SP::SimpleMatrix jachq() const { return _jachq; }
  void setJachqPtr(SP::SimpleMatrix H) { _jachq = H; }
  /// Gives what is written the sizes that laws and systems ask for.
  virtual void resize(unsigned rows, unsigned freedoms);
  /// The relation of Saltus with that many rows, which asks this one.
  virtual std::shared_ptr<const saltus::Relation> native(unsigned rows) = 0;

 protected:
  SP::SimpleMatrix _jachq;
};

/// y = H q + b.
class LagrangianLinearTIR : public Relation {
 public:
  /// @param H  (rows, n)
  /// @param b  (rows), zero if left out
  explicit LagrangianLinearTIR(SP::SimpleMatrix H, SP::SiconosVector b = nullptr) : b_(b) { _jachq = H; }
  std::shared_ptr<const saltus::Relation> native(unsigned rows) override;

 private:
  SP::SiconosVector b_;
};

/// y = h(q), by overrides or by plugins.
class LagrangianScleronomousR : public Relation {
 public:
  LagrangianScleronomousR() = default;
  /// @param h, jacobian  "Plugin:function"
  LagrangianScleronomousR(const std::string& h, const std::string& jacobian) : h_(h), jacobian_(jacobian) {}
  /// @throws std::logic_error unless they are overridden, or plugins were given
  virtual void computeh(const BlockVector& q, BlockVector& z, SiconosVector& y);
  virtual void computeJachq(const BlockVector& q, BlockVector& z);
  std::shared_ptr<const saltus::Relation> native(unsigned rows) override;

 private:
  PluggedFunction<PluggedRelation::OfPosition> h_, jacobian_;
};

/// y = h(t, q); computehDot() writes ∂h/∂t into _hDot.
class LagrangianRheonomousR : public Relation {
 public:
  LagrangianRheonomousR() = default;
  /// @param h, jacobian, motion  "Plugin:function"
  LagrangianRheonomousR(const std::string& h, const std::string& jacobian, const std::string& motion)
      : h_(h), jacobian_(jacobian), motion_(motion) {}
  SP::SiconosVector hDot() const { return _hDot; }
  void resize(unsigned rows, unsigned freedoms) override;
  /// @throws std::logic_error unless they are overridden, or plugins were given
  virtual void computeh(double time, const BlockVector& q, BlockVector& z, SiconosVector& y);
  virtual void computehDot(double time, const BlockVector& q, BlockVector& z);
  virtual void computeJachq(double time, const BlockVector& q, BlockVector& z);
  std::shared_ptr<const saltus::Relation> native(unsigned rows) override;

 protected:
  SP::SiconosVector _hDot;

 private:
  PluggedFunction<PluggedRheonomousRelation::OfTimeAndPosition> h_, jacobian_, motion_;
};

namespace SP {
using NonSmoothLaw = std::shared_ptr<kernel::NonSmoothLaw>;
using Relation = std::shared_ptr<kernel::Relation>;
}  // namespace SP

/// A law that acts in a relation.
class Interaction {
 public:
  Interaction(SP::NonSmoothLaw law, SP::Relation relation);
  /// Now: y(0) gaps, one of a contact, all of an equality [m]; y(1) (rows) velocities [m/s].
  /// @throws std::invalid_argument for another level
  SP::SiconosVector y(unsigned level) const;
  /// (rows) the impulse of the last step, that of contact forces included [N s].
  /// @throws std::invalid_argument unless level is 1
  SP::SiconosVector lambda(unsigned level) const;
  unsigned dimension() const { return law_->size(); }
  SP::Relation relation() const { return relation_; }
  SP::NonSmoothLaw nonSmoothLaw() const { return law_; }

 private:
  SP::NonSmoothLaw law_;
  SP::Relation relation_;
  SP::SiconosVector gaps_, velocities_, lambda_;
};

namespace SP {
using Interaction = std::shared_ptr<kernel::Interaction>;
}  // namespace SP

}  // namespace saltus::siconos::kernel
