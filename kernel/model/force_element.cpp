#include "saltus/kernel/model/force_element.hpp"

#include <stdexcept>

namespace saltus {

ForceElement::ForceElement(std::shared_ptr<const Relation> relation, ForceLaw law, std::string name)
    : relation_(std::move(relation)), law_(std::move(law)), name_(std::move(name)) {
  const std::string who = name_.empty() ? "" : " in '" + name_ + "'";
  if (!relation_) throw std::invalid_argument("a force element needs a relation, got none" + who);
  if (relation_->size() != 1)
    throw std::invalid_argument("the relation of a force element must have 1 row, its length, got " +
                                std::to_string(relation_->size()) + who);
}

}  // namespace saltus
