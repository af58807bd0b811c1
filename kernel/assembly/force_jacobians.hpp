#pragma once
#include <memory>
#include <vector>

#include "saltus/kernel/assembly/configuration.hpp"
#include "saltus/kernel/assembly/force_elements.hpp"
#include "saltus/kernel/assembly/partition.hpp"

namespace saltus {

/// ∂h/∂q Y and ∂h/∂v, block by block over systems that force elements couple. What a system does not define,
/// and how the direction W of an element turns, is taken by differences. Blocks with a sparse system are
/// sparse; an element on one of them whose W turns costs n evaluations of W all the same.
class ForceJacobians {
 public:
  explicit ForceJacobians(std::shared_ptr<const Layout> layout);

  const std::shared_ptr<const Partition>& partition() const { return partition_; }
  /// Are both constant in this block, of its systems and of its force elements?
  bool time_invariant(int block) const { return time_invariant_[block]; }
  /// Does the block have a sparse system?
  bool sparse(int block) const { return sparse_[block]; }
  /// Evaluates those of one block at a state of all systems.
  void evaluate(int block, double t, const Vec& q, const Vec& v);
  /// Of the block of the last call, (n of it, n of it), if it is not sparse
  InMatrix dh_dq() const { return dh_dq_.view(); }
  InMatrix dh_dv() const { return dh_dv_.view(); }
  /// Likewise, if it is sparse
  SparseEntries sparse_dh_dq() const { return collect(dq_entries_); }
  SparseEntries sparse_dh_dv() const { return collect(dv_entries_); }
  /// M of a sparse block, at a factorised position
  SparseEntries sparse_mass(int block, const Configuration& position) const;

 private:
  using Entries = std::vector<Eigen::Triplet<double>>;
  void evaluate_sparse(int block, double t, const Vec& q, const Vec& v);
  void add_element_sparse(const Layout::Force& force, double t, const Vec& q, const Vec& v);
  int place(const Layout::Force& force, int freedom) const;
  SparseEntries collect(const Entries& entries) const;
  void add_system(int system, double t, const Vec& q, const Vec& v);
  void evaluate_system(int system, double t, const Vec& q, const Vec& v, PoolMatrix& dh_dq,
                       PoolMatrix& dh_dv);
  void differentiate(int system, double t, const In& q, const In& v, PoolMatrix& dh_dq, PoolMatrix& dh_dv);
  double step_ahead(const Layout::Sides& part, const In& q, int freedom);
  void turn(const Layout::Force& force, double t, const Stretch& state, int freedom);
  void add_element(const Layout::Force& force, double t, const Vec& q, const Vec& v);
  void add(const Layout::Force& force, const PoolMatrix& local, PoolMatrix& all) const;

  std::shared_ptr<const Layout> layout_;
  std::shared_ptr<const Partition> partition_;
  std::vector<std::vector<int>> forces_;  // of each block
  std::vector<bool> time_invariant_, sparse_;
  PoolMatrix dh_dq_, dh_dv_;         // of a block
  PoolMatrix local_dq_, local_dv_;   // of a system or an element
  Entries dq_entries_, dv_entries_;  // of a sparse block
  int size_ = 0;                     // of that block
  PoolVec ahead_, h_, h_ahead_, stretch_, unit_, direction_;
};

}  // namespace saltus
