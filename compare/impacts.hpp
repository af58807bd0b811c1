#pragma once
#include <utility>
#include <vector>

#include "saltus/compare/sampled_run.hpp"

namespace saltus {

/// An impact of one contact, as far as steps can tell.
struct Impact {
  double t;        ///< its first step [s]
  double impulse;  ///< Σ Λ_N of the contact from there on, over one resolution [N s]
};

/// Impacts of one contact in two runs, in the order of time.
struct ImpactMatch {
  std::vector<std::pair<Impact, Impact>> pairs;  ///< of the run, of the reference
  std::vector<Impact> extra;                     ///< only in the run
  std::vector<Impact> missing;                   ///< only in the reference
};

/// Tells impacts apart that are further than one resolution from each other.
///
/// Impulses that follow each other more closely are one impact: the end of an accumulation, which no step
/// resolves, and a contact that Moreau-Jean keeps closed by an impulse in every step. In such a row a new
/// impact begins where an impulse is ten times the one before it.
/// @param impulses    of one contact
/// @param resolution  [s]
std::vector<Impact> find_impacts(const std::vector<Impulse>& impulses, double resolution);

/// Goes through both runs in the order of time. The two next impacts are a pair if they are at most one
/// window apart, and neither of them is nearer to the one behind the other while that one has nothing nearer
/// either. Otherwise the earlier one has no partner.
/// @param window  [s]
ImpactMatch match_impacts(const std::vector<Impact>& run, const std::vector<Impact>& reference,
                          double window);

}  // namespace saltus
