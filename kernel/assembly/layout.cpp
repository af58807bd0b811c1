#include "saltus/kernel/assembly/layout.hpp"

namespace saltus {

Layout::Layout(const NonSmoothDynamicalSystem& model, double tolerance_of_problems)
    : tolerance(tolerance_of_problems) {
  for (const auto& system : model.systems()) {
    const int size = system->dimension();
    const SparseTerms* sparse = system->sparse_terms();
    systems.push_back({system.get(), n, size, coordinates, system->coordinates(), system->has_velocity_map(),
                       mass_entries, sparse || system->constant_mass(), sparse});
    varying_mass = varying_mass || !systems.back().constant_mass;
    mapped = mapped || systems.back().mapped;
    n += size;
    coordinates += system->coordinates();
    if (!sparse) mass_entries += static_cast<std::size_t>(size) * size;
  }
  for (const auto& link : model.links()) {
    Contact contact{};
    static_cast<Sides&>(contact) = sides(link);
    contact.relation = &link.interaction->relation();
    contact.law = &link.interaction->law();
    contact.row = rows;
    contact.rows = contact.law->size();
    contact.constant_jacobian = contact.relation->constant_jacobian();
    varying_jacobian = varying_jacobian || !contact.constant_jacobian;
    contact.rheonomous = contact.relation->rheonomous();
    rheonomous = rheonomous || contact.rheonomous;
    contact.gap = gaps;
    contact.gaps = contact.law->gaps;
    contact.jacobian = jacobian_entries;
    contacts.push_back(contact);
    rows += contact.rows;
    gaps += contact.gaps;
    largest_contact = std::max({largest_contact, contact.n, contact.coordinates});
    most_rows = std::max(most_rows, contact.rows);
    jacobian_entries += static_cast<std::size_t>(contact.rows) * contact.n;
  }
  for (const auto& force : model.forces()) {
    forces.push_back({sides(force), force.element.get()});
    largest_force = std::max({largest_force, forces.back().n, forces.back().coordinates});
  }
}

Layout::Sides Layout::sides(const NonSmoothDynamicalSystem::Ends& ends) const {
  Sides sides{ends.second < 0 ? 1 : 2, {ends.first, ends.second}, 0, 0};
  for (int side = 0; side < sides.sides; ++side) {
    sides.n += systems[sides.system[side]].n;
    sides.coordinates += systems[sides.system[side]].coordinates;
  }
  return sides;
}

}  // namespace saltus
