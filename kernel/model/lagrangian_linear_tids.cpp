#include "saltus/kernel/model/lagrangian_linear_tids.hpp"

#include <Eigen/Eigenvalues>
#include <cstdio>
#include <stdexcept>

namespace saltus {
namespace {

// Larger than rounding in any assembly of M, smaller than any forgotten term.
constexpr double symmetry_tolerance = 1e-9;

std::string shape(const Matrix& A) {
  return "(" + std::to_string(A.rows()) + ", " + std::to_string(A.cols()) + ")";
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

void require_square(const std::optional<Matrix>& A, int n, const char* what) {
  if (!A) return;
  if (A->rows() != n || A->cols() != n)
    throw std::invalid_argument(std::string(what) + " must be (" + std::to_string(n) + ", " +
                                std::to_string(n) + ") as q0 has " + std::to_string(n) + " entries, got " +
                                shape(*A));
  if (!A->allFinite())
    throw std::invalid_argument(std::string(what) + " must be finite, got NaN or infinity");
}

}  // namespace

void require_mass(const Matrix& M, int n, const std::string& what) {
  require_square(M, n, what.c_str());
  const double asymmetry = (M - M.transpose()).cwiseAbs().maxCoeff();
  if (asymmetry > symmetry_tolerance * M.cwiseAbs().maxCoeff())
    throw std::invalid_argument(what + " must be symmetric, got entries that differ by " + number(asymmetry));
  const double lowest = Eigen::SelfAdjointEigenSolver<Matrix>(M, Eigen::EigenvaluesOnly).eigenvalues()[0];
  const double highest = M.cwiseAbs().maxCoeff();
  if (!(lowest > 1e-15 * highest))
    throw std::invalid_argument(what + " must be positive definite, its smallest eigenvalue is " +
                                number(lowest));
}

LagrangianLinearTIDS::LagrangianLinearTIDS(Vec q0, Vec v0, Matrix mass, Terms terms)
    : LagrangianDS(std::move(q0), std::move(v0)), mass_(std::move(mass)), terms_(std::move(terms)) {
  const int n = dimension();
  require_mass(mass_, n, "mass");
  require_square(terms_.stiffness, n, "stiffness");
  require_square(terms_.damping, n, "damping");
  if (!terms_.external_force) return;
  if (terms_.external_force->size() != n)
    throw std::invalid_argument("external_force must have " + std::to_string(n) + " entries as q0 has, got " +
                                std::to_string(terms_.external_force->size()));
  if (!terms_.external_force->allFinite())
    throw std::invalid_argument("external_force must be finite, got NaN or infinity");
}

void LagrangianLinearTIDS::mass(const In&, OutMatrix M) const { M = mass_; }

void LagrangianLinearTIDS::forces(double, const In& q, const In& v, Out h) const {
  if (terms_.external_force) h = *terms_.external_force;
  if (terms_.stiffness) h.noalias() -= *terms_.stiffness * q;
  if (terms_.damping) h.noalias() -= *terms_.damping * v;
}

double LagrangianLinearTIDS::potential_energy(const In& q) const {
  double energy = 0.0;
  if (terms_.external_force) energy -= terms_.external_force->dot(q);
  if (terms_.stiffness) energy += 0.5 * q.dot(*terms_.stiffness * q);
  return energy;
}

}  // namespace saltus
