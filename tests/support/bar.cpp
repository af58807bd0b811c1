#include "support/bar.hpp"

#include <cmath>

#include "support/models.hpp"

namespace saltus::test {
namespace {

Eigen::SparseMatrix<double> assembled(int elements, double diagonal, double beside) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < elements; ++k) {
    for (int end : {k, k + 1}) entries.emplace_back(end, end, diagonal);
    entries.emplace_back(k, k + 1, beside);
    entries.emplace_back(k + 1, k, beside);
  }
  Eigen::SparseMatrix<double> A(elements + 1, elements + 1);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

}  // namespace

double Bar::omega() const { return std::sqrt(12.0 * E / rho) * elements / length; }

Eigen::SparseMatrix<double> Bar::mass() const {
  const double sixth = rho * S * length / elements / 6.0;
  return assembled(elements, 2.0 * sixth, sixth);
}

Eigen::SparseMatrix<double> Bar::stiffness() const {
  const double k = E * S * elements / length;
  return assembled(elements, k, -k);
}

NonSmoothDynamicalSystem Bar::model(bool sparse, double damping) const {
  const int n = nodes();
  auto term = [&](const Eigen::SparseMatrix<double>& A) -> LagrangianLinearTIDS::Term {
    if (sparse) return A;
    return Matrix(A);
  };
  LagrangianLinearTIDS::Terms terms{.stiffness = term(stiffness())};
  if (damping > 0.0) terms.damping = term(damping * stiffness());
  const auto bar = std::make_shared<LagrangianLinearTIDS>(Vec::Zero(n), Vec::Constant(n, -speed),
                                                          term(mass()), std::move(terms));
  NonSmoothDynamicalSystem model({bar});
  model.link(linear_contact(Matrix(Vec::Unit(n, 0).transpose()), vec({gap}), NewtonImpactNSL(0.0), "wall"),
             *bar);
  return model;
}

}  // namespace saltus::test
