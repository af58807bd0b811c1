#include "saltus/kernel/integrators/moreau_jean/activity.hpp"

#include <algorithm>

namespace saltus {
namespace {

constexpr double steps_of_drift = 100.0;

}  // namespace

bool predict_active(const Layout& layout, Configuration& start, const Vec& v, double dt, Vec& gamma,
                    std::vector<int>& active) {
  active.clear();
  const int contacts = static_cast<int>(layout.contacts.size());
  double zero_velocity = 0.0;
  for (int k = 0; k < contacts; ++k) {
    start.relative_velocity(k, v, gamma.data() + layout.contacts[k].row);
    zero_velocity = std::max(zero_velocity, start.velocity_tolerance(k, v));
  }
  // What contact problems that are solved to their tolerance make of a gap that is closed in a while:
  // rounding must not decide whether contacts at rest are active.
  const double drift = steps_of_drift * dt * zero_velocity;
  for (int k = 0; k < contacts; ++k) {
    const auto& contact = layout.contacts[k];
    const double prediction = start.gaps()[contact.gap] + 0.5 * dt * gamma[contact.row];
    if (contact.law->bilateral || prediction <= drift + start.gap_tolerance(k, 0)) active.push_back(k);
  }
  return gamma.allFinite();
}

}  // namespace saltus
