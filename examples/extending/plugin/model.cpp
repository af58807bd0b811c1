// Model functions in a shared library, "./libown.so:ball_forces": a ball on a nonlinear spring over a floor.
// All obey the one C signature of saltus/kernel/model/model_function.hpp.
extern "C" {

// params = (mass, linear stiffness, cubic stiffness)
void ball_mass(double, int, const double*, const double*, double* out, const double* params) {
  out[0] = params[0];
}

void ball_forces(double, int, const double* q, const double*, double* out, const double* params) {
  out[0] = -9.81 * params[0] - params[1] * q[0] - params[2] * q[0] * q[0] * q[0];
}

void floor_gap(double, int, const double* q, const double*, double* out, const double*) { out[0] = q[0]; }

void floor_jacobian(double, int, const double*, const double*, double* out, const double*) { out[0] = 1.0; }
}
