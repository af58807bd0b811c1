#include <pybind11/stl.h>

#include "bindings.hpp"
#include "python_models.hpp"
#include "saltus/kernel/model/bodies/contacts.hpp"
#include "saltus/kernel/model/bodies/joint.hpp"

namespace saltus::python {
namespace {

// (3), or of the plane (2)
Vec3 to_point(const ArrayLike& values, const char* what) {
  const Vec point = to_vec(values, what);
  if (point.size() == 2) return {point[0], point[1], 0.0};
  if (point.size() != 3)
    throw std::invalid_argument(std::string(what) + " must have 3 entries, or 2 in the plane, got " +
                                std::to_string(point.size()));
  return point;
}

// (3), or of a rectangle (2)
Vec3 to_lengths(const ArrayLike& values) {
  Vec3 lengths = to_point(values, "half_lengths");
  if (to_vec(values, "half_lengths").size() == 2) lengths[2] = 1.0;  // not looked at
  return lengths;
}

Mat3 to_inertia(const ArrayLike& values) {
  if (py::len(py::module_::import("numpy").attr("shape")(values)) == 1)
    return Vec3(to_sized_vec(values, "inertia", 3)).asDiagonal();
  const Matrix inertia = to_matrix(values, "inertia");
  if (inertia.rows() != 3 || inertia.cols() != 3)
    throw std::invalid_argument("inertia must be (3, 3) or its diagonal (3,), got (" +
                                std::to_string(inertia.rows()) + ", " + std::to_string(inertia.cols()) + ")");
  return inertia;
}

std::unique_ptr<PyNewtonEulerDS> make_newton_euler(const ArrayLike& q0, const ArrayLike& v0, double mass,
                                                   const ArrayLike& inertia,
                                                   const std::optional<ArrayLike>& force,
                                                   const std::optional<ArrayLike>& moment,
                                                   const std::optional<ArrayLike>& body_force,
                                                   const std::optional<ArrayLike>& body_moment) {
  BodyLoads loads;
  const auto take = [](const std::optional<ArrayLike>& given, const char* what, Vec3& load) {
    if (given) load = to_sized_vec(*given, what, 3);
  };
  take(force, "force", loads.force);
  take(moment, "moment", loads.moment);
  take(body_force, "body_force", loads.body_force);
  take(body_moment, "body_moment", loads.body_moment);
  return std::make_unique<PyNewtonEulerDS>(to_vec(q0, "q0"), to_vec(v0, "v0"), mass, to_inertia(inertia),
                                           loads);
}

void bind_newton_euler(py::module_& module) {
  py::classh<NewtonEulerDS, LagrangianDS, PyNewtonEulerDS>(
      module, "NewtonEulerDS",
      R"(A rigid body in space, (74) with a unit quaternion:

    q = (x, p)    position of the centre of mass (3,) [m]; p = (w, x, y, z) turns the body's frame into space
    v = (ẋ, Ω)    its velocity (3,) [m/s]; angular velocity in the frame of the body (3,) [rad/s]
    m ẍ = f + R f_b,   J Ω̇ = Rᵀ m + m_b − Ω × J Ω,   ṗ = ½ p ∘ (0, Ω)

p keeps length 1. Loads that vary are methods of a derived class, each in the place of the constant:

    def force(self, t, q, v, out): ...         # out (3,): f in space [N]
    def moment(self, t, q, v, out): ...        # out (3,): m in space [N m]
    def body_force(self, t, q, v, out): ...    # out (3,): f_b in the frame of the body
    def body_moment(self, t, q, v, out): ...   # out (3,): m_b likewise
    def potential_energy(self, q): ...         # optional, [J]: only reported; known if force alone is given

Parameters
----------
q0 : (7,)
v0 : (6,)
mass : > 0 [kg]
inertia : (3, 3) J about the centre of mass in the body's frame, or its diagonal [kg m²]
force, moment : (3,) constant, in space; gravity is force=[0, 0, -m g]
body_force, body_moment : (3,) constant, in the frame of the body

Raises
------
ValueError
    If a size or a value is wrong, or the quaternion has not length 1. A load that is given twice, or a method that
    rigid bodies do not ask for, such as forces, is found by the simulation.
)")
      .def(py::init(&make_newton_euler), py::arg("q0"), py::arg("v0"), py::arg("mass"), py::arg("inertia"),
           py::kw_only(), py::arg("force") = py::none(), py::arg("moment") = py::none(),
           py::arg("body_force") = py::none(), py::arg("body_moment") = py::none())
      .def_property_readonly(
          "body_mass", [](py::object self) { return initialised<NewtonEulerDS>(self).body_mass(); }, "[kg]")
      .def_property_readonly(
          "inertia",
          [](py::object self) { return matrix_to_array(Matrix(initialised<NewtonEulerDS>(self).inertia())); },
          "(3, 3) [kg m²]");
  module.def(
      "rotation_matrix",
      [](const ArrayLike& quaternion) {
        const Vec p = to_sized_vec(quaternion, "quaternion", 4);
        if (!p.allFinite()) throw std::invalid_argument("quaternion must be finite, got NaN or infinity");
        if (!(p.norm() > 0.0)) throw std::invalid_argument("quaternion must have a length, got zero");
        return matrix_to_array(Matrix(rotation_of(p.data())));
      },
      py::arg("quaternion"),
      "R(p) (3, 3) of a quaternion (w, x, y, z): it turns vectors of the body's frame into space.\n\n"
      "Raises ValueError if it has not four entries, or its length is zero.");
}

constexpr const char* bodies_doc =
    "Bodies are NewtonEulerDS, or plane ones with q = (x, y, angle); points of the plane may have two "
    "entries.\n";

void bind_contacts(py::module_& module) {
  const Vec zero = Vec::Zero(3);
  const std::string rows =
      "\nRows: the normal one, then for friction 1 tangential row in the plane (size=2), 2 in space "
      "(size=3).\n\n"
      "Parameters\n----------\nsize : number of rows\n";
  const auto doc = [&](const char* what, const char* parameters) {
    return std::string(what) + bodies_doc + rows + parameters +
           "\nRaises\n------\nValueError\n    If a value is wrong; size that does not fit the bodies when "
           "they "
           "are linked.\n";
  };
  static const std::string plane =
      doc("A sphere, or a disc in the plane, on a plane or line of the second body or of the ground: "
          "g = n·(c − p) − r.\n\nOf radius 0 it is a point, such as the corner of a box. ",
          "radius : r >= 0 [m]\n"
          "point : of the plane, in the frame of its body [m]\n"
          "normal : of the plane likewise, towards the sphere; of any length but 0\n"
          "centre : of the sphere in the frame of the first body [m]\n");
  py::classh<SpherePlane, Relation>(module, "SpherePlane", py::is_final(), plane.c_str())
      .def(py::init([](int size, double radius, const ArrayLike& point, const ArrayLike& normal,
                       const ArrayLike& centre) {
             return std::make_unique<SpherePlane>(size, radius, to_point(centre, "centre"),
                                                  to_point(point, "point"), to_point(normal, "normal"));
           }),
           py::arg("size"), py::kw_only(), py::arg("radius"), py::arg("point"), py::arg("normal"),
           py::arg("centre") = to_array(zero));
  static const std::string spheres =
      doc("Two spheres, or discs in the plane: g = |d| − r1 − r2.\n\nWithout radii it is the distance of two "
          "points, "
          "for a ForceElement, or with a radius for a rod. Where the centres meet its gradient is not "
          "defined: a run "
          "ends there. ",
          "radius1, radius2 : their sum is taken from the distance [m]\n"
          "centre1, centre2 : in the frames of the bodies, or in space for the ground [m]\n");
  py::classh<SphereSphere, Relation>(module, "SphereSphere", py::is_final(), spheres.c_str())
      .def(py::init([](int size, double radius1, double radius2, const ArrayLike& centre1,
                       const ArrayLike& centre2) {
             return std::make_unique<SphereSphere>(size, radius1, radius2, to_point(centre1, "centre1"),
                                                   to_point(centre2, "centre2"));
           }),
           py::arg("size"), py::kw_only(), py::arg("radius1") = 0.0, py::arg("radius2") = 0.0,
           py::arg("centre1") = to_array(zero), py::arg("centre2") = to_array(zero));
  static const std::string box =
      doc("A sphere on a box of the second body or of the ground, whose edges are along that body's frame; "
          "in the "
          "plane a disc on a rectangle.\n\nInside of the box the nearest face counts. No curvature term: "
          "schemes on "
          "acceleration level refuse it. ",
          "radius : r >= 0 [m]\n"
          "half_lengths : of the box, (3,) or (2,) [m]\n"
          "box_centre : in the frame of its body [m]\n"
          "centre : of the sphere in the frame of the first body [m]\n");
  py::classh<SphereBox, Relation>(module, "SphereBox", py::is_final(), box.c_str())
      .def(py::init([](int size, double radius, const ArrayLike& half_lengths, const ArrayLike& box_centre,
                       const ArrayLike& centre) {
             return std::make_unique<SphereBox>(size, radius, to_point(centre, "centre"),
                                                to_lengths(half_lengths), to_point(box_centre, "box_centre"));
           }),
           py::arg("size"), py::kw_only(), py::arg("radius"), py::arg("half_lengths"),
           py::arg("box_centre") = to_array(zero), py::arg("centre") = to_array(zero));
}

using AlongAxis = Joint (*)(const Vec3&, const Vec3&, const LagrangianDS&, const LagrangianDS*);
using AtPoint = Joint (*)(const Vec3&, const LagrangianDS&, const LagrangianDS*);

// Systems are looked at only while the joint is made.
auto maker(AlongAxis make) {
  return [make](const LagrangianDS& ds1, const LagrangianDS* ds2, const ArrayLike& at,
                const ArrayLike& axis) { return make(to_point(at, "at"), to_point(axis, "axis"), ds1, ds2); };
}
auto maker(AtPoint make) {
  return [make](const LagrangianDS& ds1, const LagrangianDS* ds2, const ArrayLike& at) {
    return make(to_point(at, "at"), ds1, ds2);
  };
}

void bind_joints(py::module_& module) {
  py::classh<Joint, Relation>(
      module, "Joint", py::is_final(),
      R"(A joint between two bodies, or one and the ground, to be linked with EqualityConditionNSL(joint.size).

It is told where it is in space while the bodies are at their initial positions: there it is closed. Bodies are
NewtonEulerDS, or plane ones with q = (x, y, angle); points of the plane may have two entries.

    weld = sk.Joint.weld(ds1, ds2, at=[0, 0, 1])
    system.link(sk.Interaction(weld, sk.EqualityConditionNSL(weld.size)), ds1, ds2)

Rows are g = e·(a − b) for points a, b of the bodies and e fixed in the second one [m], and g = f·e for directions
at right angles fixed in either [1].
)")
      .def_static("weld", maker(&Joint::weld), py::arg("ds1"), py::arg("ds2") = py::none(), py::kw_only(),
                  py::arg("at"), "Takes all freedoms: 6 rows, 3 in the plane.")
      .def_static("pivot", maker(&Joint::pivot), py::arg("ds1"), py::arg("ds2") = py::none(), py::kw_only(),
                  py::arg("at"), py::arg("axis") = std::vector<double>{0.0, 0.0, 1.0},
                  "Lets turn about an axis: 5 rows, 2 in the plane.")
      .def_static("ball", maker(&Joint::ball), py::arg("ds1"), py::arg("ds2") = py::none(), py::kw_only(),
                  py::arg("at"), "Holds a point: 3 rows, 2 in the plane.")
      .def_static("slider", maker(&Joint::slider), py::arg("ds1"), py::arg("ds2") = py::none(), py::kw_only(),
                  py::arg("at"), py::arg("axis"), "Lets slide along an axis: 5 rows, 2 in the plane.");
}

}  // namespace

void bind_bodies(py::module_& module) {
  bind_newton_euler(module);
  bind_contacts(module);
  bind_joints(module);
}

}  // namespace saltus::python
