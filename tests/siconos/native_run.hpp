#pragma once
// Runs without Siconos, for tests in the C++ that its headers are written in.
#include <string>
#include <vector>

namespace saltus::test {

/// At the end of a step. Of each corner gap [m], velocities [m/s] and the impulse of the step, forces
/// included [N s], all in the order of the corners.
struct NativeStep {
  std::vector<double> q, v, gaps, velocities, impulses;
};

/// The frictional slider crank with a scheme of the registry and its standard options.
std::vector<NativeStep> native_slider_crank(const std::string& scheme, double dt, double until);

}  // namespace saltus::test
