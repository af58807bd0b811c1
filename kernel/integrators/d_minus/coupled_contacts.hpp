#pragma once
#include <memory>
#include <vector>

#include "saltus/kernel/integrators/half_explicit/rows.hpp"

namespace saltus {

/// The contact problem of all stages of a D⁻ step together. For P_k = Δt λ_k, k = 0…s−1, and the laws at the
/// positions of the stages l = 1…s it has the blocks
///   G_lk = A_lk W(q_l)ᵀ M_k⁻¹ W(q_k),   b_l = W(q_l)ᵀ v_free,l,
/// where the law at stage l stands with λ_{l−1}. Its sparse rows have s² times the entries of those of one
/// stage.
class CoupledContacts {
 public:
  /// @param A  (s, s) of (B.3), row l−1 for stage l
  /// @throws std::invalid_argument as ContactStage
  CoupledContacts(std::shared_ptr<const Layout> layout, ContactSolver& solver, const Matrix& A);

  /// Assembles G at the positions of the stages.
  void assemble(const std::vector<int>& active, Rows& rows);
  /// Takes λ_k [N] (rows of all contacts) as the solution to start from.
  void start_from(int k, double dt, const Vec& lambda);
  /// b of stage l, from the velocity without any λ
  void set_b(int l, Configuration& at, const Vec& v_free);

  /// To be told in turn how the contacts move at each stage: those that slide in space have friction directed
  /// by that.
  Sliding& sliding() { return sliding_; }
  /// @return false if the status in the report is no longer ok
  bool solve(StepReport& report);

  /// λ_k [N] and M_k⁻¹W_kλ_k of the solution
  void read(int k, double dt, Vec& lambda, Vec& reaction);

 private:
  ContactStage& stage(int k) { return stages_[constant_ ? 0 : k]; }
  void copy_dense(int l);
  void copy_sparse(int l);

  Matrix A_;
  bool constant_;                     // neither W nor M changes
  std::vector<ContactStage> stages_;  // one for each stage, or for all if constant
  ContactProblem problem_;
  PoolVec P_;
  Sliding sliding_;
  std::vector<int> active_;
  bool made_ = false;  // G is that of active_, and stays it
};

}  // namespace saltus
