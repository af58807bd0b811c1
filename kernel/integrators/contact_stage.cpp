#include "saltus/kernel/integrators/contact_stage.hpp"

#include <stdexcept>

namespace saltus {
namespace {

constexpr int most_rows_of_dense_G = 64;  // of all contacts: beyond, G has few entries for most models

}  // namespace

ContactStage::ContactStage(std::shared_ptr<const Layout> layout, ContactSolver& solver)
    : ContactStage(layout, one_block_a_system(*layout), solver) {}

ContactStage::ContactStage(std::shared_ptr<const Layout> layout, std::shared_ptr<const Partition> partition,
                           ContactSolver& solver)
    : assembly_(layout, std::move(partition), layout->rows > most_rows_of_dense_G && solver.takes_sparse()),
      solver_(&solver) {
  // A problem with one contact stands for its law: solvers refuse laws, or too many contacts later.
  for (const auto& contact : layout->contacts) {
    ContactProblem one;
    one.sets = contact.law->sets;
    one.b = Vec(Vec::Zero(contact.rows));
    one.G = Matrix(Matrix::Identity(contact.rows, contact.rows));
    if (!solver.accepts(one))
      throw std::invalid_argument("the contact solver '" + std::string(solver.name()) +
                                  "' does not accept a law with " + std::to_string(contact.rows) +
                                  " rows: friction in space is not among its sets");
  }
  P_.reserve(layout->rows);
  solver.reserve(layout->rows);
}

bool ContactStage::solve(StepReport& report) { return solve(assembly_.problem(), P_, report); }

void ContactStage::meet(const std::vector<int>& active, Configuration& at, const Vec& v, Vec& gamma) {
  assembly_.assemble(active, at, at, at);
  assembly_.set_b(at, v);
  assembly_.scatter(assembly_.problem().b, 1.0, gamma);
}

bool ContactStage::strike(Configuration& at, const Vec& gamma, const Vec& rebound, Vec& v, Vec& impulse,
                          StepReport& report) {
  assembly_.add_restitution(rebound);  // (59)
  assembly_.gather(impulse, 1.0, P_);
  if (!solve(report)) return false;  // (56)-(58)
  assembly_.scatter(P_, 1.0, impulse);
  report.work_impulse += assembly_.work(P_, at, gamma);
  assembly_.apply(1.0, P_.data(), v);  // (68)
  return true;
}

bool ContactStage::solve(const ContactProblem& problem, PoolVec& P, StepReport& report) {
  if (problem.rows() == 0) return true;
  if (!problem.b.view().allFinite()) {
    report.status = StepStatus::not_finite;
    return false;
  }
  SolveReport solved;
  if (solver_->accepts(problem))
    solved = solver_->solve(problem, P.data());
  else
    solved.status = SolveStatus::breakdown;
  report.solver_iterations += solved.iterations;
  if (!(solved.certificate.residual <= report.residual))
    report.residual = solved.certificate.residual;  // or NaN
  if (solved.status != SolveStatus::solved) report.status = StepStatus::solver_failed;
  return report.status == StepStatus::ok;
}

}  // namespace saltus
