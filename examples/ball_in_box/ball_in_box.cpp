#include "ball_in_box/ball_in_box.hpp"

#include <cmath>
#include <numbers>

#include "saltus/kernel/model/lagrangian_linear_tids.hpp"

namespace saltus::examples {

NonSmoothDynamicalSystem make_ball_in_box(Gravity gravity) {
  const BallInBoxParameters p;
  constexpr double angle = std::numbers::pi / 6;
  Vec q0(2), direction(2);
  q0 << p.x0, p.y0;
  if (gravity == Gravity::oblique)
    direction << -std::cos(angle), -std::sin(angle);
  else
    direction << 0.0, -1.0;
  LagrangianLinearTIDS::Terms terms;
  terms.external_force = p.m * p.gravity * direction;
  auto ball = std::make_shared<LagrangianLinearTIDS>(q0, Vec::Zero(2), p.m * Matrix::Identity(2, 2), terms);

  NonSmoothDynamicalSystem model({ball});
  const struct {
    const char* name;
    double normal_x, normal_y, offset;
  } sides[] = {{"left", 1.0, 0.0, -p.R},
               {"right", -1.0, 0.0, p.a - p.R},
               {"bottom", 0.0, 1.0, -p.R},
               {"top", 0.0, -1.0, p.b - p.R}};
  for (const auto& side : sides) {
    Matrix H(1, 2);
    H << side.normal_x, side.normal_y;
    auto gap = std::make_shared<LagrangianLinearTIR>(H, Vec::Constant(1, side.offset));
    model.link(std::make_shared<Interaction>(gap, NewtonImpactNSL(p.restitution), side.name), *ball);
  }
  return model;
}

}  // namespace saltus::examples
