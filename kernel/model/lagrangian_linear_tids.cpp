#include "saltus/kernel/model/lagrangian_linear_tids.hpp"

#include <stdexcept>
#include <string>

#include "saltus/kernel/model/requirements.hpp"

namespace saltus {
namespace {

using Term = LagrangianLinearTIDS::Term;

bool sparse(const std::optional<Term>& term) { return term && !std::holds_alternative<Matrix>(*term); }

std::optional<Matrix> to_dense(std::optional<Term> term) {
  if (!term) return std::nullopt;
  return std::get<Matrix>(std::move(*term));
}

// A dense one beside sparse ones. @throws std::invalid_argument naming `what` unless it is a finite (n, n)
SparseMatrix to_sparse(const std::optional<Term>& term, int n, const std::string& what) {
  if (!term) return {};
  const auto* dense = std::get_if<Matrix>(&*term);
  SparseMatrix A(dense ? SparseEntries(dense->sparseView())
                       : SparseEntries(std::get<Eigen::SparseMatrix<double>>(*term)));
  require_square(A.entries(), n, what);
  return A;
}

}  // namespace

LagrangianLinearTIDS::LagrangianLinearTIDS(Vec q0, Vec v0, Term mass, Terms terms)
    : LagrangianDS(std::move(q0), std::move(v0)), external_force_(std::move(terms.external_force)) {
  const int n = dimension();
  if (sparse(mass) || sparse(terms.stiffness) || sparse(terms.damping)) {
    SparseTerms matrices{to_sparse(mass, n, "mass"), {}, {}};
    require_mass(matrices.mass.entries(), n, "mass");
    matrices.stiffness = to_sparse(terms.stiffness, n, "stiffness");
    matrices.damping = to_sparse(terms.damping, n, "damping");
    matrices_ = std::move(matrices);
  } else {
    DenseTerms matrices{std::get<Matrix>(std::move(mass)), to_dense(std::move(terms.stiffness)),
                        to_dense(std::move(terms.damping))};
    require_mass(matrices.mass, n, "mass");
    if (matrices.stiffness) require_square(*matrices.stiffness, n, "stiffness");
    if (matrices.damping) require_square(*matrices.damping, n, "damping");
    matrices_ = std::move(matrices);
  }
  if (!external_force_) return;
  if (external_force_->size() != n)
    throw std::invalid_argument("external_force must have " + std::to_string(n) + " entries as q0 has, got " +
                                std::to_string(external_force_->size()));
  if (!external_force_->allFinite())
    throw std::invalid_argument("external_force must be finite, got NaN or infinity");
}

void LagrangianLinearTIDS::mass(const In&, OutMatrix M) const {
  if (const auto* sparse = sparse_terms())
    M = Matrix(sparse->mass.entries());
  else
    M = std::get<DenseTerms>(matrices_).mass;
}

void LagrangianLinearTIDS::external_force(double, Out f) const {
  if (external_force_) f = *external_force_;
}

void LagrangianLinearTIDS::forces(double t, const In& q, const In& v, Out h) const {
  external_force(t, h);
  if (const auto* sparse = sparse_terms()) {
    sparse->stiffness.add_product(-1.0, q.data(), h.data());
    sparse->damping.add_product(-1.0, v.data(), h.data());
    return;
  }
  const DenseTerms& dense = std::get<DenseTerms>(matrices_);
  if (dense.stiffness) h.noalias() -= *dense.stiffness * q;
  if (dense.damping) h.noalias() -= *dense.damping * v;
}

bool LagrangianLinearTIDS::force_jacobians(double, const In&, const In&, OutMatrix dh_dq,
                                           OutMatrix dh_dv) const {
  if (const auto* sparse = sparse_terms()) {
    if (sparse->stiffness.entries().size()) dh_dq = -Matrix(sparse->stiffness.entries());
    if (sparse->damping.entries().size()) dh_dv = -Matrix(sparse->damping.entries());
    return true;
  }
  const DenseTerms& dense = std::get<DenseTerms>(matrices_);
  if (dense.stiffness) dh_dq = -*dense.stiffness;
  if (dense.damping) dh_dv = -*dense.damping;
  return true;
}

double LagrangianLinearTIDS::potential_energy(const In& q) const {
  double energy = 0.0;
  if (external_force_ && !driven()) energy -= external_force_->dot(q);
  if (const auto* sparse = sparse_terms())
    energy += 0.5 * sparse->stiffness.form(q.data());
  else if (const auto& stiffness = std::get<DenseTerms>(matrices_).stiffness)
    energy += 0.5 * q.dot(*stiffness * q);
  return energy;
}

}  // namespace saltus
