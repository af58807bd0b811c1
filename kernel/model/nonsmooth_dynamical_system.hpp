#pragma once
#include <memory>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "saltus/kernel/model/interaction.hpp"
#include "saltus/kernel/model/lagrangian_ds.hpp"

namespace saltus {

/// Dynamical systems and the interactions between them, or with the ground. Positions and velocities
/// of the whole are those of the systems, one after the other.
class NonSmoothDynamicalSystem {
 public:
  /// An interaction and the one or two systems that it acts on.
  struct Link {
    std::shared_ptr<const Interaction> interaction;
    std::string name;
    int first = 0;
    int second = -1;  ///< -1: the ground
  };
  using Systems = std::vector<std::shared_ptr<const LagrangianDS>>;

  /// @param t0  initial time [s]
  /// @throws std::invalid_argument if there is no system, one stands twice, or t0 is not finite
  explicit NonSmoothDynamicalSystem(Systems systems, double t0 = 0.0);

  /// Lets the interaction act between a system and the ground, or between two systems.
  /// Rows of W are ordered as first, second.
  /// @throws std::invalid_argument if a system is not part of this one, both are the same, the name is
  ///         taken, or the relation does not fit the systems' dimensions
  void link(std::shared_ptr<const Interaction> interaction, const LagrangianDS& first,
            const LagrangianDS* second = nullptr);

  const Systems& systems() const { return systems_; }
  const std::vector<Link>& links() const { return links_; }
  double t0() const { return t0_; }
  /// Number of freedoms of all systems.
  int dimension() const;
  /// Initial positions and velocities of all systems, (dimension).
  Vec q0() const;
  Vec v0() const;

 private:
  int index_of(const LagrangianDS& system) const;

  Systems systems_;
  std::unordered_map<const LagrangianDS*, int> index_;
  std::vector<Link> links_;
  std::unordered_set<std::string> names_;
  double t0_;
};

}  // namespace saltus
