#pragma once
#include <memory>
#include <string>
#include <vector>

#include "saltus/kernel/first_order/first_order_ds.hpp"
#include "saltus/kernel/first_order/first_order_relation.hpp"
#include "saltus/numerics/box_problem.hpp"

namespace saltus {

/// 0 <= y, 0 <= λ, yᵀλ = 0, n rows. @throws std::invalid_argument if n < 1, likewise below
BoxLaws complementarity_laws(int n);
/// −y in the normal cone of [lower, upper] at λ: y > 0 where λ = lower, y < 0 where λ = upper.
/// @throws std::invalid_argument as validate(BoxLaws), also if a bound is infinite
BoxLaws relay_laws(int n, double lower = -1.0, double upper = 1.0);
/// y = 0
BoxLaws equality_laws(int n);
/// y = 0 in the first rows, complementarity in the others. @throws also if both are zero
BoxLaws mixed_complementarity_laws(int equalities, int inequalities);

/// First-order systems, and the relations between them with their laws. The state of the whole is that of the
/// systems, one after the other; y and λ are those of the relations likewise.
class FirstOrderSystem {
 public:
  using Systems = std::vector<std::shared_ptr<const FirstOrderDS>>;
  struct Link {
    std::string name;
    std::shared_ptr<const FirstOrderRelation> relation;
    BoxLaws laws;
    int first = 0;
    int second = -1;  ///< -1: there is none
  };

  /// @param t0  initial time [s]
  /// @throws std::invalid_argument if there is no system, one is missing or stands twice, or t0 is not finite
  explicit FirstOrderSystem(Systems systems, double t0 = 0.0);

  /// Lets a relation act on one or two systems.
  /// @param name  key of its results; if it is empty, "interaction" and a number
  /// @throws std::invalid_argument if a system is not part of this one, both are the same, the name is taken,
  ///         or sizes disagree
  void link(std::shared_ptr<const FirstOrderRelation> relation, BoxLaws laws, const FirstOrderDS& first,
            const FirstOrderDS* second = nullptr, std::string name = "");

  const Systems& systems() const { return systems_; }
  const std::vector<Link>& links() const { return links_; }
  double t0() const { return t0_; }
  /// Number of states, and of entries of y and λ.
  int dimension() const;
  int rows() const;
  Vec x0() const;

 private:
  int index_of(const FirstOrderDS& system) const;

  Systems systems_;
  std::vector<Link> links_;
  double t0_;
};

}  // namespace saltus
