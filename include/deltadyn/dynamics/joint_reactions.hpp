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

#include <Eigen/LU>

#include "deltadyn/dynamics/inverse_dynamics.hpp"

namespace deltadyn {

/// What one body exerts on another: a force [N] at the joint's centre and a moment [N m], both in W.
template <class T>
struct JointLoad {
  Vector3<T> place = Vector3<T>::Zero();  ///< of the joint's centre from W [m]
  Vector3<T> force = Vector3<T>::Zero();
  Vector3<T> moment = Vector3<T>::Zero();
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
  const T friction = p(Layout::viscous(Robot::kDrives)) * rate + p(Layout::coulomb(Robot::kDrives)) * sign_of(rate);
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

}  // namespace detail

/// Loads of all joints in a motion. For robots with a plate that does not turn; the inner joints of the others are not
/// described.
/// \return singular where the struts do not hold the plate level; then `out` keeps its values
template <class Layout, class T, class Robot>
Status joint_reactions(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion,
                       const Vector<T, Layout::kColumns>& p, JointReactions<T, Robot>& out) {
  static_assert(!Robot::kPlateTurns, "the joints inside a turning plate are not part of the geometry");
  constexpr int kOther = 4;
  // others: platform, tool, upper, lower part
  detail::Need<T> arms[Robot::kLimbs], struts[Robot::kLimbs], others[kOther];
  for_each_body(geometry, motion, JacobianRates<T, Robot>(),
                [&](Body kind, int index, int, const BodyState<T, Robot::kDrives>& body) {
                  const BodyInertia<T> inertia = body_inertia<Layout, T>(p, kind, index);
                  auto& need = kind == Body::upper_arm ? arms[index]
                               : kind == Body::strut
                                   ? struts[index]
                                   : others[static_cast<int>(kind) - static_cast<int>(Body::platform)];
                  need = {body.p_WB, body.R_WB * inertia.force(body), body.R_WB * inertia.moment(body), body.R_WB};
                });
  JointReactions<T, Robot> result;
  if constexpr (kHasPlate<Robot>) {
    // Balance of the plate without the struts' axial forces: what is left for them.
    const detail::Need<T>& plate = others[0];
    Vector3<T> force = -plate.force;
    Vector3<T> moment = -plate.moment;
    if constexpr (Robot::kTelescope) {
      detail::telescope_reactions<Layout>(geometry, motion, p, others[2], others[3], others[1], result);
      force -= result.tool_bearing.force;
      moment -= result.tool_bearing.moment +
                Vector3<T>(result.tool_bearing.place - plate.place).cross(result.tool_bearing.force);
    }
    Vector3<T> u[Robot::kLimbs], half[Robot::kLimbs], p_BA[Robot::kLimbs], across[Robot::kLimbs], couple[Robot::kLimbs];
    // columns: moment of the plate's balls for a unit difference of a limb's axial forces, times 2
    Matrix3<T> levelling;
    for (int i = 0; i < Robot::kLimbs; ++i) {
      const auto& limb = motion.posture.limbs[i];
      const Matrix3<T>& R_WL = limb.R_WL;
      const detail::Need<T>& strut = struts[i];
      u[i] = strut.R_WB.col(0);
      half[i] = T(0.5) * geometry.limbs[i].strut_spacing * R_WL.col(1);
      p_BA[i] = R_WL * limb.p_BA.value;
      const Vector3<T> n = R_WL * Vector3<T>(limb.beta.cos, T(0), -limb.beta.sin);
      couple[i] = (strut.moment.dot(u[i]) / limb.gamma.cos) * n;
      // Of the plate on one strut
      across[i] = Vector3<T>(strut.moment - couple[i]).cross(u[i]) / geometry.limbs[i].strut;
      force -= T(2) * across[i];
      moment -= T(2) * p_BA[i].cross(across[i]);
      levelling.col(i) = half[i].cross(u[i]);
    }
    // force and moment now hold what the plate takes: sum of u s, and of p_BA x u s + levelling d, for sums s and
    // differences d.
    const Vector3<T> sums = motion.posture.J_plate_loops.transpose() * force;
    for (int i = 0; i < Robot::kLimbs; ++i) moment -= sums(i) * p_BA[i].cross(u[i]);
    Matrix3<T> inverse;
    bool invertible = false;
    const T spacing = geometry.limbs[0].strut_spacing;
    levelling.computeInverseWithCheck(inverse, invertible, T(kSingularLoop) * spacing * spacing * spacing);
    if (!invertible) return Status::singular;
    const Vector3<T> differences = inverse * moment;

    for (int i = 0; i < Robot::kLimbs; ++i) {
      auto& limb = result.limbs[i];
      for (int k = 0; k < 2; ++k) {
        const T side = k == 0 ? T(1) : T(-1);
        limb.axial[k] = T(0.5) * (sums(i) + side * differences(i));
        const Vector3<T> at_plate = across[i] + limb.axial[k] * u[i];  // of the plate on the strut
        limb.plate[k] = {plate.place + p_BA[i] + side * half[i], -at_plate, Vector3<T>::Zero()};
        limb.elbow[k] = {struts[i].place + side * half[i], struts[i].force - at_plate, couple[i]};
      }
    }
  }
  for (int i = 0; i < Robot::kLimbs; ++i) {
    auto& limb = result.limbs[i];
    limb.drive = {arms[i].place, arms[i].force, arms[i].moment};
    for (const JointLoad<T>& elbow : limb.elbow) {
      limb.drive.force += elbow.force;
      limb.drive.moment += elbow.moment + Vector3<T>(elbow.place - arms[i].place).cross(elbow.force);
    }
  }
  out = result;
  return Status::ok;
}

}  // namespace deltadyn
