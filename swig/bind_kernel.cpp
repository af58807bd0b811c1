#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "saltus/kernel/model/check.hpp"
#include "saltus/kernel/model/neighbours.hpp"
#include "saltus/kernel/model/plugin_model.hpp"
#include "saltus/kernel/simulation/stability.hpp"
#include "saltus/kernel/simulation/time_stepping.hpp"
#include "saltus/numerics/solvers/registry.hpp"

namespace saltus::python {
namespace {

class PythonObserver final : public Observer {
 public:
  explicit PythonObserver(py::function callback) : callback_(std::move(callback)) {}
  void observe(const StepView& view) override {
    callback_(view.step, view.state.t, to_array(view.state.q), to_array(view.state.v), view.report);
  }

 private:
  py::function callback_;
};

// Of a link in every row of q (rows, coordinates of the system): points (rows, 3) and directions (rows,
// forces, 3); none if its relation does not know where it is.
py::object places(const NonSmoothDynamicalSystem& self, int index,
                  const py::array_t<double, py::array::c_style>& q) {
  const auto& link = self.links().at(static_cast<std::size_t>(index));
  std::vector<Eigen::Index> starts = {0};
  for (const auto& ds : self.systems()) starts.push_back(starts.back() + ds->coordinates());
  if (q.ndim() != 2 || q.shape(1) != starts.back())
    throw std::invalid_argument("q must be (rows, " + std::to_string(starts.back()) + ")");
  const auto part = [&](const double* row, int system) {
    return Eigen::Map<const Vec>(row + starts[system], starts[system + 1] - starts[system]);
  };
  const Eigen::Index first = starts[link.first + 1] - starts[link.first];
  Vec linked(first + (link.second < 0 ? 0 : starts[link.second + 1] - starts[link.second]));
  py::array_t<float> points({q.shape(0), py::ssize_t{3}}), directions;
  for (py::ssize_t row = 0; row < q.shape(0); ++row) {
    linked.head(first) = part(q.data(row, 0), link.first);
    if (link.second >= 0) linked.tail(linked.size() - first) = part(q.data(row, 0), link.second);
    const ContactPlace place = link.interaction->relation().place(In(linked.data(), linked.size()));
    if (place.forces == 0) return py::none();
    if (row == 0) directions = py::array_t<float>({q.shape(0), py::ssize_t{place.forces}, py::ssize_t{3}});
    for (int k = 0; k < 3; ++k) {
      points.mutable_at(row, k) = static_cast<float>(place.point[k]);
      for (int i = 0; i < place.forces; ++i)
        directions.mutable_at(row, i, k) = static_cast<float>(place.directions[i][k]);
    }
  }
  return py::make_tuple(points, directions);
}

void bind_model(py::module_& module) {
  const char* interaction_doc =
      "A relation with the law that acts in it, in either order; results carry its name.\n\n"
      "Raises ValueError if relation and law differ in size.";
  py::classh<Interaction>(module, "Interaction", py::dynamic_attr(), interaction_doc)
      .def(py::init([](std::shared_ptr<Relation> relation, const NonSmoothLaw& law, std::string name) {
             return std::make_shared<Interaction>(std::move(relation), law, std::move(name));
           }),
           py::arg("relation"), py::arg("law"), py::arg("name") = "")
      .def(py::init([](const NonSmoothLaw& law, std::shared_ptr<Relation> relation, std::string name) {
             return std::make_shared<Interaction>(std::move(relation), law, std::move(name));
           }),
           py::arg("law"), py::arg("relation"), py::arg("name") = "")
      .def(
          "show_at",
          [](py::object self, py::object place) {
            py::module_::import("saltus.scene").attr("show_at")(self, place);
          },
          py::arg("place"),
          "Let pictures show the contact at place(q) = (point, direction, ...), each with 2 or 3 entries: "
          "where "
          "it is\n"
          "in space [m], and the unit vectors along which its rows push ds1, the normal first. q is that of "
          "ds1, or\n"
          "[q1; q2]. Without directions there are no arrows. Contacts and joints of bodies know their place.")
      .def_property_readonly("name", &Interaction::name)
      .def_property_readonly("law", &Interaction::law, "the law that acts in it")
      .def("__repr__", shown_by("interaction_text"))
      .def("_repr_html_", shown_by("interaction"));

  py::class_<CheckItem>(module, "CheckItem", "One line of NonSmoothDynamicalSystem.check().")
      .def_readonly("subject", &CheckItem::subject)
      .def_readonly("quantity", &CheckItem::quantity)
      .def_readonly("deviation", &CheckItem::deviation)
      .def_readonly("tolerance", &CheckItem::tolerance)
      .def_readonly("note", &CheckItem::note)
      .def_readonly("advisory", &CheckItem::advisory)
      .def_property_readonly("ok", &CheckItem::ok);

  using Systems = std::vector<std::shared_ptr<LagrangianDS>>;
  py::classh<NonSmoothDynamicalSystem>(module, "NonSmoothDynamicalSystemBase")
      .def(py::init([](const Systems& systems, double t0) {
             return std::make_unique<NonSmoothDynamicalSystem>(
                 NonSmoothDynamicalSystem::Systems(systems.begin(), systems.end()), t0);
           }),
           py::arg("systems"), py::arg("t0") = 0.0)
      .def(
          "link",
          [](NonSmoothDynamicalSystem& self, std::shared_ptr<Interaction> interaction,
             const LagrangianDS& first,
             const LagrangianDS* second) { self.link(std::move(interaction), first, second); },
          py::arg("interaction"), py::arg("ds1"), py::arg("ds2") = py::none(),
          "Let an interaction act between ds1 and the ground, or between ds1 and ds2.\n\n"
          "Raises ValueError if a system is not part of this one, the name is taken, or sizes disagree.")
      .def(
          "add_force",
          [](NonSmoothDynamicalSystem& self, std::shared_ptr<ForceElement> element, const LagrangianDS& first,
             const LagrangianDS* second) { self.add_force(std::move(element), first, second); },
          py::arg("element"), py::arg("ds1"), py::arg("ds2") = py::none(),
          "Let a force element act between ds1 and the ground, or between ds1 and ds2; q of its relation is\n"
          "then [q1; q2].\n\n"
          "Raises ValueError if a system is not part of this one, the name is taken, or sizes disagree.")
      .def_property_readonly("t0", &NonSmoothDynamicalSystem::t0)
      .def_property_readonly("dimension", &NonSmoothDynamicalSystem::dimension, "entries of v")
      .def_property_readonly("coordinates", &NonSmoothDynamicalSystem::coordinates, "entries of q")
      .def("check_items", &check)
      .def("places", &places, py::arg("link"), py::arg("q"))
      .def("contacts", [](const NonSmoothDynamicalSystem& self) {
        // name, offset and number of rows, offset and number of gaps, law
        std::vector<std::tuple<std::string, int, int, int, int, py::dict>> all;
        int row = 0, gap = 0;
        for (const auto& link : self.links()) {
          const NonSmoothLaw& law = link.interaction->law();
          all.emplace_back(link.name, row, law.size(), gap, law.gaps, description(law));
          row += law.size();
          gap += law.gaps;
        }
        return all;
      });
  module.def(
      "neighbours",
      [](const ArrayLike& centres, const ArrayLike& radii, double within) {
        const auto pairs = neighbours(to_matrix(centres, "centres"), to_vec(radii, "radii"), within);
        py::array_t<std::int64_t> result({pairs.size(), std::size_t{2}});
        for (std::size_t k = 0; k < pairs.size(); ++k)
          std::copy_n(pairs[k].begin(), 2, result.mutable_data(k, 0));
        return result;
      },
      py::arg("centres"), py::arg("radii"), py::arg("within") = 0.0,
      R"(Broad phase: pairs of discs or spheres that touch, or nearly, by a uniform grid.

These are the pairs to link by interactions: |c_i - c_j| - r_i - r_j <= within. The cost grows with the discs
and the pairs, not with all pairs there could be, if the radii are alike.

Parameters
----------
centres : (n, 1 to 3) [m]
radii : (n,) >= 0 [m]
within : largest distance of their surfaces [m]

Returns
-------
(pairs, 2) of whole numbers
    i < j, in ascending order.

Raises
------
ValueError
    If shapes disagree, a value is not finite or a radius is negative.
)");
  module.def("load_model", &load_model, py::arg("library_and_function"),
             "The model that a shared library composes, \"library:function\".");
}

// A checkpoint as arrays of numbers by name. A field is named once, for both directions.
template <typename Checkpoint, typename Field>
void exchange(Checkpoint& c, Field&& field) {
  field("step", c.step);
  field("t", c.state.t);
  field("q", c.state.q);
  field("v", c.state.v);
  field("held", c.state.held);
  field("lambda_plus", c.reactions.lambda_plus);
  field("lambda_minus", c.reactions.lambda_minus);
  field("force", c.reactions.force);
  field("impulse", c.reactions.impulse);
  auto& r = c.report;
  field("impulsive", r.impulsive);
  field("closed", r.closed);
  field("solver_iterations", r.solver_iterations);
  field("residual", r.residual);
  field("penetration", r.penetration);
  field("kinetic_energy", r.kinetic_energy);
  field("work_forces", r.work_forces);
  field("work_lambda", r.work_lambda);
  field("work_impulse", r.work_impulse);
  field("accepted_steps", r.accepted_steps);
  field("rejected_steps", r.rejected_steps);
  field("event_steps", r.event_steps);
  field("captures", r.captures);
  field("memory", c.memory);
}

py::dict to_dict(const Checkpoint& checkpoint) {
  py::dict values;
  exchange(checkpoint, [&](const char* name, const auto& field) {
    using T = std::decay_t<decltype(field)>;
    if constexpr (std::is_arithmetic_v<T>) {
      values[name] = field;
    } else {
      py::array_t<double> array(static_cast<py::ssize_t>(field.size()));
      std::copy(field.data(), field.data() + field.size(), array.mutable_data());
      values[name] = array;
    }
  });
  return values;
}

Checkpoint to_checkpoint(const py::dict& values) {
  Checkpoint checkpoint;
  exchange(checkpoint, [&](const char* name, auto& field) {
    using T = std::decay_t<decltype(field)>;
    if (!values.contains(name))
      throw std::invalid_argument(std::string("a checkpoint must have '") + name + "', got none");
    if constexpr (std::is_arithmetic_v<T>) {
      field = values[name].template cast<T>();
    } else {
      const Vec given = to_vec(values[name], name);
      field.resize(given.size());
      std::copy(given.data(), given.data() + given.size(), field.data());
    }
  });
  return checkpoint;
}

// Read when it is asked for: copies that later steps do not change
void bind_event(py::module_& module) {
  const char* doc =
      "What happened at a time within a step: an impact, or a contact that opens, sticks or slips. Arrays "
      "are\n"
      "copies: (coordinates,) q, (n,) of the systems, (gaps,) and (rows,) of the contacts.";
  py::class_<LocatedEvent> event(module, "Event", doc);
  event.def_readonly("t", &LocatedEvent::t, "[s]");
  const auto show = [&](const char* name, Vec LocatedEvent::* member, const char* what) {
    event.def_property_readonly(
        name, [member](const LocatedEvent& self) { return to_array(self.*member); }, what);
  };
  show("q", &LocatedEvent::q, "position");
  show("v_before", &LocatedEvent::v_before, "v⁻");
  show("v", &LocatedEvent::v, "v⁺");
  show("gaps", &LocatedEvent::gaps, "[m]");
  show("velocities_before", &LocatedEvent::velocities_before, "γ⁻ [m/s]");
  show("velocities", &LocatedEvent::velocities, "γ⁺ [m/s]");
  show("impulse", &LocatedEvent::impulse, "Λ [N s]");
  show("generalised_impulse", &LocatedEvent::generalised_impulse, "(n,) W Λ");
  show("force", &LocatedEvent::force, "λ⁺, from then on [N]");
  show("generalised_force", &LocatedEvent::generalised_force, "(n,) W λ⁺");
}

void bind_simulation(py::module_& module) {
  bind_event(module);
  py::classh<Observer>(module, "Observer", "Looks at the steps of a run.");
  py::classh<TimeStepping>(module, "TimeSteppingBase")
      .def(py::init([](const NonSmoothDynamicalSystem& system, const OneStepIntegrator& integrator,
                       double time_step, const std::string& solver, double tolerance) {
             const auto method = make_contact_solver(solver);
             method->set_tolerance(tolerance);
             return std::make_unique<TimeStepping>(system, integrator, time_step, *method);
           }),
           py::arg("system"), py::arg("integrator"), py::arg("time_step"), py::arg("solver"),
           py::arg("tolerance") = default_tolerance)
      .def("add_observer", &TimeStepping::add_observer)
      .def("add_callback",
           [](TimeStepping& self, py::function callback) {
             self.add_observer(std::make_shared<PythonObserver>(std::move(callback)));
           })
      .def("watch_problems",
           [](TimeStepping& self, const std::optional<py::function>& watcher) {
             if (!watcher) return self.watch_problems({});
             self.watch_problems([call = *watcher](const ContactProblem& problem, const double* P,
                                                   const SolveReport& report) {
               call(matrix_of(problem), to_array(problem.b.view()), problem.sets,
                    to_array(In(P, problem.rows())), std::string(to_string(report.status)));
             });
           })
      .def("advance",
           [](TimeStepping& self, double until, const std::function<void(double)>& progress) {
             self.set_progress([progress](double t) {
               if (PyErr_CheckSignals() != 0) throw py::error_already_set();
               if (progress) progress(t);
             });
             self.run(until);
           })
      .def("take_step", &TimeStepping::step)
      .def("checkpoint", [](const TimeStepping& self) { return to_dict(self.checkpoint()); })
      .def("restore", [](TimeStepping& self, const py::dict& values) { self.restore(to_checkpoint(values)); })
      .def_property_readonly("time_step", &TimeStepping::time_step)
      .def_property_readonly("steps", &TimeStepping::steps)
      .def_property_readonly("report", [](const TimeStepping& self) { return self.report(); })
      .def_property_readonly(
          "events",
          [](const TimeStepping& self) {
            const auto events = self.integrator().events();
            return std::vector<LocatedEvent>(events.begin(), events.end());
          },
          "What the integrator located in the last step, in the order of time: a list of Event")
      .def_property_readonly("t", [](const TimeStepping& self) { return self.state().t; })
      .def_property_readonly("q", [](const TimeStepping& self) { return to_array(self.state().q); })
      .def_property_readonly("v", [](const TimeStepping& self) { return to_array(self.state().v); });
}

void bind_stability(py::module_& module) {
  module.def(
      "stability_warning",
      [](const NonSmoothDynamicalSystem& system, const OneStepIntegrator& scheme,
         double time_step) -> std::optional<std::string> {
        const std::optional<Instability> found = find_instability(system, scheme, time_step);
        if (!found) return std::nullopt;
        return found->message(scheme.name());
      },
      py::arg("system"), py::arg("integrator"), py::arg("time_step"),
      "A sentence if time_step is beyond the stability limit of the scheme, else None.");
}

// SimulationError is a Python class with the attributes of the C++ one.
void bind_error(py::module_& module) {
  static py::handle error;
  error = PyErr_NewExceptionWithDoc(
      "saltus.kernel.SimulationError",
      "A step that could not be taken: time [s], step, contacts (names of the closed ones), residual [m/s], "
      "and trajectory, what was recorded so far.",
      PyExc_RuntimeError, nullptr);
  module.attr("SimulationError") = error;
  py::register_local_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(pointer);
    } catch (const SimulationError& e) {
      py::object instance = error(e.what());
      instance.attr("time") = e.time();
      instance.attr("step") = e.step();
      instance.attr("contacts") = e.contacts();
      instance.attr("residual") = e.report().residual;
      instance.attr("trajectory") = py::none();
      PyErr_SetObject(error.ptr(), instance.ptr());
    }
  });
}

}  // namespace

void bind_kernel(py::module_& module) {
  bind_model(module);
  bind_simulation(module);
  bind_stability(module);
  bind_error(module);
}

}  // namespace saltus::python
