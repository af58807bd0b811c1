#pragma once
#include <string_view>
#include <vector>

#include "saltus/kernel/integrators/half_explicit/tableau.hpp"

namespace saltus {

/// Orders of convergence in q and v.
struct TableauOrder {
  int free = 0;         ///< without multipliers
  int constrained = 0;  ///< with those of bilateral constraints, or of contacts that stay closed
  bool operator==(const TableauOrder&) const = default;
};

/// Conditions of higher orders are not looked at.
inline constexpr int highest_order = 6;

/// A condition on the coefficients: a sum over all subscripts must be over / under.
struct OrderCondition {
  /// Such as "Σ b_i a_ij c_j". (ω) is the inverse of (a) with rows 1...s+1 and columns 0...s: ω_ij has a
  /// stage i and a row j, of which s+1 is the output: a_{s+1,k} = b_k, c_{s+1} = 1.
  std::string_view text;
  int order;         ///< of convergence that needs it
  bool constrained;  ///< needed only with multipliers
  double value;      ///< of the sum
  double terms;      ///< sum of the absolute values of its terms
  int over, under;

  /// Within 1e-11 of the terms, as coefficients are rounded, but never beyond 1e-6, whatever the terms.
  bool holds() const;
};

/// All conditions of orders 1...highest_order for a scheme of Appendix B, (B.9)-(B.16), by ascending order.
/// Those with multipliers are left out if some a_{l,l-1} = 0: (ω) does not exist, nor does λ_{l-1}.
/// @throws std::invalid_argument unless Ac = Av = Aq
std::vector<OrderCondition> order_conditions(const Tableau& tableau);

/// Highest orders of which, and below which, all conditions hold; constrained is 0 if some a_{l,l-1} = 0.
/// @throws std::invalid_argument unless Ac = Av = Aq
TableauOrder order_of(const Tableau& tableau);

/// @throws std::invalid_argument if the tableau has not the orders claimed, naming the first condition that
///         does not hold; if an order beyond highest_order is claimed; unless Ac = Av = Aq
void require_order(const Tableau& tableau, TableauOrder claimed);

}  // namespace saltus
