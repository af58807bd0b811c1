#include "saltus/kernel/first_order/first_order_system.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "saltus/numerics/text.hpp"

namespace saltus {
namespace {

int require_rows(int n, const char* what) {
  if (n < 1)
    throw std::invalid_argument(std::string(what) + " must have at least 1 row, got " + std::to_string(n));
  return n;
}

}  // namespace

BoxLaws complementarity_laws(int n) {
  require_rows(n, "a complementarity condition");
  return {Vec::Zero(n), Vec::Constant(n, BoxLaws::unbounded)};
}

BoxLaws relay_laws(int n, double lower, double upper) {
  require_rows(n, "a relay");
  if (!std::isfinite(lower) || !std::isfinite(upper))
    throw std::invalid_argument("bounds of a relay must be finite, got [" + number(lower) + ", " +
                                number(upper) + "]");
  BoxLaws laws{Vec::Constant(n, lower), Vec::Constant(n, upper)};
  validate(laws, "a relay");
  return laws;
}

BoxLaws equality_laws(int n) {
  require_rows(n, "an equality condition");
  return {Vec::Constant(n, -BoxLaws::unbounded), Vec::Constant(n, BoxLaws::unbounded)};
}

BoxLaws mixed_complementarity_laws(int equalities, int inequalities) {
  if (equalities < 0 || inequalities < 0)
    throw std::invalid_argument("numbers of rows must not be negative, got " + std::to_string(equalities) +
                                " and " + std::to_string(inequalities));
  const int n = require_rows(equalities + inequalities, "a mixed complementarity condition");
  BoxLaws laws{Vec::Zero(n), Vec::Constant(n, BoxLaws::unbounded)};
  laws.lower.head(equalities).setConstant(-BoxLaws::unbounded);
  return laws;
}

FirstOrderSystem::FirstOrderSystem(Systems systems, double t0) : systems_(std::move(systems)), t0_(t0) {
  if (systems_.empty()) throw std::invalid_argument("systems must have at least one entry, got none");
  for (auto system = systems_.begin(); system != systems_.end(); ++system) {
    if (!*system) throw std::invalid_argument("systems must all be there, got a missing one");
    if (std::find(systems_.begin(), system, *system) != system)
      throw std::invalid_argument("systems must differ, got one twice");
  }
  if (!std::isfinite(t0)) throw std::invalid_argument("t0 must be finite, got " + number(t0));
}

int FirstOrderSystem::index_of(const FirstOrderDS& system) const {
  const auto found = std::find_if(systems_.begin(), systems_.end(),
                                  [&](const auto& other) { return other.get() == &system; });
  if (found == systems_.end())
    throw std::invalid_argument("a relation must be linked to systems of this model, got another one");
  return static_cast<int>(found - systems_.begin());
}

void FirstOrderSystem::link(std::shared_ptr<const FirstOrderRelation> relation, BoxLaws laws,
                            const FirstOrderDS& first, const FirstOrderDS* second, std::string name) {
  if (!relation) throw std::invalid_argument("link needs a relation, got none");
  if (second == &first)
    throw std::invalid_argument("a relation must be linked to two different systems, got one twice");
  if (name.empty()) name = "interaction" + std::to_string(links_.size());
  const std::string who = "'" + name + "': ";
  for (const Link& other : links_)
    if (other.name == name) throw std::invalid_argument(who + "the name is taken");
  validate(laws, name);
  if (laws.rows() != relation->size())
    throw std::invalid_argument(who + "law and relation must have as many rows, got " +
                                std::to_string(laws.rows()) + " and " + std::to_string(relation->size()));
  const int second_index = second ? index_of(*second) : -1;
  relation->require_dimension(first.dimension() + (second ? second->dimension() : 0));
  links_.push_back({std::move(name), std::move(relation), std::move(laws), index_of(first), second_index});
}

int FirstOrderSystem::dimension() const {
  int n = 0;
  for (const auto& system : systems_) n += system->dimension();
  return n;
}

int FirstOrderSystem::rows() const {
  int rows = 0;
  for (const Link& link : links_) rows += link.relation->size();
  return rows;
}

Vec FirstOrderSystem::x0() const {
  Vec x(dimension());
  int at = 0;
  for (const auto& system : systems_) {
    x.segment(at, system->dimension()) = system->x0();
    at += system->dimension();
  }
  return x;
}

}  // namespace saltus
