#include "saltus/numerics/solvers/one_contact.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "saltus/numerics/solvers/angle_polynomial.hpp"

namespace saltus {
namespace {

// Below this fraction of the terms in it a velocity counts as zero: what the certificate will still accept.
constexpr double rounding = 1e-12;
// Singular values below this fraction of the largest are zero.
constexpr double singular = 1e-11;

// Plane Coulomb contact: stick or slip, each tried in turn.
bool close_in_plane(double mu, const double* G, int stride, const double* c, double* P) {
  const double* T = G + stride;
  const double det = G[0] * T[1] - G[1] * T[0];
  if (det != 0.0) {
    const double normal = (-c[0] * T[1] + G[1] * c[1]) / det;
    const double tangential = (-c[1] * G[0] + T[0] * c[0]) / det;
    if (normal >= 0.0 && std::abs(tangential) <= mu * normal) {
      P[0] = normal;
      P[1] = tangential;
      return true;
    }
  }
  for (const double slip : {mu, -mu}) {
    const double effective = G[0] + slip * G[1];
    if (!(effective > 0.0)) continue;
    const double normal = -c[0] / effective;
    const double xi_T = (T[0] + slip * T[1]) * normal + c[1];
    if (slip * xi_T > 0.0) continue;  // friction must oppose the sliding
    P[0] = normal;
    P[1] = slip * normal;
    return true;
  }
  return false;
}

using Block = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Triple = Eigen::Vector3d;

// One contact in space: the block G and the velocity c without its own impulse.
class ContactInSpace {
 public:
  ContactInSpace(double mu, const double* G, int stride, const double* c)
      : mu_(mu),
        G_(Eigen::Map<const Block, 0, Eigen::OuterStride<>>(G, Eigen::OuterStride<>(stride))),
        c_(c) {}

  bool stick(double* P) const;
  bool slip(double* P) const;

 private:
  AnglePolynomial sideways() const;
  bool take_slip(Direction e, double& least, double* P) const;

  double mu_;
  Block G_;
  Triple c_;
};

// Solution of G x = y, of least norm where G is singular; least squares where there is none
Triple nearest(const Block& G, const Triple& y) {
  const Eigen::PartialPivLU<Block> lu(G);
  const auto pivots = lu.matrixLU().diagonal().cwiseAbs();
  if (pivots.minCoeff() > singular * pivots.maxCoeff()) return lu.solve(y);
  const Eigen::JacobiSVD<Block> svd(G, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Triple sigma = svd.singularValues();
  Triple x = Triple::Zero();
  for (int k = 0; k < 3; ++k)
    if (sigma[k] > singular * sigma[0]) x += svd.matrixV().col(k) * (svd.matrixU().col(k).dot(y) / sigma[k]);
  return x;
}

// G P = -c inside the cone
bool ContactInSpace::stick(double* P) const {
  const Triple x = nearest(G_, -c_);
  if (!(x[0] >= 0.0 && std::hypot(x[1], x[2]) <= mu_ * x[0])) return false;
  const Triple size = G_.cwiseAbs() * x.cwiseAbs() + c_.cwiseAbs();  // least squares may leave a velocity
  if (!((G_ * x + c_).norm() <= singular * size.norm())) return false;
  std::copy_n(x.data(), 3, P);
  return true;
}

// In slip P_T = mu P_N e with a direction e = (cos α, sin α), and xi_N = 0 gives
//   P_N(α) = -c_N / D(α),  D = G_NN + mu G_NT e > 0,
//   xi_T(α) = c_T + (G_TN + mu G_TT e) P_N.
// Friction opposes sliding where xi_T is antiparallel to e, (35): with e' = (-sin α, cos α)
//   f(α) = D e'·xi_T = D e'·c_T - c_N e'·(G_TN + mu G_TT e) = 0  and  e·xi_T <= 0.
// f is a trigonometric polynomial of degree two, so there are at most four such angles.
AnglePolynomial ContactInSpace::sideways() const {
  const double p = G_(0, 0) * c_[1] - c_[0] * G_(1, 0), q = G_(0, 0) * c_[2] - c_[0] * G_(2, 0);
  // mu e'ᵀ A e with A = c_T G_NT - c_N G_TT
  const double a11 = mu_ * (c_[1] * G_(0, 1) - c_[0] * G_(1, 1));
  const double a12 = mu_ * (c_[1] * G_(0, 2) - c_[0] * G_(1, 2));
  const double a21 = mu_ * (c_[2] * G_(0, 1) - c_[0] * G_(2, 1));
  const double a22 = mu_ * (c_[2] * G_(0, 2) - c_[0] * G_(2, 2));
  return {0.5 * (a21 - a12), q, -p, 0.5 * (a21 + a12), 0.5 * (a22 - a11)};
}

// Keeps the slip along e if it satisfies the law with less normal impulse than the least so far
bool ContactInSpace::take_slip(Direction e, double& least, double* P) const {
  const double effective = G_(0, 0) + mu_ * (G_(0, 1) * e.cosine + G_(0, 2) * e.sine);
  if (!(effective > 0.0)) return false;
  const double normal = -c_[0] / effective;
  if (!(normal < least)) return false;
  const Triple impulse = normal * Triple(1.0, mu_ * e.cosine, mu_ * e.sine);
  const Triple xi = G_ * impulse + c_;
  const Triple size = G_.cwiseAbs() * impulse.cwiseAbs() + c_.cwiseAbs();
  const double zero = rounding * size.tail<2>().maxCoeff();
  if (!(std::abs(xi[2] * e.cosine - xi[1] * e.sine) <= zero)) return false;
  if (!(xi[1] * e.cosine + xi[2] * e.sine <= zero)) return false;
  least = normal;
  std::copy_n(impulse.data(), 3, P);
  return true;
}

bool ContactInSpace::slip(double* P) const {
  double least = std::numeric_limits<double>::infinity();
  const Angles angles = candidate_angles(sideways());
  bool found = false;
  for (int k = 0; k < angles.count; ++k) found |= take_slip(angles.directions[k], least, P);
  // Where G has rank one every angle may do: the one that needs the least impulse stands for them.
  const double coupling = std::hypot(G_(0, 1), G_(0, 2));
  if (coupling > 0.0) found |= take_slip({G_(0, 1) / coupling, G_(0, 2) / coupling}, least, P);
  return found;
}

bool close_in_space(double mu, const double* G, int stride, const double* c, double* P) {
  if (mu == 0.0) {
    if (!(G[0] > 0.0)) return false;
    P[0] = -c[0] / G[0];
    P[1] = P[2] = 0.0;
    return true;
  }
  const ContactInSpace contact(mu, G, stride, c);
  return contact.stick(P) || contact.slip(P);
}

}  // namespace

bool solve_one_contact(const ContactSet& set, const double* G, int stride, const double* c, double* P) {
  if (!std::holds_alternative<Equality>(set) && c[0] >= 0.0) {
    std::fill_n(P, rows_of(set), 0.0);
    return true;
  }
  if (const auto* law = std::get_if<Coulomb>(&set))
    return law->dim == 2 ? close_in_plane(law->mu, G, stride, c, P)
                         : close_in_space(law->mu, G, stride, c, P);
  if (!(G[0] > 0.0)) return false;
  P[0] = -c[0] / G[0];
  return true;
}

}  // namespace saltus
