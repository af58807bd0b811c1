#pragma once
#include <memory>
#include <vector>

#include "saltus/kernel/assembly/configuration.hpp"
#include "saltus/numerics/contact_problem.hpp"

namespace saltus {

/// The contact problem of some active contacts: xi = G P + b with G = W(q_c)ᵀ M⁻¹ W(q_f), where the
/// constraint is taken at q_c and the forces act at q_f. G is assembled block by block over the
/// contacts that share a system.
class ContactAssembly {
 public:
  explicit ContactAssembly(std::shared_ptr<const Layout> layout);

  /// Chooses the contacts, in ascending order, and assembles G; b is left to the caller.
  /// @param force    whose W directs the forces
  /// @param inverse  of M at the force's position, or of what takes its place
  void assemble(const std::vector<int>& active, Configuration& constraint, Configuration& force,
                const BlockInverse& inverse);
  const ContactProblem& problem() const { return problem_; }

  /// b <- W(q_c)ᵀ v of the active contacts
  void set_b(Configuration& constraint, const Vec& v);
  /// b <- weight ((dWᵀ/dt) v + Wᵀ a) of the active contacts, (40)
  void set_b_of_acceleration(Configuration& constraint, const Vec& v, const Vec& a, double weight);
  /// b <- b + ε γ, (57). @param gamma (rows of all contacts) [m/s]
  void add_restitution(const Vec& gamma);
  /// v <- v + factor M⁻¹ W(q_f) P. @param P (rows of the active contacts) [N s]
  void apply(double factor, const double* P, Vec& v) const;

  /// Work of impulses that act at the velocity γ, Pᵀ(γ + ½ G P) [J]: where q_c = q_f, exactly the change
  /// of the kinetic energy. @param gamma (rows of all contacts) [m/s]
  double work(const PoolVec& P, const Vec& gamma) const;

  /// Copies between the rows of all contacts and those of the active ones.
  void gather(const Vec& all, double factor, PoolVec& active) const;
  void scatter(const PoolVec& active, double factor, Vec& all) const;

 private:
  void assemble_shared(int system, Configuration& constraint);

  struct Touch {         // one active contact on one system
    int index;           // among the active contacts
    int row;             // in the contact problem
    std::size_t column;  // where the system's columns start in a row of Wᵀ
  };

  std::shared_ptr<const Layout> layout_;
  ContactProblem problem_;
  std::vector<int> active_;
  bool constant_ = false;  // G depends on active_ alone
  std::vector<double> minv_w_;                // rows of (M⁻¹W)ᵀ, placed as the Jacobians are
  std::vector<std::vector<Touch>> touching_;  // per system
  std::vector<int> touched_;                  // systems with a non-empty list
};

}  // namespace saltus
