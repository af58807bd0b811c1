#pragma once
#include <algorithm>
#include <span>
#include <stdexcept>
#include <vector>

#include "saltus/numerics/pool.hpp"

namespace saltus {

/// Writes what a scheme carries from step to step, one number after the other. A scheme names it once, for
/// this and for MemoryReader: `memory(t_, q_, closed_)`.
class MemoryWriter {
 public:
  std::vector<double> values;

  template <typename... Items>
  void operator()(const Items&... items) {
    (put(items), ...);
  }

 private:
  void put(double x) { values.push_back(x); }
  template <typename T>
  void put(const std::vector<T>& list) {
    values.push_back(static_cast<double>(list.size()));
    values.insert(values.end(), list.begin(), list.end());
  }
  void put(const Vec& x) { values.insert(values.end(), x.data(), x.data() + x.size()); }
  template <std::size_t n>
  void put(const double (&x)[n]) {
    values.insert(values.end(), x, x + n);
  }
};

/// Reads it again into what has the sizes of the model.
class MemoryReader {
 public:
  explicit MemoryReader(std::span<const double> values) : values_(values) {}

  template <typename... Items>
  void operator()(Items&... items) {
    (take(items), ...);
  }
  /// @throws std::invalid_argument unless all was read
  void finish() const {
    if (!values_.empty()) refuse();
  }

 private:
  std::span<const double> next(std::size_t n) {
    if (n > values_.size()) refuse();
    const auto head = values_.first(n);
    values_ = values_.subspan(n);
    return head;
  }
  template <typename T>
  void take(T& x) {
    x = static_cast<T>(next(1)[0]);
  }
  template <typename T>
  void take(std::vector<T>& list) {
    const double size = next(1)[0];
    if (!(size >= 0.0 && size <= static_cast<double>(values_.size()))) refuse();
    const auto numbers = next(static_cast<std::size_t>(size));
    list.resize(numbers.size());
    std::transform(numbers.begin(), numbers.end(), list.begin(), [](double x) { return static_cast<T>(x); });
  }
  void take(Vec& x) {
    const auto numbers = next(static_cast<std::size_t>(x.size()));
    std::copy(numbers.begin(), numbers.end(), x.data());
  }
  template <std::size_t n>
  void take(double (&x)[n]) {
    const auto numbers = next(n);
    std::copy(numbers.begin(), numbers.end(), x);
  }
  [[noreturn]] static void refuse() {
    throw std::invalid_argument(
        "the memory of a scheme must be that of the same scheme and model, got another");
  }

  std::span<const double> values_;
};

}  // namespace saltus
