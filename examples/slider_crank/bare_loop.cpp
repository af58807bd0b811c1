#include "slider_crank/bare_loop.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace saltus::examples {
namespace {

constexpr double restitution = 0.4;
constexpr double mu = 0.01;
constexpr int most_iterations = 20;

enum class Mode { open, stick, slip_plus, slip_minus };

// x <- A⁻¹ x by elimination with partial pivoting
void eliminate(double A[8][8], double* x, int n) {
  for (int k = 0; k < n; ++k) {
    int best = k;
    for (int i = k + 1; i < n; ++i)
      if (std::abs(A[i][k]) > std::abs(A[best][k])) best = i;
    if (best != k) {
      std::swap_ranges(A[k], A[k] + n, A[best]);
      std::swap(x[k], x[best]);
    }
    for (int i = k + 1; i < n; ++i) {
      const double factor = A[i][k] / A[k][k];
      for (int j = k + 1; j < n; ++j) A[i][j] -= factor * A[k][j];
      x[i] -= factor * x[k];
    }
  }
  for (int k = n - 1; k >= 0; --k) {
    for (int j = k + 1; j < n; ++j) x[k] -= A[k][j] * x[j];
    x[k] /= A[k][k];
  }
}

// What each contact does, read off the arguments of the projections (31)-(32)
void read_modes(int count, const double G[8][8], const double* b, const double* p, Mode* mode) {
  for (int k = 0; k < count; ++k) {
    const int N = 2 * k, T = N + 1;
    double xi_N = b[N], xi_T = b[T];
    for (int j = 0; j < 2 * count; ++j) {
      xi_N += G[N][j] * p[j];
      xi_T += G[T][j] * p[j];
    }
    const double d = std::max(G[N][N], G[T][T]);
    const double tangential = d * p[T] - xi_T;
    if (d * p[N] - xi_N <= 0.0)
      mode[k] = Mode::open;
    else if (std::abs(tangential) <= mu * d * std::max(p[N], 0.0))
      mode[k] = Mode::stick;
    else
      mode[k] = tangential > 0.0 ? Mode::slip_plus : Mode::slip_minus;
  }
}

// The linear equations that belong to these modes
void solve_modes(int count, const double G[8][8], const double* b, const Mode* mode, double* p) {
  int row[8], n = 0;
  double slip[8], A[8][8], x[8];
  for (int k = 0; k < count; ++k) {
    if (mode[k] == Mode::open) continue;
    row[n] = 2 * k;
    slip[n++] = mode[k] == Mode::slip_plus ? mu : mode[k] == Mode::slip_minus ? -mu : 0.0;
    if (mode[k] != Mode::stick) continue;
    row[n] = 2 * k + 1;
    slip[n++] = 0.0;
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j)
      A[i][j] = G[row[i]][row[j]] + (slip[j] != 0.0 ? slip[j] * G[row[i]][row[j] + 1] : 0.0);
    x[i] = -b[row[i]];
  }
  eliminate(A, x, n);
  std::fill_n(p, 2 * count, 0.0);
  for (int j = 0; j < n; ++j) {
    p[row[j]] = x[j];
    if (slip[j] != 0.0) p[row[j] + 1] = slip[j] * x[j];
  }
}

}  // namespace

BareSliderCrank::BareSliderCrank(const SliderCrankParameters& p)
    : crank_(Vec::Zero(3), Vec::Zero(3), p),
      corner_{SliderCorner(-p.a, p.b, 2, p), SliderCorner(p.a, p.b, 2, p), SliderCorner(-p.a, -p.b, 2, p),
              SliderCorner(p.a, -p.b, 2, p)},
      v_(150.0, -75.0, 0.0) {
  move(start_, Eigen::Vector3d::Zero());
}

void BareSliderCrank::run(double dt, long steps) {
  for (long k = 0; k < steps; ++k) step(dt);
}

void BareSliderCrank::move(Place& place, const Eigen::Vector3d& q) const {
  const In position(q.data(), 3);
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> M = Eigen::Matrix3d::Zero();
  crank_.mass(position, {M.data(), 3, 3});
  place.q = q;
  place.mass.compute(M);
  for (int i = 0; i < corners; ++i) corner_[i].gap(position, {&place.gap[i], 1});
}

Eigen::Vector3d BareSliderCrank::accelerate(const Place& place, const Eigen::Vector3d& v) const {
  Eigen::Vector3d h = Eigen::Vector3d::Zero();
  crank_.forces(0.0, {place.q.data(), 3}, {v.data(), 3}, {h.data(), 3});
  return place.mass.solve(h);
}

// v <- v + M⁻¹W P with the law on Wᵀ(v + approach), Wᵀ at the position `constraint`
void BareSliderCrank::push(const Eigen::Vector3d& constraint, const Place& force,
                           const Eigen::Vector3d& approach, Eigen::Vector3d& v, const Closed& closed,
                           Impulses& P) const {
  using Rows = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;
  Eigen::Matrix<double, 3, 2> X[corners];
  double G[8][8], b[8], p[8];
  int which[corners], count = 0;
  for (int i = 0; i < corners; ++i) {
    if (!closed[i]) continue;
    Rows W = Rows::Zero();
    corner_[i].jacobian({force.q.data(), 3}, {W.data(), 2, 3});
    X[count] = force.mass.solve(W.transpose());
    which[count++] = i;
  }
  for (int k = 0; k < count; ++k) {
    Rows W = Rows::Zero();
    corner_[which[k]].jacobian({constraint.data(), 3}, {W.data(), 2, 3});
    for (int j = 0; j < count; ++j)
      for (int row = 0; row < 2; ++row)
        for (int column = 0; column < 2; ++column)
          G[2 * k + row][2 * j + column] = W.row(row).dot(X[j].col(column));
    b[2 * k] = W.row(0).dot(v + approach);
    b[2 * k + 1] = W.row(1).dot(v);
    p[2 * k] = P[2 * which[k]];
    p[2 * k + 1] = P[2 * which[k] + 1];
  }
  Mode mode[corners], last[corners];
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    read_modes(count, G, b, p, mode);
    if (iteration > 0 && std::equal(mode, mode + count, last)) break;
    std::copy_n(mode, count, last);
    solve_modes(count, G, b, mode, p);
  }
  P.fill(0.0);
  for (int k = 0; k < count; ++k) {
    P[2 * which[k]] = p[2 * k];
    P[2 * which[k] + 1] = p[2 * k + 1];
    v += X[k] * Eigen::Vector2d(p[2 * k], p[2 * k + 1]);
  }
}

void BareSliderCrank::step(double dt) {
  Closed closed, closed_at_end;
  bool impact = false;
  for (int i = 0; i < corners; ++i) closed[i] = start_.gap[i] <= 0.0;
  const auto any = [](const Closed& all) { return all[0] || all[1] || all[2] || all[3]; };

  const Eigen::Vector3d a = accelerate(start_, v_);
  Eigen::Vector3d v1 = v_ + dt * a, reaction = Eigen::Vector3d::Zero();
  if (any(closed)) {
    push(start_.q + dt * v_, start_, Eigen::Vector3d::Zero(), v1, closed, P_plus_);  // (69)-(70)
    reaction = v1 - v_ - dt * a;
  }
  move(end_, start_.q + 0.5 * dt * (v_ + v1));  // (64)
  for (int i = 0; i < corners; ++i) {
    closed_at_end[i] = end_.gap[i] <= 0.0;
    impact |= closed_at_end[i] && !closed[i];
  }
  Eigen::Vector3d v = v_ + 0.5 * dt * (a + accelerate(end_, v1));  // (55)
  if (impact) {
    Impulses Lambda{};
    push(end_.q, end_, restitution * v, v, closed_at_end, Lambda);  // (56)-(59), (68)
  } else {
    v += 0.5 * reaction;  // (67)
    if (any(closed_at_end))
      push(end_.q, end_, Eigen::Vector3d::Zero(), v, closed_at_end, P_minus_);  // (71)-(72)
  }
  v_ = v;
  std::swap(start_, end_);
}

}  // namespace saltus::examples
