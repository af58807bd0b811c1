// Functions of a model, with the signatures of Siconos's plugins; matrices column by column.
#include <cmath>

extern "C" {

// M(q), not diagonal and not constant
void mass(unsigned, const double* q, double* M, unsigned, double*) {
  M[0] = 2.0 + 0.5 * std::sin(q[1]);
  M[1] = 0.3;
  M[2] = 0.3;
  M[3] = 1.0 + q[0] * q[0];
}

// Springs and dampers that are not linear, and not symmetric
void internal_force(double, unsigned, const double* q, const double* v, double* force, unsigned, double*) {
  force[0] = 30.0 * q[0] + 5.0 * q[0] * q[0] * q[0] + 0.1 * v[1];
  force[1] = 20.0 * q[1] + 0.2 * v[1];
}

void internal_force_dq(double, unsigned, const double* q, const double*, double* J, unsigned, double*) {
  J[0] = 30.0 + 15.0 * q[0] * q[0];
  J[3] = 20.0;
}

void internal_force_dv(double, unsigned, const double*, const double*, double* J, unsigned, double*) {
  J[2] = 0.1;
  J[3] = 0.2;
}

void gyroscopic_force(unsigned, const double*, const double* v, double* force, unsigned, double*) {
  force[0] = -2.0 * v[1] * v[0];
  force[1] = 2.0 * v[0] * v[0];
}

void external_force(double time, unsigned, double* force, unsigned, double*) {
  force[0] = 4.0 * std::cos(3.0 * time);
  force[1] = -1.0;
}

// How far q is outside of a circle
void distance(unsigned, const double* q, unsigned, double* y, unsigned, double*) {
  y[0] = std::hypot(q[0], q[1]) - 0.4;
}

void gradient(unsigned, const double* q, unsigned, double* H, unsigned, double*) {
  const double r = std::hypot(q[0], q[1]);
  H[0] = q[0] / r;
  H[1] = q[1] / r;
}

// A floor that moves up and down: y = q0 - 0.3 sin(5 t)
void height(unsigned, const double* q, double time, unsigned, double* y, unsigned, double*) {
  y[0] = q[0] - 0.3 * std::sin(5.0 * time);
}

void height_gradient(unsigned, const double*, double, unsigned, double* H, unsigned, double*) {
  H[0] = 1.0;
  H[1] = 0.0;
}

void height_rate(unsigned, const double*, double time, unsigned, double* rate, unsigned, double*) {
  rate[0] = -1.5 * std::cos(5.0 * time);
}

}  // extern "C"
