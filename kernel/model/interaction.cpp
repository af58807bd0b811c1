#include "saltus/kernel/model/interaction.hpp"

#include <stdexcept>

namespace saltus {

Interaction::Interaction(std::shared_ptr<const Relation> relation, NonSmoothLaw law, std::string name)
    : relation_(std::move(relation)), law_(std::move(law)), name_(std::move(name)) {
  if (!relation_) throw std::invalid_argument("an interaction needs a relation, got none");
  if (relation_->size() != law_.size())
    throw std::invalid_argument("relation and law must have the same number of rows, got " +
                                std::to_string(relation_->size()) + " and " + std::to_string(law_.size()) +
                                (name_.empty() ? "" : " in '" + name_ + "'"));
}

}  // namespace saltus
