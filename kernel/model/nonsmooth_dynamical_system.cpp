#include "saltus/kernel/model/nonsmooth_dynamical_system.hpp"

#include <cmath>
#include <stdexcept>

#include "saltus/numerics/text.hpp"

namespace saltus {

NonSmoothDynamicalSystem::NonSmoothDynamicalSystem(Systems systems, double t0)
    : systems_(std::move(systems)), t0_(t0) {
  if (systems_.empty()) throw std::invalid_argument("at least one dynamical system is needed, got none");
  if (!std::isfinite(t0)) throw std::invalid_argument("t0 must be finite, got " + number(t0));
  for (std::size_t i = 0; i < systems_.size(); ++i) {
    if (!systems_[i]) throw std::invalid_argument("dynamical system " + std::to_string(i) + " is null");
    if (!index_.emplace(systems_[i].get(), static_cast<int>(i)).second)
      throw std::invalid_argument("dynamical system " + std::to_string(i) + " stands twice in the list");
    const int coordinates = systems_[i]->coordinates(), freedoms = systems_[i]->dimension();
    if (!systems_[i]->has_velocity_map() && coordinates != freedoms)
      throw std::invalid_argument("v0 must have " + std::to_string(coordinates) +
                                  " entries as q0 has, unless the system defines velocity_map, got " +
                                  std::to_string(freedoms) + " in dynamical system " + std::to_string(i));
  }
}

void NonSmoothDynamicalSystem::link(std::shared_ptr<const Interaction> interaction, const LagrangianDS& first,
                                    const LagrangianDS* second) {
  if (!interaction) throw std::invalid_argument("link needs an interaction, got none");
  const std::string name =
      interaction->name().empty() ? free_name("contact", links_.size()) : interaction->name();
  Ends ends = connect("an interaction", name, interaction->relation(), first, second);
  links_.push_back({std::move(ends), std::move(interaction)});
}

void NonSmoothDynamicalSystem::add_force(std::shared_ptr<const ForceElement> element,
                                         const LagrangianDS& first, const LagrangianDS* second) {
  if (!element) throw std::invalid_argument("add_force needs a force element, got none");
  const std::string name = element->name().empty() ? free_name("force", forces_.size()) : element->name();
  Ends ends = connect("a force element", name, element->relation(), first, second);
  forces_.push_back({std::move(ends), std::move(element)});
}

// What is refused leaves nothing behind.
NonSmoothDynamicalSystem::Ends NonSmoothDynamicalSystem::connect(const std::string& kind,
                                                                 const std::string& name,
                                                                 const Relation& relation,
                                                                 const LagrangianDS& first,
                                                                 const LagrangianDS* second) {
  Ends ends{name, index_of(first), second ? index_of(*second) : -1};
  if (ends.first == ends.second)
    throw std::invalid_argument(kind + " acts between two different systems, got one twice");
  if (names_.count(name))
    throw std::invalid_argument("the name of " + kind + " must be unique, got '" + name + "' twice");
  relation.require_dimensions(first.coordinates() + (second ? second->coordinates() : 0),
                              first.dimension() + (second ? second->dimension() : 0));
  Vec q0(first.coordinates() + (second ? second->coordinates() : 0));
  q0.head(first.coordinates()) = first.q0();
  if (second) q0.tail(second->coordinates()) = second->q0();
  relation.require_start({q0.data(), q0.size()});
  names_.insert(name);
  return ends;
}

std::string NonSmoothDynamicalSystem::free_name(const std::string& stem, std::size_t number) const {
  while (names_.count(stem + std::to_string(number))) ++number;
  return stem + std::to_string(number);
}

int NonSmoothDynamicalSystem::index_of(const LagrangianDS& system) const {
  const auto found = index_.find(&system);
  if (found == index_.end())
    throw std::invalid_argument("the dynamical system is not part of this NonSmoothDynamicalSystem");
  return found->second;
}

int NonSmoothDynamicalSystem::dimension() const {
  int n = 0;
  for (const auto& system : systems_) n += system->dimension();
  return n;
}

int NonSmoothDynamicalSystem::coordinates() const {
  int n = 0;
  for (const auto& system : systems_) n += system->coordinates();
  return n;
}

namespace {

template <class Part>
Vec concatenate(const NonSmoothDynamicalSystem& model, int size, Part part) {
  Vec all(size);
  Eigen::Index offset = 0;
  for (const auto& system : model.systems()) {
    const Vec& own = part(*system);
    all.segment(offset, own.size()) = own;
    offset += own.size();
  }
  return all;
}

}  // namespace

Vec NonSmoothDynamicalSystem::q0() const {
  return concatenate(*this, coordinates(),
                     [](const LagrangianDS& system) -> const Vec& { return system.q0(); });
}

Vec NonSmoothDynamicalSystem::v0() const {
  return concatenate(*this, dimension(),
                     [](const LagrangianDS& system) -> const Vec& { return system.v0(); });
}

}  // namespace saltus
