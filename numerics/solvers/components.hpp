#pragma once
#include "saltus/numerics/contact_problem.hpp"

namespace saltus {

/// The parts of a contact problem that know nothing of each other: connected components of the graph in which
/// contacts that G couples are neighbours. Each is a problem of its own.
class Components {
 public:
  void reserve(int rows);
  /// Finds them, in the order of their first contacts. @return how many there are
  int find(const ContactProblem& problem);
  /// Number of rows of a component
  int rows(int component) const { return rows_.start[component + 1] - rows_.start[component]; }
  /// The problem of one component, with a dense G or sparse rows. Valid until the next call.
  const ContactProblem& part(const ContactProblem& problem, int component, bool sparse);
  /// Copies between the rows of the whole problem and those of a component.
  void gather(int component, const double* whole, double* part) const;
  void scatter(int component, const double* part, double* whole) const;

 private:
  struct Groups {  // of what is numbered, the members of group k from start[k] to start[k + 1]
    std::vector<int> start, members;
    void sort(const std::vector<int>& group_of, int groups);
  };

  std::vector<int> parent_, rank_;              // of each contact, for the search
  std::vector<int> contact_of_, place_;         // of each row: its contact, its row in the part
  std::vector<int> component_, row_component_;  // of each contact and each row
  std::vector<int> number_;                     // of each root
  Groups contacts_, rows_;
  ContactProblem part_;
};

}  // namespace saltus
