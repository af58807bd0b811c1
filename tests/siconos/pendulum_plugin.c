/* Functions of a model, with the signatures of Siconos's plugins; matrices column by column. */
#include <math.h>

/* M(q), not diagonal and not constant */
void mass(unsigned size, const double* q, double* M, unsigned size_z, double* z) {
  M[0] = 2.0 + 0.5 * sin(q[1]);
  M[1] = 0.3;
  M[2] = 0.3;
  M[3] = 1.0 + q[0] * q[0];
}

/* A spring and a damper that are not linear */
void internal_force(double time, unsigned size, const double* q, const double* v, double* force, unsigned size_z,
                    double* z) {
  force[0] = 30.0 * q[0] + 5.0 * q[0] * q[0] * q[0] + 0.1 * v[1];
  force[1] = 20.0 * q[1] + 0.2 * v[1];
}

void external_force(double time, unsigned size, double* force, unsigned size_z, double* z) {
  force[0] = 4.0 * cos(3.0 * time);
  force[1] = -1.0;
}

/* How far q is outside of a circle */
void distance(unsigned size_q, const double* q, unsigned size_y, double* y, unsigned size_z, double* z) {
  y[0] = hypot(q[0], q[1]) - 0.4;
}

void gradient(unsigned size_q, const double* q, unsigned size_y, double* H, unsigned size_z, double* z) {
  const double r = hypot(q[0], q[1]);
  H[0] = q[0] / r;
  H[1] = q[1] / r;
}

/* A floor that moves up and down: y = q0 - 0.3 sin(5 t) */
void height(unsigned size_q, const double* q, double time, unsigned size_y, double* y, unsigned size_z, double* z) {
  y[0] = q[0] - 0.3 * sin(5.0 * time);
}

void height_gradient(unsigned size_q, const double* q, double time, unsigned size_y, double* H, unsigned size_z,
                     double* z) {
  H[0] = 1.0;
  H[1] = 0.0;
}

void height_rate(unsigned size_q, const double* q, double time, unsigned size_y, double* rate, unsigned size_z,
                 double* z) {
  rate[0] = -1.5 * cos(5.0 * time);
}
