#pragma once
#include <vector>

#include "saltus/numerics/contact_problem.hpp"
#include "saltus/numerics/linear/dense_solve.hpp"
#include "saltus/numerics/solvers/angle_polynomial.hpp"

namespace saltus {

/// What one contact does in a guess of the solution. Given the modes of all contacts, the laws of
/// plane contact are linear equations: this is what Newton's method and enumeration share.
enum class Mode : unsigned char {
  open,        ///< P = 0
  closed,      ///< xi = 0 in all rows: Equality, NonNegative, Coulomb sticking
  slip_plus,   ///< Coulomb in the plane: xi_N = 0, P_T = +mu P_N
  slip_minus,  ///< Coulomb in the plane: xi_N = 0, P_T = -mu P_N
  slip_space,  ///< Coulomb in space: xi_N = 0, and the Slip of the contact
};

/// The projection on the disc of radius mu P_N, linearised where its argument points outside along e:
///   e·P_T = mu P_N,  shift e'·P_T + ratio e'·xi_T = 0,  e' ⟂ e.
struct Slip {
  Direction direction;  ///< e
  double ratio = 0.0;   ///< radius of the disc over the length of the argument, in [0, 1]
  double shift = 1.0;   ///< d (1 - ratio) [1/kg], d of certify()
};

/// What a contact does, by the arguments of the projections (31)-(32) with r = 1/d.
/// @param P         (rows of it) [N s]
/// @param xi        (rows of it) [m/s]
/// @param[out] slip set if the mode is slip_space
Mode read_mode(const ContactSet& set, double d, const double* P, const double* xi, Slip& slip);

/// Solves the linear equations that belong to a choice of modes.
class ActiveSet {
 public:
  void reserve(int rows);
  /// The modes, one a contact, to be chosen before solve().
  std::vector<Mode>& modes() { return modes_; }
  /// The slips, one a contact: only those in the mode slip_space are read.
  std::vector<Slip>& slips() { return slips_; }
  /// P that satisfies the equations of modes(); where contacts depend on each other, the nearest to the P
  /// that comes in, so that a P which is almost right stays so.
  /// @param[in,out] P (rows) [N s]
  void solve(const ContactProblem& problem, double* P);

 private:
  // Column u of the reduced system is column `row` of G plus `slip` times the tangential one.
  struct Unknown {
    int row;
    double slip;
  };
  // A contact that slides in space. With tangents along e and e' it is a plane one that slides along e,
  // and the tangential component along e' is an unknown more.
  struct Slide {
    int row;      // of its normal
    int unknown;  // of the component along e'
    Slip slip;
  };

  void choose_unknowns(const ContactProblem& problem);
  void turn(const ContactProblem& problem, double* P);
  void solve_in_frame(const PoolMatrix& G, const PoolVec& b, double* P);

  std::vector<Mode> modes_;
  std::vector<Slip> slips_;
  std::vector<Unknown> unknowns_;
  std::vector<Slide> slides_;
  PoolMatrix turned_G_;  // in the frames of the slides
  PoolVec turned_b_;
  DenseSolve linear_;
};

}  // namespace saltus
