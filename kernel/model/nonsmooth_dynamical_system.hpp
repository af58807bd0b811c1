#pragma once
#include <memory>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "saltus/kernel/model/force_element.hpp"
#include "saltus/kernel/model/interaction.hpp"
#include "saltus/kernel/model/lagrangian_ds.hpp"

namespace saltus {

/// Dynamical systems, the interactions and the force elements between them, or with the ground. Positions and
/// velocities of the whole are those of the systems, one after the other.
class NonSmoothDynamicalSystem {
 public:
  /// The one or two systems that something acts on, and its name.
  struct Ends {
    std::string name;
    int first = 0;
    int second = -1;  ///< -1: the ground
  };
  struct Link : Ends {
    std::shared_ptr<const Interaction> interaction;
  };
  struct Force : Ends {
    std::shared_ptr<const ForceElement> element;
  };
  using Systems = std::vector<std::shared_ptr<const LagrangianDS>>;

  /// @param t0  initial time [s]
  /// @throws std::invalid_argument if there is no system, one stands twice, q0 and v0 of one differ in size
  ///         though it has no velocity map, or t0 is not finite
  explicit NonSmoothDynamicalSystem(Systems systems, double t0 = 0.0);

  /// Lets the interaction act between a system and the ground, or between two systems.
  /// Rows of W are ordered as first, second.
  /// @throws std::invalid_argument if a system is not part of this one, both are the same, the name is
  ///         taken, or the relation does not fit the systems' dimensions
  void link(std::shared_ptr<const Interaction> interaction, const LagrangianDS& first,
            const LagrangianDS* second = nullptr);

  /// Lets the force element act between a system and the ground, or between two systems. Freedoms are ordered
  /// as first, second.
  /// @throws std::invalid_argument as link()
  void add_force(std::shared_ptr<const ForceElement> element, const LagrangianDS& first,
                 const LagrangianDS* second = nullptr);

  const Systems& systems() const { return systems_; }
  const std::vector<Link>& links() const { return links_; }
  const std::vector<Force>& forces() const { return forces_; }
  double t0() const { return t0_; }
  /// Number of freedoms of all systems, the entries of v; and of coordinates, those of q.
  int dimension() const;
  int coordinates() const;
  /// Initial positions (coordinates) and velocities (dimension) of all systems.
  Vec q0() const;
  Vec v0() const;

 private:
  int index_of(const LagrangianDS& system) const;
  Ends connect(const std::string& kind, const std::string& name, const Relation& relation,
               const LagrangianDS& first, const LagrangianDS* second);
  std::string free_name(const std::string& stem, std::size_t number) const;

  Systems systems_;
  std::unordered_map<const LagrangianDS*, int> index_;
  std::vector<Link> links_;
  std::vector<Force> forces_;
  std::unordered_set<std::string> names_;
  double t0_;
};

}  // namespace saltus
