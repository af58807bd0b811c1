#pragma once
#include <functional>

#include "saltus/numerics/contact_solver.hpp"

namespace saltus {

/// Another solver, watched: every problem and what became of it are shown to a function, which cannot change
/// them. Clones show theirs to the same one.
class ObservedSolver final : public ContactSolver {
 public:
  /// @param P (rows) [N s] what the solver found
  using Watcher = std::function<void(const ContactProblem&, const double* P, const SolveReport&)>;

  explicit ObservedSolver(std::unique_ptr<ContactSolver> solver)
      : solver_(std::move(solver)), watcher_(std::make_shared<Watcher>()) {}
  ObservedSolver(std::unique_ptr<ContactSolver> solver, std::shared_ptr<Watcher> watcher)
      : solver_(std::move(solver)), watcher_(std::move(watcher)) {}

  /// What it throws is thrown by solve(). An empty function ends it.
  void watch(Watcher watcher) { *watcher_ = std::move(watcher); }
  const ContactSolver& solver() const { return *solver_; }

  std::string_view name() const override { return solver_->name(); }
  bool accepts(const ContactProblem& problem) const override { return solver_->accepts(problem); }
  bool takes_sparse() const override { return solver_->takes_sparse(); }
  void reserve(int rows) override { solver_->reserve(rows); }
  SolveReport solve(const ContactProblem& problem, double* P) override {
    const SolveReport report = solver_->solve(problem, P);
    if (*watcher_) (*watcher_)(problem, P, report);
    return report;
  }
  std::unique_ptr<ContactSolver> clone() const override {
    return std::make_unique<ObservedSolver>(solver_->clone(), watcher_);
  }

 private:
  std::unique_ptr<ContactSolver> solver_;
  std::shared_ptr<Watcher> watcher_;
};

}  // namespace saltus
