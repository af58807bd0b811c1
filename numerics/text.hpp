#pragma once
#include <cstdio>
#include <string>

namespace saltus {

/// A number as messages show it: short, and not rounded to zero.
inline std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

}  // namespace saltus
