#pragma once
#include <memory>
#include <string>

#include "saltus/kernel/model/nonsmooth_law.hpp"
#include "saltus/kernel/model/relation.hpp"

namespace saltus {

/// A relation with the law that acts in it. Its name is the key of its results.
class Interaction {
 public:
  /// @param name  may be empty: the system then gives it one when it is linked
  /// @throws std::invalid_argument if relation and law differ in size
  Interaction(std::shared_ptr<const Relation> relation, NonSmoothLaw law, std::string name = "");
  const Relation& relation() const { return *relation_; }
  const NonSmoothLaw& law() const { return law_; }
  const std::string& name() const { return name_; }

 private:
  std::shared_ptr<const Relation> relation_;
  NonSmoothLaw law_;
  std::string name_;
};

}  // namespace saltus
