#include "saltus/numerics/contact_solver.hpp"

namespace saltus {

std::string_view to_string(SolveStatus status) {
  switch (status) {
    case SolveStatus::solved: return "solved";
    case SolveStatus::ray: return "ray";
    case SolveStatus::iteration_limit: return "iteration-limit";
    case SolveStatus::breakdown: break;
  }
  return "breakdown";
}

}  // namespace saltus
