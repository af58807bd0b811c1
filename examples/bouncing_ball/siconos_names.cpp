// A ball that bounces on the floor, as a program for Siconos would say it: the header is Saltus's, and the
// integrator is. Writes t, height, velocity, p and the floor's impulse of every step.
#include "saltus/kernel.hpp"

#include <cstdio>
#include <exception>

int main(int argc, char* argv[]) try {
  const unsigned n = 3;
  const double t0 = 0.0, T = 10.0, h = 5e-3, mass = 1.0, radius = 0.1, gravity = 9.81, restitution = 0.9;

  SP::SiconosMatrix M(new SimpleMatrix(n, n));
  (*M)(0, 0) = mass;
  (*M)(1, 1) = mass;
  (*M)(2, 2) = 0.4 * mass * radius * radius;
  SP::SiconosVector q0(new SiconosVector(n)), v0(new SiconosVector(n));
  (*q0)(0) = 1.0;
  SP::LagrangianLinearTIDS ball(new LagrangianLinearTIDS(q0, v0, M));
  SP::SiconosVector weight(new SiconosVector(n));
  (*weight)(0) = -mass * gravity;
  ball->setFExtPtr(weight);

  SP::SimpleMatrix H(new SimpleMatrix(1, n));
  (*H)(0, 0) = 1.0;
  SP::NonSmoothLaw law(new NewtonImpactNSL(restitution));
  SP::Relation relation(new LagrangianLinearTIR(H));
  SP::Interaction floor(new Interaction(law, relation));

  SP::NonSmoothDynamicalSystem model(new NonSmoothDynamicalSystem(t0, T));
  model->insertDynamicalSystem(ball);
  model->link(floor, ball);

  SP::OneStepIntegrator osi(new HalfExplicitTrapezoidalOSI());  // or MoreauJeanOSI(0.5)
  SP::TimeDiscretisation td(new TimeDiscretisation(t0, h));
  SP::OneStepNSProblem problem(new LCP());
  SP::TimeStepping simulation(new TimeStepping(model, td, osi, problem));

  SP::SiconosVector q = ball->q(), v = ball->velocity(), p = ball->p(1), lambda = floor->lambda(1);
  SimpleMatrix rows(static_cast<unsigned>(T / h) + 1, 5);
  rows(0, 1) = (*q)(0);
  unsigned k = 0, impacts = 0;
  while (simulation->hasNextEvent()) {
    simulation->computeOneStep();
    ++k;
    rows(k, 0) = simulation->nextTime();
    rows(k, 1) = (*q)(0);
    rows(k, 2) = (*v)(0);
    rows(k, 3) = (*p)(0);
    rows(k, 4) = (*lambda)(0);
    impacts += (*lambda)(0) > 0.0;
    simulation->nextStep();
  }
  std::printf("%u steps, %u impacts, height %.9f m at t = %g s\n", k, impacts, (*q)(0),
              simulation->startingTime());
  if (argc > 1) ioMatrix::write(argv[1], "ascii", rows, "noDim");
} catch (const std::exception& error) {
  std::fprintf(stderr, "bouncing_ball: %s\n", error.what());
  return 1;
}
