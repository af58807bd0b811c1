#pragma once
// The rotor of Section 6.2 in C++: axle, welds, bearing and contact. rotor.py explains the formulas.
#include "rotor/axle_element.hpp"
#include "saltus/kernel/model/bodies/contacts.hpp"
#include "saltus/kernel/model/nonsmooth_dynamical_system.hpp"

namespace saltus::examples {

/// Table 6, what belongs to the axle and its drive.
struct AxleParameters {
  int elements = 5;                 ///< N_A
  double length = 0.59;             ///< l_A [m]
  double radius = 12.5e-3;          ///< r_A [m]
  double density = 7.85e3;          ///< ρ_A [kg/m³]
  double E = 2.1e11;                ///< E_A [N/m²]
  double G = 0.81e11;               ///< G_A [N/m²]
  double mass_damping = 60.0;       ///< d_1A [1/s]
  double torsional_damping = 1e-3;  ///< d_2A [kg m²/s]
  double mount_stiffness = 6e6;     ///< c_D of the end at x = l_A [N/m]
  double mount_damping = 10.0;      ///< d_D [N s/m]
  double drive_torque = 100.0;      ///< T_D about x at x = l_A [N m]
  double drive_until = 0.05;        ///< T_D acts until then [s]
  double fault_torque = 10.0;       ///< T_F about −z at x = l_A [N m]
  double gravity = 9.81;            ///< γ along −z [m/s²]

  /// @throws std::invalid_argument unless lengths, density and moduli are positive and all are finite
  void require_sound() const;
  AxleElement element() const;
};

/// Where a station s of the axle lies in its elements, and the shape functions there.
struct Station {
  int first;                  ///< freedom of the axle: α of the element's first node
  double s;                   ///< [m]
  double linear[2];           ///< of α
  double cubic[4], slope[4];  ///< of w or u in (w1, w1', w2, w2'), and their derivatives by s
};

/// Position and directions of a cross-section: x = s e_x + w e_y' + u e_z', with e_y', e_z' turned by α about
/// the axis, and the tangent t = e_x + w' e_y' + u' e_z'.
struct Section {
  Vec3 x, tangent, y, z;
  Section(const Station& station, const double* q);
};

/// The axle, q (5 (elements + 1)) = α, w, w', u, u' of each node [rad, m, 1, m, 1].
class Axle final : public LagrangianDS {
 public:
  /// @throws std::invalid_argument if a size or a parameter is wrong
  Axle(Vec q0, Vec v0, const AxleParameters& parameters);
  const AxleParameters& parameters() const { return p_; }
  /// @throws std::invalid_argument unless 0 <= s <= length
  Station station(double s) const;

  void mass(const In& q, OutMatrix M) const override;
  void forces(double t, const In& q, const In& v, Out h) const override;
  bool force_jacobians(double t, const In& q, const In& v, OutMatrix dh_dq, OutMatrix dh_dv) const override;
  /// Of gravity, of the elastic axle and of its mount; not of the torques.
  double potential_energy(const In& q) const override;

 private:
  void add_end_forces(double t, const In& q, const In& v, Out h) const;
  AxleParameters p_;
  AxleElement element_;
};

/// A body welded to the axle at a station, bilateral, size 6. With the body's axes b1, b2, b3:
///   g = (x_B − x(s); t·b2; t·b3; e_y'·b3)  [m, 1]
class AxleWeld final : public Relation {
 public:
  /// @throws std::invalid_argument unless the station lies on the axle
  AxleWeld(const Axle& axle, double s);
  void require_dimensions(int coordinates, int freedoms) const override;
  void gap(const In& q, Out g) const override;
  void jacobian(const In& q, OutMatrix J) const override;

  /// Where a body is, and how it moves, that the weld holds to the axle at its initial state.
  struct State {
    Vec q, v;  ///< (7), (6)
  };
  static State held(const Axle& axle, double s);

 private:
  Station station_;
  int freedoms_;  // of the axle
};

/// The frustum's disc inside of the bearing's circle: with ρ the distance of the disc's centre from the
/// circle's axis, g = R − r − ρ. The first body has the disc, the second one the circle, both across their x
/// axes.
class JournalContact final : public BodyContact {
 public:
  /// @param size    1, or 3 with friction
  /// @param disc    radius r of the disc [m]
  /// @param circle  radius R of the circle, > r > 0 [m]
  /// @param along   centres of disc and circle on the x axes of their bodies [m]
  /// @throws std::invalid_argument if a value is wrong
  JournalContact(int size, double disc, double circle, double along);
  Closest closest(const BodyPair& bodies) const override;

 private:
  double disc_, circle_;
  Vec3 centre_;
};

/// A rigid body on springs and dampers that hold it at the origin, translation and rotation alike.
class MountedBody final : public NewtonEulerDS {
 public:
  /// @param stiffness  c >= 0 [N/m, N m]
  /// @param damping    d >= 0 [N s/m, N m s]
  /// @param gravity    along −z [m/s²]
  /// @throws std::invalid_argument if a value is wrong
  MountedBody(Vec q0, Vec v0, double mass, const Mat3& inertia, double stiffness, double damping,
              double gravity);
  void loads(double t, const In& q, const In& v, BodyLoads& loads) const override;
  bool varying_loads() const override { return true; }
  double potential_energy(const In& q) const override;

 private:
  double stiffness_, damping_, gravity_;
};

/// The whole model with the values of Table 6, as build() of rotor.py makes it: axle, flywheel, frustum,
/// bearing; interactions "flywheel weld", "frustum weld" and "journal".
NonSmoothDynamicalSystem make_rotor();

}  // namespace saltus::examples
