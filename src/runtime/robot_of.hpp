#pragma once

/// \file
/// Robot for one compile-time type. Torque is that of the layout of individual limbs, each of which has the shared
/// values where limbs share them; the regressor has both layouts. Columns that the options leave out are dropped here,
/// once, by index.

#include <cstddef>
#include <string>
#include <vector>

#include "deltadyn/dynamics/forward_dynamics.hpp"
#include "deltadyn/dynamics/inverse_dynamics.hpp"
#include "deltadyn/dynamics/inverse_dynamics_derivatives.hpp"
#include "deltadyn/dynamics/joint_reactions.hpp"
#include "deltadyn/dynamics/mass_matrix.hpp"
#include "deltadyn/runtime/geometry_of.hpp"
#include "deltadyn/runtime/layout_columns.hpp"
#include "deltadyn/runtime/robot.hpp"

#include "link_poses_of.hpp"
#include "posture_along.hpp"

namespace deltadyn::detail {

/// Every column of a layout, in order.
template <class R, Limbs kSharing>
std::vector<ParameterId> layout_ids() {
  using Layout = ParameterLayout<R, kSharing>;
  std::vector<ParameterId> ids;
  const auto add_body = [&ids](Body body, int number) {
    for (int k = 0; k < kInertialParameters; ++k) ids.push_back({ParameterKind::inertial, number, body, k});
  };
  const auto of_limb = [](int i) { return kSharing == Limbs::individual ? i + 1 : 0; };
  for (int i = 0; i < Layout::kLimbSets; ++i) add_body(Body::upper_arm, of_limb(i));
  for (int i = 0; i < Layout::kStruts; ++i) add_body(Body::strut, of_limb(i));
  for (int k = 0, sets = 0; k < R::kPlateParts; ++k) {
    if (Layout::plate_set(k) < sets) continue;  // the same body once more
    ++sets;
    add_body(R::kParts[k], R::kParts[k] == Body::half_plate ? of_limb(k) : 0);
  }
  if (R::kTelescope)
    for (const Body body : {Body::tool, Body::telescope_upper, Body::telescope_lower}) add_body(body, 0);
  for (int j = 0; j < Layout::kFrictionJoints; ++j)
    for (const ParameterKind kind : {ParameterKind::viscous, ParameterKind::coulomb})
      ids.push_back({.kind = kind,
                     .number = j < R::kDrives ? j + 1 : 0,
                     .inner = R::kPlateTurns && j == R::kDrives ? InnerJointKind::plate : InnerJointKind::telescope});
  for (const ParameterKind kind : {ParameterKind::rotor_inertia, ParameterKind::offset})
    for (int j = 0; j < R::kDrives; ++j) ids.push_back({kind, j + 1});
  return ids;
}

template <class R>
class RobotOf final : public Robot {
 public:
  using Layout = ParameterLayout<R, Limbs::individual>;
  static constexpr int N = R::kDrives;
  using Drives = deltadyn::Vector<double, N>;

  RobotOf(const RobotDescription& description, const ParameterOptions& options)
      : description_(description), options_(options), geometry_(geometry_of<double, R>(description)) {
    const std::vector<ParameterId> all =
        options.individual_limbs ? layout_ids<R, Limbs::individual>() : layout_ids<R, Limbs::shared>();
    columns_ = layout_columns<R>(options);
    entry_ = layout_entries<R>(options);
    for (const int column : columns_) {
      ids_.push_back(all[static_cast<std::size_t>(column)]);
      names_.push_back(parameter_name(ids_.back()));
      units_.push_back(parameter_unit(
          ids_.back(), ids_.back().number > 0 ? description.kind_of_drive(ids_.back().number - 1) == DriveKind::revolute
                                              : ids_.back().inner == InnerJointKind::plate));
    }
  }

  const RobotDescription& description() const override { return description_; }
  const ParameterOptions& parameter_options() const override { return options_; }
  const std::vector<ParameterId>& parameter_ids() const override { return ids_; }
  const std::vector<std::string>& parameter_names() const override { return names_; }
  const std::vector<std::string>& parameter_units() const override { return units_; }

  Status inverse_kinematics(const ConstRef& z, Eigen::Ref<Vector> q) const override {
    Drives out;
    const Status status = deltadyn::inverse_kinematics(geometry_, Drives(z), out);
    if (status == Status::ok) q = out;
    return status;
  }

  Status forward_kinematics(const ConstRef& q, Eigen::Ref<Vector> z, PathPose* path) const override {
    Drives out;
    const Status status = pose_along(geometry_, Drives(q), path, out);
    if (status == Status::ok) z = out;
    return status;
  }

  Status to_drives(const TaskState& task, Eigen::Ref<Vector> q, Eigen::Ref<Vector> qd,
                   Eigen::Ref<Vector> qdd) const override {
    Motion<double, R> motion;
    const Status status = motion_from_task(geometry_, Drives(task.z), Drives(task.zd), Drives(task.zdd), motion);
    if (status == Status::ok) {
      q = motion.posture.q;
      qd = motion.qd;
      qdd = motion.qdd;
    }
    return status;
  }

  Status to_task(const ConstRef& q, const ConstRef& qd, const ConstRef& qdd, TaskState& task) const override {
    Motion<double, R> motion;
    const Status status = motion_from_drives(geometry_, Drives(q), Drives(qd), Drives(qdd), motion);
    if (status == Status::ok) task = {motion.posture.z, motion.zd, motion.zdd};
    return status;
  }

  Status jacobian(const ConstRef& q, Eigen::Ref<Eigen::MatrixXd> J_q_z) const override {
    Posture<double, R> posture;
    const Status status = posture_from_drives(geometry_, Drives(q), posture);
    if (status == Status::ok) J_q_z = task_jacobian(posture);
    return status;
  }

  Status link_poses(const ConstRef& q, LinkPoses& out) const override {
    Posture<double, R> posture;
    const Status status = posture_from_drives(geometry_, Drives(q), posture);
    if (status == Status::ok) out = link_poses_of<R>(geometry_, posture);
    return status;
  }

  Status regressor(const ConstRef& q, const ConstRef& qd, const ConstRef& qdd, Eigen::Ref<Eigen::MatrixXd> Y,
                   PathPose* path) const override {
    Motion<double, R> motion;
    const Status status = motion_along(geometry_, Drives(q), Drives(qd), Drives(qdd), path, motion);
    if (status != Status::ok) return status;
    if (options_.individual_limbs) {
      fill_regressor<Layout>(motion, Y);
    } else {
      fill_regressor<ParameterLayout<R, Limbs::shared>>(motion, Y);
    }
    return status;
  }

  Status inverse_dynamics(const ConstRef& q, const ConstRef& qd, const ConstRef& qdd, const ConstRef& p,
                          Eigen::Ref<Vector> tau, PathPose* path) const override {
    Motion<double, R> motion;
    const Status status = motion_along(geometry_, Drives(q), Drives(qd), Drives(qdd), path, motion);
    if (status == Status::ok) tau = deltadyn::inverse_dynamics<Layout>(geometry_, motion, all_columns(p));
    return status;
  }

  Status mass_matrix(const ConstRef& q, const ConstRef& p, Eigen::Ref<Eigen::MatrixXd> M,
                     PathPose* path) const override {
    Posture<double, R> posture;
    const Status status = posture_along(geometry_, Drives(q), path, posture);
    if (status == Status::ok) M = deltadyn::mass_matrix<Layout>(geometry_, posture, all_columns(p));
    return status;
  }

  Status forward_dynamics(const ConstRef& q, const ConstRef& qd, const ConstRef& tau, const ConstRef& p,
                          Eigen::Ref<Vector> qdd) const override {
    Posture<double, R> posture;
    Status status = posture_from_drives(geometry_, Drives(q), posture);
    Drives out;
    if (status == Status::ok) {
      status = deltadyn::forward_dynamics<Layout, double, R>(geometry_, posture, Drives(qd), Drives(tau),
                                                             all_columns(p), out);
    }
    if (status == Status::ok) qdd = out;
    return status;
  }

  Status equations_of_motion(const ConstRef& q, const ConstRef& qd, const ConstRef& p, Coordinates coordinates,
                             EquationTerms& terms) const override {
    Motion<double, R> motion;
    Status status = motion_from_drives(geometry_, Drives(q), Drives(qd), Drives(Drives::Zero()), motion);
    if (status != Status::ok) return status;
    EquationsOfMotion<double, N> found = deltadyn::equations_of_motion<Layout>(geometry_, motion, all_columns(p));
    if (coordinates == Coordinates::task) {
      const EquationsOfMotion<double, N> of_drives = found;
      status = equations_in_task(geometry_, motion, of_drives, found);
    }
    if (status == Status::ok) terms = {found.M, found.C, found.g, found.f};
    return status;
  }

  Status energies(const ConstRef& q, const ConstRef& qd, const ConstRef& p, Energies& energies) const override {
    Motion<double, R> motion;
    const Status status = motion_from_drives(geometry_, Drives(q), Drives(qd), Drives(Drives::Zero()), motion);
    if (status != Status::ok) return status;
    const auto all = all_columns(p);
    energies = {kinetic_energy<Layout>(geometry_, motion, all),
                potential_energy<Layout>(geometry_, motion.posture, all)};
    return status;
  }

  Status inverse_dynamics_derivatives(const ConstRef& q, const ConstRef& qd, const ConstRef& qdd, const ConstRef& p,
                                      TorqueSlopes& slopes) const override {
    Motion<double, R> motion;
    Status status = motion_from_drives(geometry_, Drives(q), Drives(qd), Drives(qdd), motion);
    if (status != Status::ok) return status;
    TorqueDerivatives<double, N> found;
    status = deltadyn::inverse_dynamics_derivatives<Layout>(geometry_, motion, all_columns(p), found);
    if (status == Status::ok) slopes = {found.by_q, found.by_qd, found.by_qdd};
    return status;
  }

  Status joint_reactions(const ConstRef& q, const ConstRef& qd, const ConstRef& qdd, const ConstRef& p,
                         std::vector<JointReaction>& reactions) const override {
    Motion<double, R> motion;
    Status status = motion_from_drives(geometry_, Drives(q), Drives(qd), Drives(qdd), motion);
    if (status != Status::ok) return status;
    JointReactions<double, R> found;
    status = deltadyn::joint_reactions<Layout>(geometry_, motion, all_columns(p), found);
    if (status == Status::ok) reactions = named_reactions(found);
    return status;
  }

  Status friction_joint_rates(const ConstRef& q, const ConstRef& qd, Eigen::Ref<Vector> rates,
                              PathPose* path) const override {
    Motion<double, R> motion;
    const Status status = motion_along(geometry_, Drives(q), Drives(qd), Drives(Drives::Zero()), path, motion);
    if (status != Status::ok) return status;
    for (int j = 0; j < Layout::kFrictionJoints; ++j) rates(j) = friction_joint(motion, j).rate;
    return status;
  }

 private:
  deltadyn::Vector<double, Layout::kColumns> all_columns(const ConstRef& p) const {
    deltadyn::Vector<double, Layout::kColumns> full;
    for (std::size_t k = 0; k < entry_.size(); ++k)
      full(static_cast<Eigen::Index>(k)) = entry_[k] < 0 ? 0.0 : p(entry_[k]);
    return full;
  }

  template <class OfRegressor>
  void fill_regressor(const Motion<double, R>& motion, Eigen::Ref<Eigen::MatrixXd> Y) const {
    Matrix<double, N, OfRegressor::kColumns> full;
    deltadyn::regressor<OfRegressor>(geometry_, motion, full);
    Y = full(Eigen::all, columns_);
  }

  std::vector<JointReaction> named_reactions(const JointReactions<double, R>& loads) const {
    std::vector<JointReaction> out;
    const auto add = [&out](const std::string& joint, const std::string& from, const std::string& onto,
                            const JointLoad<double>& load, double axial = 0) {
      out.push_back({joint, from, onto, load.place, load.force, load.moment, axial});
    };
    for (int i = 0; i < R::kLimbs; ++i) {
      const auto& limb = loads.limbs[i];
      const std::string number = std::to_string(i + 1), arm = name(Body::upper_arm) + number;
      add("drive" + number, "base", arm, limb.drive);
      for (int k = 0; k < (kHasPlate<R> ? 2 : 0); ++k) {
        const std::string strut = name(Body::strut) + number + (k == 0 ? 'a' : 'b');
        add(strut + ".elbow", arm, strut, limb.elbow[k]);
        add(strut + ".plate", strut, part_name(geometry_.limbs[i].part), limb.plate[k], limb.axial[k]);
      }
    }
    for (int k = 0; k < (R::kPlateTurns ? 2 : 0); ++k)
      add(part_name(k) + ".joints", "plate", part_name(k), loads.half_plate[k]);
    if constexpr (R::kTelescope) {
      const char *upper = name(Body::telescope_upper), *lower = name(Body::telescope_lower), *tool = name(Body::tool);
      add("telescope.base", "base", upper, loads.telescope_base);
      add("telescope.slide", upper, lower, loads.telescope_slide);
      add("telescope.tool", lower, tool, loads.telescope_tool);
      add("tool.bearing", name(Body::platform), tool, loads.tool_bearing);
    }
    return out;
  }

  /// Of a part of the plate that limbs hold.
  static std::string part_name(int part) {
    return name(R::kParts[part]) + (R::kPlateTurns ? std::to_string(part + 1) : std::string());
  }

  RobotDescription description_;
  ParameterOptions options_;
  Geometry<double, R> geometry_;
  std::vector<int> columns_;  // of the regressor's layout, in order
  std::vector<int> entry_;    // of each column of Layout in the parameters; -1: none
  std::vector<ParameterId> ids_;
  std::vector<std::string> names_, units_;
};

template <class R>
std::unique_ptr<Robot> make_robot_of(const RobotDescription& description, const ParameterOptions& options) {
  return std::make_unique<RobotOf<R>>(description, options);
}
}  // namespace deltadyn::detail
