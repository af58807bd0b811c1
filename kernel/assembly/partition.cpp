#include "saltus/kernel/assembly/partition.hpp"

#include <numeric>

namespace saltus {
namespace {

// @param leader  of each system: the first one of its block
std::shared_ptr<const Partition> partition(const Layout& layout, const std::vector<int>& leader) {
  auto result = std::make_shared<Partition>();
  for (int k = 0; k < static_cast<int>(layout.systems.size()); ++k) {
    if (leader[k] == k) {
      result->blocks.emplace_back();
      result->sizes.push_back(0);
    }
    const int block =
        leader[k] == k ? static_cast<int>(result->sizes.size()) - 1 : result->places[leader[k]].block;
    result->places.push_back({block, result->sizes[block]});
    result->blocks[block].push_back(k);
    result->sizes[block] += layout.systems[k].n;
  }
  return result;
}

std::vector<int> alone(const Layout& layout) {
  std::vector<int> leader(layout.systems.size());
  std::iota(leader.begin(), leader.end(), 0);
  return leader;
}

}  // namespace

std::shared_ptr<const Partition> one_block_a_system(const Layout& layout) {
  return partition(layout, alone(layout));
}

std::shared_ptr<const Partition> coupled_by_forces(const Layout& layout) {
  std::vector<int> leader = alone(layout);
  auto find = [&](int k) {
    while (leader[k] != k) k = leader[k] = leader[leader[k]];
    return k;
  };
  for (const auto& force : layout.forces) {
    if (force.sides == 1) continue;
    const int a = find(force.system[0]), b = find(force.system[1]);
    leader[std::max(a, b)] = std::min(a, b);
  }
  for (int k = 0; k < static_cast<int>(leader.size()); ++k) leader[k] = find(k);
  return partition(layout, leader);
}

}  // namespace saltus
