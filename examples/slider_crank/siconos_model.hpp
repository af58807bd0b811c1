#pragma once
// The frictional slider crank of Section 2.1 in classes of Siconos, or in those of siconos/compat.
// slider_crank.py explains the formulas.
#include <SiconosKernel.hpp>

/// Crank, rod and slider with the initial conditions of Table 1, in the notch with clearance.
/// @param until  end of the simulation [s]
SP::NonSmoothDynamicalSystem make_siconos_slider_crank(double until);
