#pragma once
#include <vector>

#include "saltus/kernel/simulation/observer.hpp"

namespace saltus {

/// A run in memory, column by column; every column holds its rows one after the other.
class Recording final : public Observer {
 public:
  /// Keeps row 0, every n-th row and all impulsive steps.
  /// @throws std::invalid_argument if every < 1
  explicit Recording(long every = 1);

  bool wants(long number, const StepReport& report) const override;
  void observe(const StepView& view) override;

  long rows() const { return static_cast<long>(t.size()); }

  std::vector<double> t;                                       ///< (rows) [s]
  std::vector<double> q, v;                                    ///< (rows, n)
  std::vector<double> gaps;                                    ///< (rows, gaps) [m]
  std::vector<double> velocities;                              ///< (rows, contact rows) [m/s]
  std::vector<double> lambda_plus, lambda_minus;               ///< likewise [N]
  std::vector<double> impulse;                                 ///< likewise [N s]
  std::vector<double> residual, penetration;                   ///< (rows) [m/s], [m]
  std::vector<double> kinetic_energy, potential_energy;        ///< (rows) [J]
  std::vector<double> work_forces, work_lambda, work_impulse;  ///< (rows) [J], of the recorded step
  std::vector<long> step, closed;                              ///< (rows)
  std::vector<unsigned char> impulsive;                        ///< (rows)

 private:
  long every_;
};

}  // namespace saltus
