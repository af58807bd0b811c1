#include "saltus/kernel/model/nonsmooth_law.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

double require_restitution(double e, const char* name) {
  if (!(e >= 0.0 && e <= 1.0))
    throw std::invalid_argument(std::string("restitution ") + name + " must be in [0, 1], got " + number(e));
  return e;
}

}  // namespace

NewtonImpactNSL::NewtonImpactNSL(double e) {
  sets = {NonNegative{}};
  restitution = Vec::Constant(1, require_restitution(e, "e"));
}

NewtonImpactFrictionNSL::NewtonImpactFrictionNSL(double en, double et, double mu, int dim) {
  if (!(mu >= 0.0) || !std::isfinite(mu))
    throw std::invalid_argument("friction coefficient mu must be finite and >= 0, got " + number(mu));
  if (dim != 2 && dim != 3)
    throw std::invalid_argument("dim must be 2 (plane) or 3 (space), got " + std::to_string(dim));
  sets = {Coulomb{mu, dim}};
  restitution = Vec::Constant(dim, require_restitution(et, "et"));
  restitution[0] = require_restitution(en, "en");
}

EqualityConditionNSL::EqualityConditionNSL(int n) {
  if (n < 1) throw std::invalid_argument("an equality condition needs n >= 1 rows, got " + std::to_string(n));
  sets.assign(n, Equality{});
  restitution = Vec::Zero(n);
  gaps = n;
  bilateral = true;
}

}  // namespace saltus
