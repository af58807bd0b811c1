#pragma once
// Lagrangian systems as C++ programs written for Siconos make them.
#include "saltus/kernel/model/plugged_models.hpp"
#include "saltus/siconos/kernel/algebra.hpp"

namespace saltus::siconos::kernel {

/// M(q) v̇ + F_int(t, q, v) + F_gyr(q, v) = F_ext(t) + p, q̇ = v. Terms are constants that are set, functions
/// of plugins, or overrides that write into _mass, _fInt, _fGyr, _fExt. Derivatives of forces are found by
/// differences, unless plugins give all of them.
class LagrangianDS {
 public:
  /// @param q0, v0  (n) initial position and velocity
  /// @param mass    (n, n), the identity if it is left out
  /// @throws std::invalid_argument if sizes disagree
  LagrangianDS(SP::SiconosVector q0, SP::SiconosVector v0, SP::SiconosMatrix mass = nullptr);
  /// @param mass  "Plugin:function"
  LagrangianDS(SP::SiconosVector q0, SP::SiconosVector v0, const std::string& mass);
  virtual ~LagrangianDS() = default;

  unsigned dimension() const { return q_->size(); }
  /// Now: they follow the steps.
  SP::SiconosVector q() const { return q_; }
  SP::SiconosVector velocity() const { return velocity_; }
  /// Wλ of all interactions in the last step [N s].
  /// @throws std::invalid_argument unless level is 1
  SP::SiconosVector p(unsigned level) const;
  SP::SiconosVector q0() const { return q0_; }
  SP::SiconosVector velocity0() const { return velocity0_; }
  SP::SiconosMatrix mass() const { return _mass; }
  SP::SiconosVector fExt() const { return _fExt; }
  SP::SiconosVector fInt() const { return _fInt; }
  SP::SiconosVector fGyr() const { return _fGyr; }
  void setMassPtr(SP::SiconosMatrix mass) { _mass = mass; }
  void setFExtPtr(SP::SiconosVector force) { _fExt = force; }
  void setFIntPtr(SP::SiconosVector force) { _fInt = force; }
  void setFGyrPtr(SP::SiconosVector force) { _fGyr = force; }
  /// Parameters of plugins.
  void setzPtr(SP::SiconosVector z) { z_ = z; }

  /// @throws std::invalid_argument as load_symbol()
  void setComputeMassFunction(const std::string& library, const std::string& function);
  void setComputeFIntFunction(const std::string& library, const std::string& function);
  void setComputeFGyrFunction(const std::string& library, const std::string& function);
  void setComputeFExtFunction(const std::string& library, const std::string& function);
  void setComputeJacobianFIntqFunction(const std::string& library, const std::string& function);
  void setComputeJacobianFIntqDotFunction(const std::string& library, const std::string& function);
  void setComputeJacobianFGyrqFunction(const std::string& library, const std::string& function);
  void setComputeJacobianFGyrqDotFunction(const std::string& library, const std::string& function);

  virtual void computeMass(SP::SiconosVector position);
  virtual void computeFInt(double time, SP::SiconosVector position, SP::SiconosVector velocity);
  virtual void computeFGyr(SP::SiconosVector position, SP::SiconosVector velocity);
  virtual void computeFExt(double time);
  /// ∂/∂q and ∂/∂v of F_int + F_gyr by plugins, (n, n).
  /// @return false if there is a force without both of its derivatives
  bool computeJacobians(double time, Eigen::MatrixXd& by_q, Eigen::MatrixXd& by_v) const;
  /// ½ vᵀ M v [J] now.
  double computeKineticEnergy();

  /// The system of Saltus, which asks this one; it must outlive it.
  virtual std::shared_ptr<const saltus::LagrangianDS> native();

 protected:
  SP::SiconosMatrix _mass;
  SP::SiconosVector _fExt, _fInt, _fGyr;

 private:
  SP::SiconosVector q0_, velocity0_, q_, velocity_, p_, z_;
  PluggedFunction<PluggedDS::OfPosition> mass_function_;
  PluggedFunction<PluggedDS::OfTimeAndState> internal_function_;
  PluggedFunction<PluggedDS::OfState> gyroscopic_function_;
  PluggedFunction<PluggedDS::OfTime> external_function_;
  PluggedFunction<PluggedDS::OfTimeAndState> internal_dq_, internal_dv_;
  PluggedFunction<PluggedDS::OfState> gyroscopic_dq_, gyroscopic_dv_;
};

/// M v̇ + C v + K q = F_ext(t) + p.
class LagrangianLinearTIDS : public LagrangianDS {
 public:
  /// @param K, C  (n, n) stiffness [N/m] and damping [N s/m], zero if left out
  LagrangianLinearTIDS(SP::SiconosVector q0, SP::SiconosVector v0, SP::SiconosMatrix mass,
                       SP::SiconosMatrix K = nullptr, SP::SiconosMatrix C = nullptr)
      : LagrangianDS(q0, v0, mass), K_(K), C_(C) {}
  SP::SiconosMatrix K() const { return K_; }
  SP::SiconosMatrix C() const { return C_; }
  void setKPtr(SP::SiconosMatrix K) { K_ = K; }
  void setCPtr(SP::SiconosMatrix C) { C_ = C; }
  std::shared_ptr<const saltus::LagrangianDS> native() override;

 private:
  SP::SiconosMatrix K_, C_;
};

using DynamicalSystem = LagrangianDS;

namespace SP {
using LagrangianDS = std::shared_ptr<kernel::LagrangianDS>;
using LagrangianLinearTIDS = std::shared_ptr<kernel::LagrangianLinearTIDS>;
using DynamicalSystem = std::shared_ptr<kernel::DynamicalSystem>;
}  // namespace SP

}  // namespace saltus::siconos::kernel
