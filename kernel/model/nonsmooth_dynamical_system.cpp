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
  }
}

void NonSmoothDynamicalSystem::link(std::shared_ptr<const Interaction> interaction, const LagrangianDS& first,
                                    const LagrangianDS* second) {
  if (!interaction) throw std::invalid_argument("link needs an interaction, got none");
  Link link{interaction, interaction->name(), index_of(first), second ? index_of(*second) : -1};
  if (link.first == link.second)
    throw std::invalid_argument("an interaction acts between two different systems, got one twice");
  for (std::size_t k = links_.size(); link.name.empty(); ++k)
    if (const std::string candidate = "contact" + std::to_string(k); !names_.count(candidate))
      link.name = candidate;
  if (names_.count(link.name))
    throw std::invalid_argument("the name of an interaction must be unique, got '" + link.name + "' twice");
  interaction->relation().require_dimension(first.dimension() + (second ? second->dimension() : 0));
  names_.insert(link.name);
  links_.push_back(std::move(link));
}

int NonSmoothDynamicalSystem::index_of(const LagrangianDS& system) const {
  const auto found = index_.find(&system);
  if (found == index_.end())
    throw std::invalid_argument("link: the dynamical system is not part of this NonSmoothDynamicalSystem");
  return found->second;
}

int NonSmoothDynamicalSystem::dimension() const {
  int n = 0;
  for (const auto& system : systems_) n += system->dimension();
  return n;
}

namespace {

template <class Part>
Vec concatenate(const NonSmoothDynamicalSystem& model, Part part) {
  Vec all(model.dimension());
  int offset = 0;
  for (const auto& system : model.systems()) {
    all.segment(offset, system->dimension()) = part(*system);
    offset += system->dimension();
  }
  return all;
}

}  // namespace

Vec NonSmoothDynamicalSystem::q0() const {
  return concatenate(*this, [](const LagrangianDS& system) { return system.q0(); });
}

Vec NonSmoothDynamicalSystem::v0() const {
  return concatenate(*this, [](const LagrangianDS& system) { return system.v0(); });
}

}  // namespace saltus
