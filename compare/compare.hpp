#pragma once
// What a program needs that compares integrators on its own model, as the command `saltus compare` does:
//   const auto result = saltus::compare(model, {.integrators =
//   {saltus::candidate("HalfExplicitTrapezoidalOSI")},
//                                               .time_steps = {1e-4}, .until = 0.1, .limits = {.max_error =
//                                               1e-2}});
//   std::cout << saltus::to_text(result);
//   return result.ok() ? 0 : 1;
#include "saltus/compare/comparison.hpp"
