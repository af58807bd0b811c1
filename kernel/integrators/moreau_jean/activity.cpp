#include "saltus/kernel/integrators/moreau_jean/activity.hpp"

namespace saltus {
namespace {

constexpr double steps_of_drift = 100.0;

}  // namespace

bool predict_active(const Layout& layout, Configuration& start, const Vec& v, double dt, Vec& gamma,
                    std::vector<int>& active, double part) {
  active.clear();
  for (int k = 0; k < static_cast<int>(layout.contacts.size()); ++k) {
    const auto& contact = layout.contacts[k];
    start.relative_velocity(k, v, gamma.data() + contact.row);
    const double prediction = start.gaps()[contact.gap] + part * dt * gamma[contact.row];
    const bool closes =
        prediction <= 0.0 ||
        prediction <= steps_of_drift * dt * start.velocity_tolerance(k, v) + start.gap_tolerance(k, 0);
    if (contact.law->bilateral || closes) active.push_back(k);
  }
  return gamma.allFinite();
}

}  // namespace saltus
