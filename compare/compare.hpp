#pragma once
// What a program needs that compares integrators on its own model, as the command `saltus compare` does:
//   saltus::CompareSettings settings{.time_steps = {1e-4}, .until = 0.1, .limits = {.max_error = 1e-2}};
//   settings.integrators = {saltus::candidate("HalfExplicitTrapezoidalOSI")};
//   const auto result = saltus::compare(model, settings);
//   std::cout << saltus::to_text(result);
//   return result.ok() ? 0 : 1;
#include "saltus/compare/comparison.hpp"
