#include "saltus/kernel/integrators/moreau_jean/iteration_matrix.hpp"

#include <cmath>
#include <limits>

namespace saltus {
namespace {

// Forward differences lose half of the digits: enough for the direction of an iteration.
const double difference_step = std::sqrt(std::numeric_limits<double>::epsilon());

}  // namespace

IterationMatrix::IterationMatrix(std::shared_ptr<const Layout> layout) : layout_(std::move(layout)) {
  blocks_.resize(layout_->systems.size());
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const int n = layout_->systems[k].n;
    Block& block = blocks_[k];
    for (Matrix* A : {&block.dh_dq, &block.dh_dv, &block.A}) A->setZero(n, n);
    for (Vec* x : {&block.right, &block.x, &block.ahead, &block.h, &block.h_ahead}) x->setZero(n);
    block.lu = Eigen::PartialPivLU<Matrix>(n);
  }
}

StepStatus IterationMatrix::update(double theta, double dt, double t, const Configuration& position,
                                   const Vec& q, const Vec& v) {
  const bool same_step = dt == made_for_;
  made_for_ = 0.0;  // until all blocks are made
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const auto& system = layout_->systems[k];
    if (system.model->time_invariant() && same_step) continue;
    Block& block = blocks_[k];
    const In local_q(q.data() + system.offset, system.n);
    const In local_v(v.data() + system.offset, system.n);
    block.dh_dq.setZero();
    block.dh_dv.setZero();
    if (!system.model->force_jacobians(t, local_q, local_v, {block.dh_dq.data(), system.n, system.n},
                                       {block.dh_dv.data(), system.n, system.n}))
      differentiate(block, *system.model, t, local_q, local_v);
    block.A = position.mass(static_cast<int>(k));
    block.A -= theta * dt * block.dh_dv;
    block.A -= theta * theta * dt * dt * block.dh_dq;
    if (!block.A.allFinite()) return StepStatus::not_finite;
    block.lu.compute(block.A);
    if (!(block.lu.matrixLU().diagonal().cwiseAbs().minCoeff() > 0.0)) return StepStatus::iteration_failed;
  }
  made_for_ = dt;
  return StepStatus::ok;
}

void IterationMatrix::differentiate(Block& block, const LagrangianDS& model, double t, const In& q,
                                    const In& v) {
  const Eigen::Index n = q.size();
  auto forces = [&](const double* at_q, const double* at_v, Vec& h) {
    h.setZero();
    model.forces(t, {at_q, n}, {at_v, n}, {h.data(), n});
  };
  forces(q.data(), v.data(), block.h);
  for (const bool in_q : {true, false}) {
    const In& x = in_q ? q : v;
    Matrix& slope = in_q ? block.dh_dq : block.dh_dv;
    block.ahead = x;
    for (Eigen::Index j = 0; j < n; ++j) {
      const double step = difference_step * std::max(1.0, std::abs(x[j]));
      block.ahead[j] = x[j] + step;
      forces(in_q ? block.ahead.data() : q.data(), in_q ? v.data() : block.ahead.data(), block.h_ahead);
      slope.col(j) = (block.h_ahead - block.h) / step;
      block.ahead[j] = x[j];
    }
  }
}

void IterationMatrix::solve_block(int system, double* x) const {
  const Block& block = blocks_[system];
  Out values(x, block.right.size());
  block.right = values;
  block.x = block.lu.solve(block.right);
  values = block.x;
}

void IterationMatrix::solve(Vec& x) const {
  for (std::size_t k = 0; k < blocks_.size(); ++k)
    solve_block(static_cast<int>(k), x.data() + layout_->systems[k].offset);
}

}  // namespace saltus
