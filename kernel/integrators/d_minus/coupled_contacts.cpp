#include "saltus/kernel/integrators/d_minus/coupled_contacts.hpp"

#include <algorithm>

namespace saltus {
namespace {

constexpr int reserved_rows = 64;  // of a dense G, of one stage; beyond, it grows when it is first needed

}  // namespace

CoupledContacts::CoupledContacts(std::shared_ptr<const Layout> layout, ContactSolver& solver, const Matrix& A)
    : A_(A),
      constant_(!layout->varying_jacobian && !layout->varying_mass),
      sliding_(layout, static_cast<int>(A.rows())) {
  const int s = static_cast<int>(A_.rows()), rows = s * layout->rows;
  for (int k = 0; k < (constant_ ? 1 : s); ++k) stages_.emplace_back(layout, solver);
  solver.reserve(rows);
  const int dense = s * std::min(layout->rows, reserved_rows);
  problem_.G.reserve(dense, dense);
  problem_.b.reserve(rows);
  problem_.sets.reserve(rows);
  problem_.tolerance = layout->tolerance;
  problem_.brief = true;  // the simple scheme takes the step otherwise
  P_.reserve(rows);
  active_.reserve(layout->contacts.size());
}

void CoupledContacts::assemble(const std::vector<int>& active, Rows& rows) {
  const int s = static_cast<int>(A_.rows());
  for (std::size_t k = 0; k < stages_.size(); ++k)
    stages_[k].assembly().assemble(active, rows.at(k + 1), rows.at(k), rows.at(k));
  if (made_ && active == active_) return;
  active_ = active;
  made_ = constant_;

  const ContactProblem& one = stages_[0].assembly().problem();
  problem_.sets.clear();
  for (int k = 0; k < s; ++k) problem_.sets.insert(problem_.sets.end(), one.sets.begin(), one.sets.end());
  problem_.b.resize(s * one.rows());
  P_.resize(s * one.rows());
  problem_.sparse.clear();
  const int size = one.is_sparse() ? 0 : s * one.rows();
  problem_.G.resize(size, size);
  for (int l = 1; l <= s; ++l) {
    if (!constant_)
      for (auto& stage : stages_) stage.assembly().constrain(rows.at(l));
    one.is_sparse() ? copy_sparse(l) : copy_dense(l);
  }
}

void CoupledContacts::copy_dense(int l) {
  for (int k = 0; k < A_.cols(); ++k) {
    const ContactProblem& one = stage(k).assembly().problem();
    const int rows = one.rows();
    for (int i = 0; i < rows; ++i) {
      const double* from = one.G.row(i);
      double* to = problem_.G.row((l - 1) * rows + i) + k * rows;
      for (int j = 0; j < rows; ++j) to[j] = A_(l - 1, k) * from[j];
    }
  }
}

void CoupledContacts::copy_sparse(int l) {
  const int rows = stage(0).assembly().problem().rows();
  for (int i = 0; i < rows; ++i) {
    for (int k = 0; k < A_.cols(); ++k)
      for_row(stage(k).assembly().problem(), i,
              [&](int j, double entry) { problem_.sparse.add(k * rows + j, A_(l - 1, k) * entry); });
    problem_.sparse.end_row();
  }
}

void CoupledContacts::start_from(int k, double dt, const Vec& lambda) {
  PoolVec& P = stage(k).P();
  stage(k).assembly().gather(lambda, dt, P);
  std::copy_n(P.data(), P.size(), P_.data() + k * P.size());
}

void CoupledContacts::set_b(int l, Configuration& at, const Vec& v_free) {
  ContactAssembly& assembly = stage(l - 1).assembly();
  assembly.set_b(at, v_free);
  const PoolVec& b = assembly.problem().b;
  std::copy_n(b.data(), b.size(), problem_.b.data() + (l - 1) * b.size());
}

bool CoupledContacts::solve(StepReport& report) {
  return sliding_.any() ? sliding_.solve(stages_[0], problem_, P_, report)
                        : stages_[0].solve(problem_, P_, report);
}

void CoupledContacts::read(int k, double dt, Vec& lambda, Vec& reaction) {
  ContactStage& stage = this->stage(k);
  PoolVec& P = stage.P();
  std::copy_n(P_.data() + k * P.size(), P.size(), P.data());
  lambda.setZero();
  stage.assembly().scatter(P, 1.0 / dt, lambda);
  reaction.setZero();
  stage.assembly().apply(1.0 / dt, P.data(), reaction);
}

}  // namespace saltus
