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
  explicit Sliding(std::shared_ptr<const Layout> layout);

  /// Finds those of the active contacts that slide at a stage. @return true if there are any
  bool find(const std::vector<int>& active, Configuration& stage, const Vec& v);
  /// As ContactStage::solve(), with the law above for those that find() found.
  bool solve(ContactStage& contacts, StepReport& report);

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
  ContactProblem reduced_;  // of these the normal rows alone
  PoolVec reduced_P_;
  std::vector<int> column_;     // of the reduced problem, of each row of the problem
  std::vector<double> factor_;  // P of a row over that of its column
  std::vector<double> gamma_;   // of one contact
};

}  // namespace saltus
