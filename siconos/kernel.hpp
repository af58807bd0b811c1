#pragma once
// The names of Siconos's C++ kernel over the classes of Saltus, without Siconos:
//   #include "saltus/siconos/kernel.hpp"
//   using namespace saltus::siconos::kernel;
#include "saltus/siconos/kernel/algebra.hpp"
#include "saltus/siconos/kernel/interactions.hpp"
#include "saltus/siconos/kernel/simulation.hpp"
#include "saltus/siconos/kernel/systems.hpp"
