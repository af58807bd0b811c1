#include "saltus/numerics/solvers/components.hpp"

#include <boost/pending/disjoint_sets.hpp>

namespace saltus {

void Components::reserve(int rows) {
  for (auto* list : {&parent_, &rank_, &contact_of_, &place_, &component_, &row_component_, &number_,
                     &contacts_.members, &rows_.members})
    list->reserve(rows);
  contacts_.start.reserve(rows + 2);
  rows_.start.reserve(rows + 2);
  part_.b.reserve(rows);
  part_.sets.reserve(rows);
}

void Components::Groups::sort(const std::vector<int>& group_of, int groups) {
  start.assign(groups + 2, 0);
  for (int k : group_of) ++start[k + 2];
  for (int k = 2; k <= groups; ++k) start[k + 1] += start[k];
  members.resize(group_of.size());
  // start[k + 1] runs through the members of group k, and ends where group k + 1 starts
  for (std::size_t i = 0; i < group_of.size(); ++i) members[start[group_of[i] + 1]++] = static_cast<int>(i);
  start.pop_back();
}

int Components::find(const ContactProblem& problem) {
  const int contacts = problem.contacts();
  contact_of_.clear();
  for (int k = 0; k < contacts; ++k) contact_of_.insert(contact_of_.end(), rows_of(problem.sets[k]), k);
  parent_.resize(contacts);
  rank_.resize(contacts);
  boost::disjoint_sets<int*, int*> sets(rank_.data(), parent_.data());
  for (int k = 0; k < contacts; ++k) sets.make_set(k);
  for (int i = 0; i < problem.rows(); ++i)
    for_row(problem, i, [&](int j, double entry) {
      if (entry != 0.0) sets.union_set(contact_of_[i], contact_of_[j]);
    });
  number_.assign(contacts, -1);
  component_.clear();
  row_component_.clear();
  int count = 0;
  for (int k = 0; k < contacts; ++k) {
    int& number = number_[sets.find_set(k)];
    if (number < 0) number = count++;
    component_.push_back(number);
    row_component_.insert(row_component_.end(), rows_of(problem.sets[k]), number);
  }
  contacts_.sort(component_, count);
  rows_.sort(row_component_, count);
  place_.resize(problem.rows());
  for (int k = 0; k < count; ++k)
    for (int i = rows_.start[k]; i < rows_.start[k + 1]; ++i) place_[rows_.members[i]] = i - rows_.start[k];
  return count;
}

const ContactProblem& Components::part(const ContactProblem& problem, int component, bool sparse) {
  const int count = rows(component);
  part_.tolerance = problem.tolerance;
  part_.brief = problem.brief;
  part_.sets.clear();
  for (int k = contacts_.start[component]; k < contacts_.start[component + 1]; ++k)
    part_.sets.push_back(problem.sets[contacts_.members[k]]);
  part_.b.resize(count);
  gather(component, problem.b.data(), part_.b.data());
  part_.sparse.clear();
  part_.G.resize(sparse ? 0 : count, sparse ? 0 : count);
  if (!sparse) part_.G.view().setZero();
  for (int i = 0; i < count; ++i) {
    for_row(problem, rows_.members[rows_.start[component] + i], [&](int j, double entry) {
      if (row_component_[j] != component) return;  // a zero
      if (sparse)
        part_.sparse.add(place_[j], entry);
      else
        part_.G(i, place_[j]) = entry;
    });
    if (sparse) part_.sparse.end_row();
  }
  return part_;
}

void Components::gather(int component, const double* whole, double* part) const {
  for (int i = rows_.start[component]; i < rows_.start[component + 1]; ++i) *part++ = whole[rows_.members[i]];
}

void Components::scatter(int component, const double* part, double* whole) const {
  for (int i = rows_.start[component]; i < rows_.start[component + 1]; ++i) whole[rows_.members[i]] = *part++;
}

}  // namespace saltus
