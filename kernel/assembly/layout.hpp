#pragma once
#include <algorithm>
#include <vector>

#include "saltus/kernel/model/nonsmooth_dynamical_system.hpp"
#include "saltus/numerics/contact_problem.hpp"

namespace saltus {

/// Where each system, each interaction and each force element keeps its numbers. Made once from a model, then
/// constant.
struct Layout {
  struct System {
    const LagrangianDS* model;
    int offset;         ///< of its freedoms in q and v
    int n;              ///< number of them
    std::size_t block;  ///< of its M, row by row, among all blocks of dense M
    bool constant_mass;
    const SparseTerms* sparse;  ///< its M, K, C if they are sparse: there is no dense block then
  };
  /// The systems that something acts on.
  struct Sides {
    int sides;      ///< one system or two
    int system[2];  ///< which
    int n;          ///< freedoms of these together
  };
  struct Contact : Sides {
    const Relation* relation;
    const NonSmoothLaw* law;
    int row;  ///< of its velocities and forces among all rows
    int rows;
    bool constant_jacobian;
    int gap;  ///< of its gaps among all gaps
    int gaps;
    std::size_t jacobian;  ///< of its Wᵀ (rows, n), row by row, among all
  };
  struct Force : Sides {
    const ForceElement* element;
  };

  explicit Layout(const NonSmoothDynamicalSystem& model, double tolerance_of_problems = default_tolerance);

  /// The part of x (n) that belongs to these systems; gathered into `both` if there are two.
  In local(const Sides& part, const Vec& x, double* both) const {
    const System& first = systems[part.system[0]];
    if (part.sides == 1) return {x.data() + first.offset, first.n};
    const System& second = systems[part.system[1]];
    std::copy_n(x.data() + first.offset, first.n, both);
    std::copy_n(x.data() + second.offset, second.n, both + first.n);
    return {both, part.n};
  }

  std::vector<System> systems;
  std::vector<Contact> contacts;
  std::vector<Force> forces;
  double tolerance;  ///< ContactProblem::tolerance
  int n = 0;         ///< freedoms
  int rows = 0;      ///< rows of all contacts
  int gaps = 0;
  int largest_contact = 0;        ///< largest n of a contact
  int largest_force = 0;          ///< largest n of a force element
  int most_rows = 0;              ///< largest number of rows of a contact
  bool varying_mass = false;      ///< of some system
  bool varying_jacobian = false;  ///< of some contact
  std::size_t mass_entries = 0;
  std::size_t jacobian_entries = 0;

 private:
  Sides sides(const NonSmoothDynamicalSystem::Ends& ends) const;
};

}  // namespace saltus
