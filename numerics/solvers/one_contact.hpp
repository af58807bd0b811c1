#pragma once
#include "saltus/numerics/contact_problem.hpp"

namespace saltus {

/// The law of one contact alone: P with xi = G P + c, in closed form.
/// @param G    (rows, rows) the contact's diagonal block, row i at G + i*stride; may be unsymmetric or
/// singular
/// @param c    (rows) [m/s]
/// @param[out] P (rows) [N s]; of several solutions one that sticks, or the one with the least normal impulse
/// @return false if no P satisfies the law; P is untouched then
bool solve_one_contact(const ContactSet& set, const double* G, int stride, const double* c, double* P);

}  // namespace saltus
