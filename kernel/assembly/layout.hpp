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
    int offset;         ///< of its freedoms in v
    int n;              ///< number of them
    int first;          ///< of its coordinates in q
    int coordinates;    ///< number of them
    bool mapped;        ///< q̇ = Y v with a Y that is not the identity
    std::size_t block;  ///< of its M, row by row, among all blocks of dense M
    bool constant_mass;
    const SparseTerms* sparse;  ///< its M, K, C if they are sparse: there is no dense block then
  };
  /// The systems that something acts on.
  struct Sides {
    int sides;        ///< one system or two
    int system[2];    ///< which
    int n;            ///< freedoms of these together
    int coordinates;  ///< likewise
  };
  struct Contact : Sides {
    const Relation* relation;
    const NonSmoothLaw* law;
    int row;  ///< of its velocities and forces among all rows
    int rows;
    bool constant_jacobian;
    bool rheonomous;
    int gap;  ///< of its gaps among all gaps
    int gaps;
    std::size_t jacobian;  ///< of its Wᵀ (rows, n), row by row, among all
  };
  struct Force : Sides {
    const ForceElement* element;
  };

  explicit Layout(const NonSmoothDynamicalSystem& model, double tolerance_of_problems = default_tolerance);

  /// The part of v (n) that belongs to these systems; gathered into `both` if there are two.
  In local(const Sides& part, const Vec& v, double* both) const {
    return gathered(part, v, both, &System::offset, &System::n);
  }
  /// The same of q (coordinates).
  In local_position(const Sides& part, const Vec& q, double* both) const {
    return gathered(part, q, both, &System::first, &System::coordinates);
  }

  std::vector<System> systems;
  std::vector<Contact> contacts;
  std::vector<Force> forces;
  double tolerance;     ///< ContactProblem::tolerance
  int n = 0;            ///< freedoms
  int coordinates = 0;  ///< entries of q
  int rows = 0;         ///< rows of all contacts
  int gaps = 0;
  int largest_contact = 0;        ///< most freedoms or coordinates of a contact
  int largest_force = 0;          ///< most freedoms or coordinates of a force element
  int most_rows = 0;              ///< largest number of rows of a contact
  bool varying_mass = false;      ///< of some system
  bool varying_jacobian = false;  ///< of some contact
  bool mapped = false;            ///< some system
  bool rheonomous = false;        ///< some contact
  std::size_t mass_entries = 0;
  std::size_t jacobian_entries = 0;

 private:
  In gathered(const Sides& part, const Vec& x, double* both, int System::* start, int System::* size) const {
    const System& first = systems[part.system[0]];
    if (part.sides == 1) return {x.data() + first.*start, first.*size};
    const System& second = systems[part.system[1]];
    std::copy_n(x.data() + first.*start, first.*size, both);
    std::copy_n(x.data() + second.*start, second.*size, both + first.*size);
    return {both, first.*size + second.*size};
  }
  Sides sides(const NonSmoothDynamicalSystem::Ends& ends) const;
};

}  // namespace saltus
