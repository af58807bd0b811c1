#pragma once
#include <memory>
#include <vector>

#include "saltus/kernel/assembly/contact_assembly.hpp"
#include "saltus/numerics/linear/dense_solve.hpp"
#include "saltus/numerics/linear/sparse_solve.hpp"

namespace saltus {

/// What a contact does while the motion is smooth.
enum class ContactMode : unsigned char {
  open,
  bilateral,  ///< all rows are held
  smooth,     ///< closed, no friction
  sticking,   ///< closed, γ_T = 0
  sliding,    ///< closed, λ_T = −μ λ_N d
};

struct ContactState {
  ContactMode mode = ContactMode::open;
  double direction[2] = {1.0, 0.0};  ///< d of one that slides
  double before[2] = {1.0, 0.0};     ///< the same at the start of the step; in the plane it cannot turn
  double gap = 0.0;                  ///< [m] where a closed one is held; where an open one closes
  double mu = 0.0;
  int dim = 1;  ///< rows of normal and tangents

  bool closed() const { return mode != ContactMode::open; }
};

/// The contact problem of contacts whose modes are known: rows that need not vanish are left out, and λ_T of
/// sliding contacts is that of their λ_N, with W_N − μ W_T d in the place of W.
class ModeEquations {
 public:
  explicit ModeEquations(std::shared_ptr<const Layout> layout);

  /// Which rows must vanish.
  enum class Level { position, velocity, acceleration };
  /// @param problem  of these contacts, with G
  /// @param b        (rows of all contacts), in the place of the problem's
  void reduce(Level level, const std::vector<int>& active, const std::vector<ContactState>& contacts,
              const ContactProblem& problem, const Vec& b, double weight);
  /// With the laws of the modes: one that sticks may start to slide, one that is closed may open.
  const ContactProblem& problem() const { return reduced_; }
  PoolVec& P() { return reduced_P_; }
  /// Solves G P + b = 0; of rows that depend on each other the solution of least norm.
  /// @return false if there is none that is finite
  bool solve();
  /// P of all rows of the problem that was reduced
  void expand(PoolVec& P) const;
  /// Row of the reduced problem, -1 if it was left out. @param row  of the problem
  int equation(int row) const { return equation_[row]; }

 private:
  void number(Level level, int row, const Layout::Contact& slot, const ContactState& contact);
  void add_row(const ContactProblem& problem, int row);

  std::shared_ptr<const Layout> layout_;
  ContactProblem reduced_;
  PoolVec reduced_P_;
  DenseSolve dense_;
  SparseSolve sparse_;
  std::vector<int> equation_, column_;  // of each row of the problem
  std::vector<double> factor_;          // P of a row over that of its column
  std::vector<double> line_;            // a row of the reduced G
  int size_ = 0;
};

}  // namespace saltus
