#include "saltus/numerics/solvers/automatic.hpp"

#include <algorithm>
#include <initializer_list>

#include "saltus/numerics/solvers/one_contact.hpp"

namespace saltus {
namespace {

constexpr int most_rounds = 50;
constexpr int most_reserved_rows =
    256;  // of dense methods, whose storage is their square: beyond, it grows when needed
constexpr int most_dense_rows = 48;  // of a component: beyond, sparse equations are cheaper
constexpr int few_rows = 24;         // up to these, methods that allocate come last
constexpr int most_last_rows =
    600;  // where these fail, dense methods are the last resort; for a dense G at any size
// Of the rounds together, counted in operations of Newton's method: seconds, where small problems take all
// rounds.
constexpr double most_work = 2e10;

int rounds(int rows) {
  const double work = 40.0 / 3.0 * rows * rows * rows;
  return static_cast<int>(std::clamp(most_work / std::max(work, 1.0), 1.0, double(most_rounds)));
}

}  // namespace

void Automatic::reserve(int rows) {
  const int dense = std::min(rows, most_reserved_rows);
  newton_.reserve(dense);
  enumeration_.reserve(dense);
  lemke_.reserve(dense);
  subsets_.reserve(dense);
  prox_.reserve(rows);
  sweeps_.reserve(rows);
  trial_.reserve(rows);
  sweeps_P_.reserve(rows);
  xi_.reserve(rows);
  part_P_.reserve(rows);
  rigid_.reserve(rows);
  interior_.reserve(rows);
  proximal_.reserve(rows);
  components_.reserve(rows);
}

// One contact alone has a closed form.
SolveReport Automatic::solve_single(const ContactProblem& problem, double* P) {
  xi_.resize(problem.rows());
  SolveReport report{.iterations = 1, .solver = "single-contact"};
  solve_one_contact(problem.sets[0], problem.G.row(0), problem.rows(), problem.b.data(), P);
  report.certificate = certify(problem, P, xi_.data());
  if (!report.certificate.within(problem.tolerance)) report.status = SolveStatus::breakdown;
  return report;
}

SolveReport Automatic::solve(const ContactProblem& problem, double* P) {
  const bool small = !problem.is_sparse() && problem.rows() <= most_dense_rows;
  return small ? solve_dense(problem, P) : solve_components(problem, P);
}

SolveReport Automatic::solve_components(const ContactProblem& problem, double* P) {
  SolveReport report;
  int largest = 0;
  const int count = components_.find(problem);
  for (int k = 0; k < count; ++k) {
    const int rows = components_.rows(k);
    const bool sparse = rows > most_dense_rows;
    const ContactProblem& part = components_.part(problem, k, sparse);
    part_P_.resize(rows);
    components_.gather(k, P, part_P_.data());
    SolveReport of_part = sparse ? solve_large(part, part_P_.data()) : solve_dense(part, part_P_.data());
    const bool last = rows <= most_last_rows || !problem.is_sparse();
    if (of_part.status != SolveStatus::solved && sparse && last && !problem.brief) {
      report.iterations += of_part.iterations;
      of_part = solve_dense(components_.part(problem, k, false), part_P_.data());
    }
    components_.scatter(k, part_P_.data(), P);
    report.iterations += of_part.iterations;
    if (of_part.status != SolveStatus::solved) report.status = of_part.status;
    if (of_part.status != SolveStatus::solved && problem.brief) break;
    if (rows > largest) report.solver = of_part.solver;
    largest = std::max(largest, rows);
  }
  xi_.resize(problem.rows());
  report.certificate = certify(problem, P, xi_.data());
  if (report.certificate.within(problem.tolerance))
    report.status = SolveStatus::solved;
  else if (report.status == SolveStatus::solved)
    report.status = SolveStatus::breakdown;
  return report;
}

// Where hardly anything changes, two of Newton's iterations from the warm start are enough.
SolveReport Automatic::solve_large(const ContactProblem& problem, double* P) {
  int iterations = 0;
  SolveReport report;
  for (ContactSolver* method : std::initializer_list<ContactSolver*>{&rigid_, &interior_, &proximal_}) {
    report = method->solve(problem, P);
    report.iterations = iterations += report.iterations;
    if (report.status == SolveStatus::solved || problem.brief) break;
  }
  return report;
}

SolveReport Automatic::solve_dense(const ContactProblem& problem, double* P) {
  const int rows = problem.rows();
  const bool single = problem.contacts() == 1;
  const bool cold = !single && std::all_of(P, P + rows, [](double p) { return p == 0.0; });
  SolveReport best = single ? solve_single(problem, P) : newton_.solve(problem, P);
  if (best.status == SolveStatus::solved) return best;

  trial_.resize(rows);
  sweeps_P_.resize(rows);
  bool ray = false;
  auto improved_by = [&](ContactSolver& method, double* start) {
    const SolveReport report = method.solve(problem, start);
    ray |= report.status == SolveStatus::ray;
    if (report.status == SolveStatus::solved || report.certificate.better_than(best.certificate)) {
      best = report;
      std::copy_n(start, rows, P);
    }
    return best.status == SolveStatus::solved;
  };
  if (problem.brief) {
    std::fill_n(trial_.data(), rows, 0.0);
    if (!cold) improved_by(newton_, trial_.data());
    return best;
  }
  for (ContactSolver* method :
       std::initializer_list<ContactSolver*>{&newton_, &enumeration_, &lemke_, &subsets_}) {
    if (cold && method == &newton_) continue;  // it was just that
    std::fill_n(trial_.data(), rows, 0.0);
    if (method->accepts(problem) && improved_by(*method, trial_.data())) return best;
  }
  auto improved_by_barrier = [&] {
    std::fill_n(trial_.data(), rows, 0.0);
    return improved_by(interior_, trial_.data());
  };
  const bool few = rows <= few_rows, many = rows > most_dense_rows;  // of many it was tried before
  if (!few && !many && improved_by_barrier()) return best;
  // Sweeps come near a solution, Newton's method makes it exact.
  auto improved_by_both = [&](ContactSolver& method) {
    if (improved_by(method, sweeps_P_.data())) return true;
    std::copy_n(sweeps_P_.data(), rows, trial_.data());
    return improved_by(newton_, trial_.data());
  };
  std::fill_n(sweeps_P_.data(), rows, 0.0);
  if (improved_by_both(prox_)) return best;
  std::fill_n(sweeps_P_.data(), rows, 0.0);
  for (int round = 0; round < rounds(rows); ++round)
    if (improved_by_both(sweeps_)) return best;
  if (few && improved_by_barrier()) return best;  // its equations are sparse ones
  if (ray) best.status = SolveStatus::ray;  // says more than that the iterations of the others are used up
  return best;
}

}  // namespace saltus
