#include "saltus/kernel/model/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>

#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

using Cell = std::array<std::int64_t, 3>;

// Beyond this many cells in one direction, whole numbers and the rounding of coordinates come to their end.
constexpr double most_cells = 1e15;

void require(const Matrix& centres, const Vec& radii, double within) {
  if (centres.cols() < 1 || centres.cols() > 3)
    throw std::invalid_argument("centres must have 1 to 3 columns, got " + std::to_string(centres.cols()));
  if (radii.size() != centres.rows())
    throw std::invalid_argument("radii must have " + std::to_string(centres.rows()) +
                                " entries as centres has rows, got " + std::to_string(radii.size()));
  if (!centres.allFinite() || !radii.allFinite() || !std::isfinite(within))
    throw std::invalid_argument("centres, radii and within must be finite, got NaN or infinity");
  if (radii.size() > 0 && radii.minCoeff() < 0.0)
    throw std::invalid_argument("radii must be >= 0, got " + number(radii.minCoeff()));
}

std::vector<Cell> cells_of(const Matrix& centres, double width) {
  const double farthest = centres.cwiseAbs().maxCoeff();
  width = std::max(1.000001 * width, farthest / most_cells);  // wider than rounding could miss
  std::vector<Cell> cells(centres.rows(), Cell{0, 0, 0});
  if (width <= 0.0) return cells;
  for (Eigen::Index i = 0; i < centres.rows(); ++i)
    for (Eigen::Index k = 0; k < centres.cols(); ++k)
      cells[i][k] = static_cast<std::int64_t>(std::floor(centres(i, k) / width));
  return cells;
}

}  // namespace

std::vector<std::array<int, 2>> neighbours(const Matrix& centres, const Vec& radii, double within) {
  require(centres, radii, within);
  const int n = static_cast<int>(centres.rows());
  std::vector<std::array<int, 2>> pairs;
  if (n < 2) return pairs;
  const std::vector<Cell> cells = cells_of(centres, std::max(0.0, 2.0 * radii.maxCoeff() + within));
  std::vector<int> order(n);
  std::iota(order.begin(), order.end(), 0);
  auto before = [&](int i, int j) { return cells[i] != cells[j] ? cells[i] < cells[j] : i < j; };
  std::sort(order.begin(), order.end(), before);
  auto take_pairs = [&](int i, const Cell& cell) {
    auto next = std::lower_bound(order.begin(), order.end(), cell,
                                 [&](int k, const Cell& wanted) { return cells[k] < wanted; });
    for (; next != order.end() && cells[*next] == cell; ++next) {
      const int j = *next;
      if (j <= i) continue;
      const double distance = (centres.row(i) - centres.row(j)).stableNorm() - radii[i] - radii[j];
      if (distance <= within) pairs.push_back({i, j});
    }
  };
  const int depth = centres.cols() > 2 ? 1 : 0, height = centres.cols() > 1 ? 1 : 0;
  for (int i = 0; i < n; ++i)
    for (int x = -1; x <= 1; ++x)
      for (int y = -height; y <= height; ++y)
        for (int z = -depth; z <= depth; ++z)
          take_pairs(i, {cells[i][0] + x, cells[i][1] + y, cells[i][2] + z});
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace saltus
