#pragma once
#include <memory>
#include <vector>

#include "saltus/kernel/assembly/force_elements.hpp"
#include "saltus/kernel/assembly/partition.hpp"

namespace saltus {

/// ∂h/∂q and ∂h/∂v, block by block over systems that force elements couple. What a system does not define,
/// and how the direction W of an element turns, is taken by differences.
class ForceJacobians {
 public:
  explicit ForceJacobians(std::shared_ptr<const Layout> layout);

  const std::shared_ptr<const Partition>& partition() const { return partition_; }
  /// Are both constant in this block, of its systems and of its force elements?
  bool time_invariant(int block) const { return time_invariant_[block]; }
  /// Evaluates those of one block at a state of all systems.
  void evaluate(int block, double t, const Vec& q, const Vec& v);
  /// Of the block of the last call, (n of it, n of it)
  InMatrix dh_dq() const { return dh_dq_.view(); }
  InMatrix dh_dv() const { return dh_dv_.view(); }

 private:
  void add_system(int system, double t, const Vec& q, const Vec& v);
  void evaluate_system(int system, double t, const Vec& q, const Vec& v, PoolMatrix& dh_dq,
                       PoolMatrix& dh_dv);
  void differentiate(const LagrangianDS& model, double t, const In& q, const In& v, PoolMatrix& dh_dq,
                     PoolMatrix& dh_dv);
  void add_element(const Layout::Force& force, double t, const Vec& q, const Vec& v);
  void add(const Layout::Force& force, const PoolMatrix& local, PoolMatrix& all) const;

  std::shared_ptr<const Layout> layout_;
  std::shared_ptr<const Partition> partition_;
  std::vector<std::vector<int>> forces_;  // of each block
  std::vector<bool> time_invariant_;
  PoolMatrix dh_dq_, dh_dv_;        // of a block
  PoolMatrix local_dq_, local_dv_;  // of a system or an element
  PoolVec ahead_, h_, h_ahead_, stretch_;
};

}  // namespace saltus
