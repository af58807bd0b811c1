#include "saltus/kernel/model/plugged_models.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "saltus/kernel/model/requirements.hpp"

namespace saltus {
namespace {

using Columns = Eigen::Map<const Eigen::MatrixXd>;  // column by column

// Where functions write to; a model may be shared by simulations in several threads.
double* zeros(Eigen::Index size) {
  thread_local std::vector<double> values;
  values.assign(size, 0.0);
  return values.data();
}

// A copy: functions may write into z, models are constant.
double* copy_of(const Vec& z) {
  thread_local std::vector<double> values;
  values.assign(z.data(), z.data() + z.size());
  return values.data();
}

double* one_zero() {
  thread_local double z;
  z = 0.0;
  return &z;
}

void require_terms(const PluggedDS::Terms& terms, int n) {
  if (static_cast<bool>(terms.mass) == terms.constant_mass.has_value())
    throw std::invalid_argument(std::string("mass must be a function or constant, got ") +
                                (terms.mass ? "both" : "none"));
  if (terms.constant_mass) require_mass(*terms.constant_mass, n, "mass");
  if (terms.stiffness) require_square(*terms.stiffness, n, "stiffness");
  if (terms.damping) require_square(*terms.damping, n, "damping");
  if (terms.constant_force && (terms.constant_force->size() != n || !terms.constant_force->allFinite()))
    throw std::invalid_argument("constant_force must have " + std::to_string(n) + " finite entries, got " +
                                std::to_string(terms.constant_force->size()));
  if (terms.z.size() < 1 || !terms.z.allFinite())
    throw std::invalid_argument("z must have at least one entry and be finite, got " +
                                std::to_string(terms.z.size()) + " entries");
}

void require_functions(bool all, const char* which) {
  if (!all)
    throw std::invalid_argument(std::string("a relation needs the functions ") + which + ", got none");
}

void require_no_velocity_map(int coordinates, int freedoms) {
  if (coordinates != freedoms)
    throw std::invalid_argument(
        "the functions of a relation take systems with as many coordinates as freedoms, got " +
        std::to_string(coordinates) + " and " + std::to_string(freedoms));
}

}  // namespace

PluggedDS::PluggedDS(Vec q0, Vec v0, Terms terms)
    : LagrangianDS(std::move(q0), std::move(v0)), terms_(std::move(terms)) {
  require_terms(terms_, dimension());
}

void PluggedDS::mass(const In& q, OutMatrix M) const {
  if (terms_.constant_mass) {
    M = *terms_.constant_mass;
    return;
  }
  double* out = zeros(M.size());
  terms_.mass.call(dimension(), q.data(), out, static_cast<unsigned>(terms_.z.size()), copy_of(terms_.z));
  M = Columns(out, M.rows(), M.cols());
}

void PluggedDS::forces(double t, const In& q, const In& v, Out h) const {
  const int n = dimension();
  const auto size_z = static_cast<unsigned>(terms_.z.size());
  if (terms_.constant_force) h += *terms_.constant_force;
  if (terms_.external_force) {
    double* out = zeros(n);
    terms_.external_force.call(t, n, out, size_z, copy_of(terms_.z));
    h += In(out, n);
  }
  if (terms_.internal_force) {
    double* out = zeros(n);
    terms_.internal_force.call(t, n, q.data(), v.data(), out, size_z, copy_of(terms_.z));
    h -= In(out, n);
  }
  if (terms_.gyroscopic_force) {
    double* out = zeros(n);
    terms_.gyroscopic_force.call(n, q.data(), v.data(), out, size_z, copy_of(terms_.z));
    h -= In(out, n);
  }
  if (terms_.stiffness) h.noalias() -= *terms_.stiffness * q;
  if (terms_.damping) h.noalias() -= *terms_.damping * v;
}

bool PluggedDS::force_jacobians(double t, const In& q, const In& v, OutMatrix dh_dq, OutMatrix dh_dv) const {
  const bool internal = terms_.internal_dq && terms_.internal_dv;
  const bool gyroscopic = terms_.gyroscopic_dq && terms_.gyroscopic_dv;
  if ((terms_.internal_force && !internal) || (terms_.gyroscopic_force && !gyroscopic)) return false;
  const int n = dimension();
  const auto size_z = static_cast<unsigned>(terms_.z.size());
  if (terms_.internal_force)
    for (auto [function, to] :
         {std::pair(terms_.internal_dq.call, &dh_dq), {terms_.internal_dv.call, &dh_dv}}) {
      double* out = zeros(to->size());
      function(t, n, q.data(), v.data(), out, size_z, copy_of(terms_.z));
      *to -= Columns(out, n, n);
    }
  if (terms_.gyroscopic_force)
    for (auto [function, to] :
         {std::pair(terms_.gyroscopic_dq.call, &dh_dq), {terms_.gyroscopic_dv.call, &dh_dv}}) {
      double* out = zeros(to->size());
      function(n, q.data(), v.data(), out, size_z, copy_of(terms_.z));
      *to -= Columns(out, n, n);
    }
  if (terms_.stiffness) dh_dq -= *terms_.stiffness;
  if (terms_.damping) dh_dv -= *terms_.damping;
  return true;
}

bool PluggedDS::time_invariant() const {
  return constant_mass() && !terms_.internal_force && !terms_.gyroscopic_force;
}

PluggedRelation::PluggedRelation(int size, PluggedFunction<OfPosition> h,
                                 PluggedFunction<OfPosition> jacobian, PluggedFunction<OfState> rate)
    : Relation(size), h_(std::move(h)), jacobian_(std::move(jacobian)), rate_(std::move(rate)) {
  require_functions(h_ && jacobian_, "h and H");
}

void PluggedRelation::require_dimensions(int coordinates, int freedoms) const {
  require_no_velocity_map(coordinates, freedoms);
}

void PluggedRelation::gap(const In& q, Out g) const {
  double* y = zeros(size());
  h_.call(static_cast<unsigned>(q.size()), q.data(), size(), y, 1, one_zero());
  std::copy_n(y, g.size(), g.data());
}

void PluggedRelation::jacobian(const In& q, OutMatrix J) const {
  double* out = zeros(J.size());
  jacobian_.call(static_cast<unsigned>(q.size()), q.data(), size(), out, 1, one_zero());
  J = Columns(out, J.rows(), J.cols());
}

void PluggedRelation::curvature(const In& q, const In& v, Out c) const {
  if (!rate_) return Relation::curvature(q, v, c);
  const auto n = static_cast<unsigned>(q.size());
  double* out = zeros(c.size() * v.size());
  rate_.call(n, q.data(), n, v.data(), out, 1, one_zero());
  c.noalias() = Columns(out, c.size(), v.size()) * v;
}

PluggedRheonomousRelation::PluggedRheonomousRelation(int size, PluggedFunction<OfTimeAndPosition> h,
                                                     PluggedFunction<OfTimeAndPosition> jacobian,
                                                     PluggedFunction<OfTimeAndPosition> motion)
    : RheonomousRelation(size), h_(std::move(h)), jacobian_(std::move(jacobian)), motion_(std::move(motion)) {
  require_functions(h_ && jacobian_ && motion_, "h, H and ∂h/∂t");
}

void PluggedRheonomousRelation::require_dimensions(int coordinates, int freedoms) const {
  require_no_velocity_map(coordinates, freedoms);
}

void PluggedRheonomousRelation::gap_at(double t, const In& q, Out g) const {
  double* y = zeros(size());
  h_.call(static_cast<unsigned>(q.size()), q.data(), t, size(), y, 1, one_zero());
  std::copy_n(y, g.size(), g.data());
}

void PluggedRheonomousRelation::jacobian_at(double t, const In& q, OutMatrix J) const {
  double* out = zeros(J.size());
  jacobian_.call(static_cast<unsigned>(q.size()), q.data(), t, size(), out, 1, one_zero());
  J = Columns(out, J.rows(), J.cols());
}

void PluggedRheonomousRelation::motion_at(double t, const In& q, Out w) const {
  double* out = zeros(size());
  motion_.call(static_cast<unsigned>(q.size()), q.data(), t, size(), out, 1, one_zero());
  w = In(out, size());
}

}  // namespace saltus
