#pragma once
#include <vector>

#include "saltus/kernel/integrators/contact_stage.hpp"

namespace saltus {

/// The contact problem of a half-explicit row where contacts slide in space. Friction that lasts acts against
/// the direction in which a contact slides at the stage of the multiplier,
///   λ_T = −μ λ_N d,   d = γ_T / |γ_T| at that stage,
/// like all other forces of that stage. (70) takes d at the end of the row, which costs schemes all orders
/// above the first where d turns; in the plane d cannot turn. (70) remains where a contact would lose nine
/// tenths of its speed within the row, so that it can stop, and where no such forces are found at once.
class Sliding {
 public:
  /// @param stages  whose multipliers can be in one contact problem
  explicit Sliding(std::shared_ptr<const Layout> layout, int stages = 1);

  void clear();
  /// Adds those of the active contacts that slide at a stage, whose multipliers follow those of stages that
  /// were added before.
  void add(const std::vector<int>& active, Configuration& stage, const Vec& v);
  bool any() const { return !slides_.empty(); }
  /// As ContactStage::solve(), with the law above for those that add() found.
  bool solve(ContactStage& contacts, const ContactProblem& problem, PoolVec& P, StepReport& report);

 private:
  struct Slide {
    int row;  // its first in the contact problem
    int set;  // among the laws
    double mu;
    double speed;  // |γ_T| at the stage [m/s]
    double d[2];
  };
  void reduce(const ContactProblem& problem, const PoolVec& P);
  void expand(PoolVec& P) const;
  bool release_stopping(const ContactProblem& problem, const PoolVec& P);

  std::shared_ptr<const Layout> layout_;
  std::vector<Slide> slides_;
  int rows_ = 0, sets_ = 0;  // of the stages added
  ContactProblem reduced_;   // of these the normal rows alone
  PoolVec reduced_P_;
  std::vector<int> column_;     // of the reduced problem, of each row of the problem
  std::vector<double> factor_;  // P of a row over that of its column
  std::vector<double> gamma_;   // of one contact
};

}  // namespace saltus
