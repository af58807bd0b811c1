// Order conditions: all there, each as its text says, and in agreement with measured orders.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "saltus/kernel/integrators/half_explicit/half_explicit.hpp"
#include "saltus/kernel/integrators/half_explicit/order_conditions.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

Tableau from_rows(const char* name, std::initializer_list<std::initializer_list<double>> rows, const Vec& b) {
  Matrix A = Matrix::Zero(b.size(), b.size());
  int i = 0;
  for (const auto& row : rows) std::copy(row.begin(), row.end(), A.row(++i).data());
  return runge_kutta(name, A, b);
}

Tableau euler() { return runge_kutta("Euler", Matrix::Zero(1, 1), vec({1.0})); }
Tableau ralston3() { return from_rows("Ralston3", {{0.5}, {0.0, 0.75}}, vec({2.0 / 9, 1.0 / 3, 4.0 / 9})); }
Tableau nystrom3() { return from_rows("Nystrom3", {{2.0 / 3}, {0.0, 2.0 / 3}}, vec({0.25, 0.375, 0.375})); }
Tableau three_eighths() {
  return from_rows("3/8", {{1.0 / 3}, {-1.0 / 3, 1.0}, {1.0, -1.0, 1.0}}, vec({0.125, 0.375, 0.375, 0.125}));
}
Tableau butcher5() {
  return from_rows("Butcher5",
                   {{0.25},
                    {0.125, 0.125},
                    {0.0, -0.5, 1.0},
                    {3.0 / 16, 0.0, 0.0, 9.0 / 16},
                    {-3.0 / 7, 2.0 / 7, 12.0 / 7, -12.0 / 7, 8.0 / 7}},
                   vec({7.0, 0.0, 32.0, 12.0, 32.0, 7.0}) / 90.0);
}
Tableau butcher6() {  // some a_{l,l-1} < 0: no scheme takes it
  return from_rows("Butcher6",
                   {{1.0 / 3},
                    {0.0, 2.0 / 3},
                    {1.0 / 12, 1.0 / 3, -1.0 / 12},
                    {-1.0 / 16, 9.0 / 8, -3.0 / 16, -3.0 / 8},
                    {0.0, 9.0 / 8, -3.0 / 8, -3.0 / 4, 1.0 / 2},
                    {9.0 / 44, -9.0 / 11, 63.0 / 44, 18.0 / 11, 0.0, -16.0 / 11}},
                   vec({11.0, 0.0, 81.0, 81.0, -32.0, -32.0, 11.0}) / 120.0);
}
Tableau five_stages_of_order_four() {  // found by Newton's method on the conditions
  return from_rows("five stages",
                   {{0.097245402127458663},
                    {0.079013477936947213, 0.47052986052319634},
                    {0.56264059431108271, -0.58242558420264934, 0.43045769043874416},
                    {-0.051448253172856569, -0.30872143047263445, 0.21829435189276059, 1.1418753317527306}},
                   vec({0.19501266706436782, -0.061514177859744577, 0.38384313249436941, 0.31835423878827213,
                        0.1643041395127352}));
}

TEST(OrderConditions, AreAllThere) {
  std::map<int, int> free, constrained;
  std::set<std::string_view> texts;
  for (const OrderCondition& condition : order_conditions(hem5_tableau())) {
    ++(condition.constrained ? constrained : free)[condition.order];
    EXPECT_TRUE(texts.insert(condition.text).second) << condition.text;
    EXPECT_EQ(condition.constrained, condition.text.find("ω") != std::string_view::npos);
  }
  // Rooted trees. The others were counted by enumerating all derivatives of q̇ = v, v̇ = M⁻¹(h + Wλ), 0 = Wᵀv.
  EXPECT_EQ(free, (std::map<int, int>{{1, 1}, {2, 1}, {3, 2}, {4, 4}, {5, 9}, {6, 20}}));
  EXPECT_EQ(constrained, (std::map<int, int>{{3, 2}, {4, 12}, {5, 57}, {6, 258}}));
}

TEST(OrderConditions, AreThoseOfTheBooksUpToOrderFour) {
  const std::map<std::string_view, std::pair<int, int>> expected = {
      {"Σ b_i", {1, 1}},
      {"Σ b_i c_i", {1, 2}},
      {"Σ b_i c_i^2", {1, 3}},
      {"Σ b_i a_ij c_j", {1, 6}},
      {"Σ b_i c_i ω_ij c_j^2", {2, 3}},
      {"Σ b_i c_i ω_ij a_jk c_k", {1, 3}},
      {"Σ b_i c_i^3", {1, 4}},
      {"Σ b_i c_i a_ij c_j", {1, 8}},
      {"Σ b_i a_ij c_j^2", {1, 12}},
      {"Σ b_i a_ij a_jk c_k", {1, 24}},
      {"Σ b_i a_ij c_j ω_jk c_k^2", {1, 6}},
      {"Σ b_i a_ij c_j ω_jk a_kl c_l", {1, 12}},
      {"Σ b_i c_i^2 ω_ij c_j^2", {1, 2}},
      {"Σ b_i a_ij c_j ω_ik c_k^2", {1, 4}},
      {"Σ b_i c_i^2 ω_ij a_jk c_k", {1, 4}},
      {"Σ b_i a_ij c_j ω_ik a_kl c_l", {1, 8}},
      {"Σ b_i c_i ω_ij c_j^3", {3, 4}},
      {"Σ b_i c_i ω_ij c_j a_jk c_k", {3, 8}},
      {"Σ b_i c_i ω_ij a_jk c_k^2", {1, 4}},
      {"Σ b_i c_i ω_ij a_jk a_kl c_l", {1, 8}},
      {"Σ b_i c_i ω_ij a_jk c_k ω_kl c_l^2", {1, 2}},
      {"Σ b_i c_i ω_ij a_jk c_k ω_kl a_lm c_m", {1, 4}},
  };
  std::map<std::string_view, std::pair<int, int>> found;
  for (const OrderCondition& condition : order_conditions(hem5_tableau()))
    if (condition.order <= 4) found[condition.text] = {condition.over, condition.under};
  EXPECT_EQ(found, expected);
}

// A condition's text, read back: the factors that stand at a subscript, with the subscript they lead to.
struct Factor {
  char kind;  // 'c', 'a' or 'w' for ω
  int power;  // of c
  char to;    // of a and ω
};
using Factors = std::map<char, std::vector<Factor>>;

Factors factors_of(std::string_view text) {
  std::istringstream words{std::string(text)};
  std::string word;
  words >> word >> word;  // Σ b_i
  Factors factors;
  while (words >> word) {
    const std::string at = word.substr(word.find('_') + 1);
    if (word[0] == 'c')
      factors[at[0]].push_back({'c', at.size() > 1 ? std::stoi(at.substr(2)) : 1, 0});
    else
      factors[at[0]].push_back({word[0] == 'a' ? 'a' : 'w', 0, at[1]});
  }
  return factors;
}

// The sum as written, over subscripts 0...s+1 of stages and rows
double sum_at(const Factors& factors, char at, int i, const Tableau& t) {
  const int n = t.stages();
  const Matrix inverse = t.Av.inverse();
  auto c = [&](int l) { return l == n ? 1.0 : t.c[l]; };
  auto coefficient = [&](char kind, int l, int k) {
    if (kind == 'a') return l == 0 || k == n ? 0.0 : t.Av(l - 1, k);
    return l == n || k == 0 ? 0.0 : inverse(l, k - 1);
  };
  double product = 1.0;
  if (!factors.contains(at)) return product;
  for (const Factor& factor : factors.at(at)) {
    if (factor.kind == 'c') {
      product *= std::pow(c(i), factor.power);
      continue;
    }
    double sum = 0.0;
    for (int j = 0; j <= n; ++j)
      if (const double weight = coefficient(factor.kind, i, j); weight != 0.0)
        sum += weight * sum_at(factors, factor.to, j, t);
    product *= sum;
  }
  return product;
}

TEST(OrderConditions, HaveTheValueOfTheirText) {
  const Tableau t = from_rows("any", {{0.3}, {-0.2, 0.9}, {0.15, -0.3, 0.7}}, vec({0.35, -0.1, 0.2, 0.55}));
  for (const OrderCondition& condition : order_conditions(t)) {
    const Factors factors = factors_of(condition.text);
    double sum = 0.0;
    for (int k = 0; k < t.stages(); ++k) sum += t.Av(t.stages() - 1, k) * sum_at(factors, 'i', k, t);
    EXPECT_NEAR(condition.value, sum, 1e-14 * (1.0 + condition.terms)) << condition.text;
  }
}

// With integrals from 0 to x in the place of Σ_j a_ij, derivatives in that of Σ_j ω_ij, and x in that of c,
// which fulfil every condition, a vertex is factor · x^power.
std::pair<double, int> monomial(const Factors& factors, char at) {
  double factor = 1.0;
  int power = 0;
  if (!factors.contains(at)) return {factor, power};
  for (const Factor& child : factors.at(at)) {
    if (child.kind == 'c') {
      power += child.power;
      continue;
    }
    const auto [inner, exponent] = monomial(factors, child.to);
    factor *= child.kind == 'a' ? inner / (exponent + 1) : inner * exponent;
    power += child.kind == 'a' ? exponent + 1 : exponent - 1;
  }
  return {factor, power};
}

TEST(OrderConditions, MustBeWhatTheExactSolutionGives) {
  for (const OrderCondition& condition : order_conditions(hem5_tableau())) {
    const auto [factor, power] = monomial(factors_of(condition.text), 'i');
    EXPECT_EQ(power, condition.order - 1) << condition.text;
    EXPECT_NEAR(static_cast<double>(condition.over) / condition.under, factor / (power + 1), 1e-15)
        << condition.text;
  }
}

TEST(OrderConditions, GiveTheOrdersOfKnownTableaux) {
  auto expect = [](const Tableau& tableau, int free, int constrained) {
    const TableauOrder order = order_of(tableau);
    EXPECT_EQ(order.free, free) << tableau.name;
    EXPECT_EQ(order.constrained, constrained) << tableau.name;
    EXPECT_NO_THROW(require_order(tableau, {free, constrained}));
    EXPECT_THROW(require_order(tableau, {free + 1, constrained}), std::invalid_argument);
    EXPECT_THROW(require_order(tableau, {free, constrained + 1}), std::invalid_argument);
  };
  expect(euler(), 1, 1);
  expect(heun_tableau(), 2, 2);
  expect(third_order_tableau(), 3, 3);
  expect(kutta3_tableau(), 3, 3);
  expect(ralston3(), 3, 2);
  expect(nystrom3(), 3, 2);
  expect(rk4_tableau(), 4, 3);
  expect(three_eighths(), 4, 3);
  expect(five_stages_of_order_four(), 4, 4);
  expect(butcher5(), 5, 3);
  expect(hem5_tableau(), 5, 5);
  expect(butcher6(), 6, 3);
}

TEST(OrderConditions, OneViolatedConditionCostsItsOrder) {
  auto expect = [](const Tableau& tableau, int order, std::string_view only) {
    EXPECT_EQ(order_of(tableau).free, order) << tableau.name;
    EXPECT_LE(order_of(tableau).constrained, order) << tableau.name;
    for (const OrderCondition& condition : order_conditions(tableau)) {
      if (condition.constrained || condition.order > order + 1) continue;
      EXPECT_EQ(condition.holds(), condition.text != only) << tableau.name << ": " << condition.text;
    }
  };
  expect(runge_kutta("1", Matrix::Zero(1, 1), vec({1.1})), 0, "Σ b_i");
  expect(from_rows("2", {{0.9}}, vec({0.5, 0.5})), 1, "Σ b_i c_i");
  expect(from_rows("3", {{0.5}, {-1.0 / 3, 4.0 / 3}}, vec({0.25, 0.5, 0.25})), 2, "Σ b_i c_i^2");
  expect(from_rows("3'", {{0.5}, {0.0, 1.0}}, vec({1.0, 4.0, 1.0}) / 6.0), 2, "Σ b_i a_ij c_j");
  expect(from_rows("4", {{0.5}, {0.0, 0.5}, {0.0, 0.5, 0.5}}, vec({1.0, 2.0, 2.0, 1.0}) / 6.0), 3,
         "Σ b_i a_ij a_jk c_k");
}

TEST(OrderConditions, SayWhichOneIsViolated) {
  Tableau mine = rk4_tableau();
  mine.name = "mine";
  expect_refusal([&] { require_order(mine, {5, 0}); },
                 {"tableau 'mine': order 5 claimed, but Σ b_i c_i^4 = 0.208333333333333, must be 1/5"});
  expect_refusal([&] { require_order(mine, {4, 4}); },
                 {"order 4 with multipliers claimed", "Σ b_i a_ij c_j ω_jk c_k^2 = 0.125, must be 1/6",
                  "(ω) is the inverse of (a)"});
  expect_refusal([] { require_order(runge_kutta("sum", Matrix::Zero(1, 1), vec({1.1})), {1, 0}); },
                 {"'sum': order 1 claimed, but Σ b_i = 1.1, must be 1"});
  expect_refusal([&] { require_order(mine, {7, 0}); }, {"order 7 claimed", "up to order 6"});
  expect_refusal([] { order_of(trapezoidal_tableau()); }, {"trapezoidal", "Ac = Av = Aq"});
  mine.Aq = Matrix::Zero(2, 3);
  expect_refusal([&] { order_of(mine); }, {"mine", "Ac = Av = Aq"});
}

TEST(OrderConditions, AMultiplierThatDoesNotActHasNoOrder) {
  const Tableau t = from_rows("a_32 = 0", {{1.0}, {0.5, 0.0}}, vec({0.5, 0.3, 0.2}));
  EXPECT_EQ(order_of(t).constrained, 0);
  EXPECT_EQ(order_of(t).free, 1);
  expect_refusal([&] { require_order(t, {1, 1}); }, {"order 1 with multipliers", "a_{l,l-1} is 0"});
}

// A tiny a_{l,l-1} makes the terms huge, not the condition true.
TEST(OrderConditions, LargeTermsExcuseNothing) {
  EXPECT_FALSE((OrderCondition{"", 3, true, 0.66, 1e12, 2, 3}.holds()));
  EXPECT_TRUE((OrderCondition{"", 3, true, 2.0 / 3 + 1e-9, 1e4, 2, 3}.holds()));
  EXPECT_FALSE((OrderCondition{"", 3, true, 2.0 / 3 + 1e-9, 10.0, 2, 3}.holds()));
  EXPECT_FALSE((OrderCondition{"", 3, true, std::nan(""), 1.0, 2, 3}.holds()));
}

TEST(OrderConditions, CoefficientsMayBeRounded) {
  for (const OrderCondition& condition : order_conditions(hem5_tableau()))
    if (condition.order <= 5) {
      EXPECT_NEAR(condition.value, static_cast<double>(condition.over) / condition.under, 1e-13)
          << condition.text;
    }
  Tableau t = rk4_tableau();
  auto moved_by = [&](double difference) {
    Matrix A = Matrix::Zero(4, 4);
    A.bottomRows(3) = t.Av.topRows(3);
    A(2, 1) += difference;
    return order_of(runge_kutta("moved", A, t.Av.row(3).transpose())).free;
  };
  EXPECT_EQ(moved_by(1e-15), 4);
  EXPECT_EQ(moved_by(1e-9), 1);
}

// Four freedoms, two constraints, nothing symmetric, forces of no potential: every term of an expansion is
// there. A pendulum is blind to some: it gives order 4 where Σ b_i c_i ω_ij c_j^3 is not 3/4.
const Vec start = vec({0.3, -0.2, 0.5, 0.1});
const Matrix plain = (Matrix(2, 4) << 1.0, 0.3, -0.2, 0.5, -0.4, 1.0, 0.6, 0.1).finished();
const Matrix waved = (Matrix(2, 4) << 0.5, -0.7, 0.4, 0.3, 0.2, 0.6, -0.5, 0.8).finished();
const Matrix bent = (Matrix(2, 4) << 0.3, 0.5, -0.6, 0.2, -0.5, 0.3, 0.4, 0.7).finished();

Vec gaps(const Vec& q) {
  return plain * q + Vec((waved * q).array().sin()) + 0.5 * Vec((bent * q).array().square());
}
Matrix gradients(const Vec& q) {
  const Vec wave = (waved * q).array().cos(), bend = bent * q;
  return plain + wave.asDiagonal() * waved + bend.asDiagonal() * bent;
}
Vec curvatures(const Vec& q, const Vec& v) {
  return (bent * v).array().square() - (waved * q).array().sin() * (waved * v).array().square();
}

class Bodies final : public LagrangianDS {
 public:
  using LagrangianDS::LagrangianDS;
  static Matrix inertia(const Vec& q) {
    Matrix B(4, 4);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        B(i, j) = (i == j ? 1.5 : 0.0) + 0.3 * std::sin(q[i] + (j + 1) * 0.5 * q[j] + i - 0.7 * j);
    return B * B.transpose();
  }
  static Vec force(double t, const Vec& q, const Vec& v) {
    Vec h(4);
    for (int i = 0; i < 4; ++i) {
      const int j = (i + 1) % 4, k = (i + 2) % 4;
      h[i] = 3.0 * std::sin(2.0 * q[i] + q[j]) + v[j] * v[k] * std::cos(q[i]) - 0.5 * v[i] * v[j] +
             0.4 * v[k] * v[k] * q[j] - 0.2 * std::sin(3.0 * v[i]) + std::cos(3.0 * t + i);
    }
    return h;
  }
  void mass(const In& q, OutMatrix M) const override { M = inertia(q); }
  void forces(double t, const In& q, const In& v, Out h) const override { h = force(t, q, v); }
};

class Guides final : public Relation {
 public:
  Guides() : Relation(2) {}
  void gap(const In& q, Out g) const override { g = gaps(q) - gaps(start); }
  void jacobian(const In& q, OutMatrix J) const override { J = gradients(q); }
};

// The model, with its guides or free, and its state at `until` by integrating v̇ and λ from one linear system
struct Generic {
  int rows;
  Vec v0 = vec({1.2, -0.7, 0.9, 0.4});

  explicit Generic(bool guided) : rows(guided ? 2 : 0) {
    const Matrix J = gradients(start);
    v0 -= J.transpose() * (J * J.transpose()).inverse() * (J * v0).eval();
  }
  NonSmoothDynamicalSystem model() const {
    auto bodies = std::make_shared<Bodies>(start, v0);
    NonSmoothDynamicalSystem all({bodies});
    if (rows > 0)
      all.link(std::make_shared<Interaction>(std::make_shared<Guides>(), EqualityConditionNSL(2), "guides"),
               *bodies);
    return all;
  }
  State exact(double until) const {
    auto rate = [&](double t, const Vec& y) {
      const Vec q = y.head(4), v = y.tail(4);
      Matrix K = Matrix::Zero(4 + rows, 4 + rows);
      Vec right(4 + rows);
      K.topLeftCorner(4, 4) = Bodies::inertia(q);
      K.bottomLeftCorner(rows, 4) = gradients(q).topRows(rows);
      K.topRightCorner(4, rows) = -gradients(q).topRows(rows).transpose();
      right << Bodies::force(t, q, v), -curvatures(q, v).head(rows);
      Vec result(8);
      result << v, K.partialPivLu().solve(right).head(4);
      return result;
    };
    const Vec y = integrate_ode(rate, (Vec(8) << start, v0).finished(), until, 2000);
    return {until, y.head(4), y.tail(4)};
  }
};

TEST(OrderConditions, AgreeWithMeasuredOrders) {
  const double until = 0.5;
  const Generic free(false), guided(true);
  const State free_end = free.exact(until), guided_end = guided.exact(until);
  auto expect = [&](const Tableau& tableau) {
    const HalfExplicit scheme("under test", tableau, HalfExplicitSettings{});
    auto compare = [&](const Generic& generic, const State& end, int order) {
      const double dt = order > 4 ? 0.05 : order > 3 ? 0.01 : order > 1 ? 2.5e-3 : 1.25e-3;
      const Orders measured = measure_orders(generic.model(), scheme, end, until, {dt, dt / 2, dt / 4});
      EXPECT_NEAR(measured.q, order, 0.2) << tableau.name << ", rows " << generic.rows;
      EXPECT_NEAR(measured.v, order, 0.2) << tableau.name << ", rows " << generic.rows;
    };
    const TableauOrder order = order_of(tableau);
    compare(free, free_end, order.free);
    compare(guided, guided_end, order.constrained);
  };
  expect(euler());
  expect(heun_tableau());
  expect(third_order_tableau());
  expect(kutta3_tableau());
  expect(ralston3());
  expect(nystrom3());
  expect(rk4_tableau());
  expect(three_eighths());
  expect(five_stages_of_order_four());
  expect(butcher5());
  expect(hem5_tableau());
}

}  // namespace
}  // namespace saltus::test
