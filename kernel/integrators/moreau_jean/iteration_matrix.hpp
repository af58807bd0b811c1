#pragma once
#include <Eigen/LU>
#include <memory>
#include <vector>

#include "saltus/kernel/assembly/configuration.hpp"
#include "saltus/kernel/integrators/one_step_integrator.hpp"

namespace saltus {

/// The matrix of Newton's iteration in a theta scheme, block by block over the systems:
///   Ŵ = M − θ Δt ∂h/∂v − θ² Δt² ∂h/∂q,  for a linear system M + θ Δt C + θ² Δt² K.
/// Jacobians that a system does not define are taken by differences.
class IterationMatrix final : public BlockInverse {
 public:
  explicit IterationMatrix(std::shared_ptr<const Layout> layout);

  /// Makes and factorises the blocks; those of time-invariant systems only if Δt has changed.
  /// @param position  where M is taken, factorised
  /// @return ok, not_finite, or iteration_failed if a block is singular
  StepStatus update(double theta, double dt, double t, const Configuration& position, const Vec& q,
                    const Vec& v);
  void solve_block(int system, double* x) const override;
  /// x <- Ŵ⁻¹ x, x (n)
  void solve(Vec& x) const;

 private:
  struct Block {
    Matrix dh_dq, dh_dv, A;
    Eigen::PartialPivLU<Matrix> lu;
    mutable Vec right, x;  // of a solution: the factorisation cannot work in place
    Vec ahead, h, h_ahead;
  };
  void differentiate(Block& block, const LagrangianDS& model, double t, const In& q, const In& v);

  std::shared_ptr<const Layout> layout_;
  std::vector<Block> blocks_;
  double made_for_ = 0.0;  // Δt of the blocks
};

}  // namespace saltus
