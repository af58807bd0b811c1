#include "saltus/numerics/linear/sparse_matrix.hpp"

#include <algorithm>
#include <cmath>

namespace saltus {
namespace {

constexpr int rows_at_a_time = 512;  // the part of y that all diagonals add to stays in the fastest cache
constexpr int most_zeros = 2;        // diagonals may have as many entries as this times those of the matrix

}  // namespace

double asymmetry(const SparseEntries& A) {
  return largest_entry(SparseEntries(A - SparseEntries(A.transpose())));
}

double largest_entry(const SparseEntries& A) {
  double largest = 0.0;
  for (int i = 0; i < A.outerSize(); ++i)
    for (SparseEntries::InnerIterator entry(A, i); entry; ++entry)
      largest = std::max(largest, std::abs(entry.value()));
  return largest;
}

SparseMatrix::SparseMatrix(SparseEntries entries) : entries_(std::move(entries)) {
  entries_.prune([](Eigen::Index, Eigen::Index, double value) { return value != 0.0; });
  take_diagonals();
}

void SparseMatrix::take_diagonals() {
  const Eigen::Index n = entries_.rows();
  const auto limit =
      static_cast<std::size_t>(most_zeros * entries_.nonZeros() / std::max<Eigen::Index>(n, 1));
  std::vector<int> offsets;
  for (int i = 0; i < n; ++i) {
    for (SparseEntries::InnerIterator entry(entries_, i); entry; ++entry) {
      const int offset = static_cast<int>(entry.col()) - i;
      const auto place = std::lower_bound(offsets.begin(), offsets.end(), offset);
      if (place == offsets.end() || *place != offset) offsets.insert(place, offset);
    }
    if (offsets.size() > limit) return;
  }
  offsets_ = std::move(offsets);
  values_.assign(offsets_.size() * n, 0.0);
  for (int i = 0; i < n; ++i) {
    for (SparseEntries::InnerIterator entry(entries_, i); entry; ++entry) {
      const int offset = static_cast<int>(entry.col()) - i;
      const auto diagonal = std::lower_bound(offsets_.begin(), offsets_.end(), offset) - offsets_.begin();
      values_[diagonal * n + i] = entry.value();
    }
  }
}

void SparseMatrix::add_product(double factor, const double* x, double* y) const {
  const int n = static_cast<int>(entries_.rows());
  for (int i = 0; i < n; i += rows_at_a_time) add_rows(i, std::min(i + rows_at_a_time, n), factor, x, y + i);
}

double SparseMatrix::form(const double* x) const {
  const int n = static_cast<int>(entries_.rows());
  double product[rows_at_a_time], sum = 0.0;
  for (int i = 0; i < n; i += rows_at_a_time) {
    const int rows = std::min(rows_at_a_time, n - i);
    std::fill_n(product, rows, 0.0);
    add_rows(i, i + rows, 1.0, x, product);
    sum += In(x + i, rows).dot(In(product, rows));
  }
  return sum;
}

// y (end - begin) <- y + factor A x in some rows
void SparseMatrix::add_rows(int begin, int end, double factor, const double* x, double* y) const {
  if (by_diagonals()) {
    const int n = static_cast<int>(entries_.rows());
    const double* values = values_.data();
    for (const int offset : offsets_) {
      const int first = std::max(begin, -offset), last = std::min(end, n - offset);
      const double* ahead = x + offset;
      for (int i = first; i < last; ++i) y[i - begin] += factor * values[i] * ahead[i];
      values += n;
    }
    return;
  }
  const int* start = entries_.outerIndexPtr();
  const int* column = entries_.innerIndexPtr();
  const double* value = entries_.valuePtr();
  for (int i = begin; i < end; ++i) {
    double sum = 0.0;
    for (int k = start[i]; k < start[i + 1]; ++k) sum += value[k] * x[column[k]];
    y[i - begin] += factor * sum;
  }
}

}  // namespace saltus
