#pragma once
#include <memory>
#include <vector>

#include "saltus/kernel/assembly/layout.hpp"

namespace saltus {

/// The systems in groups: each group is one block of a matrix that is block diagonal.
struct Partition {
  struct Place {
    int block;   ///< of the system
    int offset;  ///< of its freedoms among those of the block
  };

  std::vector<std::vector<int>> blocks;  ///< systems of each, ascending
  std::vector<int> sizes;                ///< freedoms of each
  std::vector<Place> places;             ///< of each system
};

/// One block a system, as M has them.
std::shared_ptr<const Partition> one_block_a_system(const Layout& layout);

/// Systems that force elements connect share a block, as ∂h/∂q and ∂h/∂v have them.
std::shared_ptr<const Partition> coupled_by_forces(const Layout& layout);

/// The inverse of a matrix that is block diagonal over a partition: of M, or of an implicit scheme's matrix.
class BlockInverse {
 public:
  virtual ~BlockInverse() = default;
  /// x <- A⁻¹ x for one block, x (n of it)
  virtual void solve_block(int block, double* x) const = 0;
  /// A number that is another one after every change of the matrix; 0 if nothing is known about that.
  virtual long revision() const { return 0; }
};

}  // namespace saltus
