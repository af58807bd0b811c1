#pragma once
#include <limits>
#include <vector>

#include "saltus/numerics/contact_solver.hpp"

namespace saltus {

/// Laws between z and w, row by row: -w in the normal cone of [lower, upper] at z. An equality w = 0 has no
/// bounds, complementarity 0 <= w, 0 <= z has lower = 0 and no upper one, a relay has both: w > 0 where
/// z = lower, w < 0 where z = upper.
struct BoxLaws {
  static constexpr double unbounded = std::numeric_limits<double>::infinity();
  Vec lower;  ///< (rows), -infinity where there is none
  Vec upper;  ///< (rows), infinity likewise

  int rows() const { return static_cast<int>(lower.size()); }
};

/// @throws std::invalid_argument naming `what` if sizes differ, a bound is NaN, lower > upper, or lower is
///         infinity or upper -infinity
void validate(const BoxLaws& laws, const std::string& what);

/// Find z with w = M z + q and the laws of a box between z and w: an affine variational inequality.
/// It is rewritten as a mixed linear complementarity problem for a ContactSolver,
///   z = lower + p,  0 <= p, 0 <= w;   z = upper - p,  0 <= p, 0 <= -w;
///   both bounds:  0 <= p, 0 <= w + s;  0 <= s, 0 <= (upper - lower) - p;   none: an Equality,
/// with rows and columns scaled by powers of two: no unit of z and w weighs more than another, and the terms
/// that cancel in a row of w are of the size of one in every row.
class BoxProblem {
 public:
  /// Sizes everything: set_matrix() and solve() then allocate nothing but what the solver does.
  /// @throws std::invalid_argument as validate(laws), or if the solver does not take such problems
  void prepare(const BoxLaws& laws, ContactSolver& solver);
  /// @param M  (rows, rows), finite
  void set_matrix(const Matrix& M);
  /// @param q          (rows)
  /// @param[in,out] z  (rows), in: first guess, out: solution, within its bounds
  /// @return certificate of the scaled rewritten problem, of the z that came out; "solved" if it is within
  ///         a tenth of the solver's tolerance
  SolveReport solve(const Vec& q, Vec& z);
  /// With any w beside z: the largest entry of the natural map |z − mid(lower, z − w, upper)| of a scaled
  /// row, each relative to the terms that cancel in it; NaN if one is.
  double residual(const Vec& q, const Vec& z, const Vec& w) const;

 private:
  enum class Kind { free, above, below, between };
  struct Row {
    Kind kind;
    double lower, upper;
    int slack = -1;       // unknown of s
    double d = 1.0;       // of certify(): scaled w beside d times scaled z
    double row = 1.0;     // scaling of w
    double column = 1.0;  // z = column × scaled z
    /// +1, or -1 where p counts down from the upper bound
    double sign() const { return kind == Kind::below ? -1.0 : 1.0; }
    /// Where p is zero.
    double origin() const { return kind == Kind::free ? 0.0 : kind == Kind::below ? upper : lower; }
  };

  void scale(const Matrix& M);
  double term(int j, const Vec& z) const;
  double terms(int i, const Vec& q, const Vec& z) const;
  void pose(const Vec& q, const Vec& z);

  std::vector<Row> rows_;
  Matrix M_;  // scaled
  ContactProblem problem_;
  ContactSolver* solver_ = nullptr;
  PoolVec P_;
};

}  // namespace saltus
