#include "saltus/kernel/integrators/moreau_jean/iteration_matrix.hpp"

#include <algorithm>

namespace saltus {

IterationMatrix::IterationMatrix(std::shared_ptr<const Layout> layout)
    : layout_(std::move(layout)), jacobians_(layout_) {
  blocks_.resize(partition()->blocks.size());
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const int n = partition()->sizes[k];
    Block& block = blocks_[k];
    block.A.setZero(n, n);
    for (Vec* x : {&block.right, &block.x}) x->setZero(n);
    block.lu = Eigen::PartialPivLU<Matrix>(n);
    gathered_.reserve(n);
  }
}

StepStatus IterationMatrix::update(double theta, double dt, double t, const Configuration& position,
                                   const Vec& q, const Vec& v) {
  const bool same_step = dt == made_for_;
  made_for_ = 0.0;  // until all blocks are made
  for (int k = 0; k < static_cast<int>(blocks_.size()); ++k) {
    if (jacobians_.time_invariant(k) && same_step) continue;
    jacobians_.evaluate(k, t, q, v);
    Block& block = blocks_[k];
    block.A = -theta * dt * jacobians_.dh_dv() - theta * theta * dt * dt * jacobians_.dh_dq();
    for (int system : partition()->blocks[k]) {
      const int n = layout_->systems[system].n, at = partition()->places[system].offset;
      block.A.block(at, at, n, n) += position.mass(system);
    }
    if (!block.A.allFinite()) return StepStatus::not_finite;
    block.lu.compute(block.A);
    if (!(block.lu.matrixLU().diagonal().cwiseAbs().minCoeff() > 0.0)) return StepStatus::iteration_failed;
  }
  made_for_ = dt;
  return StepStatus::ok;
}

void IterationMatrix::solve_block(int k, double* x) const {
  const Block& block = blocks_[k];
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
