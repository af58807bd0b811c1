#pragma once
#include <Eigen/LU>
#include <memory>
#include <variant>
#include <vector>

#include "saltus/kernel/assembly/configuration.hpp"
#include "saltus/kernel/assembly/force_jacobians.hpp"
#include "saltus/kernel/integrators/one_step_integrator.hpp"

namespace saltus {

/// The matrix of Newton's iteration in a theta scheme:
///   Ŵ = M − θ Δt ∂h/∂v − θ² Δt² ∂h/∂q,  for a linear system M + θ Δt C + θ² Δt² K.
/// Systems that force elements couple share a block of it.
class IterationMatrix final : public BlockInverse {
 public:
  explicit IterationMatrix(std::shared_ptr<const Layout> layout);

  /// Its blocks.
  const std::shared_ptr<const Partition>& partition() const { return jacobians_.partition(); }
  /// Makes and factorises the blocks; those of time-invariant systems and elements only if Δt has changed.
  /// @param position  where M is taken, factorised
  /// @return ok, not_finite, or iteration_failed if a block is singular
  StepStatus update(double theta, double dt, double t, const Configuration& position, const Vec& q,
                    const Vec& v);
  void solve_block(int block, double* x) const override;
  long revision() const override { return revision_; }
  /// x <- Ŵ⁻¹ x, x (n)
  void solve(Vec& x) const;

 private:
  struct Dense {
    Matrix A;
    Eigen::PartialPivLU<Matrix> lu;
    mutable Vec right, x;  // of a solution: the factorisation cannot work in place
  };
  struct Sparse {
    SparseFactor factor;
  };

  StepStatus make(int block, Dense& dense, double c, double k, const Configuration& position);
  StepStatus make(int block, Sparse& sparse, double c, double k, const Configuration& position);

  std::shared_ptr<const Layout> layout_;
  ForceJacobians jacobians_;
  std::vector<std::variant<Dense, Sparse>> blocks_;
  mutable PoolVec gathered_;  // of a block with several systems
  double made_for_ = 0.0;     // Δt of the blocks
  long revision_ = 0;         // how often one of them was made
};

}  // namespace saltus
