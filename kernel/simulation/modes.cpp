#include "saltus/kernel/simulation/modes.hpp"

#include <optional>

#include "saltus/kernel/assembly/force_jacobians.hpp"
#include "saltus/numerics/linear/largest_eigenvector.hpp"

namespace saltus {
namespace {

constexpr double symmetry_tolerance = 1e-9;

bool symmetric(const Matrix& A) {
  return (A - A.transpose()).cwiseAbs().maxCoeff() <= symmetry_tolerance * A.cwiseAbs().maxCoeff();
}
bool symmetric(const SparseEntries& A) { return asymmetry(A) <= symmetry_tolerance * largest_entry(A); }

bool any(const Matrix& A) { return A.any(); }
bool any(const SparseEntries& A) { return largest_entry(A) > 0.0; }

// M of a block; of time-invariant systems it does not depend on q
Matrix mass_of(const Layout& layout, const Partition& partition, int block, const Vec& q) {
  Matrix M = Matrix::Zero(partition.sizes[block], partition.sizes[block]);
  for (int k : partition.blocks[block]) {
    const auto& system = layout.systems[k];
    Matrix own = Matrix::Zero(system.n, system.n);
    system.model->mass({q.data() + system.first, system.coordinates}, {own.data(), system.n, system.n});
    M.block(partition.places[k].offset, partition.places[k].offset, system.n, system.n) = own;
  }
  return M;
}

// @param momentum  M φ
int most_moved(const Layout& layout, const Partition& partition, int block, const Vec& momentum,
               const Vec& mode) {
  int most = partition.blocks[block].front();
  double largest = -1.0;
  for (int k : partition.blocks[block]) {
    const int at = partition.places[k].offset, n = layout.systems[k].n;
    const double part = mode.segment(at, n).dot(momentum.segment(at, n));
    if (part > largest) most = k;
    largest = std::max(largest, part);
  }
  return most;
}

// The mode of the largest eigenvalue of (M, A), A being K or C, if it is positive
template <class AnyMatrix>
std::optional<Vec> top_mode(const AnyMatrix& A, const AnyMatrix& M) {
  if (!any(A)) return std::nullopt;
  const Vec mode = largest_eigenvector(A, M);
  if (mode.size() == 0 || !(mode.dot(A * mode) > 0.0)) return std::nullopt;
  return mode;
}

struct Fastest {
  Mode stiffest, most_damped;
};

// Those of one block, if they are faster than what was found before
template <class AnyMatrix>
void note(const Layout& layout, const Partition& partition, int block, const AnyMatrix& M, const AnyMatrix& K,
          const AnyMatrix& C, Fastest& fastest) {
  if (!symmetric(K) || !symmetric(C)) return;
  auto compare = [&](const AnyMatrix& A, double Mode::* size, Mode& largest) {
    const std::optional<Vec> mode = top_mode(A, M);
    if (!mode) return;
    const Mode found{mode->dot(K * *mode), mode->dot(C * *mode),
                     most_moved(layout, partition, block, M * *mode, *mode)};
    if (found.*size > largest.*size) largest = found;
  };
  compare(K, &Mode::stiffness, fastest.stiffest);
  compare(C, &Mode::damping, fastest.most_damped);
}

}  // namespace

std::vector<Mode> fastest_modes(const NonSmoothDynamicalSystem& model) {
  const auto layout = std::make_shared<const Layout>(model);
  ForceJacobians jacobians(layout);
  const Partition& partition = *jacobians.partition();
  const Vec q = model.q0(), v = model.v0();
  Fastest fastest;
  for (int block = 0; block < static_cast<int>(partition.blocks.size()); ++block) {
    if (!jacobians.time_invariant(block)) continue;
    jacobians.evaluate(block, model.t0(), q, v);
    if (jacobians.sparse(block)) {
      const SparseEntries K = -jacobians.sparse_dh_dq(), C = -jacobians.sparse_dh_dv();
      const SparseEntries M = jacobians.sparse_mass(block, Configuration(layout));
      note(*layout, partition, block, M, K, C, fastest);
    } else {
      const Matrix K = -jacobians.dh_dq(), C = -jacobians.dh_dv();
      if (any(K) || any(C))
        note(*layout, partition, block, mass_of(*layout, partition, block, q), K, C, fastest);
    }
  }
  std::vector<Mode> modes;
  if (fastest.stiffest.stiffness > 0.0) modes.push_back(fastest.stiffest);
  if (fastest.most_damped.damping > 0.0) modes.push_back(fastest.most_damped);
  return modes;
}

}  // namespace saltus
