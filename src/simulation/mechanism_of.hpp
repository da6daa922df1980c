#pragma once

/// \file
/// Mechanism for one compile-time type.

#include <memory>

#include "deltadyn/dynamics/equations_of_motion.hpp"
#include "deltadyn/dynamics/forward_dynamics.hpp"
#include "deltadyn/kinematics/passive_joints.hpp"
#include "deltadyn/kinematics/tool_point.hpp"
#include "deltadyn/runtime/geometry_of.hpp"
#include "deltadyn/simulation/mechanism.hpp"

namespace deltadyn::detail {

template <class R>
class MechanismOf final : public Mechanism {
 public:
  using Layout = ParameterLayout<R, Limbs::individual>;
  static constexpr int N = R::kDrives;
  using Drives = Vector<double, N>;

  MechanismOf(const RobotDescription& description, const Eigen::VectorXd& p, const MechanismOptions& options)
      : geometry_(geometry_of<double, R>(description)), p_(p), passive_(options.passive_joints && kHasPlate<R>) {
    for (int j = 0; j < Layout::kFrictionJoints; ++j) p_(Layout::viscous(j)) = p_(Layout::coulomb(j)) = 0;
    for (int j = 0; j < N; ++j) p_(Layout::kOffset + j) = 0;
    for (int j = 0; j < N && options.home_offset.size() == N; ++j) home_offset_(j) = options.home_offset(j);
    drives_ = N;
    multiplicity_.assign(static_cast<std::size_t>(Layout::kFrictionJoints), 1.0);
    if (kHasInnerJoint<R>) inner_joint_ = N;
    if (passive_) {
      for (int k = 0; k < kPassiveJoints<R>; ++k) multiplicity_.push_back(passive_joints_alike<R>(k));
    }
  }

  Status evaluate(const DriveVector& q, const DriveVector& qd, MechanismTerms& terms) const override {
    Motion<double, R> motion;
    Drives rates;
    for (int j = 0; j < N; ++j) rates(j) = qd(j);
    if (!rates.allFinite()) return Status::out_of_range;
    if (const Status status = posture_from_drives(geometry_, true_coordinates(q), motion.posture);
        status != Status::ok) {
      return status;
    }
    set_drive_rates<double, R>(geometry_, rates, Drives::Zero(), motion);
    Matrix<double, N, N> M;
    Drives bias;
    mass_and_bias<Layout, double, R>(geometry_, motion.posture, rates, p_, M, bias);
    // Entry by entry: gcc 12 takes Eigen's copy of one number to dynamic size for a read past its end.
    terms.M.resize(N, N);
    terms.bias.resize(N);
    for (int i = 0; i < N; ++i) {
      terms.bias(i) = bias(i);
      for (int j = 0; j < N; ++j) terms.M(i, j) = M(i, j);
    }
    set_joints(motion, terms);
    if constexpr (kHasPlate<R>) {
      const auto tool = tool_point(geometry_, motion);
      terms.r = tool.position;
      terms.v = tool.velocity;
      terms.a_bias = tool.acceleration;
      terms.J_r = tool.J;
      if constexpr (R::kTelescope) terms.bar = motion.posture.telescope.e;
    }
    return Status::ok;
  }

  Status potential_energy(const DriveVector& q, double& joule) const override {
    Posture<double, R> posture;
    const Status status = posture_from_drives(geometry_, true_coordinates(q), posture);
    if (status == Status::ok) joule = deltadyn::potential_energy<Layout>(geometry_, posture, p_);
    return status;
  }

 private:
  Drives true_coordinates(const DriveVector& q) const {
    Drives coordinates;
    for (int j = 0; j < N; ++j) coordinates(j) = q(j) + home_offset_(j);
    return coordinates;
  }

  void set_joints(const Motion<double, R>& motion, MechanismTerms& terms) const {
    const int count = joints();
    if (terms.J.rows() != count || terms.J.cols() != N) {
      terms.position = terms.rate = terms.bias_rate = JointVector::Zero(count);
      terms.J.setZero(count, N);
    }
    terms.J.template topRows<N>().setIdentity();
    terms.position.template head<N>() = motion.posture.q;
    terms.rate.template head<N>() = motion.qd;
    terms.bias_rate.template head<N>().setZero();
    int row = N;
    const auto add = [&](double position, double rate, double bias_rate, const RowVector<double, N>& J) {
      terms.position(row) = position;
      terms.rate(row) = rate;
      terms.bias_rate(row) = bias_rate;
      terms.J.row(row++) = J;
    };
    if constexpr (kHasInnerJoint<R>) {
      const InnerJoint<double, R> inner = deltadyn::inner_joint(motion);
      add(inner.position, inner.rate, inner.acceleration, inner.J);
    }
    if (!passive_) return;
    for_each_passive_joint(
        motion, [&add](int, const PassiveJoint<double, R>& joint) { add(0, joint.rate, joint.acceleration, joint.J); });
  }

  Geometry<double, R> geometry_;
  Vector<double, Layout::kColumns> p_;
  Drives home_offset_ = Drives::Zero();
  bool passive_;
};

template <class R>
std::unique_ptr<Mechanism> make_mechanism_of(const RobotDescription& description, const Eigen::VectorXd& p,
                                             const MechanismOptions& options) {
  return std::make_unique<MechanismOf<R>>(description, p, options);
}
}  // namespace deltadyn::detail
