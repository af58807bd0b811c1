#include "elastic_bar/bare_loop.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace saltus::examples {

BareElasticBar::BareElasticBar(int elements, double damping, const ElasticBarParameters& p)
    : nodes_(elements + 1), gap_(p.gap), stiffness_(p.element_stiffness(elements)), damping_(damping) {
  if (elements < 2 || elements % 2 != 0)
    throw std::invalid_argument("elements must be even and positive, got " + std::to_string(elements));
  factorise(p.element_mass(elements));
  q_ = a_ = a1_ = v1_ = Vec::Zero(nodes_);
  v_ = Vec::Constant(nodes_, -p.speed);
  mobility_ = Vec::Unit(nodes_, 0);
  solve_mass(mobility_.data());
}

void BareElasticBar::run(double dt, long steps) {
  for (long k = 0; k < steps; ++k) step(dt);
}

// From the ends of the bar to its middle
void BareElasticBar::factorise(double mass) {
  const int middle = nodes_ / 2;
  const double beside = mass / 6.0;
  ratio_.resize(middle);
  inverse_.resize(middle + 1);
  double pivot = mass / 3.0;
  for (int i = 0; i < middle; ++i) {
    inverse_[i] = 1.0 / pivot;
    ratio_[i] = beside * inverse_[i];
    pivot = 4.0 * beside - ratio_[i] * beside;
  }
  inverse_[middle] = 1.0 / (pivot - ratio_[middle - 1] * beside);
}

// x <- M⁻¹x; the halves of the bar do not wait for each other
void BareElasticBar::solve_mass(double* x) const {
  const int middle = nodes_ / 2;
  double left = 0.0, right = 0.0;
  for (int i = 0, j = nodes_ - 1; i < middle; ++i, --j) {
    x[i] -= left;
    x[j] -= right;
    left = ratio_[i] * x[i];
    right = ratio_[i] * x[j];
  }
  left = right = x[middle] = (x[middle] - left - right) * inverse_[middle];
  for (int i = middle - 1, j = middle + 1; i >= 0; --i, ++j) {
    left = x[i] = x[i] * inverse_[i] - ratio_[i] * left;
    right = x[j] = x[j] * inverse_[i] - ratio_[i] * right;
  }
}

// a = M⁻¹h, h = −K (q + δ v)
void BareElasticBar::accelerate(const Vec& v, Vec& a) const {
  const int last = nodes_ - 1;
  const double *q = q_.data(), *speed = v.data();
  const double k = stiffness_, d = stiffness_ * damping_;
  double* h = a.data();
  h[0] = k * (q[1] - q[0]) + d * (speed[1] - speed[0]);
  for (int i = 1; i < last; ++i)
    h[i] = k * (q[i - 1] - 2.0 * q[i] + q[i + 1]) + d * (speed[i - 1] - 2.0 * speed[i] + speed[i + 1]);
  h[last] = k * (q[last - 1] - q[last]) + d * (speed[last - 1] - speed[last]);
  solve_mass(h);
}

// v <- v + M⁻¹W P with the law on Wᵀv. @return P
double BareElasticBar::push(Vec& v) const {
  const double P = std::max(0.0, -v[0] / mobility_[0]);
  v += P * mobility_;
  return P;
}

void BareElasticBar::step(double dt) {
  const bool closed = gap_ + q_[0] <= 0.0;
  accelerate(v_, a_);
  v1_ = v_ + dt * a_;
  const double P = closed ? push(v1_) : 0.0;  // (69)-(70)
  q_ += 0.5 * dt * (v_ + v1_);                // (64)
  const bool closed_at_end = gap_ + q_[0] <= 0.0;
  accelerate(v1_, a1_);
  v_ += 0.5 * dt * (a_ + a1_);  // (55)
  if (closed_at_end && !closed) {
    push(v_);  // (56)-(59), (68)
    return;
  }
  if (P > 0.0) v_ += 0.5 * P * mobility_;  // (67)
  if (closed_at_end) push(v_);             // (71)-(72)
}

}  // namespace saltus::examples
