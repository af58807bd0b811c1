#pragma once
#include <string>

#include "saltus/numerics/pool.hpp"

namespace saltus {

/// Coefficients of a half-explicit scheme with stages 0..s. Row l = 1..s stands at index l-1, the output
/// is row s+1 at index s; column k belongs to stage k.
///   where the constraint is taken   q_c = q_0 + Δt Σ_{k<l}  Ac_lk v_k
///   velocity                        v_l = v_0 + Δt Σ_{k<l}  Av_lk M_k⁻¹(h_k + W_k λ_k)
///   position                        q_l = q_0 + Δt Σ_{k<=l} Aq_lk v_k
/// The output row's weights are b. A multiplier λ_{l-1} acts through Av_{l,l-1}.
struct Tableau {
  std::string name;
  Matrix Ac, Av, Aq;  ///< (s+1, s+1)
  Vec c;              ///< (s+1) times of the stages

  int stages() const { return static_cast<int>(c.size()); }
};

/// The forecasting trapezoidal rule on velocity level (62)-(68), the same as (A.1)-(A.10).
Tableau trapezoidal_tableau();

/// An explicit Runge-Kutta scheme (B.9)-(B.16): Ac = Av = Aq.
Tableau runge_kutta(std::string name, const Matrix& A, const Vec& b);
Tableau heun_tableau();
Tableau third_order_tableau();
Tableau kutta3_tableau();
Tableau rk4_tableau();
Tableau hem5_tableau();

struct TableauOrder {
  int free = 0;
  int constrained = 0;
};
TableauOrder order_of(const Tableau& tableau);

/// @throws std::invalid_argument if shapes disagree, a row does not sum up to c_l (the output to 1), it
///         uses a stage that comes after it, or Av_{l,l-1} <= 0: complementarity would change its sign
void validate(const Tableau& tableau);

}  // namespace saltus
