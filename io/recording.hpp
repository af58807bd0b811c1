#pragma once
#include <functional>
#include <string_view>
#include <variant>
#include <vector>

#include "saltus/kernel/simulation/observer.hpp"

namespace saltus {

/// A run in memory, column by column; every column holds its rows one after the other.
class Recording final : public Observer {
 public:
  /// Takes a recording whose rows are about to be forgotten.
  using Sink = std::function<void(const Recording& chunk)>;

  /// Keeps row 0, every n-th row and all impulsive steps.
  /// @throws std::invalid_argument if every < 1
  explicit Recording(long every = 1);

  bool wants(long number, const StepReport& report) const override;
  void observe(const StepView& view) override;

  /// Bounds the memory of a long run: from now on rows are handed to the sink and then forgotten, whenever
  /// one is recorded and there are `rows`, or the last time was `seconds` ago. A row whose sink throws stays,
  /// and the exception ends the run.
  /// @throws std::invalid_argument if there is no sink, rows < 1, or seconds is not positive
  void stream(Sink sink, long rows, double seconds);
  /// Hands on what is there. @throws what the sink throws
  void flush();

  /// Number of the rows in memory, and of those that were handed on before them.
  long rows() const { return static_cast<long>(t.size()); }
  long handed_on() const { return handed_on_; }

  std::vector<double> t;                                       ///< (rows) [s]
  std::vector<double> q, v;                                    ///< (rows, coordinates), (rows, n)
  std::vector<double> gaps;                                    ///< (rows, gaps) [m]
  std::vector<double> velocities;                              ///< (rows, contact rows) [m/s]
  std::vector<double> lambda_plus, lambda_minus, force;        ///< likewise [N]
  std::vector<double> impulse;                                 ///< likewise [N s]
  std::vector<double> residual, penetration;                   ///< (rows) [m/s], [m]
  std::vector<double> kinetic_energy, potential_energy;        ///< (rows) [J]
  std::vector<double> work_forces, work_lambda, work_impulse;  ///< (rows) [J], of the recorded step
  std::vector<long> step, closed;                              ///< (rows)
  std::vector<long> accepted_steps, rejected_steps, event_steps, captures;  ///< (rows), of the recorded step
  std::vector<unsigned char> impulsive;                                     ///< (rows)

 private:
  long every_;
  long handed_on_ = 0;
  Sink sink_;
  long chunk_rows_ = 0;
  double chunk_seconds_ = 0.0;
  double last_ = 0.0;  // when rows were handed on [s of a steady clock]
};

/// A column of a run: what files call it, and where a recording keeps it.
struct Column {
  /// How many values a row has: one, one a coordinate, a freedom, a gap, or a row of Wᵀ.
  enum class Width { one, coordinates, freedoms, gaps, rows };
  using Values = std::variant<std::vector<double> Recording::*, std::vector<long> Recording::*,
                              std::vector<unsigned char> Recording::*>;

  std::string_view name;
  std::string_view unit;  ///< "1" if it has none
  Width width;
  Values values;
};

/// All columns of a run, in the order of files.
const std::vector<Column>& run_columns();

}  // namespace saltus
