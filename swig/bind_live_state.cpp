#include <pybind11/stl.h>

#include <array>
#include <stdexcept>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "saltus/kernel/simulation/observer.hpp"

namespace saltus::python {
namespace {

using Array = py::array_t<double, py::array::c_style>;
using Arrays = std::array<Array, 4>;
using Given = std::vector<std::array<py::array, 4>>;

/// Keeps arrays of Python what the simulation is: whoever holds one sees every step without a call.
class LiveState final : public Observer {
 public:
  /// @param systems    of each system q (coordinates), v (n), impulse (n), force (n)
  /// @param contacts   of the interactions, or the first of them, gaps (gaps), velocities, impulses, forces
  ///                   (rows)
  /// @param time_step  Δt [s]
  /// @param steps      after that many, impulses start from zero again
  LiveState(std::vector<Arrays> systems, std::vector<Arrays> contacts, double time_step, long steps)
      : systems_(std::move(systems)), contacts_(std::move(contacts)), time_step_(time_step), steps_(steps) {
    if (steps < 1) throw std::invalid_argument("steps must be at least 1, got " + std::to_string(steps));
  }

  void observe(const StepView& view) override {
    const Layout& layout = view.configuration.layout();
    require_sizes(layout);
    const bool first = view.step == 0 || (view.step - 1) % steps_ == 0;
    for (std::size_t k = 0; k < systems_.size(); ++k) {
      const auto& system = layout.systems[k];
      std::copy_n(view.state.q.data() + system.first, system.coordinates, systems_[k][0].mutable_data());
      std::copy_n(view.state.v.data() + system.offset, system.n, systems_[k][1].mutable_data());
      if (first) std::fill_n(systems_[k][2].mutable_data(), system.n, 0.0);
      std::fill_n(systems_[k][3].mutable_data(), system.n, 0.0);
    }
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
      const auto& contact = layout.contacts[k];
      std::copy_n(view.gaps.data() + contact.gap, contact.gaps, contacts_[k][0].mutable_data());
      std::copy_n(view.velocities.data() + contact.row, contact.rows, contacts_[k][1].mutable_data());
      if (first) std::fill_n(contacts_[k][2].mutable_data(), contact.rows, 0.0);
      add_impulses(contact, static_cast<int>(k), view);
      take_forces(contact, static_cast<int>(k), view);
    }
  }

 private:
  // Of the whole step, that of the forces included: Λ, and p = W Λ on the systems.
  void add_impulses(const Layout::Contact& contact, int index, const StepView& view) {
    double* total = contacts_[index][2].mutable_data();
    for (int row = 0; row < contact.rows; ++row) {
      const int at = contact.row + row;
      const double impulse = view.reactions.impulse[at] + time_step_ * view.reactions.force[at];
      total[row] += impulse;
      act(contact, index, row, impulse, 2, view);
    }
  }

  // λ⁻ at the end of the step, and Wλ⁻
  void take_forces(const Layout::Contact& contact, int index, const StepView& view) {
    const double* lambda = view.reactions.lambda_minus.data() + contact.row;
    std::copy_n(lambda, contact.rows, contacts_[index][3].mutable_data());
    for (int row = 0; row < contact.rows; ++row) act(contact, index, row, lambda[row], 3, view);
  }

  // Adds W's column of a row, times a value, to arrays of the systems
  void act(const Layout::Contact& contact, int index, int row, double value, int array,
           const StepView& view) {
    if (value == 0.0) return;
    const double* W = view.configuration.jacobian(index) + row * contact.n;
    for (int side = 0; side < contact.sides; ++side) {
      Array& p = systems_[contact.system[side]][array];
      double* values = p.mutable_data();
      for (py::ssize_t j = 0; j < p.size(); ++j) values[j] += *W++ * value;
    }
  }

  void require_sizes(const Layout& layout) const {
    bool fits = systems_.size() == layout.systems.size() && contacts_.size() <= layout.contacts.size();
    const auto sized = [](const Arrays& arrays, int first, int second) {
      return arrays[0].size() == first && arrays[1].size() == second && arrays[2].size() == second &&
             arrays[3].size() == second;
    };
    for (std::size_t k = 0; fits && k < systems_.size(); ++k)
      fits = sized(systems_[k], layout.systems[k].coordinates, layout.systems[k].n);
    for (std::size_t k = 0; fits && k < contacts_.size(); ++k)
      fits = sized(contacts_[k], layout.contacts[k].gaps, layout.contacts[k].rows);
    if (!fits) throw std::invalid_argument("the arrays of a LiveState must have the sizes of the model");
  }

  std::vector<Arrays> systems_, contacts_;
  double time_step_;
  long steps_;
};

}  // namespace

void bind_live_state(py::module_& module) {
  py::classh<LiveState, Observer>(module, "LiveState", py::is_final(),
                                  R"(Keeps given arrays what the simulation is after every step.

Parameters
----------
systems : of each system arrays q (coordinates,), v, impulse, force (n,): impulse of its contacts, their force at
    the end of the step
contacts : likewise of the interactions, or the first of them, gap (gaps,), velocity, impulse, force (rows,)
time_step : Δt [s]: forces of contacts count as impulses over it
steps : impulses are summed up over that many steps, then start from zero again

Raises
------
ValueError
    If steps < 1; at the first step if sizes are not those of the model, or an array cannot be written.
)")
      .def(py::init([](const Given& systems, const Given& contacts, double time_step, long steps) {
             const auto own = [](const Given& all) {
               std::vector<Arrays> result;
               for (const auto& arrays : all) {
                 for (const py::array& array : arrays)  // a converted copy would be seen by nobody
                   if (!py::isinstance<Array>(array))
                     throw py::type_error("the arrays of a LiveState must be contiguous and of float64");
                 result.push_back({Array(arrays[0]), Array(arrays[1]), Array(arrays[2]), Array(arrays[3])});
               }
               return result;
             };
             return std::make_unique<LiveState>(own(systems), own(contacts), time_step, steps);
           }),
           py::arg("systems"), py::arg("contacts"), py::arg("time_step"), py::arg("steps") = 1);
}

}  // namespace saltus::python
