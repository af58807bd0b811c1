#include "saltus/kernel/assembly/force_jacobians.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace saltus {
namespace {

// Forward differences lose half of the digits: enough for the direction of an iteration.
const double difference_step = std::sqrt(std::numeric_limits<double>::epsilon());

// Adds a block at (row, column); only the entries that are not zero.
template <class Block>
void add_entries(const Block& block, double factor, int row, int column,
                 std::vector<Eigen::Triplet<double>>& entries) {
  for (Eigen::Index i = 0; i < block.rows(); ++i)
    for (Eigen::Index j = 0; j < block.cols(); ++j)
      if (block(i, j) != 0.0)
        entries.emplace_back(row + static_cast<int>(i), column + static_cast<int>(j), factor * block(i, j));
}

void add_entries(const SparseEntries& block, double factor, int row, int column,
                 std::vector<Eigen::Triplet<double>>& entries) {
  for (int i = 0; i < block.outerSize(); ++i)
    for (SparseEntries::InnerIterator entry(block, i); entry; ++entry)
      entries.emplace_back(row + i, column + static_cast<int>(entry.col()), factor * entry.value());
}

double step_at(double x) { return difference_step * std::max(1.0, std::abs(x)); }

}  // namespace

ForceJacobians::ForceJacobians(std::shared_ptr<const Layout> layout)
    : layout_(std::move(layout)), partition_(coupled_by_forces(*layout_)) {
  const std::size_t blocks = partition_->blocks.size();
  forces_.resize(blocks);
  time_invariant_.assign(blocks, true);
  sparse_.assign(blocks, false);
  for (std::size_t k = 0; k < layout_->systems.size(); ++k) {
    const int block = partition_->places[k].block;
    if (!layout_->systems[k].model->time_invariant()) time_invariant_[block] = false;
    if (layout_->systems[k].sparse) sparse_[block] = true;
  }
  int largest = 0;  // of what needs a dense matrix of its own
  int longest = layout_->largest_force;
  for (const auto& system : layout_->systems) {
    if (!system.sparse) largest = std::max(largest, system.n);
    if (!system.sparse) longest = std::max({longest, system.n, system.coordinates});
  }
  for (std::size_t k = 0; k < layout_->forces.size(); ++k) {
    const int block = partition_->places[layout_->forces[k].system[0]].block;
    forces_[block].push_back(static_cast<int>(k));
    if (!sparse_[block]) largest = std::max(largest, layout_->forces[k].n);
    if (!layout_->forces[k].element->time_invariant()) time_invariant_[block] = false;
  }
  for (PoolMatrix* A : {&local_dq_, &local_dv_}) A->reserve(largest, largest);
  for (PoolVec* x : {&ahead_, &h_, &h_ahead_, &unit_, &direction_}) x->reserve(longest);
  stretch_.resize(3 * layout_->largest_force);
  for (std::size_t block = 0; block < blocks; ++block)
    if (const int n = partition_->sizes[block]; !sparse_[block])
      for (PoolMatrix* A : {&dh_dq_, &dh_dv_}) A->reserve(n, n);
}

void ForceJacobians::evaluate(int block, double t, const Vec& q, const Vec& v) {
  if (sparse_[block]) return evaluate_sparse(block, t, q, v);
  const int n = partition_->sizes[block];
  for (PoolMatrix* A : {&dh_dq_, &dh_dv_}) {
    A->resize(n, n);
    A->view().setZero();
  }
  if (partition_->blocks[block].size() == 1)  // the system's are the block's
    evaluate_system(partition_->blocks[block][0], t, q, v, dh_dq_, dh_dv_);
  else
    for (int system : partition_->blocks[block]) add_system(system, t, q, v);
  for (int force : forces_[block]) add_element(layout_->forces[force], t, q, v);
}

void ForceJacobians::evaluate_sparse(int block, double t, const Vec& q, const Vec& v) {
  size_ = partition_->sizes[block];
  dq_entries_.clear();
  dv_entries_.clear();
  for (int k : partition_->blocks[block]) {
    const auto& system = layout_->systems[k];
    const int at = partition_->places[k].offset;
    if (system.sparse) {
      add_entries(system.sparse->stiffness.entries(), -1.0, at, at, dq_entries_);
      add_entries(system.sparse->damping.entries(), -1.0, at, at, dv_entries_);
      continue;
    }
    for (PoolMatrix* A : {&local_dq_, &local_dv_}) {
      A->resize(system.n, system.n);
      A->view().setZero();
    }
    evaluate_system(k, t, q, v, local_dq_, local_dv_);
    add_entries(local_dq_.view(), 1.0, at, at, dq_entries_);
    add_entries(local_dv_.view(), 1.0, at, at, dv_entries_);
  }
  for (int force : forces_[block]) add_element_sparse(layout_->forces[force], t, q, v);
}

SparseEntries ForceJacobians::collect(const Entries& entries) const {
  SparseEntries result(size_, size_);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

SparseEntries ForceJacobians::sparse_mass(int block, const Configuration& position) const {
  const int n = partition_->sizes[block];
  Entries entries;
  for (int k : partition_->blocks[block]) {
    const int at = partition_->places[k].offset;
    if (const auto* sparse = layout_->systems[k].sparse)
      add_entries(sparse->mass.entries(), 1.0, at, at, entries);
    else
      add_entries(position.mass(k), 1.0, at, at, entries);
  }
  SparseEntries M(n, n);
  M.setFromTriplets(entries.begin(), entries.end());
  return M;
}

// Where a freedom of the element's systems is in their block
int ForceJacobians::place(const Layout::Force& force, int freedom) const {
  const int first = layout_->systems[force.system[0]].n;
  if (freedom < first) return partition_->places[force.system[0]].offset + freedom;
  return partition_->places[force.system[1]].offset + freedom - first;
}

// As add_element(), column by column of what is not zero
void ForceJacobians::add_element_sparse(const Layout::Force& force, double t, const Vec& q, const Vec& v) {
  const Stretch state = stretch(*layout_, force, t, q, v, stretch_.data());
  const ForceLaw& law = force.element->law();
  const ForceLaw::Slopes slopes = law.slopes(t, state.length, state.rate);
  const In W(state.W, force.n);
  const Relation& relation = force.element->relation();
  const bool turns = !relation.constant_jacobian();
  const double f = turns ? law.force(t, state.length, state.rate) : 0.0;
  for (PoolVec* x : {&h_, &h_ahead_}) x->resize(force.n);
  const In local_v = state.v;
  Out column = h_.view(), turned = h_ahead_.view();
  for (int j = 0; j < force.n; ++j) {
    if (W[j] == 0.0 && !turns) continue;
    column = slopes.length * W[j] * W;
    if (turns) {
      turn(force, t, state, j);
      column += f * turned + slopes.rate * turned.dot(local_v) * W;
    }
    for (int i = 0; i < force.n; ++i) {
      if (column[i] != 0.0) dq_entries_.emplace_back(place(force, i), place(force, j), column[i]);
      const double damping = slopes.rate * W[i] * W[j];
      if (damping != 0.0) dv_entries_.emplace_back(place(force, i), place(force, j), damping);
    }
  }
}

void ForceJacobians::add_system(int system, double t, const Vec& q, const Vec& v) {
  const int n = layout_->systems[system].n, at = partition_->places[system].offset;
  for (PoolMatrix* A : {&local_dq_, &local_dv_}) {
    A->resize(n, n);
    A->view().setZero();
  }
  evaluate_system(system, t, q, v, local_dq_, local_dv_);
  dh_dq_.view().block(at, at, n, n) = local_dq_.view();
  dh_dv_.view().block(at, at, n, n) = local_dv_.view();
}

// @param[out] dh_dq, dh_dv  (n, n) of the system, starting as zero
void ForceJacobians::evaluate_system(int system, double t, const Vec& q, const Vec& v, PoolMatrix& dh_dq,
                                     PoolMatrix& dh_dv) {
  const auto& slot = layout_->systems[system];
  const In local_q(q.data() + slot.first, slot.coordinates), local_v(v.data() + slot.offset, slot.n);
  if (!slot.model->force_jacobians(t, local_q, local_v, dh_dq.view(), dh_dv.view()))
    differentiate(system, t, local_q, local_v, dh_dq, dh_dv);
}

void ForceJacobians::differentiate(int system, double t, const In& q, const In& v, PoolMatrix& dh_dq,
                                   PoolMatrix& dh_dv) {
  const auto& slot = layout_->systems[system];
  const Layout::Sides alone{1, {system, -1}, slot.n, slot.coordinates};
  for (PoolVec* x : {&h_, &h_ahead_}) x->resize(slot.n);
  auto forces = [&](const In& at_q, const In& at_v, PoolVec& h) {
    h.view().setZero();
    slot.model->forces(t, at_q, at_v, h.view());
  };
  forces(q, v, h_);
  for (int j = 0; j < slot.n; ++j) {
    const double step = step_ahead(alone, q, j);
    forces({ahead_.data(), slot.coordinates}, v, h_ahead_);
    dh_dq.view().col(j) = (h_ahead_.view() - h_.view()) / step;
  }
  ahead_.resize(slot.n);
  ahead_.view() = v;
  for (int j = 0; j < slot.n; ++j) {
    const double step = step_at(v[j]);
    ahead_[j] = v[j] + step;
    forces(q, {ahead_.data(), slot.n}, h_ahead_);
    dh_dv.view().col(j) = (h_ahead_.view() - h_.view()) / step;
    ahead_[j] = v[j];
  }
}

// ahead_ <- q + s Y e_j for a freedom of these systems. @return s
double ForceJacobians::step_ahead(const Layout::Sides& part, const In& q, int freedom) {
  ahead_.resize(part.coordinates);
  ahead_.view() = q;
  int first = 0;
  for (int side = 0;; ++side) {
    const auto& system = layout_->systems[part.system[side]];
    if (freedom >= system.n) {
      freedom -= system.n;
      first += system.coordinates;
      continue;
    }
    if (!system.mapped) {
      const double step = step_at(q[first + freedom]);
      ahead_[first + freedom] += step;
      return step;
    }
    unit_.resize(system.n);
    unit_.view().setZero();
    unit_[freedom] = 1.0;
    direction_.resize(system.coordinates);
    direction_.view().setZero();
    const In own(q.data() + first, system.coordinates);
    system.model->position_rate(own, {unit_.data(), system.n}, direction_.view());
    const double step = step_at(own.lpNorm<Eigen::Infinity>());
    ahead_.view().segment(first, system.coordinates) += step * direction_.view();
    return step;
  }
}

// h_ahead_ <- the derivative of W along a freedom of the element
void ForceJacobians::turn(const Layout::Force& force, double t, const Stretch& state, int freedom) {
  const double step = step_ahead(force, state.q, freedom);
  Out turned = h_ahead_.view();
  turned.setZero();
  force.element->relation().jacobian_at(t, {ahead_.data(), force.coordinates}, {turned.data(), 1, force.n});
  turned = (turned - In(state.W, force.n)) / step;
}

// ∂(W f)/∂v = W f_l̇ Wᵀ; ∂(W f)/∂q = W (f_l Wᵀ + f_l̇ vᵀ∂W/∂q) + f ∂W/∂q
void ForceJacobians::add_element(const Layout::Force& force, double t, const Vec& q, const Vec& v) {
  const Stretch state = stretch(*layout_, force, t, q, v, stretch_.data());
  const ForceLaw& law = force.element->law();
  const ForceLaw::Slopes slopes = law.slopes(t, state.length, state.rate);
  const In W(state.W, force.n);
  for (PoolMatrix* A : {&local_dq_, &local_dv_}) A->resize(force.n, force.n);
  local_dv_.view().noalias() = slopes.rate * W * W.transpose();
  local_dq_.view().noalias() = slopes.length * W * W.transpose();
  const Relation& relation = force.element->relation();
  if (!relation.constant_jacobian()) {
    const double f = law.force(t, state.length, state.rate);
    h_ahead_.resize(force.n);
    const In local_v = state.v;
    for (int j = 0; j < force.n; ++j) {
      turn(force, t, state, j);
      local_dq_.view().col(j) += f * h_ahead_.view() + slopes.rate * h_ahead_.view().dot(local_v) * W;
    }
  }
  add(force, local_dq_, dh_dq_);
  add(force, local_dv_, dh_dv_);
}

void ForceJacobians::add(const Layout::Force& force, const PoolMatrix& local, PoolMatrix& all) const {
  int row = 0;
  for (int left = 0; left < force.sides; ++left) {
    const int a = force.system[left], m = layout_->systems[a].n;
    int column = 0;
    for (int right = 0; right < force.sides; ++right) {
      const int b = force.system[right], n = layout_->systems[b].n;
      all.view().block(partition_->places[a].offset, partition_->places[b].offset, m, n) +=
          local.view().block(row, column, m, n);
      column += n;
    }
    row += m;
  }
}

}  // namespace saltus
