#pragma once
#include <memory>
#include <string_view>

#include "saltus/numerics/certificate.hpp"

namespace saltus {

enum class SolveStatus {
  solved,           ///< the certificate is within the problem's tolerance
  ray,              ///< it is not, and a pivoting method has come to the end of its path
  iteration_limit,  ///< it is not, and the iterations are used up
  breakdown,        ///< it is not, and the method knows no further step
};

/// "solved", "ray", "iteration-limit" or "breakdown".
std::string_view to_string(SolveStatus status);

struct SolveReport {
  SolveStatus status = SolveStatus::solved;
  int iterations = 0;
  Certificate certificate;  ///< of the P that came out, computed outside the method
  std::string_view solver;  ///< name of the method that answered
};

/// Takes a trial over into P and the report if it solves the problem, or has a smaller residual than P.
/// @param trial    (rows) [N s]
/// @param[out] xi  (rows) [m/s], of the trial
/// @return true if it solves the problem
bool keep_if_better(const ContactProblem& problem, const double* trial, double* xi, SolveReport& report,
                    double* P);

/// Finds P with xi = G P + b and every contact's law between xi and P.
class ContactSolver {
 public:
  virtual ~ContactSolver() = default;
  /// Name in the registry.
  virtual std::string_view name() const = 0;
  /// Can this method take the problem at all? One that it does not accept must not be passed to solve().
  virtual bool accepts(const ContactProblem& problem) const = 0;
  /// Can it take problems with sparse rows? Others are given a copy with a dense G.
  virtual bool takes_sparse() const { return false; }
  /// ContactProblem::tolerance of the problems that a simulation poses to this solver.
  double tolerance() const { return tolerance_; }
  /// @throws std::invalid_argument if it is not in (0, 1)
  void set_tolerance(double tolerance);
  /// Sizes the workspace: problems of up to this many rows are then solved without allocation.
  virtual void reserve(int rows) = 0;
  /// @param[in,out] P  (rows) [N s]; in: warm start, out: solution, or the best P that was found
  virtual SolveReport solve(const ContactProblem& problem, double* P) = 0;
  /// A solver with the same settings and a workspace of its own.
  virtual std::unique_ptr<ContactSolver> clone() const = 0;

 private:
  double tolerance_ = default_tolerance;
};

}  // namespace saltus
