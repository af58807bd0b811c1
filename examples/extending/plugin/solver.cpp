// A contact solver in a shared library, "./libown.so:ProjectedSor": projected successive overrelaxation for
// contacts without friction, P_i <- max(0, P_i − ω ξ_i / G_ii).
#include <algorithm>

#include "saltus/numerics/solvers/registry.hpp"

namespace {

using namespace saltus;

class ProjectedSor final : public ContactSolver {
 public:
  std::string_view name() const override { return "projected-sor"; }
  std::unique_ptr<ContactSolver> clone() const override { return std::make_unique<ProjectedSor>(); }
  void reserve(int rows) override { xi_.reserve(rows); }
  bool accepts(const ContactProblem& problem) const override {
    return std::all_of(problem.sets.begin(), problem.sets.end(),
                       [](const ContactSet& set) { return std::holds_alternative<NonNegative>(set); });
  }

  SolveReport solve(const ContactProblem& problem, double* P) override {
    constexpr int most_sweeps = 10000;
    constexpr double omega = 1.2;
    SolveReport report{.solver = name()};
    const int rows = problem.rows();
    xi_.resize(rows);
    for (;; ++report.iterations) {
      report.certificate = certify(problem, P, xi_.data());
      if (report.certificate.within(problem.tolerance)) return report;
      if (report.iterations == most_sweeps) break;
      for (int i = 0; i < rows; ++i) {
        double xi = problem.b[i];
        for (int j = 0; j < rows; ++j) xi += problem.G(i, j) * P[j];
        if (problem.G(i, i) > 0.0) P[i] = std::max(0.0, P[i] - omega * xi / problem.G(i, i));
      }
    }
    report.status = SolveStatus::iteration_limit;
    return report;
  }

 private:
  PoolVec xi_;
};

}  // namespace

SALTUS_CONTACT_SOLVER(ProjectedSor, "projected successive overrelaxation, without friction");
