#include <cmath>
#include <numbers>
#include <stdexcept>

#include "rotor/rotor.hpp"
#include "saltus/numerics/text.hpp"

namespace saltus::examples {
namespace {

constexpr int of_node = 5;  // α, w, w', u, u'
constexpr int of_element = AxleElement::freedoms;
using Block = Eigen::Map<const Eigen::Matrix<double, of_element, of_element, Eigen::RowMajor>>;

void require(bool sound, const char* what, double value) {
  if (!sound) throw std::invalid_argument(std::string(what) + ", got " + number(value));
}

}  // namespace

void AxleParameters::require_sound() const {
  if (elements < 1)
    throw std::invalid_argument("elements must be at least 1, got " + std::to_string(elements));
  for (double value : {length, radius, density, E, G})
    require(value > 0.0 && std::isfinite(value), "lengths, density and moduli must be positive and finite",
            value);
  for (double value : {mass_damping, torsional_damping, mount_stiffness, mount_damping})
    require(value >= 0.0 && std::isfinite(value), "stiffness and damping must be finite and not negative",
            value);
  for (double value : {drive_torque, fault_torque, gravity, drive_until})
    require(std::isfinite(value), "torques, gravity and drive_until must be finite", value);
}

AxleElement AxleParameters::element() const {
  const double A = std::numbers::pi * radius * radius, I = 0.25 * A * radius * radius;
  return {length / elements, density * A,           density * 2 * I, E * I,
          G * 2 * I,         density * A * gravity, mass_damping,    torsional_damping};
}

Axle::Axle(Vec q0, Vec v0, const AxleParameters& parameters)
    : LagrangianDS(std::move(q0), std::move(v0)), p_(parameters) {
  p_.require_sound();
  element_ = p_.element();
  if (dimension() != of_node * (p_.elements + 1))
    throw std::invalid_argument("an axle of " + std::to_string(p_.elements) + " elements has " +
                                std::to_string(of_node * (p_.elements + 1)) + " freedoms, got " +
                                std::to_string(dimension()));
}

Station Axle::station(double s) const {
  require(s >= 0.0 && s <= p_.length, "a station must lie on the axle, from 0 to its length", s);
  const double l = element_.l;
  const int k = std::min(static_cast<int>(s / l), p_.elements - 1);
  const double x = s / l - k, y = 1.0 - x;
  return {of_node * k,
          s,
          {y, x},
          {y * y * (1.0 + 2.0 * x), l * x * y * y, x * x * (3.0 - 2.0 * x), -l * x * x * y},
          {-6.0 * x * y / l, y * (1.0 - 3.0 * x), 6.0 * x * y / l, x * (3.0 * x - 2.0)}};
}

Section::Section(const Station& at, const double* q) {
  const double* e = q + at.first;
  const auto sum = [](const double* shape, const double* u1, const double* u2) {
    return shape[0] * u1[0] + shape[1] * u1[1] + shape[2] * u2[0] + shape[3] * u2[1];
  };
  const double alpha = at.linear[0] * e[0] + at.linear[1] * e[of_node];
  y = Vec3(0.0, std::cos(alpha), std::sin(alpha));
  z = Vec3(0.0, -std::sin(alpha), std::cos(alpha));
  x = at.s * Vec3::UnitX() + sum(at.cubic, e + 1, e + 6) * y + sum(at.cubic, e + 3, e + 8) * z;
  tangent = Vec3::UnitX() + sum(at.slope, e + 1, e + 6) * y + sum(at.slope, e + 3, e + 8) * z;
}

void Axle::mass(const In& q, OutMatrix M) const {
  double local[of_element * of_element];
  for (int k = 0; k < p_.elements; ++k) {
    const int i = of_node * k;
    element_mass(element_, q.data() + i, local);
    M.block<of_element, of_element>(i, i) += Block(local);
  }
}

void Axle::forces(double t, const In& q, const In& v, Out h) const {
  double local[of_element];
  for (int k = 0; k < p_.elements; ++k) {
    const int i = of_node * k;
    element_forces(element_, q.data() + i, v.data() + i, local);
    h.segment<of_element>(i) += Eigen::Map<const Eigen::Matrix<double, of_element, 1>>(local);
  }
  add_end_forces(t, q, v, h);
}

// Of the mount −c x − d ẋ, with ẋ = (ẇ − α̇u) e_y' + (u̇ + α̇w) e_z', and of the torques.
void Axle::add_end_forces(double t, const In& q, const In& v, Out h) const {
  const Eigen::Index end = of_node * p_.elements;
  const double alpha = q[end], w = q[end + 1], u = q[end + 3], turning = v[end];
  const double along_y = p_.mount_damping * (v[end + 1] - turning * u);
  const double along_z = p_.mount_damping * (v[end + 3] + turning * w);
  h[end] += u * along_y - w * along_z;
  h[end + 1] -= p_.mount_stiffness * w + along_y;
  h[end + 3] -= p_.mount_stiffness * u + along_z;
  if (t < p_.drive_until) h[end] += p_.drive_torque;
  // The section turns with ω = −u̇' e_y' + ẇ' e_z' + α̇ e_x.
  h[end + 2] -= p_.fault_torque * std::cos(alpha);
  h[end + 4] += p_.fault_torque * std::sin(alpha);
}

bool Axle::force_jacobians(double, const In& q, const In& v, OutMatrix dh_dq, OutMatrix dh_dv) const {
  double by_q[of_element * of_element], by_v[of_element * of_element];
  for (int k = 0; k < p_.elements; ++k) {
    const int i = of_node * k;
    element_force_jacobians(element_, q.data() + i, v.data() + i, by_q, by_v);
    dh_dq.block<of_element, of_element>(i, i) += Block(by_q);
    dh_dv.block<of_element, of_element>(i, i) += Block(by_v);
  }
  const Eigen::Index end = of_node * p_.elements;
  const double c = p_.mount_stiffness, d = p_.mount_damping;
  const double alpha = q[end], w = q[end + 1], u = q[end + 3], turning = v[end];
  // of α, w and u; then of the slopes, which the fault torque bends
  dh_dq(end, end + 1) -= d * (v[end + 3] + 2.0 * turning * w);
  dh_dq(end, end + 3) += d * (v[end + 1] - 2.0 * turning * u);
  dh_dq(end + 1, end + 1) -= c;
  dh_dq(end + 1, end + 3) += d * turning;
  dh_dq(end + 3, end + 1) -= d * turning;
  dh_dq(end + 3, end + 3) -= c;
  dh_dq(end + 2, end) += p_.fault_torque * std::sin(alpha);
  dh_dq(end + 4, end) += p_.fault_torque * std::cos(alpha);
  dh_dv(end, end) -= d * (w * w + u * u);
  dh_dv(end, end + 1) += d * u;
  dh_dv(end, end + 3) -= d * w;
  dh_dv(end + 1, end) += d * u;
  dh_dv(end + 1, end + 1) -= d;
  dh_dv(end + 3, end) -= d * w;
  dh_dv(end + 3, end + 3) -= d;
  return true;
}

double Axle::potential_energy(const In& q) const {
  const Eigen::Index end = of_node * p_.elements;
  double V = 0.5 * p_.mount_stiffness * (q[end + 1] * q[end + 1] + q[end + 3] * q[end + 3]);
  for (int k = 0; k < p_.elements; ++k) V += element_potential(element_, q.data() + of_node * k);
  return V;
}

}  // namespace saltus::examples
