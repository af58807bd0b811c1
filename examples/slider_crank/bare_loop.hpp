#pragma once
#include <Eigen/Cholesky>
#include <array>

#include "slider_crank/slider_crank.hpp"

namespace saltus::examples {

/// The frictional slider crank under the half-explicit trapezoidal rule (62)-(72), as a loop written by hand
/// for this one model and this one scheme: the same model functions, but no layout, no virtual call, no
/// solver to choose, no report. What a step could cost at least, for `saltus bench`.
class BareSliderCrank {
 public:
  explicit BareSliderCrank(const SliderCrankParameters& parameters = {});
  /// Takes this many steps of dt [s].
  void run(double dt, long steps);
  const Eigen::Vector3d& q() const { return start_.q; }
  const Eigen::Vector3d& v() const { return v_; }

 private:
  static constexpr int corners = 4;
  struct Place {
    Eigen::Vector3d q;
    Eigen::LLT<Eigen::Matrix3d> mass;
    std::array<double, corners> gap;
  };
  using Closed = std::array<bool, corners>;
  using Impulses = std::array<double, 2 * corners>;

  void move(Place& place, const Eigen::Vector3d& q) const;
  Eigen::Vector3d accelerate(const Place& place, const Eigen::Vector3d& v) const;
  void push(const Eigen::Vector3d& constraint, const Place& force, const Eigen::Vector3d& approach,
            Eigen::Vector3d& v, const Closed& closed, Impulses& P) const;
  void step(double dt);

  SliderCrank crank_;
  std::array<SliderCorner, corners> corner_;
  Eigen::Vector3d v_;
  Place start_, end_;
  Impulses P_plus_{}, P_minus_{};  // of λ⁺ and λ⁻, warm start of the next step
};

}  // namespace saltus::examples
