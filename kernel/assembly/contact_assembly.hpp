#pragma once
#include <memory>
#include <vector>

#include "saltus/kernel/assembly/configuration.hpp"
#include "saltus/numerics/contact_problem.hpp"

namespace saltus {

/// The contact problem of some active contacts: xi = G P + b with G = W(q_c)ᵀ M⁻¹ W(q_f), where the
/// constraint is taken at q_c and the forces act at q_f. G is assembled block by block over the
/// contacts that share a block of M, or of the matrix that takes its place.
class ContactAssembly {
 public:
  /// @param partition  of that matrix
  /// @param sparse     G is made of sparse rows
  ContactAssembly(std::shared_ptr<const Layout> layout, std::shared_ptr<const Partition> partition,
                  bool sparse = false);

  /// Chooses the contacts, in ascending order, and assembles G; b is left to the caller.
  /// @param force    whose W directs the forces
  /// @param inverse  of M at the force's position, or of what takes its place
  void assemble(const std::vector<int>& active, Configuration& constraint, Configuration& force,
                const BlockInverse& inverse);
  /// G with the constraint taken elsewhere, and the forces that assemble() took.
  void constrain(Configuration& constraint);
  const ContactProblem& problem() const { return problem_; }

  /// b <- W(q_c)ᵀ v of the active contacts
  void set_b(Configuration& constraint, const Vec& v);
  /// b <- weight ((dWᵀ/dt) v + Wᵀ a) of the active contacts, (40)
  void set_b_of_acceleration(Configuration& constraint, const Vec& v, const Vec& a, double weight);
  /// b <- b + ε γ, (57). @param gamma (rows of all contacts) [m/s]
  void add_restitution(const Vec& gamma);
  /// v <- v + factor M⁻¹ W(q_f) P. @param P (rows of the active contacts) [N s]
  void apply(double factor, const double* P, Vec& v) const;

  /// Work of impulses that act at the relative velocity γ, Pᵀ(γ − w + ½ G P) [J]: where q_c = q_f, exactly
  /// the change of the kinetic energy. @param gamma (rows of all contacts) [m/s]
  double work(const PoolVec& P, Configuration& constraint, const Vec& gamma) const;

  /// Copies between the rows of all contacts and those of the active ones.
  void gather(const Vec& all, double factor, PoolVec& active) const;
  void scatter(const PoolVec& active, double factor, Vec& all) const;

 private:
  void place(const Layout::Contact& contact);
  void choose(const std::vector<int>& active);
  void touch(int index, int row);
  void find_neighbours(int index);
  void respond(int contact, const double* W, const BlockInverse& inverse);
  void assemble_shared(int block, Configuration& constraint);

  struct Span {  // a system's freedoms among all
    int offset;
    int n;
  };
  struct Extent {  // where the (M⁻¹W)ᵀ of a contact lies
    std::size_t start;
    int width;                          // freedoms of the blocks that the contact touches
    int blocks;                         // one or two
    int column[2];                      // where the block of each side starts in a row
    std::size_t first_span, last_span;  // the systems of these blocks, in the order of a row
  };
  struct Touch {       // one side of an active contact on one block
    int index;         // among the active contacts
    int row;           // in the contact problem
    int n;             // freedoms of the side's system
    int column;        // where they start in a row of Wᵀ
    int block_column;  // where the block starts in a row of (M⁻¹W)ᵀ
    int offset;        // of the system's freedoms in the block
    bool first;        // side of the contact on this block
  };

  struct Neighbour {  // an active contact that shares a block with another one
    int index;        // among the active contacts
    int column;       // where its entries start in the sparse rows of the other one
  };

  std::shared_ptr<const Layout> layout_;
  std::shared_ptr<const Partition> partition_;
  bool sparse_;
  ContactProblem problem_;
  std::vector<int> active_;
  long made_with_ = 0;               // the revision of the matrix that is in G; 0 if W changes as well
  std::vector<long> answered_with_;  // and of each contact in minv_w_
  std::vector<Span> spans_;
  std::vector<Extent> extents_;               // of each contact
  std::vector<double> minv_w_;                // rows of (M⁻¹W)ᵀ of all contacts
  std::vector<std::vector<Touch>> touching_;  // per block
  std::vector<int> touched_;                  // blocks with a non-empty list
  std::vector<Neighbour> neighbours_;         // of the first active contact, of the second...
  std::vector<int> first_neighbour_;          // of each active contact
  std::vector<int> first_row_;                // of each active contact in the problem
};

}  // namespace saltus
