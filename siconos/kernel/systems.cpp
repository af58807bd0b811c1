#include "saltus/siconos/kernel/systems.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace saltus::siconos::kernel {
namespace {

void require_length(const SiconosVector* vector, unsigned n, const char* what) {
  if (vector && vector->size() != n)
    throw std::invalid_argument(std::string(what) + " must have " + std::to_string(n) + " entries, got " +
                                std::to_string(vector->size()));
}

void require_square(const SiconosMatrix* matrix, unsigned n, const char* what) {
  if (matrix && (matrix->size(0) != n || matrix->size(1) != n))
    throw std::invalid_argument(std::string(what) + " must be (" + std::to_string(n) + ", " +
                                std::to_string(n) + "), got (" + std::to_string(matrix->size(0)) + ", " +
                                std::to_string(matrix->size(1)) + ")");
}

// Asks the program's object, which sees position and velocity as its own
class LiveDS : public saltus::LagrangianDS {
 public:
  explicit LiveDS(kernel::LagrangianDS& ds)
      : LagrangianDS(ds.q0()->values(), ds.velocity0()->values()),
        ds_(ds),
        by_q_(dimension(), dimension()),
        by_v_(dimension(), dimension()) {}

  void mass(const In& q, OutMatrix M) const override {
    ds_.q()->values() = q;
    ds_.computeMass(ds_.q());
    M = ds_.mass()->values();
  }

  void forces(double t, const In& q, const In& v, Out h) const override {
    ds_.q()->values() = q;
    ds_.velocity()->values() = v;
    ds_.computeFExt(t);
    ds_.computeFInt(t, ds_.q(), ds_.velocity());
    ds_.computeFGyr(ds_.q(), ds_.velocity());
    if (ds_.fExt()) h += ds_.fExt()->values();
    if (ds_.fInt()) h -= ds_.fInt()->values();
    if (ds_.fGyr()) h -= ds_.fGyr()->values();
  }

  bool force_jacobians(double t, const In& q, const In& v, OutMatrix dh_dq, OutMatrix dh_dv) const override {
    ds_.q()->values() = q;
    ds_.velocity()->values() = v;
    if (!ds_.computeJacobians(t, by_q_, by_v_)) return false;
    dh_dq = -by_q_;
    dh_dv = -by_v_;
    return true;
  }

 private:
  kernel::LagrangianDS& ds_;
  mutable Eigen::MatrixXd by_q_, by_v_;
};

// Its matrices are constant; an external force may be computed.
class LiveLinearDS final : public LiveDS {
 public:
  explicit LiveLinearDS(kernel::LagrangianLinearTIDS& ds) : LiveDS(ds), K_(ds.K()), C_(ds.C()) {}
  bool constant_mass() const override { return true; }
  bool time_invariant() const override { return true; }

  void forces(double t, const In& q, const In& v, Out h) const override {
    LiveDS::forces(t, q, v, h);
    if (K_) h.noalias() -= K_->values() * q;
    if (C_) h.noalias() -= C_->values() * v;
  }

  bool force_jacobians(double, const In&, const In&, OutMatrix dh_dq, OutMatrix dh_dv) const override {
    if (K_) dh_dq = -K_->values();
    if (C_) dh_dv = -C_->values();
    return true;
  }

 private:
  SP::SiconosMatrix K_, C_;
};

SP::SiconosVector zeros(unsigned n) { return std::make_shared<SiconosVector>(n); }

}  // namespace

LagrangianDS::LagrangianDS(SP::SiconosVector q0, SP::SiconosVector v0, SP::SiconosMatrix mass)
    : _mass(mass),
      q0_(std::make_shared<SiconosVector>(*q0)),
      velocity0_(std::make_shared<SiconosVector>(*v0)),
      q_(std::make_shared<SiconosVector>(*q0)),
      velocity_(std::make_shared<SiconosVector>(*v0)),
      p_(zeros(q0->size())),
      z_(zeros(1)) {
  require_length(v0.get(), dimension(), "v0");
  if (_mass) return;
  _mass = std::make_shared<SimpleMatrix>(dimension(), dimension());
  _mass->eye();
}

LagrangianDS::LagrangianDS(SP::SiconosVector q0, SP::SiconosVector v0, const std::string& mass)
    : LagrangianDS(q0, v0) {
  mass_function_ = mass;
}

SP::SiconosVector LagrangianDS::p(unsigned level) const {
  if (level != 1)
    throw std::invalid_argument("p(1), the impulse, is there, got p(" + std::to_string(level) + ")");
  return p_;
}

void LagrangianDS::setComputeMassFunction(const std::string& library, const std::string& function) {
  mass_function_ = library + ":" + function;
}

void LagrangianDS::setComputeFIntFunction(const std::string& library, const std::string& function) {
  internal_function_ = library + ":" + function;
  _fInt = zeros(dimension());
}

void LagrangianDS::setComputeFGyrFunction(const std::string& library, const std::string& function) {
  gyroscopic_function_ = library + ":" + function;
  _fGyr = zeros(dimension());
}

void LagrangianDS::setComputeFExtFunction(const std::string& library, const std::string& function) {
  external_function_ = library + ":" + function;
  _fExt = zeros(dimension());
}

void LagrangianDS::setComputeJacobianFIntqFunction(const std::string& library, const std::string& function) {
  internal_dq_ = library + ":" + function;
}

void LagrangianDS::setComputeJacobianFIntqDotFunction(const std::string& library,
                                                      const std::string& function) {
  internal_dv_ = library + ":" + function;
}

void LagrangianDS::setComputeJacobianFGyrqFunction(const std::string& library, const std::string& function) {
  gyroscopic_dq_ = library + ":" + function;
}

void LagrangianDS::setComputeJacobianFGyrqDotFunction(const std::string& library,
                                                      const std::string& function) {
  gyroscopic_dv_ = library + ":" + function;
}

bool LagrangianDS::computeJacobians(double time, Eigen::MatrixXd& by_q, Eigen::MatrixXd& by_v) const {
  const bool internal = internal_dq_ && internal_dv_, gyroscopic = gyroscopic_dq_ && gyroscopic_dv_;
  if ((_fInt && !internal) || (_fGyr && !gyroscopic)) return false;
  by_q.setZero();
  by_v.setZero();
  thread_local std::vector<double> one;
  const unsigned n = dimension();
  const auto add = [&](const auto& function, Eigen::MatrixXd& to, auto... time_or_none) {
    one.assign(to.size(), 0.0);
    function.call(time_or_none..., n, q_->getArray(), velocity_->getArray(), one.data(), z_->size(),
                  z_->getArray());
    to += Eigen::Map<const Eigen::MatrixXd>(one.data(), n, n);
  };
  if (_fInt) {
    add(internal_dq_, by_q, time);
    add(internal_dv_, by_v, time);
  }
  if (_fGyr) {
    add(gyroscopic_dq_, by_q);
    add(gyroscopic_dv_, by_v);
  }
  return true;
}

void LagrangianDS::computeMass(SP::SiconosVector position) {
  if (mass_function_)
    mass_function_.call(dimension(), position->getArray(), _mass->getArray(), z_->size(), z_->getArray());
}

void LagrangianDS::computeFInt(double time, SP::SiconosVector position, SP::SiconosVector velocity) {
  if (internal_function_)
    internal_function_.call(time, dimension(), position->getArray(), velocity->getArray(), _fInt->getArray(),
                            z_->size(), z_->getArray());
}

void LagrangianDS::computeFGyr(SP::SiconosVector position, SP::SiconosVector velocity) {
  if (gyroscopic_function_)
    gyroscopic_function_.call(dimension(), position->getArray(), velocity->getArray(), _fGyr->getArray(),
                              z_->size(), z_->getArray());
}

void LagrangianDS::computeFExt(double time) {
  if (external_function_)
    external_function_.call(time, dimension(), _fExt->getArray(), z_->size(), z_->getArray());
}

double LagrangianDS::computeKineticEnergy() {
  computeMass(q_);
  return 0.5 * velocity_->values().dot(_mass->values() * velocity_->values());
}

std::shared_ptr<const saltus::LagrangianDS> LagrangianDS::native() {
  require_square(_mass.get(), dimension(), "mass");
  require_length(_fExt.get(), dimension(), "fExt");
  require_length(_fInt.get(), dimension(), "fInt");
  require_length(_fGyr.get(), dimension(), "fGyr");
  return std::make_shared<LiveDS>(*this);
}

std::shared_ptr<const saltus::LagrangianDS> LagrangianLinearTIDS::native() {
  LagrangianDS::native();
  require_square(K_.get(), dimension(), "K");
  require_square(C_.get(), dimension(), "C");
  return std::make_shared<LiveLinearDS>(*this);
}

}  // namespace saltus::siconos::kernel
