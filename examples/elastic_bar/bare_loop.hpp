#pragma once
#include <vector>

#include "elastic_bar/elastic_bar.hpp"

namespace saltus::examples {

/// The elastic bar under the half-explicit trapezoidal rule (62)-(72), as a loop written by hand for this one
/// model and this one scheme: no layout, no sparse matrix, no solver to choose, no report. What a step could
/// cost at least, for `saltus bench`. It takes forces that depend on velocities, so h is evaluated twice.
class BareElasticBar {
 public:
  /// @param elements  N, an even number
  /// @param damping  δ of C = δK [s]
  /// @throws std::invalid_argument if elements is not even and positive
  explicit BareElasticBar(int elements, double damping = 0.0, const ElasticBarParameters& parameters = {});
  /// Takes this many steps of dt [s].
  void run(double dt, long steps);
  const Vec& q() const { return q_; }
  const Vec& v() const { return v_; }

 private:
  void factorise(double mass);
  void solve_mass(double* x) const;
  void accelerate(const Vec& v, Vec& a) const;
  double push(Vec& v) const;
  void step(double dt);

  int nodes_;
  double gap_, stiffness_, damping_;
  std::vector<double> ratio_, inverse_;  // of the elimination, which is the same from both ends
  Vec q_, v_, v1_, a_, a1_;
  Vec mobility_;  // M⁻¹W
};

}  // namespace saltus::examples
