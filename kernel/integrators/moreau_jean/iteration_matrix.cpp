#include "saltus/kernel/integrators/moreau_jean/iteration_matrix.hpp"

#include <algorithm>

namespace saltus {

IterationMatrix::IterationMatrix(std::shared_ptr<const Layout> layout)
    : layout_(std::move(layout)), jacobians_(layout_) {
  for (std::size_t k = 0; k < partition()->blocks.size(); ++k) {
    const int n = partition()->sizes[k];
    gathered_.reserve(n);
    if (jacobians_.sparse(static_cast<int>(k)))
      blocks_.emplace_back(Sparse{});
    else
      blocks_.emplace_back(
          Dense{Matrix::Zero(n, n), Eigen::PartialPivLU<Matrix>(n), Vec::Zero(n), Vec::Zero(n)});
  }
}

StepStatus IterationMatrix::update(double theta, double dt, double t, const Configuration& position,
                                   const Vec& q, const Vec& v) {
  const bool same_step = dt == made_for_;
  made_for_ = 0.0;  // until all blocks are made
  for (int k = 0; k < static_cast<int>(blocks_.size()); ++k) {
    if (jacobians_.time_invariant(k) && same_step) continue;
    ++revision_;
    jacobians_.evaluate(k, t, q, v);
    const StepStatus status =
        std::visit([&](auto& block) { return make(k, block, theta * dt, theta * theta * dt * dt, position); },
                   blocks_[k]);
    if (status != StepStatus::ok) return status;
  }
  made_for_ = dt;
  return StepStatus::ok;
}

// M − c ∂h/∂v − k ∂h/∂q of one block
StepStatus IterationMatrix::make(int index, Dense& block, double c, double k, const Configuration& position) {
  block.A = -c * jacobians_.dh_dv() - k * jacobians_.dh_dq();
  for (int system : partition()->blocks[index]) {
    const int n = layout_->systems[system].n, at = partition()->places[system].offset;
    block.A.block(at, at, n, n) += position.mass(system);
  }
  if (!block.A.allFinite()) return StepStatus::not_finite;
  block.lu.compute(block.A);
  const bool regular = block.lu.matrixLU().diagonal().cwiseAbs().minCoeff() > 0.0;
  return regular ? StepStatus::ok : StepStatus::iteration_failed;
}

StepStatus IterationMatrix::make(int index, Sparse& block, double c, double k,
                                 const Configuration& position) {
  SparseEntries A = jacobians_.sparse_mass(index, position);
  A -= c * jacobians_.sparse_dh_dv();
  A -= k * jacobians_.sparse_dh_dq();
  return block.factor.factorise(A) ? StepStatus::ok : StepStatus::iteration_failed;
}

void IterationMatrix::solve_block(int k, double* x) const {
  if (const auto* sparse = std::get_if<Sparse>(&blocks_[k])) return sparse->factor.solve(x);
  const Dense& block = std::get<Dense>(blocks_[k]);
  Out values(x, block.right.size());
  block.right = values;
  block.x = block.lu.solve(block.right);
  values = block.x;
}

void IterationMatrix::solve(Vec& x) const {
  for (int k = 0; k < static_cast<int>(blocks_.size()); ++k) {
    const std::vector<int>& systems = partition()->blocks[k];
    if (systems.size() == 1) {
      solve_block(k, x.data() + layout_->systems[systems[0]].offset);
      continue;
    }
    gathered_.resize(partition()->sizes[k]);
    auto parts = [&](auto copy) {
      double* part = gathered_.data();
      for (int system : systems) {
        copy(x.data() + layout_->systems[system].offset, layout_->systems[system].n, part);
        part += layout_->systems[system].n;
      }
    };
    parts([](const double* from, int n, double* to) { std::copy_n(from, n, to); });
    solve_block(k, gathered_.data());
    parts([](double* to, int n, const double* from) { std::copy_n(from, n, to); });
  }
}

}  // namespace saltus
