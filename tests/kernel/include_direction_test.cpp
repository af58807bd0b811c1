// Includes point one way: compare → io → kernel → numerics, siconos → kernel, inside the kernel simulation →
// integrators → assembly → model. What is included by a file below it would make a circle of the house.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>

namespace saltus::test {
namespace {

namespace fs = std::filesystem;

// Rooms from bottom to top. A file may include from its own room and from those below.
const std::map<std::string, int> floors = {{"numerics", 0},
                                           {"kernel/model", 1},
                                           {"kernel/assembly", 2},
                                           {"kernel/integrators", 3},
                                           {"kernel/simulation", 4},
                                           {"kernel/first_order", 5},
                                           {"io", 6},
                                           {"compare", 7},
                                           {"siconos", 7}};

// -1 where a path belongs to no room
int floor_of(const std::string& path) {
  for (const auto& [room, level] : floors)
    if (path.rfind(room + "/", 0) == 0) return level;
  return -1;
}

// The path behind `#include "saltus/`, empty on any other line.
std::string included_by(const std::string& line) {
  const std::string start = "#include \"saltus/";
  if (line.rfind(start, 0) != 0) return "";
  return line.substr(start.size(), line.rfind('"') - start.size());
}

struct Include {
  std::string from, to;  // paths in the tree
};

std::vector<Include> includes() {
  const fs::path root = SALTUS_SOURCE_DIR;
  std::vector<Include> found;
  for (const char* room : {"numerics", "kernel", "io", "compare", "siconos"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / room)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".hpp" && extension != ".cpp") continue;
      std::ifstream file(entry.path());
      for (std::string line; std::getline(file, line);)
        if (const std::string to = included_by(line); !to.empty())
          found.push_back({fs::relative(entry.path(), root).generic_string(), to});
    }
  }
  return found;
}

TEST(Includes, PointDownwards) {
  for (const Include& include : includes()) {
    const int from = floor_of(include.from), to = floor_of(include.to);
    EXPECT_GE(from, 0) << include.from << " is in no room that this test knows";
    EXPECT_GE(to, 0) << include.to << ", included by " << include.from
                     << ", is in no room that this test knows";
    EXPECT_GE(from, to) << include.from << " must not include " << include.to;
  }
}

TEST(Includes, OnlyIntegratorsCallAContactSolver) {
  // The kernel's other rooms may name the interface, and the simulation the registry, to hand one on.
  for (const Include& include : includes()) {
    if (include.to.rfind("numerics/solvers/", 0) != 0 || floor_of(include.from) <= 0) continue;
    EXPECT_EQ(include.to, "numerics/solvers/registry.hpp") << include.from;
  }
}

TEST(Includes, WereFoundAtAll) {
  std::set<std::string> rooms;
  for (const Include& include : includes())
    for (const auto& [room, level] : floors)
      if (floor_of(include.from) == level) rooms.insert(room);
  EXPECT_EQ(rooms.size(), floors.size());
  EXPECT_GT(includes().size(), 50u);
}

TEST(Includes, EveryHeaderThatIsIncludedExists) {
  for (const Include& include : includes())
    EXPECT_TRUE(fs::exists(fs::path(SALTUS_SOURCE_DIR) / include.to)) << include.from << ": " << include.to;
}

}  // namespace
}  // namespace saltus::test
