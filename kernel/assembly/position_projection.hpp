#pragma once
#include <memory>
#include <vector>

#include "saltus/kernel/assembly/contact_assembly.hpp"
#include "saltus/numerics/linear/dense_solve.hpp"
#include "saltus/numerics/linear/sparse_solve.hpp"

namespace saltus {

/// Pulls positions back onto constraints from which they have drifted, along the shortest way in the metric
/// of the mass:  q <- q + Y M⁻¹ W (Wᵀ M⁻¹ W)⁺ (−g),  Newton's iteration. Bilateral constraints are pulled to
/// g = 0, unilateral contacts only if they are open: a penetration is what keeps a contact closed, and
/// pulling it out would move the error with which the contact was met.
class PositionProjection {
 public:
  explicit PositionProjection(const std::shared_ptr<const Layout>& layout);

  /// @param held     contacts that may be pulled, in ascending order
  /// @param at       moved to the new position
  /// @param inverse  of M, which is not taken anew while the position moves
  /// @param t        time of the geometry [s]
  /// @param level    where gaps of unilateral contacts are to be (gaps) [m], pulled from above and from
  /// below:
  ///                 for schemes whose closed contacts stay closed at any gap. Without it only open ones are
  void pull(const std::vector<int>& held, Configuration& at, double t, const BlockInverse& inverse,
            const Vec* level = nullptr);

 private:
  void iterate(const std::vector<int>& held, Configuration& at, double t, const BlockInverse& inverse);
  void aim(Configuration& at);
  double take_violated(const std::vector<int>& held, Configuration& at);
  const double* solve();

  std::shared_ptr<const Layout> layout_, gap_rows_;
  const Vec* level_ = nullptr;
  ContactAssembly assembly_;  // of the rows of gaps
  DenseSolve dense_;
  SparseSolve sparse_;  // where there are many gaps
  PoolVec aim_;         // what the gaps are to change by
  std::vector<int> violated_, bilateral_;
  std::vector<unsigned char> pulled_;  // contacts, once they were violated
  Vec q_, rate_, change_;
};

}  // namespace saltus
