#pragma once

/// \file
/// Forces in the joints of a Delta by Newton's and Euler's laws, body by body from the given motion (the outlook of the
/// paper).
///
/// What carries what: a ball joint carries a force; at the elbow it carries, beside that, the moment about the normal
/// of the two axes that the paper takes it for (II.A), which is what holds a strut against turning about itself. It
/// does no work, and is small, because a strut's inertia about itself is. With that each of the six struts of a Delta
/// has one unknown, its axial force, and the plate's six balances give them: their sums in a limb hold the plate, their
/// differences hold it level. The telescope bar carries a moment from its upper to its lower universal joint, the slide
/// all but the axial force, which is its friction, and the tool's bearing on the plate all but the moment about its
/// axis. So everything is determined, with no stiffness assumed. Unlike drive torques, single reactions depend on
/// parameters that no motion shows (see base parameters): they are as good as the prior is there.
///
/// Of an articulated plate each half has one load, that of all joints that join it to the rest of the plate. The halves
/// of an H4 turn about their hinges by themselves, and eight struts hold what can move. The halves of an I4 and a Par4
/// stay parallel, so that one of eight struts is one too many: the differences are then the smallest that hold the
/// plate, which is how struts of equal stiffness share it.

#include <Eigen/LU>

#include "deltadyn/dynamics/inverse_dynamics.hpp"
#include "deltadyn/kinematics/inner_joint.hpp"

namespace deltadyn {

/// What one body exerts on another: a force [N] at the joint's centre and a moment [N m], both in W.
template <class T>
struct JointLoad {
  Vector3<T> place = Vector3<T>::Zero();  ///< of the joint's centre from W [m]
  Vector3<T> force = Vector3<T>::Zero();
  Vector3<T> moment = Vector3<T>::Zero();

  /// Takes over a share of what acts at another joint of the same body.
  void add(const JointLoad& other, const T& share) {
    force += share * other.force;
    moment += share * (other.moment + Vector3<T>(other.place - place).cross(other.force));
  }
};

/// Strut 0 stands at +y of the limb frame, strut 1 at -y.
template <class T, class Robot>
struct JointReactions {
  struct Limb {
    /// Base on upper arm, at the drive origin; on a carriage, at its own origin. The moment about the drive's axis (the
    /// force along it) is the drive torque less rotor inertia, friction and offset.
    JointLoad<T> drive;
    JointLoad<T> elbow[2];      ///< upper arm on strut
    JointLoad<T> plate[2];      ///< strut on plate
    T axial[2] = {T(0), T(0)};  ///< force along the strut at the plate's ball, tension positive [N]
  };
  Limb limbs[Robot::kLimbs];
  JointLoad<T> half_plate[2];  ///< rest of an articulated plate on either half, at the origin of its frame
  /// Base on the upper part of the bar; its vertical moment is what the fourth drive gives the bar
  JointLoad<T> telescope_base;
  JointLoad<T> telescope_slide;  ///< upper on lower part, at the lower joint's centre
  JointLoad<T> telescope_tool;   ///< lower part on tool
  JointLoad<T> tool_bearing;     ///< plate on tool, on the tool's axis at the height of the plate's centre
};

namespace detail {

/// What a body needs from its joints to move as it does: force and moment about its origin, in W.
template <class T>
struct Need {
  Vector3<T> place, force, moment;
  Matrix3<T> R_WB;
};

/// Reactions of bar and tool. Joints of the bar carry moments along n, the normal of both universal joints' axes.
template <class Layout, class T, class Robot>
void telescope_reactions(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion,
                         const Vector<T, Layout::kColumns>& p, const Need<T>& upper, const Need<T>& lower,
                         const Need<T>& tool, JointReactions<T, Robot>& out) {
  const auto& bar = motion.posture.telescope;
  const Vector3<T> n = rot_z(bar.psi) * Vector3<T>(T(0), -bar.a.sin, bar.a.cos);
  const Vector3<T>& e = bar.e;
  const Vector3<T> p_UV = -bar.length * e;
  const Vector3<T> turning = upper.moment + lower.moment + p_UV.cross(lower.force);  // about the upper joint
  const T both = turning.dot(e) / n.dot(e);
  const Vector3<T> bending = turning - both * n;
  const T rate = motion.telescope.length_d;
  const T friction = joint_friction<Layout>(p, Robot::kDrives, rate);
  // Of the tool on the bar
  const Vector3<T> at_lower = bending.cross(-e) / bar.length + (lower.force.dot(e) - friction) * e;
  const T mu_lower = -tool.moment.z() / n.z();

  out.telescope_base = {geometry.telescope.p_WU, upper.force + lower.force - at_lower, (both - mu_lower) * n};
  out.telescope_tool = {lower.place, -at_lower, -mu_lower * n};
  out.telescope_slide = {lower.place, lower.force - at_lower, lower.moment - mu_lower * n};
  const Vector3<T> to_joint(T(0), T(0), geometry.telescope.p_BV.z());  // from the bearing, along the tool's axis
  out.tool_bearing.place = lower.place - to_joint;
  out.tool_bearing.force = tool.force + at_lower;
  out.tool_bearing.moment = tool.moment + to_joint.cross(at_lower) + mu_lower * n;
}

/// What the joints inside an articulated plate give a half about the vertical axis of its frame: half of the friction
/// moment, and half of what a gear between plate and tool needs.
template <class Layout, class T, class Robot>
T moment_on_a_half(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion,
                   const Vector<T, Layout::kColumns>& p, const Need<T>& tool) {
  const T friction = joint_friction<Layout>(p, Robot::kDrives, inner_joint(motion).rate);
  return T(0.5) * (friction - (T(1) - geometry.yaw_ratio) * tool.moment.z());
}

/// Balance of the whole plate, which the struts hold: what their axial forces have to give.
template <class T, class Robot>
struct PlateBalance {
  static constexpr int P = kPlateCoordinates<Robot>;
  static constexpr bool kHinged = halves_turn_apart<Robot>();
  static constexpr int kTurns = kHinged ? 4 : 3;  ///< turns of the plate that the struts prevent
  Vector<T, P> along = Vector<T, P>::Zero();      ///< forces along the plate's coordinates [N; N m by psi]
  /// Moments about the plate's centre, and about the hinge of half plate 1
  Vector<T, kTurns> turning = Vector<T, kTurns>::Zero();

  /// \param half  the part is half plate 1, or held by it
  void add(const Vector3<T>& arm, const Vector3<T>& force, const Vector3<T>& moment, bool half,
           const Vector3<T>& hinge) {
    along.template head<3>() += force;
    turning.template head<3>() += moment + arm.cross(force);
    if (kHinged && half) turning(kTurns - 1) += moment.z() + Vector3<T>(arm - hinge).cross(force).z();
  }
};

/// Needs of the parts of the plate, its inner joints included.
template <class Layout, class T, class Robot>
PlateBalance<T, Robot> balance_of_parts(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion,
                                        const Vector<T, Layout::kColumns>& p, const Need<T>* parts) {
  PlateBalance<T, Robot> balance;
  const Vector3<T> r = motion.posture.z.template head<3>();
  for (int k = 0; k < Robot::kPlateParts; ++k) {
    const Need<T>& part = parts[k];
    const Vector3<T> arm = part.place - r;
    balance.add(arm, part.force, part.moment, k == 0, arm);
    if constexpr (Robot::kPlateTurns) {
      const PartPose<T> pose = part_pose(geometry.parts[k], motion.posture.z(3), geometry.yaw_ratio);
      balance.along(3) += pose.p.first.dot(part.force) + pose.rate * part.moment.z();
    }
  }
  if constexpr (Robot::kPlateTurns) {
    balance.along(3) += motion.posture.theta_gain * joint_friction<Layout>(p, Robot::kDrives, inner_joint(motion).rate);
    if constexpr (PlateBalance<T, Robot>::kHinged)
      balance.turning(3) -= moment_on_a_half<Layout>(geometry, motion, p, parts[tool_part<Robot>()]);
  }
  return balance;
}

/// Joint loads of all limbs, from the balance of the plate without the struts' axial forces.
template <class T, class Robot>
Status limb_reactions(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion, const Need<T>* struts,
                      PlateBalance<T, Robot> balance, const Vector3<T>& hinge, JointReactions<T, Robot>& out) {
  constexpr int kTurns = PlateBalance<T, Robot>::kTurns;
  const Vector3<T> r = motion.posture.z.template head<3>();
  Vector3<T> u[Robot::kLimbs], half[Robot::kLimbs], p_BA[Robot::kLimbs], across[Robot::kLimbs], couple[Robot::kLimbs];
  // columns: moments of the plate's balls for a unit difference of a limb's axial forces, times 2
  Matrix<T, kTurns, Robot::kLimbs> levelling;
  for (int i = 0; i < Robot::kLimbs; ++i) {
    const auto& limb = motion.posture.limbs[i];
    const bool on_first = geometry.limbs[i].part == 0;
    const Need<T>& strut = struts[i];
    u[i] = strut.R_WB.col(0);
    half[i] = T(0.5) * geometry.limbs[i].strut_spacing * limb.R_WL.col(1);
    p_BA[i] = limb.R_WL * limb.p_BA.value;
    const Vector3<T> n = limb.R_WL * Vector3<T>(limb.beta.cos, T(0), -limb.beta.sin);
    couple[i] = (strut.moment.dot(u[i]) / limb.gamma.cos) * n;
    // Of the plate on one strut
    across[i] = Vector3<T>(strut.moment - couple[i]).cross(u[i]) / geometry.limbs[i].strut;
    const Vector3<T> both = T(2) * across[i];
    balance.add(p_BA[i], both, Vector3<T>::Zero(), on_first, hinge);
    if constexpr (Robot::kPlateTurns) balance.along(3) += (limb.R_WL * limb.p_BA.first).dot(both);
    const Vector3<T> levels = half[i].cross(u[i]);
    levelling.col(i).template head<3>() = levels;
    if constexpr (kTurns > 3) levelling(3, i) = on_first ? levels.z() : T(0);
  }
  // What the plate takes: sum of u s, and of p_BA x u s + levelling d, for sums s and differences d.
  const Vector<T, PlateBalance<T, Robot>::P> sums = -(motion.posture.J_plate_loops.transpose() * balance.along);
  for (int i = 0; i < Robot::kLimbs; ++i)
    balance.add(p_BA[i], sums(i) * u[i], Vector3<T>::Zero(), geometry.limbs[i].part == 0, hinge);
  const Matrix<T, kTurns, kTurns> square = levelling * levelling.transpose();
  Matrix<T, kTurns, kTurns> inverse;
  bool invertible = false;
  T enough = T(kSingularLoop) * T(kSingularLoop);
  for (int k = 0; k < 2 * kTurns; ++k) enough *= geometry.limbs[0].strut_spacing;
  square.computeInverseWithCheck(inverse, invertible, enough);
  if (!invertible) return Status::singular;
  const Vector<T, Robot::kLimbs> differences = -(levelling.transpose() * (inverse * balance.turning));

  for (int i = 0; i < Robot::kLimbs; ++i) {
    auto& limb = out.limbs[i];
    for (int k = 0; k < 2; ++k) {
      const T side = k == 0 ? T(1) : T(-1);
      limb.axial[k] = T(0.5) * (sums(i) + side * differences(i));
      const Vector3<T> at_plate = across[i] + limb.axial[k] * u[i];  // of the plate on the strut
      limb.plate[k] = {r + p_BA[i] + side * half[i], -at_plate, Vector3<T>::Zero()};
      limb.elbow[k] = {struts[i].place + side * half[i], struts[i].force - at_plate, couple[i]};
    }
  }
  return Status::ok;
}

/// What the rest of an articulated plate gives each half: what its limbs leave of its need.
template <class T, class Robot>
void half_plate_reactions(const Geometry<T, Robot>& geometry, const Need<T>* parts, JointReactions<T, Robot>& out) {
  for (int k = 0; k < 2; ++k) {
    JointLoad<T>& load = out.half_plate[k];
    load = {parts[k].place, parts[k].force, parts[k].moment};
    for (int i = 0; i < Robot::kLimbs; ++i) {
      if (geometry.limbs[i].part != k) continue;
      for (const JointLoad<T>& ball : out.limbs[i].plate) load.add(ball, T(-1));
    }
  }
}

}  // namespace detail

/// Loads of all joints in a motion.
/// \return singular where the struts do not hold the plate level; then `out` keeps its values
template <class Layout, class T, class Robot>
Status joint_reactions(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion,
                       const Vector<T, Layout::kColumns>& p, JointReactions<T, Robot>& out) {
  constexpr int kOthers = Robot::kPlateParts + (Robot::kTelescope ? 3 : 0);  // the plate's parts; tool, bar
  detail::Need<T> arms[Robot::kLimbs], struts[Robot::kLimbs], others[kOthers > 0 ? kOthers : 1];
  int other = 0;
  for_each_body(
      geometry, motion, JacobianRates<T, Robot>(),
      [&](Body kind, int index, int, const BodyState<T, Robot::kDrives>& body) {
        const BodyInertia<T> inertia = body_inertia<Layout, T>(p, kind, index);
        auto& need = kind == Body::upper_arm ? arms[index] : kind == Body::strut ? struts[index] : others[other++];
        need = {body.p_WB, body.R_WB * inertia.force(body), body.R_WB * inertia.moment(body), body.R_WB};
      });
  JointReactions<T, Robot> result;
  if constexpr (kHasPlate<Robot>) {
    auto balance = detail::balance_of_parts<Layout>(geometry, motion, p, others);
    const Vector3<T> r = motion.posture.z.template head<3>();
    if constexpr (Robot::kTelescope) {
      detail::telescope_reactions<Layout>(geometry, motion, p, others[2], others[3], others[1], result);
      const JointLoad<T>& bearing = result.tool_bearing;
      balance.add(bearing.place - r, bearing.force, bearing.moment, false, Vector3<T>::Zero());
    }
    const Status status =
        detail::limb_reactions(geometry, motion, struts, balance, Vector3<T>(others[0].place - r), result);
    if (status != Status::ok) return status;
    if constexpr (Robot::kPlateTurns) detail::half_plate_reactions(geometry, others, result);
  }
  for (int i = 0; i < Robot::kLimbs; ++i) {
    auto& limb = result.limbs[i];
    limb.drive = {arms[i].place, arms[i].force, arms[i].moment};
    for (const JointLoad<T>& elbow : limb.elbow) limb.drive.add(elbow, T(1));
  }
  out = result;
  return Status::ok;
}

}  // namespace deltadyn
