#pragma once
#include <algorithm>
#include <vector>

namespace saltus {

/// A sparse matrix, row by row: of row i the entries start[i]...start[i+1], columns ascending.
struct SparseRows {
  std::vector<int> start = {0};
  std::vector<int> column;
  std::vector<double> value;

  int rows() const { return static_cast<int>(start.size()) - 1; }
  bool empty() const { return rows() == 0; }
  void clear() {
    start.assign(1, 0);
    column.clear();
    value.clear();
  }
  void add(int j, double entry) {
    column.push_back(j);
    value.push_back(entry);
  }
  void end_row() { start.push_back(static_cast<int>(column.size())); }
  /// Values of row i.
  double* row(int i) { return value.data() + start[i]; }
  /// Entry (i, j), zero if it is not stored.
  double at(int i, int j) const {
    const auto from = column.begin() + start[i], to = column.begin() + start[i + 1];
    const auto found = std::lower_bound(from, to, j);
    return found != to && *found == j ? value[found - column.begin()] : 0.0;
  }
};

}  // namespace saltus
