#include "saltus/kernel/integrators/d_minus/coefficients.hpp"

#include <cmath>
#include <vector>

namespace saltus {
namespace {

using Points = std::vector<long double>;

Points points_of(int s, StagePoints points) {
  if (s == 1) return {0.0L, 1.0L};
  if (s == 2) return {0.0L, 0.5L, 1.0L};
  if (points == StagePoints::chebyshev) return {0.0L, 0.25L, 0.75L, 1.0L};
  const long double inner = 0.5L - 0.5L / std::sqrt(5.0L);
  return {0.0L, inner, 1.0L - inner, 1.0L};
}

// ∫ of the k-th Lagrange polynomial (B.6), (B.8) of the first n points from 0 to x
long double integral(const Points& c, int n, int k, long double x) {
  Points polynomial = {1.0L};  // coefficients, the constant first
  for (int j = 0; j < n; ++j) {
    if (j == k) continue;
    polynomial.push_back(0.0L);
    for (std::size_t i = polynomial.size(); i-- > 0;)
      polynomial[i] = ((i > 0 ? polynomial[i - 1] : 0.0L) - c[j] * polynomial[i]) / (c[k] - c[j]);
  }
  long double sum = 0.0L;
  for (std::size_t i = polynomial.size(); i-- > 0;) sum = x * (sum + polynomial[i] / (i + 1));
  return sum;
}

}  // namespace

Tableau d_minus_tableau(int s, StagePoints points) {
  const Points c = points_of(s, points);
  const int n = s + 1;
  Tableau tableau{"D-minus", Matrix(n, n), Matrix::Zero(n, n), Matrix(n, n), Vec(n), true};
  for (int l = 1; l <= n; ++l) {
    const long double end = l <= s ? c[l] : 1.0L;
    for (int k = 0; k < n; ++k) {
      tableau.c[k] = static_cast<double>(c[k]);
      tableau.Aq(l - 1, k) = static_cast<double>(integral(c, n, k, end));                       // (B.5)
      if (l <= s && k < s) tableau.Av(l - 1, k) = static_cast<double>(integral(c, s, k, end));  // (B.7)
    }
  }
  tableau.Av.row(s) = tableau.Aq.row(s);
  tableau.Ac = tableau.Aq;
  return tableau;
}

}  // namespace saltus
