// Which impulses are one impact, and which impacts of two runs are the same.
#include "saltus/compare/impacts.hpp"

#include <gtest/gtest.h>

namespace saltus::test {
namespace {

constexpr double resolution = 3.0;

std::vector<Impact> impacts_at(std::initializer_list<double> times) {
  std::vector<Impact> impacts;
  for (double t : times) impacts.push_back({t, 1.0});
  return impacts;
}

std::vector<std::pair<double, double>> times_of(const ImpactMatch& match) {
  std::vector<std::pair<double, double>> times;
  for (const auto& [a, b] : match.pairs) times.emplace_back(a.t, b.t);
  return times;
}

using Pairs = std::vector<std::pair<double, double>>;

TEST(FindImpacts, ApartFromEachOther) {
  const auto impacts = find_impacts({{1.0, 5.0}, {10.0, 4.0}, {20.0, 3.0}}, resolution);
  ASSERT_EQ(impacts.size(), 3u);
  EXPECT_EQ(impacts[1].t, 10.0);
  EXPECT_EQ(impacts[1].impulse, 4.0);
  EXPECT_TRUE(find_impacts({}, resolution).empty());
}

TEST(FindImpacts, AContactThatStaysClosedIsOne) {
  // As Moreau-Jean holds it: the impact, then m g Δt in every step. Only one resolution of that is counted.
  std::vector<Impulse> impulses{{0.0, 5.0}};
  for (int k = 1; k <= 50; ++k) impulses.push_back({static_cast<double>(k), 0.1});
  const auto impacts = find_impacts(impulses, resolution);
  ASSERT_EQ(impacts.size(), 1u);
  EXPECT_NEAR(impacts[0].impulse, 5.3, 1e-12);
}

TEST(FindImpacts, AnImpulseThatJumpsInAClosedContactIsAnother) {
  std::vector<Impulse> impulses{{0.0, 5.0}};
  for (int k = 1; k <= 50; ++k) impulses.push_back({static_cast<double>(k), k == 30 ? 2.0 : 0.1});
  const auto impacts = find_impacts(impulses, resolution);
  ASSERT_EQ(impacts.size(), 2u);
  EXPECT_EQ(impacts[1].t, 30.0);
  EXPECT_NEAR(impacts[1].impulse, 2.3, 1e-12);
}

TEST(FindImpacts, AnAccumulationEndsInOne) {
  std::vector<Impulse> impulses;
  double t = 0.0, flight = 64.0;
  for (int k = 0; k < 500; ++k, t += flight, flight *= 0.5) impulses.push_back({t, flight});
  EXPECT_EQ(find_impacts(impulses, resolution).size(),
            6u);  // flights of 64, 32, 16, 8, 4 and all shorter ones
}

TEST(MatchImpacts, InTheOrderOfTime) {
  const auto match = match_impacts(impacts_at({1.0, 2.1, 2.9}), impacts_at({1.1, 2.0, 3.0}), 0.5);
  EXPECT_EQ(times_of(match), (Pairs{{1.0, 1.1}, {2.1, 2.0}, {2.9, 3.0}}));
  EXPECT_TRUE(match.extra.empty());
  EXPECT_TRUE(match.missing.empty());
}

TEST(MatchImpacts, WithoutPartner) {
  const auto match = match_impacts(impacts_at({1.0, 5.0}), impacts_at({1.0, 3.0, 9.0}), 0.5);
  EXPECT_EQ(times_of(match), (Pairs{{1.0, 1.0}}));
  ASSERT_EQ(match.extra.size(), 1u);
  EXPECT_EQ(match.extra[0].t, 5.0);
  EXPECT_EQ(match.missing.size(), 2u);
}

TEST(MatchImpacts, TheNearerOneWins) {
  // One impact more at the beginning must not shift all the others by one.
  const auto match = match_impacts(impacts_at({0.8, 1.1, 2.0, 3.0}), impacts_at({1.05, 2.05, 3.05}), 0.5);
  EXPECT_EQ(times_of(match), (Pairs{{1.1, 1.05}, {2.0, 2.05}, {3.0, 3.05}}));
  ASSERT_EQ(match.extra.size(), 1u);
  EXPECT_EQ(match.extra[0].t, 0.8);
  // A common delay that is less than half the distance does not lose any
  EXPECT_EQ(match_impacts(impacts_at({1.0, 2.0, 3.0}), impacts_at({1.4, 2.4, 3.4}), 0.5).pairs.size(), 3u);
}

TEST(MatchImpacts, NoneAtAll) {
  EXPECT_TRUE(match_impacts({}, {}, 1.0).pairs.empty());
  EXPECT_EQ(match_impacts({}, impacts_at({1.0}), 1.0).missing.size(), 1u);
  EXPECT_EQ(match_impacts(impacts_at({1.0}), {}, 1.0).extra.size(), 1u);
}

}  // namespace
}  // namespace saltus::test
