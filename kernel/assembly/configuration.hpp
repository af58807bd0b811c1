#pragma once
#include <memory>
#include <span>
#include <vector>

#include "saltus/kernel/assembly/partition.hpp"
#include "saltus/numerics/linear/sparse_factor.hpp"
#include "saltus/numerics/linear/spd_factor.hpp"

namespace saltus {

/// Everything that depends on the position alone, and on the time where the geometry moves: gaps, M and its
/// factor, Wᵀ and w. Gaps are evaluated by move_to(), M by factorise(), Wᵀ and w of a contact when they are
/// asked for; each once a position.
class Configuration final : public BlockInverse {
 public:
  /// @throws std::invalid_argument if a constant M is not symmetric positive definite
  explicit Configuration(std::shared_ptr<const Layout> layout);

  /// Moves to the position q (coordinates) at the time t [s] and evaluates all gaps.
  void move_to(const Vec& q, double t);
  /// As move_to(), where only Wᵀ and w are wanted.
  void move_without_gaps(const Vec& q, double t);
  const Vec& q() const { return q_; }
  /// Is this where it is, so that nothing has to be evaluated again?
  bool is_at(const Vec& q, double t) const { return placed_ && (!layout_->rheonomous || t == t_) && q == q_; }

  /// Evaluates and factorises M(q). @return false if M is not positive definite or not finite
  bool factorise();
  /// x <- M⁻¹ x for one system, x (n of it)
  void solve_block(int system, double* x) const override {
    if (layout_->systems[system].sparse)
      (*sparse_factors_)[system].solve(x);
    else
      factor(system).solve(x);
  }
  long revision() const override { return layout_->varying_mass ? 0 : 1; }
  /// x <- M⁻¹ x, x (n)
  void solve_mass(Vec& x) const;
  /// y <- M x, both (n), after factorise()
  void multiply_mass(const Vec& x, Vec& y) const;
  /// M of one system (n, n of it) that is not sparse, after factorise()
  InMatrix mass(int system) const;
  /// Does M of some system depend on q?
  bool has_varying_mass() const { return layout_->varying_mass; }
  /// ½ vᵀ M v [J], of all systems or of those whose M depends on q
  double kinetic_energy(const Vec& v, bool only_varying = false) const;

  const Layout& layout() const { return *layout_; }
  /// Gaps of all contacts (gaps) [m]
  const Vec& gaps() const { return gaps_; }
  /// Is the contact closed, g <= 0 (18)? Judged by position only, without tolerance.
  bool closed(int contact) const {
    const auto& slot = layout_->contacts[contact];
    return slot.law->bilateral || gaps_[slot.gap] <= 0.0;
  }
  /// All of them, in ascending order.
  std::span<const int> closed_contacts() const { return {closed_.data(), closed_count_}; }
  /// Are the contact's gaps finite? A NaN would count as open.
  bool finite(int contact) const;
  bool finite() const { return all_finite(gaps_); }
  /// Largest -g of the unilateral contacts, or 0 [m]
  double penetration() const;

  /// Wᵀ(q) of one contact, (rows, n of it), row by row
  const double* jacobian(int contact) {
    if (!has_jacobian_[contact]) evaluate_jacobian(contact);
    return jacobians_.data() + layout_->contacts[contact].jacobian;
  }
  /// w of a contact whose geometry moves, (rows) [m/s]
  const double* motion(int contact);
  /// γ = Wᵀ v + w of one contact. @param[out] gamma (rows) [m/s]
  void relative_velocity(int contact, const Vec& v, double* gamma);
  /// Wᵀ v: what forces of the contact work at, where the geometry moves. @param[out] gamma (rows) [m/s]
  void velocity_of_work(int contact, const Vec& v, double* gamma);
  /// x <- x + W λ of one contact. @param lambda  (rows). @param[in,out] x (n)
  void add_forces(int contact, const double* lambda, Vec& x);
  /// Normal velocities below this are zero to the tolerance of the contact solvers, when v was computed from
  /// terms of size |v| + Δt |a| [m/s]
  double velocity_tolerance(int contact, const Vec& v, const Vec& a, double dt);
  double velocity_tolerance(int contact, const Vec& v);
  /// A gap below this is zero up to the rounding of its terms [m]. @param row  of the contact's gaps
  double gap_tolerance(int contact, int row);
  /// γ̇ = (dWᵀ/dt) v + Wᵀ a + ẇ of one contact, (38). @param[out] gamma_dot (rows) [m/s²]
  void relative_acceleration(int contact, const Vec& v, const Vec& a, double* gamma_dot);

 private:
  In local_position(const Layout::Contact& contact) {
    return layout_->local_position(contact, q_, local_q_.data());
  }
  void evaluate_jacobian(int contact);
  template <class Function>
  void for_jacobian(int contact, int row, Function function);
  double term_size(int contact, int row, const Vec& x);
  const SpdFactor& factor(int system) const {
    return layout_->systems[system].constant_mass ? (*constant_factors_)[system] : factors_[system];
  }

  std::shared_ptr<const Layout> layout_;
  std::shared_ptr<const std::vector<SpdFactor>> constant_factors_;   // shared by copies
  std::shared_ptr<const std::vector<SparseFactor>> sparse_factors_;  // of sparse systems, likewise
  Vec q_, gaps_, local_q_, local_v_, curvature_;
  struct Columns {
    int first, last;
  };
  std::vector<double> mass_, jacobians_;
  std::vector<Columns> columns_;  // of each row of Wᵀ: beyond these a constant one is zero
  std::vector<int>
      closed_;  // as many as there are contacts: a copy of a vector keeps its size, not its capacity
  std::size_t closed_count_ = 0;
  std::vector<SpdFactor> factors_;
  std::vector<unsigned char> has_jacobian_, has_motion_;
  Vec motions_;  // w of all contacts
  double t_ = 0.0;
  bool placed_ = false;  // gaps are those of a position that it was moved to
  bool factorised_ = false;
};

/// ∫ ½ vᵀṀv dt between two positions by the trapezoidal rule [J]: what the gyroscopic part of h takes away,
/// so that work of h and this together are the work of the applied forces. Both must be factorised.
double inertia_work(const Configuration& start, const Configuration& end, const Vec& v_start,
                    const Vec& v_end);

/// h(t, q, v) of all systems and force elements. @param[out] h (n)
void evaluate_forces(const Layout& layout, double t, const Vec& q, const Vec& v, Vec& h);

/// Potential energy of all systems and force elements [J], NaN if a system does not know its own
double potential_energy(const Layout& layout, double t, const Vec& q);

/// q̇ = Y(q) v of all systems, (74). @param[out] rate (coordinates)
void position_rates(const Layout& layout, const Vec& q, const Vec& v, Vec& rate);

/// q <- q + dt Y(at) v, brought back to what is allowed. @param rate (coordinates) workspace
void advance(const Layout& layout, const Vec& at, const Vec& v, double dt, Vec& rate, Vec& q);

/// Brings the coordinates of systems with a velocity map back to those that are allowed.
void normalise(const Layout& layout, Vec& q);

}  // namespace saltus
