#include "saltus/compare/impacts.hpp"

#include <cmath>

namespace saltus {
namespace {

constexpr double jump = 10.0;      // of an impulse over the one before, where a new impact begins
constexpr double rounding = 1e-6;  // of a resolution: times are multiples of steps

double between(const Impact& a, const Impact& b) { return std::abs(a.t - b.t); }

// Does next[k + 1] suit `other` better than next[k], and `other` suit it better than what follows other?
bool skips(const std::vector<Impact>& next, std::size_t k, const std::vector<Impact>& others, std::size_t o) {
  if (k + 1 >= next.size()) return false;
  const double nearer = between(next[k + 1], others[o]);
  if (nearer >= between(next[k], others[o])) return false;
  return o + 1 >= others.size() || nearer <= between(next[k + 1], others[o + 1]);
}

}  // namespace

std::vector<Impact> find_impacts(const std::vector<Impulse>& impulses, double resolution) {
  const double apart = resolution * (1.0 + rounding);
  std::vector<Impact> impacts;
  const Impulse* last = nullptr;
  for (const Impulse& impulse : impulses) {
    const bool begins = !last || impulse.t - last->t > apart ||
                        (impulse.value > jump * last->value && impulse.t - impacts.back().t > apart);
    if (begins)
      impacts.push_back({impulse.t, impulse.value});
    else if (impulse.t - impacts.back().t <= apart)
      impacts.back().impulse += impulse.value;
    last = &impulse;
  }
  return impacts;
}

ImpactMatch match_impacts(const std::vector<Impact>& run, const std::vector<Impact>& reference,
                          double window) {
  ImpactMatch match;
  std::size_t i = 0, j = 0;
  while (i < run.size() && j < reference.size()) {
    const bool near = between(run[i], reference[j]) <= window;
    if (near && !skips(run, i, reference, j) && !skips(reference, j, run, i))
      match.pairs.emplace_back(run[i++], reference[j++]);
    else if (run[i].t < reference[j].t)
      match.extra.push_back(run[i++]);
    else
      match.missing.push_back(reference[j++]);
  }
  match.extra.insert(match.extra.end(), run.begin() + static_cast<long>(i), run.end());
  match.missing.insert(match.missing.end(), reference.begin() + static_cast<long>(j), reference.end());
  return match;
}

}  // namespace saltus
