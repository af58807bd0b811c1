#include <pybind11/native_enum.h>
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "python_integrators.hpp"
#include "saltus/kernel/integrators/half_explicit/order_conditions.hpp"
#include "saltus/kernel/integrators/registry.hpp"

namespace saltus::python {
namespace {

py::dict to_dict(const SchemeProperties& properties) {
  py::dict all;
  all["friction"] = properties.friction;
  all["velocity_level"] = properties.velocity_level;
  all["implicit"] = properties.implicit;
  all["order_free"] = properties.order_free;
  all["order_bilateral"] = properties.order_bilateral;
  all["order_sliding"] = properties.order_sliding;
  all["forces_at_rest"] = properties.forces_at_rest;
  all["impact_law"] = properties.impact_law;
  all["error_controlled"] = properties.error_controlled;
  return all;
}

// Keywords as in to_dict(); what is left out keeps its default.
SchemeProperties to_properties(const py::dict& given) {
  SchemeProperties properties;
  const py::dict known = to_dict(properties);
  for (const auto& [key, value] : given) {
    if (!known.contains(key))
      throw std::invalid_argument("properties has no '" + std::string(py::str(key)) + "', it has " +
                                  std::string(py::str(", ").attr("join")(known).cast<py::str>()));
    known[key] = value;
  }
  properties.friction = known["friction"].cast<bool>();
  properties.velocity_level = known["velocity_level"].cast<bool>();
  properties.implicit = known["implicit"].cast<bool>();
  properties.order_free = known["order_free"].cast<int>();
  properties.order_bilateral = known["order_bilateral"].cast<int>();
  properties.order_sliding = known["order_sliding"].cast<int>();
  properties.forces_at_rest = known["forces_at_rest"].cast<bool>();
  properties.impact_law = known["impact_law"].cast<bool>();
  properties.error_controlled = known["error_controlled"].cast<bool>();
  return properties;
}

py::dict to_dict(const IntegratorEntry& entry) {
  py::dict options;
  for (const SchemeOption& option : entry.options) {
    py::dict about;
    about["default"] = option.standard;
    about["choices"] = option.choices;
    about["meaning"] = option.meaning;
    options[py::str(option.name)] = about;
  }
  py::dict row;
  row["name"] = entry.name;
  row["summary"] = entry.summary;
  row["options"] = options;
  row["properties"] = to_dict(entry.properties);
  return row;
}

// The class lives as long as the process: the table cannot give it back.
void register_class(const std::string& name, const std::string& summary, const py::dict& properties,
                    const std::map<std::string, OptionValue>& options, const py::function& make) {
  IntegratorEntry entry{.name = name, .summary = summary, .properties = to_properties(properties)};
  for (const auto& [option, standard] : options) entry.options.push_back({option, standard, {}, ""});
  PyObject* const factory = py::function(make).release().ptr();
  entry.make = [factory](const Options& given) {
    py::dict keywords;
    for (const auto& [option, value] : given) keywords[py::str(option)] = value;
    return py::cast<std::unique_ptr<OneStepIntegrator>>(py::handle(factory)(**keywords));
  };
  register_integrator(std::move(entry));
}

TableauOrder claimed_order(const py::object& order) {
  const auto whole = [&](py::handle value) {
    const bool is_it = PyIndex_Check(value.ptr()) && !py::isinstance<py::bool_>(value);
    const int number = is_it ? py::int_(py::reinterpret_borrow<py::object>(value)).cast<int>() : -1;
    if (number < 0)
      throw py::type_error("order must be a whole number, or two of them, from 0 on; got " +
                           std::string(py::repr(order)));
    return number;
  };
  if (!py::isinstance<py::sequence>(order) || py::len(order) != 2) return {whole(order), 0};
  const py::sequence both = order;
  return {whole(both[0]), whole(both[1])};
}

void bind_tableau(py::module_& module) {
  py::class_<Tableau>(module, "Tableau", R"(Coefficients of an explicit Runge-Kutta scheme (B.9)-(B.16).

Parameters
----------
A : (stages, stages) a_lk, zero on and above the diagonal; a_{l,l-1} > 0: the multiplier λ_{l-1} acts through it
b : (stages,) weights, their sum is 1; the last is positive
name : what it is called in messages and in what a run stores
order : order of convergence that is claimed and checked: without multipliers, or also with those of contacts
    that stay closed, (order, order with multipliers)

Raises
------
ValueError
    If it can be no half-explicit scheme, or an order condition of the order claimed does not hold, naming it.
)")
      .def(py::init(
               [](const ArrayLike& A, const ArrayLike& b, const std::string& name, const py::object& order) {
                 Tableau tableau = runge_kutta(name, to_matrix(A, "A"), to_vec(b, "b"));
                 validate(tableau);
                 if (!order.is_none()) require_order(tableau, claimed_order(order));
                 return tableau;
               }),
           py::arg("A"), py::arg("b"), py::arg("name") = "own", py::arg("order") = py::none())
      .def_readonly("name", &Tableau::name)
      .def_property_readonly(
          "A",
          [](const Tableau& t) {
            Matrix A = Matrix::Zero(t.stages(), t.stages());
            A.bottomRows(t.stages() - 1) = t.Av.topRows(t.stages() - 1);
            return matrix_to_array(A);
          },
          "(stages, stages)")
      .def_property_readonly(
          "b", [](const Tableau& t) { return to_array(Vec(t.Av.row(t.stages() - 1).transpose())); },
          "(stages,)")
      .def_property_readonly(
          "c", [](const Tableau& t) { return to_array(t.c); }, "(stages,) sums of the rows")
      .def_property_readonly(
          "order",
          [](const Tableau& t) {
            const TableauOrder order = order_of(t);
            return py::make_tuple(order.free, order.constrained);
          },
          "orders by the order conditions, at most 6: without multipliers, with those of closed contacts")
      .def("__repr__", [](const Tableau& t) { return "<Tableau " + t.name + ">"; });
}

void bind_state(py::module_& module) {
  py::class_<State>(module, "State",
                    "What a run carries from step to step. Assign new arrays, do not write into old ones.")
      .def_readwrite("t", &State::t, "[s]")
      .def_property(
          "q", [](const State& s) { return to_array(s.q); },
          [](State& s, const ArrayLike& q) { s.q = to_sized_vec(q, "q", s.q.size()); }, "(n,)")
      .def_property(
          "v", [](const State& s) { return to_array(s.v); },
          [](State& s, const ArrayLike& v) { s.v = to_sized_vec(v, "v", s.v.size()); },
          "(n,) right limit v⁺");
  auto reactions = py::class_<Reactions>(
      module, "Reactions", "Contact forces and impulses of one step, of all contacts, open ones zero.");
  const auto array = [&](const char* name, Vec Reactions::* member, const char* doc) {
    reactions.def_property(
        name, [member](const Reactions& r) { return to_array(r.*member); },
        [member, name](Reactions& r, const ArrayLike& x) {
          r.*member = to_sized_vec(x, name, (r.*member).size());
        },
        doc);
  };
  array("lambda_plus", &Reactions::lambda_plus, "(rows,) λ⁺ at the start of the step [N]");
  array("lambda_minus", &Reactions::lambda_minus, "(rows,) λ⁻ at its end [N]");
  array("force", &Reactions::force, "(rows,) their mean over the step [N]");
  array("impulse", &Reactions::impulse, "(rows,) Λ at its end [N s]");
}

void bind_report(py::module_& module) {
  py::class_<StepReport>(module, "StepReport", "What one step says about itself.")
      .def(py::init<>())
      .def_readwrite("impulsive", &StepReport::impulsive,
                     "the impact law was applied; Moreau-Jean: an impulse acted")
      .def_readwrite("closed", &StepReport::closed, "closed contacts at the end of the step")
      .def_readwrite("solver_iterations", &StepReport::solver_iterations)
      .def_readwrite("residual", &StepReport::residual, "largest certificate of the step [m/s]")
      .def_readwrite("penetration", &StepReport::penetration, "[m]")
      .def_readwrite("kinetic_energy", &StepReport::kinetic_energy, "at the end [J]")
      .def_readwrite("work_forces", &StepReport::work_forces, "of h and of the change of M over the step [J]")
      .def_readwrite("work_lambda", &StepReport::work_lambda, "of λ⁺ and λ⁻ over the step [J]")
      .def_readwrite("work_impulse", &StepReport::work_impulse, "of Λ [J]")
      .def_readwrite("accepted_steps", &StepReport::accepted_steps,
                     "of a scheme that chooses steps of its own within this one: those taken; 0 of others")
      .def_readwrite("rejected_steps", &StepReport::rejected_steps,
                     "likewise: taken again because their error was too large")
      .def_readwrite("event_steps", &StepReport::event_steps,
                     "likewise: ended at a closing contact, or another event, that was located")
      .def_readwrite("captures", &StepReport::captures,
                     "likewise: contacts closed plastically, because their bounces have become too short");
}

// What the registry was asked for, or, of an object that a Python class made by itself, its numbers and
// words.
py::dict options_of(const py::object& self) {
  const py::dict attributes = self.attr("__dict__");
  if (attributes.contains("_options")) return attributes["_options"];
  py::dict options;
  for (const auto& [name, value] : attributes)
    if (py::isinstance<py::float_>(value) || py::isinstance<py::int_>(value) ||
        py::isinstance<py::str>(value))
      options[name] = value;
  return options;
}

void bind_integrator(py::module_& module) {
  py::classh<OneStepIntegrator, PyIntegrator>(
      module, "OneStepIntegrator", py::dynamic_attr(),
      R"(A one-step scheme with its options; simulations take copies of it. To write one, derive from it and define

    def prepare(self, system, solver): ...        # make Configuration and ContactStage of them
    def step(self, dt, state, reactions): ...     # take state to t + dt, return a StepReport
    def memory(self): ...                         # optional: what it carries on besides state and reactions, (m,)
    def remember(self, memory): ...               # with it: go on with what memory() gave

`state` and `reactions` come in as the last step left them and are taken over if the method returns. What Configuration and
ContactStage cannot do raises StepFailure: let it pass, the simulation reports it.
)")
      .def(py::init<>())
      .def_property_readonly("name", &OneStepIntegrator::name)
      .def_property_readonly("options", &options_of, "All options by name, also those that were not given.")
      .def("__repr__", [](const OneStepIntegrator& self) { return "<" + self.name() + ">"; });
  module.def(
      "make_integrator",
      [](const std::string& name, const Options& options) {
        const py::object scheme = py::cast(make_integrator(name, options));
        scheme.attr("_options") = integrator_options(scheme.attr("name").cast<std::string>(), options);
        return scheme;
      },
      py::arg("name"), py::arg("options") = Options{},
      "An integrator by its name in integrators().\n\nRaises ValueError naming those that there are.");
  module.def(
      "integrators",
      [] {
        py::list table;
        for (const IntegratorEntry& entry : integrators()) table.append(to_dict(entry));
        return table;
      },
      "The registered integrators: name, summary, options and what holds for each.");
  module.def(
      "integrator_properties",
      [](const std::string& name, const Options& options) {
        return to_dict(integrator_properties(name, options));
      },
      py::arg("name"), py::arg("options") = Options{}, "What holds for a scheme with these options.");
  module.def("register_class", &register_class);
  module.def("load_integrator", &load_integrator);
}

void bind_parts(py::module_& module) {
  py::class_<PyConfiguration>(module, "Configuration",
                              "Everything of a system that depends on the position alone: M, gaps, Wᵀ.")
      .def(py::init<const NonSmoothDynamicalSystem&>(), py::arg("system"))
      .def(
          "move_to",
          [](PyConfiguration& self, const ArrayLike& q, std::optional<double> t) {
            self.move_to(to_vec(q, "q"), t);
          },
          py::arg("q"), py::arg("t") = py::none(),
          "Go to the position q (coordinates,) at the time t, which rheonomous relations need.\n\n"
          "Raises StepFailure if M is not positive definite or a gap not finite, ValueError without a t that "
          "is\nneeded.")
      .def(
          "rates",
          [](const PyConfiguration& self, const ArrayLike& v) {
            return to_array(self.rates(to_vec(v, "v")));
          },
          py::arg("v"), "q̇ = Y(q) v (coordinates,), (74)")
      .def_property_readonly("q", [](const PyConfiguration& self) { return to_array(self.get().q()); })
      .def_property_readonly(
          "gaps", [](const PyConfiguration& self) { return to_array(self.get().gaps()); }, "(gaps,) [m]")
      .def_property_readonly("closed", &PyConfiguration::closed,
                             "numbers of the contacts with g <= 0, and of the bilateral constraints")
      .def_property_readonly(
          "penetration", [](const PyConfiguration& self) { return self.get().penetration(); },
          "largest -g of the unilateral contacts, or 0 [m]")
      .def(
          "forces",
          [](const PyConfiguration& self, double t, const ArrayLike& v) {
            return to_array(self.forces(t, to_vec(v, "v")));
          },
          py::arg("t"), py::arg("v"), "h(t, q, v) (n,) [N]")
      .def(
          "solve_mass",
          [](const PyConfiguration& self, const ArrayLike& x) {
            return to_array(self.solve_mass(to_vec(x, "x")));
          },
          py::arg("x"), "M⁻¹ x (n,)")
      .def(
          "velocities",
          [](PyConfiguration& self, const ArrayLike& v) { return to_array(self.velocities(to_vec(v, "v"))); },
          py::arg("v"), "γ = Wᵀ v of all contacts (rows,) [m/s]")
      .def(
          "kinetic_energy",
          [](const PyConfiguration& self, const ArrayLike& v) { return self.kinetic_energy(to_vec(v, "v")); },
          py::arg("v"), "½ vᵀ M v [J]");
  py::class_<ContactImpulses>(module, "ContactImpulses", "The solution of a contact problem.")
      .def_property_readonly(
          "impulse", [](const ContactImpulses& c) { return to_array(c.impulse); },
          "(rows,) of all contacts [N s]")
      .def_property_readonly(
          "velocity", [](const ContactImpulses& c) { return to_array(c.velocity); },
          "(n,) M⁻¹ W P, the jump that the impulses make")
      .def_readonly("iterations", &ContactImpulses::iterations)
      .def_readonly("residual", &ContactImpulses::residual, "certificate [m/s]");
  const auto optional_vec = [](const std::optional<ArrayLike>& x, const char* what) {
    return x ? std::optional<Vec>(to_vec(*x, what)) : std::nullopt;
  };
  py::class_<PyContactStage>(module, "ContactStage",
                             "The contact problems of a system and the solver for them.")
      .def(py::init<const NonSmoothDynamicalSystem&, ContactSolver&>(), py::arg("system"), py::arg("solver"),
           py::keep_alive<1, 3>())
      .def(
          "solve",
          [optional_vec](PyContactStage& self, const std::vector<int>& active, PyConfiguration& constraint,
                         PyConfiguration& force, const ArrayLike& v, const std::optional<ArrayLike>& before,
                         const std::optional<ArrayLike>& warm_start) {
            return self.solve(active, constraint, force, to_vec(v, "v"), optional_vec(before, "before"),
                              optional_vec(warm_start, "warm_start"));
          },
          py::arg("active"), py::arg("constraint"), py::arg("force"), py::arg("v"),
          py::arg("before") = py::none(), py::arg("warm_start") = py::none(),
          R"(Impulses P of the contacts `active` that put v right: the laws hold between
ξ = W(q_c)ᵀ(v + M⁻¹ W(q_f) P) + ε γ⁻ and P.

Parameters
----------
active : numbers of contacts, ascending
constraint : q_c, where the constraint is taken
force : q_f, where W directs the impulses, and M is taken
v : (n,) velocity without the impulses
before : (rows,) γ⁻ of the impact law, zero if left out
warm_start : (rows,) impulses to start from [N s]

Raises
------
StepFailure
    If the solver finds no impulses that satisfy the laws.
)");
}

void bind_failure(py::module_& module) {
  py::native_enum<StepStatus>(module, "StepStatus", "enum.Enum", "Why a step could not be taken.")
      .value("ok", StepStatus::ok)
      .value("solver_failed", StepStatus::solver_failed)
      .value("mass_not_positive_definite", StepStatus::mass_not_positive_definite)
      .value("iteration_failed", StepStatus::iteration_failed)
      .value("gap_not_finite", StepStatus::gap_not_finite)
      .value("accumulation", StepStatus::accumulation)
      .value("not_finite", StepStatus::not_finite)
      .finalize();
  static py::handle error;
  error = PyErr_NewExceptionWithDoc("saltus.kernel.StepFailure",
                                    "A step that a Python integrator cannot take; `status` says why.",
                                    PyExc_ArithmeticError, nullptr);
  py::setattr(error, "status", py::cast(StepStatus::iteration_failed));  // of those that Python raises
  module.attr("StepFailure") = error;
  py::register_local_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(pointer);
    } catch (const StepFailure& failure) {
      py::object instance = error(std::string(to_string(failure.status)));
      instance.attr("status") = failure.status;
      PyErr_SetObject(error.ptr(), instance.ptr());
    }
  });
}

}  // namespace

void bind_integrators(py::module_& module) {
  bind_state(module);
  bind_report(module);
  bind_failure(module);
  bind_tableau(module);
  bind_integrator(module);
  bind_parts(module);
}

}  // namespace saltus::python
