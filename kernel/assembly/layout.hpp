#pragma once
#include <vector>

#include "saltus/kernel/model/nonsmooth_dynamical_system.hpp"

namespace saltus {

/// Where each system and each interaction keeps its numbers. Made once from a model, then constant.
struct Layout {
  struct System {
    const LagrangianDS* model;
    int offset;         ///< of its freedoms in q and v
    int n;              ///< number of them
    std::size_t block;  ///< of its M, row by row, among all blocks of M
    bool constant_mass;
  };
  struct Contact {
    const Relation* relation;
    const NonSmoothLaw* law;
    int sides;      ///< one system or two
    int system[2];  ///< which
    int n;          ///< freedoms of these together
    int row;        ///< of its velocities and forces among all rows
    int rows;
    bool constant_jacobian;
    int gap;  ///< of its gaps among all gaps
    int gaps;
    std::size_t jacobian;  ///< of its Wᵀ (rows, n), row by row, among all
  };

  explicit Layout(const NonSmoothDynamicalSystem& model);

  std::vector<System> systems;
  std::vector<Contact> contacts;
  int n = 0;     ///< freedoms
  int rows = 0;  ///< rows of all contacts
  int gaps = 0;
  int largest_contact = 0;        ///< largest n of a contact
  int most_rows = 0;              ///< largest number of rows of a contact
  bool varying_mass = false;      ///< of some system
  bool varying_jacobian = false;  ///< of some contact
  std::size_t mass_entries = 0;
  std::size_t jacobian_entries = 0;
};

}  // namespace saltus
