#include "saltus/kernel/integrators/moreau_jean/activity.hpp"

namespace saltus {

void predict_active(const Layout& layout, const Configuration& start, const Vec& gamma, double dt,
                    std::vector<int>& active) {
  active.clear();
  for (int k = 0; k < static_cast<int>(layout.contacts.size()); ++k) {
    const auto& contact = layout.contacts[k];
    const double prediction = start.gaps()[contact.gap] + 0.5 * dt * gamma[contact.row];
    if (contact.law->bilateral || prediction <= 0.0) active.push_back(k);
  }
}

}  // namespace saltus
