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
  Matrix Ac, Av, Aq;     ///< (s+1, s+1)
  Vec c;                 ///< (s+1) times of the stages
  bool coupled = false;  ///< rows use every stage, Σ_{k<=s}: DMinusGalerkin finds them together

  int stages() const { return static_cast<int>(c.size()); }
};

/// The forecasting trapezoidal rule on velocity level (62)-(68), the same as (A.1)-(A.10).
Tableau trapezoidal_tableau();

/// A scheme of Appendix B, (B.9)-(B.16), from an explicit Runge-Kutta method: Ac = Av = Aq, c are the sums of
/// the rows. For its orders see order_conditions.hpp; whether a scheme can have it, validate() says.
/// @param A  (s+1, s+1) a row for each stage, the first is zero
/// @param b  (s+1) weights of the output
/// @throws std::invalid_argument if shapes disagree, or an entry is not finite, or on or above the diagonal
Tableau runge_kutta(std::string name, const Matrix& A, const Vec& b);

// Order without and with multipliers, and the largest ωΔt at which an undamped oscillator does not grow.
Tableau heun_tableau();         ///< 2, 2; none, grows by (ωΔt)⁴/8 a step
Tableau third_order_tableau();  ///< of three stages, c = (0, 1/3, 1): 3, 3; 1.732
Tableau kutta3_tableau();       ///< 3, 3; 1.732
Tableau rk4_tableau();          ///< the classic method: 4, 3; 2.828
/// Of the code HEM5 by Brasey and Hairer, 8 stages: 5, 5; none, grows by (ωΔt)⁶/1800 a step, at most by 3e-4
/// up to 1.35, and is damped from there to 3.456.
Tableau hem5_tableau();

/// @throws std::invalid_argument if shapes disagree, a row does not sum up to c_l (the output to 1), it
///         uses a stage that comes after it, Av_{l,l-1} <= 0: complementarity would change its sign, or <
///         1e-6, or an entry is beyond ±1000
void validate(const Tableau& tableau);

}  // namespace saltus
