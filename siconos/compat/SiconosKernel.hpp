#pragma once
// For programs that stay as they were written for Siconos: with this folder among those of headers they are
// compiled with Saltus; or they include the same header as <saltus/kernel.hpp>.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <iostream>

#include "saltus/siconos/kernel.hpp"

using namespace saltus::siconos::kernel;

/// Shows how much is done, 0 to 1.
inline void progressBar(double done) { std::fprintf(stderr, "\r%3.0f %%", 100.0 * done); }

namespace Siconos {

/// What programs catch, and how they show what was thrown.
struct exception : std::exception {
  /// In a catch block: prints the message of what was caught.
  static void process() {
    try {
      throw;
    } catch (const std::exception& error) {
      std::cerr << error.what() << '\n';
    } catch (...) {
      std::cerr << "an exception that is no std::exception\n";
    }
  }
  static void process(const std::exception& error) { std::cerr << error.what() << '\n'; }
};

}  // namespace Siconos

namespace siconos = Siconos;  // as newer programs say
