#pragma once
// For programs that stay as they were written for Siconos: with this folder among those of headers they are
// compiled with Saltus.
#include "saltus/siconos/kernel.hpp"

using namespace saltus::siconos::kernel;
