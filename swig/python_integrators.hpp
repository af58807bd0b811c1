#pragma once
// Integrators and contact solvers written in Python, and the parts that they are made of.
#include <pybind11/trampoline_self_life_support.h>

#include <memory>
#include <optional>
#include <vector>

#include "bindings.hpp"
#include "saltus/kernel/integrators/contact_stage.hpp"

namespace saltus::python {

/// A step that cannot be taken: raised by the parts, returned by the integrator as its status.
struct StepFailure {
  StepStatus status;
};

/// An integrator whose prepare() and step() are methods of a Python class.
class PyIntegrator final : public OneStepIntegrator, public py::trampoline_self_life_support {
 public:
  std::string name() const override;
  void prepare(const NonSmoothDynamicalSystem& model, ContactSolver& solver) override;
  /// State and reactions change only if the method returns a report whose status is ok.
  StepReport step(double dt, State& state, Reactions& reactions) override;
  /// Of a class that has it; nothing of others.
  std::vector<double> memory() const override;
  void remember(std::span<const double> memory) override;
  /// An object of the same class with the same attributes.
  std::unique_ptr<OneStepIntegrator> clone() const override;
};

/// A contact solver whose solve() is a method of a Python class; the certificate decides about its success.
/// It takes the interpreter's lock, which whoever calls it need not hold.
class PyContactSolver final : public ContactSolver, public py::trampoline_self_life_support {
 public:
  std::string_view name() const override;
  bool accepts(const ContactProblem& problem) const override;
  void reserve(int) override {}
  SolveReport solve(const ContactProblem& problem, double* P) override;
  std::unique_ptr<ContactSolver> clone() const override;

 private:
  mutable std::string name_;
};

/// Configuration for Python, with a model of its own.
class PyConfiguration {
 public:
  explicit PyConfiguration(const NonSmoothDynamicalSystem& model);
  /// @throws std::invalid_argument without a time, if the geometry depends on it
  void move_to(const Vec& q, std::optional<double> t);
  Vec rates(const Vec& v) const;
  Vec forces(double t, const Vec& v) const;
  Vec solve_mass(const Vec& x) const;
  Vec velocities(const Vec& v);
  std::vector<int> closed() const;
  double kinetic_energy(const Vec& v) const;
  /// Is this of the same system, as far as sizes tell?
  bool has_layout_of(const Layout& layout) const {
    return layout_->n == layout.n && layout_->rows == layout.rows &&
           layout_->jacobian_entries == layout.jacobian_entries &&
           layout_->contacts.size() == layout.contacts.size();
  }
  const Configuration& get() const { return configuration_; }
  Configuration& get() { return configuration_; }

 private:
  std::shared_ptr<const NonSmoothDynamicalSystem> model_;
  std::shared_ptr<const Layout> layout_;
  Configuration configuration_;
};

/// What a solved contact problem does.
struct ContactImpulses {
  Vec impulse;   ///< (rows of all contacts) [N s]
  Vec velocity;  ///< (n) M⁻¹ W P, the jump that it makes
  int iterations;
  double residual;  ///< [m/s]
};

/// ContactStage for Python, with a model of its own.
class PyContactStage {
 public:
  PyContactStage(const NonSmoothDynamicalSystem& model, ContactSolver& solver);
  ContactImpulses solve(const std::vector<int>& active, PyConfiguration& constraint, PyConfiguration& force,
                        const Vec& v, const std::optional<Vec>& before, const std::optional<Vec>& warm_start);

 private:
  std::shared_ptr<const NonSmoothDynamicalSystem> model_;
  std::shared_ptr<const Layout> layout_;
  ContactStage stage_;
};

}  // namespace saltus::python
