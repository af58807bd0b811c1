// Reactions that are determined and such that are not: tables, corners and blocks in them.
#include "saltus/numerics/uniqueness.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "saltus/numerics/problems.hpp"
#include "saltus/numerics/solvers/registry.hpp"
#include "support/complementarity.hpp"

namespace saltus::test {
namespace {

Vec vec(std::initializer_list<double> values) {
  return Eigen::Map<const Vec>(values.begin(), static_cast<int>(values.size()));
}

ContactProblem sized(const Matrix& W, const Vec& v, const ContactSet& set) {
  return problem_of(W * W.transpose(), W * v, std::vector<ContactSet>(W.rows() / rows_of(set), set));
}

ProblemSolution solve(const ContactProblem& problem, const char* solver = "auto") {
  return solve_problem(problem, *make_contact_solver(solver), 1e-12, Vec::Zero(problem.rows()));
}

// Legs at the places, of unit mass and inertia, in what gravity makes of rest in a second: normals alone, or
// with tangents in x and y half a metre below the centre.
ContactProblem table(std::initializer_list<std::pair<double, double>> places, double push, double mu) {
  const int dim = mu > 0.0 ? 3 : 1;
  Matrix W = Matrix::Zero(dim * static_cast<int>(places.size()), 6);
  int row = 0;
  for (const auto& [x, y] : places) {
    const Eigen::Vector3d arm(x, y, -0.5);
    for (const int axis : {2, 0, 1}) {
      if (axis != 2 && dim == 1) continue;
      const Eigen::Vector3d direction = Eigen::Vector3d::Unit(axis);
      W.row(row++) << direction.transpose(), arm.cross(direction).transpose();
    }
  }
  const Vec v = vec({push, 0.0, -1.0, 0.0, 0.0, 0.0});
  return mu > 0.0 ? sized(W, v, Coulomb{mu, 3}) : sized(W, v, NonNegative{});
}

const std::initializer_list<std::pair<double, double>> corners = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
const std::initializer_list<std::pair<double, double>> tripod = {{1, 0}, {-0.5, 0.8}, {-0.5, -0.8}};

TEST(Uniqueness, OfATableOnThreeLegsNotOnFour) {
  EXPECT_EQ(solve(table(tripod, 0.0, 0.0)).unique, true);
  EXPECT_EQ(solve(table(corners, 0.0, 0.0)).unique, false);
  EXPECT_EQ(solve(table(corners, 0.0, 0.5)).unique, false);
  // Three legs that stick have 9 reactions for 6 freedoms; where all slide along x, the three normals are
  // left.
  EXPECT_EQ(solve(table(tripod, 0.0, 0.5)).unique, false);
  EXPECT_EQ(solve(table(tripod, 1.0, 0.2)).unique, true);
}

TEST(Uniqueness, AnAnswerOnTwoOfFourLegsIsNotTheOnlyOne) {
  // Its own legs are independent: what counts is that the others may take from them.
  const ContactProblem problem = table(corners, 0.0, 0.0);
  const Vec two = vec({0.5, 0.0, 0.5, 0.0}), four = vec({0.25, 0.25, 0.25, 0.25});
  EXPECT_LE(problem_residual(problem, two.data()), 1e-15);
  EXPECT_EQ(is_only_solution(problem, two.data()), false);
  EXPECT_EQ(is_only_solution(problem, four.data()), false);
}

TEST(Uniqueness, ALegThatCouldOnlyPullTakesNothing) {
  // A beam on two supports at x = 0 and 2 whose weight is above the first: the second touches without a
  // force.
  const Matrix W = (Matrix(2, 2) << 1.0, 0.0, 1.0, 2.0).finished();
  EXPECT_EQ(solve(sized(W, vec({-1.0, 0.0}), NonNegative{})).unique, true);
  // One more at x = 1: forces 1, -2, 1 move nothing, and of them the middle would have to pull, or both
  // others.
  const Matrix three = (Matrix(3, 2) << 1.0, 0.0, 1.0, 2.0, 1.0, 1.0).finished();
  const ContactProblem beam = sized(three, vec({-1.0, 0.0}), NonNegative{});
  EXPECT_EQ(is_only_solution(beam, vec({1.0, 0.0, 0.0}).data()), true);
  // and where the middle one carries, it can give to both
  const ContactProblem middle = sized(three, vec({-1.0, -1.0}), NonNegative{});
  EXPECT_LE(problem_residual(middle, vec({0.0, 0.0, 1.0}).data()), 1e-15);
  EXPECT_EQ(is_only_solution(middle, vec({0.0, 0.0, 1.0}).data()), false);
}

TEST(Uniqueness, OfACornerNotOfTwoAtOnePlace) {
  const Matrix one = (Matrix(2, 2) << 0.0, 1.0, 1.0, 0.0).finished();  // normal y, tangent x
  Matrix two(4, 2);
  two << one, one;
  for (const double push : {0.0, 3.0}) {  // sticking, sliding
    const Vec v = vec({push, -1.0});
    EXPECT_EQ(solve(sized(one, v, Coulomb{0.5, 2})).unique, true) << push;
    EXPECT_EQ(solve(sized(two, v, Coulomb{0.5, 2})).unique, false) << push;
  }
  EXPECT_EQ(solve(sized(two, vec({0.0, 1.0}), Coulomb{0.5, 2})).unique, true);  // open
}

TEST(Uniqueness, OfABlockInACorner) {
  // Floor and wall, both with friction, hold 2 freedoms of a block that is pressed into the corner: the wall
  // may carry a part of the weight. Without friction every force has its freedom.
  Matrix W(4, 2);
  W << 0, 1, 1, 0, 1, 0, 0, 1;
  const Vec v = vec({-1.0, -1.0});
  EXPECT_EQ(solve(sized(W, v, Coulomb{0.5, 2})).unique, false);
  Matrix normals(2, 2);
  normals << 0, 1, 1, 0;
  EXPECT_EQ(solve(sized(normals, v, NonNegative{})).unique, true);
  EXPECT_EQ(solve(sized(W, v, Coulomb{0.0, 2})).unique, true);
}

TEST(Uniqueness, OfStickingOnTheEdgeOfTheCone) {
  // Sticking at |P_T| = mu P_N as it happens, and an equality along the tangent beside it. Inwards the
  // friction may go, the equality takes it; where the equality is along the normal, and so along nothing
  // friction does, not.
  const Matrix shared = (Matrix(3, 2) << 0, 1, 1, 0, 1, 0).finished();
  ContactProblem problem = sized(shared, vec({-0.5, -1.0}), Equality{});
  problem.sets = {Coulomb{0.5, 2}, Equality{}};
  EXPECT_LE(problem_residual(problem, vec({1.0, 0.5, 0.0}).data()), 1e-15);
  EXPECT_EQ(is_only_solution(problem, vec({1.0, 0.5, 0.0}).data()), false);
  const Matrix apart = (Matrix(3, 3) << 0, 1, 0, 1, 0, 0, 0, 0, 1).finished();
  problem = sized(apart, vec({-0.5, -1.0, 0.0}), Equality{});
  problem.sets = {Coulomb{0.5, 2}, Equality{}};
  EXPECT_EQ(is_only_solution(problem, vec({1.0, 0.5, 0.0}).data()), true);
}

TEST(Uniqueness, IsNotKnownAtTheTipOfAConeInSpace) {
  // Nothing moves, so that any force in the cone does as well: with more sides than a cone in the plane has.
  EXPECT_EQ(is_only_solution(problem_of(Matrix::Zero(3, 3), Vec::Zero(3), {Coulomb{0.5, 3}}),
                             Vec::Zero(3).eval().data()),
            std::nullopt);
  EXPECT_EQ(is_only_solution(problem_of(Matrix::Zero(2, 2), Vec::Zero(2), {Coulomb{0.5, 2}}),
                             Vec::Zero(2).eval().data()),
            false);
  // where all of its rows move something each, there is nothing to know of the cone
  EXPECT_EQ(is_only_solution(problem_of(Matrix::Identity(3, 3), Vec::Zero(3), {Coulomb{0.5, 3}}),
                             Vec::Zero(3).eval().data()),
            true);
}

TEST(Uniqueness, IsNotKnownOfWhatIsNotSolvedOrTooLarge) {
  EXPECT_EQ(solve(problem_of(Matrix::Constant(1, 1, -1.0), vec({-1.0}), {NonNegative{}})).unique,
            std::nullopt);
  EXPECT_EQ(solve(problem_of(Matrix(0, 0), Vec(0), {})).unique, true);
  const int n = 501;
  ContactProblem large;
  large.b = Vec(Vec::Constant(n, -1.0));
  large.sets.assign(n, NonNegative{});
  for (int i = 0; i < n; ++i) {
    large.sparse.add(i, 1.0);
    large.sparse.end_row();
  }
  EXPECT_EQ(solve(large).unique, std::nullopt);
  large.b[0] = 1.0;  // one direction less
  EXPECT_EQ(solve(large).unique, true);
}

TEST(Uniqueness, DoesNotDependOnUnits) {
  for (const double mass : {1e-9, 1.0, 1e9})
    for (const double unit : {1e-12, 1.0, 1e12})
      for (const bool four : {false, true}) {
        ContactProblem problem = table(four ? corners : tripod, 0.0, 0.0);
        problem.G.view() /= mass;
        problem.b.view() *= unit;
        EXPECT_EQ(solve(problem).unique, !four) << mass << ' ' << unit;
        for (int i = 0; i < problem.rows(); ++i) {  // one leg in other units
          problem.G(0, i) *= 1e4;
          problem.G(i, 0) *= 1e4;
        }
        problem.b[0] *= 1e4;
        EXPECT_EQ(solve(problem).unique, !four) << mass << ' ' << unit;
      }
}

TEST(Uniqueness, WhereReactionsAreNotUniqueVelocitiesAre) {
  const ContactProblem problem = table(corners, 0.0, 0.0);
  const ProblemSolution expected = solve(problem);
  const std::vector<double> P(expected.solution.begin(), expected.solution.end());
  const std::vector<double> xi = relative_velocities(problem, P);
  double furthest = 0.0;
  for (const SolverEntry& entry : contact_solvers()) {
    const ProblemSolution answer = solve(problem, entry.name.c_str());
    ASSERT_EQ(answer.status, SolveStatus::solved) << entry.name;
    EXPECT_EQ(answer.unique, false) << entry.name;
    const std::vector<double> Q(answer.solution.begin(), answer.solution.end());
    const std::vector<double> other = relative_velocities(problem, Q);
    for (int i = 0; i < problem.rows(); ++i) EXPECT_NEAR(other[i], xi[i], 1e-10) << entry.name;
    furthest = std::max(furthest, (answer.solution - expected.solution).cwiseAbs().maxCoeff());
  }
  EXPECT_GT(furthest, 0.1);  // Lemke's method leaves a leg without a force
}

TEST(Uniqueness, OfRandomProblemsIsWhatTheirNullSpaceSays) {
  // More freedoms than rows: the only one. Every contact twice: not, as soon as one of them carries.
  std::mt19937 random(12);
  int carrying = 0;
  for (int k = 0; k < 300; ++k) {
    const ContactProblem single = random_problem(random, {.equalities = false});
    const ProblemSolution answer = solve(single);
    ASSERT_EQ(answer.status, SolveStatus::solved) << k;
    EXPECT_EQ(answer.unique, true) << k;
    const int n = single.rows();
    Matrix G(2 * n, 2 * n);
    G << single.G.view(), single.G.view(), single.G.view(), single.G.view();
    Vec b(2 * n), P(2 * n);
    b << single.b.view(), single.b.view();
    P << 0.5 * answer.solution, 0.5 * answer.solution;
    std::vector<ContactSet> sets = single.sets;
    sets.insert(sets.end(), single.sets.begin(), single.sets.end());
    const bool carries = answer.solution.cwiseAbs().maxCoeff() > 0.0;
    carrying += carries;
    EXPECT_EQ(is_only_solution(problem_of(G, b, sets), P.data()), !carries) << k;
  }
  EXPECT_GT(carrying, 100);
}

}  // namespace
}  // namespace saltus::test
