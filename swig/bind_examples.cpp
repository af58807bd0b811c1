#include <pybind11/stl.h>

#include "ball_in_box/ball_in_box.hpp"
#include "bindings.hpp"
#include "elastic_bar/bare_loop.hpp"
#include "elastic_bar/elastic_bar.hpp"
#include "rotor/rotor.hpp"
#include "slider_crank/bare_loop.hpp"
#include "slider_crank/slider_crank.hpp"

namespace saltus::python {
namespace {

using namespace examples;

void bind_slider_crank(py::module_& module) {
  py::class_<SliderCrankParameters>(module, "SliderCrankParameters", "Table 1 of the paper.")
      .def(py::init<>())
      .def_readwrite("l1", &SliderCrankParameters::l1, "length of the crank [m]")
      .def_readwrite("l2", &SliderCrankParameters::l2, "length of the rod [m]")
      .def_readwrite("a", &SliderCrankParameters::a, "half-length of the slider [m]")
      .def_readwrite("b", &SliderCrankParameters::b, "half-height of the slider [m]")
      .def_readwrite("c", &SliderCrankParameters::c, "clearance of the notch [m]")
      .def_readwrite("m1", &SliderCrankParameters::m1, "mass of the crank [kg]")
      .def_readwrite("m2", &SliderCrankParameters::m2, "mass of the rod [kg]")
      .def_readwrite("m3", &SliderCrankParameters::m3, "mass of the slider [kg]")
      .def_readwrite("J1", &SliderCrankParameters::J1, "inertia of the crank [kg m²]")
      .def_readwrite("J2", &SliderCrankParameters::J2, "inertia of the rod [kg m²]")
      .def_readwrite("J3", &SliderCrankParameters::J3, "inertia of the slider [kg m²]")
      .def_readwrite("gravity", &SliderCrankParameters::gravity, "[m/s²]");
  py::classh<SliderCrank, LagrangianDS>(module, "CompiledSliderCrank", py::is_final(),
                                        "Crank, rod and slider in C++, q = (θ1, θ2, θ3) [rad].")
      .def(py::init([](const ArrayLike& q0, const ArrayLike& v0, const SliderCrankParameters& parameters) {
             return std::make_unique<SliderCrank>(to_vec(q0, "q0"), to_vec(v0, "v0"), parameters);
           }),
           py::arg("q0"), py::arg("v0"), py::arg("parameters"));
  py::classh<SliderCorner, Relation>(module, "CompiledSliderCorner", py::is_final(),
                                     "A corner (xi, eta) of the slider in the notch, in C++.")
      .def(py::init<double, double, int, const SliderCrankParameters&>(), py::arg("xi"), py::arg("eta"),
           py::arg("size"), py::arg("parameters"));
  py::classh<SliderGuide, Relation>(module, "CompiledSliderGuide", py::is_final(),
                                    "The slider on a straight guide, y = 0 and θ3 = 0, in C++.")
      .def(py::init<const SliderCrankParameters&>(), py::arg("parameters"));
  module.def(
      "bare_slider_crank",
      [](double time_step, long steps) {
        BareSliderCrank crank;
        crank.run(time_step, steps);
        return std::make_pair(to_array(crank.q()), to_array(crank.v()));
      },
      py::arg("time_step"), py::arg("steps"),
      "q and v of the frictional slider crank after some steps of a loop that is written by hand for it.");
}

void bind_ball_in_box(py::module_& module) {
  module.def(
      "compiled_ball_in_box",
      [](bool oblique) { return make_ball_in_box(oblique ? Gravity::oblique : Gravity::down); },
      py::arg("oblique"), "The ball in a box in C++, which a test compares with the one in Python.");
}

void bind_elastic_bar(py::module_& module) {
  module.def(
      "compiled_elastic_bar",
      [](int elements, double damping) { return make_elastic_bar(elements, damping); }, py::arg("elements"),
      py::arg("damping"), "The elastic bar in C++, which a test compares with the one in Python.");
  module.def(
      "bare_elastic_bar",
      [](int elements, double damping, double gap, double time_step, long steps) {
        ElasticBarParameters parameters;
        parameters.gap = gap;
        BareElasticBar bar(elements, damping, parameters);
        bar.run(time_step, steps);
        return std::make_pair(to_array(bar.q()), to_array(bar.v()));
      },
      py::arg("elements"), py::arg("damping"), py::arg("gap"), py::arg("time_step"), py::arg("steps"),
      "q and v of the elastic bar after some steps of a loop that is written by hand for it.");
}

void bind_axle(py::module_& module) {
  py::class_<AxleParameters>(module, "AxleParameters", "Table 6 of the paper, axle and drive.")
      .def(py::init<>())
      .def_readwrite("elements", &AxleParameters::elements, "N_A")
      .def_readwrite("length", &AxleParameters::length, "l_A [m]")
      .def_readwrite("radius", &AxleParameters::radius, "r_A [m]")
      .def_readwrite("density", &AxleParameters::density, "ρ_A [kg/m³]")
      .def_readwrite("E", &AxleParameters::E, "Young modulus [N/m²]")
      .def_readwrite("G", &AxleParameters::G, "shear modulus [N/m²]")
      .def_readwrite("mass_damping", &AxleParameters::mass_damping, "d_1A [1/s]")
      .def_readwrite("torsional_damping", &AxleParameters::torsional_damping, "d_2A [kg m²/s]")
      .def_readwrite("mount_stiffness", &AxleParameters::mount_stiffness, "c_D [N/m]")
      .def_readwrite("mount_damping", &AxleParameters::mount_damping, "d_D [N s/m]")
      .def_readwrite("drive_torque", &AxleParameters::drive_torque, "T_D [N m]")
      .def_readwrite("drive_until", &AxleParameters::drive_until, "[s]")
      .def_readwrite("fault_torque", &AxleParameters::fault_torque, "T_F [N m]")
      .def_readwrite("gravity", &AxleParameters::gravity, "[m/s²]");
  py::classh<Axle, LagrangianDS>(module, "CompiledAxle", py::is_final(),
                                 "The axle of the rotor in C++, q = (α, w, w', u, u') of each node.")
      .def(py::init([](const ArrayLike& q0, const ArrayLike& v0, const AxleParameters& parameters) {
             return std::make_unique<Axle>(to_vec(q0, "q0"), to_vec(v0, "v0"), parameters);
           }),
           py::arg("q0"), py::arg("v0"), py::arg("parameters"))
      .def(
          "force_jacobians",
          [](const Axle& axle, double t, const ArrayLike& q, const ArrayLike& v) {
            const int n = axle.dimension();
            const Vec at = to_sized_vec(q, "q", n), rate = to_sized_vec(v, "v", n);
            Matrix by_q = Matrix::Zero(n, n), by_v = Matrix::Zero(n, n);
            axle.force_jacobians(t, In(at.data(), n), In(rate.data(), n), OutMatrix(by_q.data(), n, n),
                                 OutMatrix(by_v.data(), n, n));
            return std::make_pair(matrix_to_array(by_q), matrix_to_array(by_v));
          },
          py::arg("t"), py::arg("q"), py::arg("v"), "∂h/∂q and ∂h/∂v, (n, n) each.");
}

void bind_rotor(py::module_& module) {
  bind_axle(module);
  module.def("compiled_rotor", &make_rotor,
             "The rotor composed in C++, which a test compares with the one composed in Python.");
  py::classh<AxleWeld, Relation>(module, "CompiledAxleWeld", py::is_final(),
                                 "A body welded to the axle at a station, 6 rows, in C++.")
      .def(py::init<const Axle&, double>(), py::arg("axle"), py::arg("s"))
      .def_static(
          "held",
          [](const Axle& axle, double s) {
            const AxleWeld::State state = AxleWeld::held(axle, s);
            return std::make_pair(to_array(state.q), to_array(state.v));
          },
          py::arg("axle"), py::arg("s"), "q (7,) and v (6,) of a body that is held at the axle's start.");
  py::classh<JournalContact, Relation>(module, "CompiledJournalContact", py::is_final(),
                                       "A disc of one body inside of a circle of another, in C++.")
      .def(py::init<int, double, double, double>(), py::arg("size"), py::kw_only(), py::arg("disc"),
           py::arg("circle"), py::arg("along"));
  py::classh<MountedBody, NewtonEulerDS>(module, "CompiledMountedBody", py::is_final(),
                                         "A rigid body that springs hold at the origin, in C++.")
      .def(py::init([](const ArrayLike& q0, const ArrayLike& v0, double mass, const ArrayLike& inertia,
                       double stiffness, double damping, double gravity) {
             const Vec diagonal = to_sized_vec(inertia, "inertia", 3);
             return std::make_unique<MountedBody>(to_vec(q0, "q0"), to_vec(v0, "v0"), mass,
                                                  Mat3(diagonal.asDiagonal()), stiffness, damping, gravity);
           }),
           py::arg("q0"), py::arg("v0"), py::kw_only(), py::arg("mass"), py::arg("inertia"),
           py::arg("stiffness"), py::arg("damping"), py::arg("gravity"));
}

}  // namespace

// The models of the examples in C++. The Python documents beside them explain the formulas.
void bind_examples(py::module_& module) {
  bind_slider_crank(module);
  bind_ball_in_box(module);
  bind_elastic_bar(module);
  bind_rotor(module);
}

}  // namespace saltus::python
