#pragma once
#include <memory>
#include <vector>

#include "saltus/kernel/integrators/contact_stage.hpp"
#include "saltus/kernel/integrators/half_explicit/sliding.hpp"
#include "saltus/kernel/integrators/half_explicit/tableau.hpp"

namespace saltus {

/// The rows of one step of a half-explicit scheme, each an explicit stage with a multiplier that keeps the
/// constraint. Which contacts act in a row, and what follows a step, are the affair of the schemes.
class Rows {
 public:
  struct Stage {
    Vec v;                // velocity
    Vec rate;             // q̇ = Y v, of models with velocity maps
    Vec h;                // forces
    Vec acceleration;     // M⁻¹h
    bool loaded = false;  // contacts carry λ; else λ is zero, and reaction is not looked at
    Vec reaction;         // M⁻¹Wλ
    Vec lambda;           // (rows of all contacts) [N]
  };

  /// @param on_velocity_level  else the constraint is taken at the stage of the multiplier
  /// @throws std::invalid_argument if the tableau is refused
  explicit Rows(Tableau tableau, bool on_velocity_level = true);
  void prepare(std::shared_ptr<const Layout> layout, const NonSmoothDynamicalSystem& model,
               ContactSolver& solver);

  /// Row 0. @param warm  reactions of the step before
  void begin(double t, const Vec& q, const Vec& v, const Reactions& warm);
  /// Chooses where the first and the last multiplier are sought from, if a step is taken again.
  void warm_start(const Reactions& before);
  /// h and M⁻¹h at stage l
  bool stage(int l, double dt, StepReport& report);
  /// v_l without λ_{l-1}
  void free_velocity(int l, double dt);
  /// Where Wᵀv = 0 is asked for in row l: at its own position, or at a prediction of it where that needs the
  /// velocity first, (69), (71). @param gaps  the gaps there are wanted as well
  Configuration& constraint(int l, double dt, bool gaps);
  /// The contact problem of row l on velocity level, for these contacts.
  void assemble(int l, const std::vector<int>& active, Configuration& constraint);
  /// The same on acceleration level, g̈ at the stage of the multiplier times the time that it acts: (40),
  /// (49)-(50)
  void assemble_acceleration(int l, double dt, const std::vector<int>& active);
  /// λ_{l-1} of these contacts, for which the problem was assembled; then v_l and q_l: (66), (69)-(70), (63)
  /// and (67), (71)-(72)
  bool finish(int l, double dt, const std::vector<int>& active, StepReport& report);
  /// The end velocity of another scheme on the same stages, whose last multiplier is found anew; after the
  /// output row. @param b  weights (s+1) @param[out] v  (n)
  bool embedded_velocity(const Vec& b, double dt, const std::vector<int>& active, Vec& v, StepReport& report);
  /// v_{s+1} and λ_s once more, with the constraint at another place than the end; after the output row.
  /// @param v       in: without λ_s; out: v_{s+1} (n)
  /// @param lambda  in: warm start; out: λ_s (rows) [N]
  bool redo_last(double dt, const std::vector<int>& active, Configuration& at, Vec& v, Vec& lambda,
                 StepReport& report);
  /// q_l of the velocities at hand; gaps only where it is the end
  void locate(int l, double dt);
  /// q_i, (64), with its gaps
  void move_to_end(double dt);
  /// Work of h and of λ by the scheme's quadrature, and ½ vᵀṀv by the trapezoidal rule.
  /// @param v_end  up to which h and λ act
  void take_work(double dt, const Vec& v_end, StepReport& report);
  /// λ_kᵀ W(q_k)ᵀ v_k [W]
  double lambda_power(int k);
  /// The mean of λ, by the scheme's quadrature. @param[out] force (rows) [N]
  void mean_force(Vec& force) const;
  /// The end becomes the next start.
  void advance();

  /// Start of the step [s]
  double t() const { return t_; }
  const Tableau& tableau() const { return tableau_; }
  /// Rows 1...s, output s+1
  int s() const { return s_; }
  Stage& at_stage(int l) { return stages_[l]; }
  const Stage& at_stage(int l) const { return stages_[l]; }
  Stage& output() { return stages_[s_ + 1]; }
  Configuration& at(int l) { return configurations_[slot_[l]]; }
  Configuration& end() { return at(s_ + 1); }
  ContactStage& contacts() { return *contacts_; }

 private:
  bool solve(const Vec& lambda, double weight, StepReport& report);
  void position(const Matrix& A, int l, double dt);
  void move(Configuration& configuration, int l, double dt);
  double time(int l, double dt) const { return t_ + (l <= s_ ? tableau_.c[l] * dt : dt); }

  Tableau tableau_;
  int s_;
  std::vector<char> explicit_;      // per row: Ac = Aq, the constraint is taken at the row's own position
  std::vector<char> same_as_last_;  // per row: its position is that of the row before
  std::vector<char> is_end_;        // per row: its position is that of the output

  std::shared_ptr<const Layout> layout_;
  std::vector<Configuration> configurations_;
  std::vector<int> slot_;  // per row 0..s_+1: which configuration
  std::unique_ptr<Configuration> predicted_;
  std::unique_ptr<ContactStage> contacts_;
  std::unique_ptr<Sliding> sliding_;
  std::vector<Stage> stages_;  // 0..s_+1
  Vec q_, gamma_;
  double t_ = 0.0;  // of the start of the step
};

}  // namespace saltus
