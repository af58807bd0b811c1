#pragma once
#include <memory>

#include "saltus/kernel/assembly/position_projection.hpp"
#include "saltus/kernel/integrators/adaptive/inner_step.hpp"
#include "saltus/kernel/integrators/half_explicit/rows.hpp"

namespace saltus {

/// A step without impact that can be taken again from the same start with another length, and its error. The
/// contacts that are closed at its start stay in it to its end; others are not looked at.
class Trial {
 public:
  virtual ~Trial() = default;
  /// @param level  gaps at which closed contacts are held (gaps) [m]; must outlive it
  virtual void prepare(const std::shared_ptr<const Layout>& layout, const NonSmoothDynamicalSystem& model,
                       ContactSolver& solver, const Vec& level) = 0;
  /// Chooses the start. @param warm  reactions of the step before
  /// @return false if the status in the report is no longer ok
  virtual bool begin(double t, const Vec& q, const Vec& v, const Reactions& warm, StepReport& report) = 0;
  /// The step. @return as begin()
  virtual bool take(double dt, const std::vector<int>& closed, StepReport& report) = 0;
  /// The end becomes the next start.
  virtual void accept() = 0;
  /// What there is to know about the last step.
  virtual void describe(InnerStep& step) = 0;

  virtual Configuration& start() = 0;
  virtual Configuration& middle() = 0;      ///< somewhere in the step, at
  virtual double middle_place() const = 0;  ///< a fraction of it
  virtual Configuration& last_stage() = 0;  ///< near the end, with a factor of M
  virtual Configuration& end() = 0;
  virtual const Vec& v_start() const = 0;            ///< v⁺ (n)
  virtual const Vec& v_middle() const = 0;           ///< (n)
  virtual Vec& v_end() = 0;                          ///< v⁻ (n)
  virtual const Vec& last_acceleration() const = 0;  ///< M⁻¹h (n)
  virtual const Vec& first_lambda() const = 0;       ///< (rows) [N]
  virtual const Vec& last_lambda() const = 0;        ///< (rows) [N]
  virtual ContactStage& contacts() = 0;

  const Vec& error_q() const { return error_q_; }  ///< (coordinates)
  const Vec& error_v() const { return error_v_; }  ///< (n)

 protected:
  Vec error_q_, error_v_;
};

/// The third-order tableau, c = (0, 1/3, 1). Its error is the difference to the trapezoidal rule on the same
/// stages, with a last multiplier of its own.
std::unique_ptr<Trial> third_order_trial();
/// The forecasting trapezoidal rule in one step and in two halves, extrapolated. Their difference is the
/// error.
std::unique_ptr<Trial> trapezoidal_trial();

}  // namespace saltus
