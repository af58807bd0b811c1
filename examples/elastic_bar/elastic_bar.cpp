#include "elastic_bar/elastic_bar.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "saltus/kernel/model/lagrangian_linear_tids.hpp"

namespace saltus::examples {
namespace {

// The sum over all elements of [diagonal beside; beside diagonal] on their two nodes
Eigen::SparseMatrix<double> assemble(int elements, double diagonal, double beside) {
  Eigen::SparseMatrix<double> A(elements + 1, elements + 1);
  A.reserve(Eigen::VectorXi::Constant(elements + 1, 3));
  for (int i = 0; i <= elements; ++i) {
    if (i > 0) A.insert(i - 1, i) = beside;
    A.insert(i, i) = i == 0 || i == elements ? diagonal : 2.0 * diagonal;
    if (i < elements) A.insert(i + 1, i) = beside;
  }
  A.makeCompressed();
  return A;
}

}  // namespace

NonSmoothDynamicalSystem make_elastic_bar(int elements, double damping, const ElasticBarParameters& p) {
  if (elements < 1)
    throw std::invalid_argument("elements must be at least 1, got " + std::to_string(elements));
  if (!(damping >= 0.0 && std::isfinite(damping)))
    throw std::invalid_argument("damping must be finite and at least 0, got " + std::to_string(damping));
  const int nodes = elements + 1;
  const double m = p.element_mass(elements), k = p.element_stiffness(elements);
  const Eigen::SparseMatrix<double> K = assemble(elements, k, -k);
  LagrangianLinearTIDS::Terms terms{.stiffness = K};
  if (damping > 0.0) terms.damping = Eigen::SparseMatrix<double>(damping * K);
  const auto bar = std::make_shared<LagrangianLinearTIDS>(Vec::Zero(nodes), Vec::Constant(nodes, -p.speed),
                                                          assemble(elements, m / 3.0, m / 6.0), terms);
  NonSmoothDynamicalSystem model({bar});
  Matrix H = Matrix::Zero(1, nodes);
  H(0, 0) = 1.0;
  const auto gap = std::make_shared<LagrangianLinearTIR>(H, Vec::Constant(1, p.gap));
  model.link(std::make_shared<Interaction>(gap, NewtonImpactNSL(0.0), "obstacle"), *bar);
  return model;
}

}  // namespace saltus::examples
