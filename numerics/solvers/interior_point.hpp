#pragma once
#include "saltus/numerics/contact_solver.hpp"
#include "saltus/numerics/linear/klu_factor.hpp"
#include "saltus/numerics/solvers/proximal_newton.hpp"
#include "saltus/numerics/solvers/quadratic_cone.hpp"

namespace saltus {

/// For many contacts that depend on each other: a primal-dual interior-point method. It writes the laws as
/// products that vanish,
///   P_N u_N = 0, P_N >= 0, u_N >= 0,   x∘y = 0,  x = (μ P_N, P_T), y = (a, u_T) in the cone |x_T| <= x_0,
///   u = G P + b,
/// with an unknown a of each contact that becomes |u_T| in the solution: De Saxcé's term without its kink.
/// Acary, Cadoux, Lemaréchal, Malick, ZAMM 91 (2011) 155-175, have the cone with that term given; to leave it
/// to a fixed point does not converge in a pyramid. In the plane the cone is two inequalities, and the
/// problem the complementarity problem of Lemke's method. Newton's method goes to products β > 0 and stays
/// inside the cones, while β shrinks by the rule of Mehrotra, SIAM J. Optim. 2 (1992) 575-601. Each iteration
/// solves with G + a block of each contact. Contacts that are degenerate or depend on each other do no harm,
/// but friction makes the problem not monotone: the path may turn to where β would have to grow, and steps
/// become short there. Then β is lifted; after many iterations another path begins. From a small residual the
/// proximal point method, with contacts that are almost rigid, makes the end exact.
class InteriorPoint final : public ContactSolver {
 public:
  std::string_view name() const override { return "interior-point"; }
  bool accepts(const ContactProblem&) const override { return true; }
  bool takes_sparse() const override { return true; }
  void reserve(int rows) override;
  SolveReport solve(const ContactProblem& problem, double* P) override;
  std::unique_ptr<ContactSolver> clone() const override { return std::make_unique<InteriorPoint>(); }

 private:
  struct Contact {
    int row;
    int rows;
    bool one_sided;  // P_N >= 0
    double mu;
    double d;  // of certify()
    bool has_cone() const { return mu > 0.0; }
    bool is_frictionless() const { return rows > 1 && mu == 0.0; }
  };
  struct Point {
    PoolVec P, u, a;  // of rows, rows and contacts
    void resize(int rows, int contacts);
  };

  void read_contacts(const ContactProblem& problem);
  void read_matrix(const ContactProblem& problem);
  void start(const ContactProblem& problem);
  bool follow_path(const ContactProblem& problem, SolveReport& report, double* P);
  bool iterate();
  double barrier(double step) const;
  bool factorise();
  bool find_direction(double barrier, bool correct);
  void find_right_hand_side(double barrier, bool correct);
  double reach() const;
  void raise(double barrier);
  static ConeVec force(const Contact& contact, const PoolVec& P);
  ConeVec velocity(const Point& point, int contact) const;

  std::vector<Contact> contacts_;
  Point now_, step_;
  PoolVec xi_, right_;
  SparseRows A_;
  std::vector<double> G_;   // its values, in the structure of A
  std::vector<int> block_;  // of each row, where its entries of its own contact begin
  double first_residual_ = 0.0, largest_scale_ = 0.0;
  double weight_ = 1.0;  // of the cones' products
  bool same_pivots_ = false;
  KluFactor factor_{1e-8};
  ProximalNewton finish_{20};
};

}  // namespace saltus
