#include "saltus/kernel/integrators/half_explicit/sliding.hpp"

#include <algorithm>
#include <cmath>

namespace saltus {
namespace {

constexpr double none_in_tolerances = 1e3;  // what counts as no speed
constexpr double least_kept = 0.1;          // of the speed, to go on sliding
constexpr int reserved_rows = 64;           // of a dense G; beyond, it grows when it is first needed

}  // namespace

Sliding::Sliding(std::shared_ptr<const Layout> layout, int stages) : layout_(std::move(layout)) {
  const int rows = stages * layout_->rows;
  slides_.reserve(stages * layout_->contacts.size());
  gamma_.resize(layout_->most_rows);
  reduced_.tolerance = layout_->tolerance;
  reduced_.brief = true;
  reduced_.G.reserve(std::min(rows, reserved_rows), std::min(rows, reserved_rows));
  reduced_.b.reserve(rows);
  reduced_.sets.reserve(rows);
  reduced_P_.reserve(rows);
  column_.reserve(rows);
  factor_.reserve(rows);
}

void Sliding::clear() {
  slides_.clear();
  rows_ = sets_ = 0;
}

void Sliding::add(const std::vector<int>& active, Configuration& stage, const Vec& v) {
  for (int k : active) {
    const auto& slot = layout_->contacts[k];
    const auto* law = std::get_if<Coulomb>(&slot.law->sets[0]);
    if (law && law->dim == 3 && law->mu > 0.0) {
      stage.relative_velocity(k, v, gamma_.data());
      const double none = none_in_tolerances * stage.velocity_tolerance(k, v);
      const double speed = std::hypot(gamma_[1], gamma_[2]);
      // One that still approaches is stopped as by an impact.
      if (speed > none && gamma_[0] >= -none)
        slides_.push_back({rows_, sets_, law->mu, speed, {gamma_[1] / speed, gamma_[2] / speed}});
    }
    rows_ += slot.rows;
    sets_ += static_cast<int>(slot.law->sets.size());
  }
}

bool Sliding::solve(ContactStage& contacts, const ContactProblem& problem, PoolVec& P, StepReport& report) {
  while (!slides_.empty()) {
    reduce(problem, P);
    StepReport trial = report;
    if (!contacts.solve(reduced_, reduced_P_, trial)) break;
    expand(P);
    report.solver_iterations = trial.solver_iterations;
    if (release_stopping(problem, P)) continue;
    report = trial;
    return true;
  }
  return contacts.solve(problem, P, report);  // (70)
}

// ξ_N of sliding contacts depends on their P_N alone, with W_N − μ W_T d in the place of W.
void Sliding::reduce(const ContactProblem& problem, const PoolVec& P) {
  reduced_.sets = problem.sets;
  const int rows = problem.rows();
  column_.resize(rows);
  factor_.assign(rows, 1.0);
  for (const Slide& slide : slides_) {
    reduced_.sets[slide.set] = NonNegative{};
    for (int i : {0, 1}) factor_[slide.row + 1 + i] = -slide.mu * slide.d[i];
  }
  int size = 0;
  auto next = slides_.begin();
  for (int row = 0; row < rows; ++row) {
    while (next != slides_.end() && row > next->row + 2) ++next;
    const bool dependent = next != slides_.end() && row > next->row;
    column_[row] = dependent ? size - 1 : size++;
  }
  reduced_.b.resize(size);
  reduced_P_.resize(size);
  reduced_.sparse.clear();
  reduced_.G.resize(problem.is_sparse() ? 0 : size, problem.is_sparse() ? 0 : size);
  reduced_.G.view().setZero();
  for (int row = 0; row < rows; ++row) {
    const int i = column_[row];
    if (row > 0 && column_[row - 1] == i) continue;
    reduced_.b[i] = problem.b[row];
    reduced_P_[i] = P[row];
    if (!problem.is_sparse()) {
      for_row(problem, row, [&](int j, double entry) { reduced_.G(i, column_[j]) += factor_[j] * entry; });
      continue;
    }
    SparseRows& G = reduced_.sparse;
    int last = -1;
    for_row(problem, row, [&](int j, double entry) {
      if (column_[j] == last)
        G.value.back() += factor_[j] * entry;
      else
        G.add(last = column_[j], factor_[j] * entry);
    });
    G.end_row();
  }
}

void Sliding::expand(PoolVec& P) const {
  for (int row = 0; row < P.size(); ++row) P[row] = factor_[row] * reduced_P_[column_[row]];
}

// Takes out those that keep less than least_kept of their speed along d. @return true if there are any
bool Sliding::release_stopping(const ContactProblem& problem, const PoolVec& P) {
  return std::erase_if(slides_, [&](const Slide& slide) {
           double along = 0.0;
           for (int i : {0, 1}) {
             double xi = problem.b[slide.row + 1 + i];
             for_row(problem, slide.row + 1 + i, [&](int j, double entry) { xi += entry * P[j]; });
             along += slide.d[i] * xi;
           }
           return !(along >= least_kept * slide.speed);
         }) > 0;
}

}  // namespace saltus
