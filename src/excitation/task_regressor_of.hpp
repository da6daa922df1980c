#pragma once

/// \file
/// TaskRegressor for one compile-time type. The kinematics run once in numbers that carry their derivatives by the 3 N
/// entries of the state (forward mode); what the bodies make of them is differentiated by hand (reverse mode), because
/// a body turns few numbers into ten columns for each drive.

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <vector>

#include "deltadyn/core/dual.hpp"
#include "deltadyn/dynamics/regressor.hpp"
#include "deltadyn/excitation/task_regressor.hpp"
#include "deltadyn/runtime/geometry_of.hpp"
#include "deltadyn/runtime/layout_columns.hpp"

namespace deltadyn::detail {

template <class R>
class TaskRegressorOf final : public TaskRegressor {
 public:
  using Layout = ParameterLayout<R, Limbs::individual>;
  using SharedLayout = ParameterLayout<R, Limbs::shared>;
  static constexpr int N = R::kDrives;
  static constexpr int kState = 3 * N;
  using State = deltadyn::Vector<double, kState>;
  using Jet = Dual<double, kState>;
  using Drives = deltadyn::Vector<double, N>;
  using JetDrives = deltadyn::Vector<Jet, N>;
  using Full = Matrix<double, N, Layout::kColumns>;  // each limb on its own
  using Vec = const Eigen::Ref<const Eigen::VectorXd>&;

  explicit TaskRegressorOf(const Robot& robot)
      : geometry_(geometry_of<double, R>(robot.description())),
        jet_geometry_(geometry_of<Jet, R>(robot.description())),
        individual_limbs_(robot.parameter_options().individual_limbs),
        columns_(layout_columns<R>(robot.parameter_options())),
        entry_(layout_entries<R>(robot.parameter_options())) {}

  int drives() const override { return N; }
  int parameters() const override { return static_cast<int>(columns_.size()); }
  int friction_joints() const override { return Layout::kFrictionJoints; }

  Status evaluate(Vec x, Vec sign_width, Eigen::Ref<Eigen::MatrixXd> Y,
                  Eigen::Ref<Eigen::VectorXd> out) const override {
    Motion<double, R> motion;
    const Status status = motion_from_task(geometry_, Drives(x.template head<N>()), Drives(x.template segment<N>(N)),
                                           Drives(x.template tail<N>()), motion);
    if (status != Status::ok) return status;
    if (individual_limbs_) {
      fill<Layout>(motion, sign_width, Y);
    } else {
      fill<SharedLayout>(motion, sign_width, Y);
    }
    out << motion.posture.q, motion.qd, motion.qdd;
    return Status::ok;
  }

  Status differentiate(Vec x, Vec sign_width, const Eigen::Ref<const Eigen::MatrixXd>& G_columns,
                       Eigen::Ref<Eigen::MatrixXd> gradients, Eigen::Ref<Eigen::MatrixXd> jacobian) const override {
    Motion<Jet, R> motion;
    const Status status = jet_motion(x, motion);
    if (status != Status::ok) return status;
    const auto full = [&](Eigen::Index sum) {
      Full G = Full::Zero();  // a column that limbs share goes to each of them
      for (std::size_t k = 0; k < entry_.size(); ++k)
        if (entry_[k] >= 0) G.col(static_cast<Eigen::Index>(k)) = G_columns.col(entry_[k]).template segment<N>(sum * N);
      return G;
    };
    std::vector<Full> G;
    for (Eigen::Index sum = 0; sum < gradients.cols(); ++sum) G.push_back(full(sum));
    gradients.setZero();
    for_each_body(jet_geometry_, motion, [&](Body kind, int index, int count, const BodyMotion<Jet, N>& body) {
      const int first = kInertialParameters * Layout::body(kind, index);
      for (std::size_t sum = 0; sum < G.size(); ++sum)
        gradients.col(static_cast<Eigen::Index>(sum)) +=
            count * body_gradient(body, G[sum].template middleCols<kInertialParameters>(first));
    });
    for (std::size_t sum = 0; sum < G.size(); ++sum)
      add_joints(motion, sign_width, G[sum], gradients.col(static_cast<Eigen::Index>(sum)));
    for (int i = 0; i < N; ++i) {
      jacobian.row(i) = motion.posture.q(i).slope.transpose();
      jacobian.row(N + i) = motion.qd(i).slope.transpose();
      jacobian.row(2 * N + i) = motion.qdd(i).slope.transpose();
    }
    return Status::ok;
  }

 private:
  using Vec3 = deltadyn::Vector3<double>;

  template <class OfRegressor>
  void fill(const Motion<double, R>& motion, Vec sign_width, Eigen::Ref<Eigen::MatrixXd> Y) const {
    Matrix<double, N, OfRegressor::kColumns> full;
    deltadyn::regressor<OfRegressor>(geometry_, motion, full);
    if (sign_width.size() > 0) {
      for (int joint = 0; joint < Layout::kFrictionJoints; ++joint) {
        const auto f = friction_joint(motion, joint);
        full.col(OfRegressor::coulomb(joint)) = f.rate / std::hypot(f.rate, sign_width(joint)) * f.J.transpose();
      }
    }
    Y = full(Eigen::all, columns_);
  }

  /// Share of friction and rotors in the gradient.
  static void add_joints(const Motion<Jet, R>& motion, Vec sign_width, const Full& G,
                         Eigen::Ref<Eigen::VectorXd> gradient) {
    State sum = gradient;
    for (int joint = 0; joint < Layout::kFrictionJoints; ++joint) {
      const auto f = friction_joint(motion, joint);
      const double v = f.rate.value, w = sign_width.size() > 0 ? sign_width(joint) : 0.0;
      const double root = std::hypot(v, w);
      const double sign = root > 0 ? v / root : 0.0;
      const double slope = w > 0 ? w * w / (root * root * root) : 0.0;
      double by_rate = 0;
      for (int i = 0; i < N; ++i) {
        const double viscous = G(i, Layout::viscous(joint)), coulomb = G(i, Layout::coulomb(joint));
        by_rate += (viscous + coulomb * slope) * f.J(i).value;
        sum += (viscous * v + coulomb * sign) * f.J(i).slope;
      }
      sum += by_rate * f.rate.slope;
    }
    for (int i = 0; i < N; ++i) sum += G(i, Layout::kRotorInertia + i) * motion.qdd(i).slope;
    gradient = sum;
  }

  /// The motion of a task-space state with its derivatives by all of the state.
  Status jet_motion(Vec x, Motion<Jet, R>& motion) const {
    // Inverse kinematics in plain numbers; a drive's derivative by z is its rate for a unit rate of z.
    Motion<double, R> still;
    const Drives z = x.template head<N>(), none = Drives::Zero();
    Status status = motion_from_task(geometry_, z, none, none, still);
    if (status != Status::ok) return status;
    JetDrives jet_z, jet_zd, jet_zdd, jet_q;
    for (int i = 0; i < N; ++i) {
      jet_z(i) = Jet(x(i), State::Unit(i));
      jet_zd(i) = Jet(x(N + i), State::Unit(N + i));
      jet_zdd(i) = Jet(x(2 * N + i), State::Unit(2 * N + i));
      jet_q(i) = Jet(still.posture.q(i));
    }
    for (int k = 0; k < N; ++k) {
      Drives qd, unused;
      status = drive_rates(geometry_, still.posture, Drives(Drives::Unit(k)), none, qd, unused);
      if (status != Status::ok) return status;
      for (int i = 0; i < N; ++i) jet_q(i).slope(k) = qd(i);
    }
    status = assemble_posture(jet_geometry_, jet_q, jet_z, motion.posture);
    JetDrives jet_qd, jet_qdd;
    if (status == Status::ok) status = drive_rates(jet_geometry_, motion.posture, jet_zd, jet_zdd, jet_qd, jet_qdd);
    if (status == Status::ok) set_drive_rates(jet_geometry_, jet_qd, jet_qdd, motion);
    return status;
  }

  static Vec3 value(const deltadyn::Vector3<Jet>& v) { return {v.x().value, v.y().value, v.z().value}; }
  static void add(State& sum, const Vec3& weight, const deltadyn::Vector3<Jet>& v) {
    sum += weight.x() * v.x().slope + weight.y() * v.y().slope + weight.z() * v.z().slope;
  }

  /// Gradient of sum_ij G_ij (J_v' F + J_w' M)_ij with the force and moment regressors F, M of the body. With the rows
  /// of G as parameters (m, c, I) of bodies, row i adds J_v,i . f_i + J_w,i . n_i, where f = m a + w_d x c + w x (w x
  /// c) and n = I w_d + w x I w + c x a.
  static State body_gradient(const BodyMotion<Jet, N>& body, const Matrix<double, N, kInertialParameters>& G) {
    const Vec3 a = value(body.a), w = value(body.w), w_d = value(body.w_d);
    Vec3 by_a = Vec3::Zero(), by_w = Vec3::Zero(), by_w_d = Vec3::Zero();
    State sum = State::Zero();
    for (int i = 0; i < N; ++i) {
      const double m = G(i, 0);
      const Vec3 c(G(i, 1), G(i, 2), G(i, 3));
      Matrix3<double> I;
      I << G(i, 4), G(i, 7), G(i, 9), G(i, 7), G(i, 5), G(i, 8), G(i, 9), G(i, 8), G(i, 6);
      const deltadyn::Vector3<Jet> jet_v = body.J_v.col(i), jet_w = body.J_w.col(i);
      const Vec3 v_i = value(jet_v), w_i = value(jet_w);
      const Vec3 w_c = w.cross(c), I_w = I * w;
      by_a += m * v_i + w_i.cross(c);
      by_w_d += c.cross(v_i) + I * w_i;
      by_w += w_c.cross(v_i) + c.cross(v_i.cross(w)) + I_w.cross(w_i) + I * w_i.cross(w);
      add(sum, m * a + w_d.cross(c) + w.cross(w_c), jet_v);
      add(sum, I * w_d + w.cross(I_w) + c.cross(a), jet_w);
    }
    add(sum, by_a, body.a);
    add(sum, by_w, body.w);
    add(sum, by_w_d, body.w_d);
    return sum;
  }

  Geometry<double, R> geometry_;
  Geometry<Jet, R> jet_geometry_;
  bool individual_limbs_;
  std::vector<int> columns_;  // of the regressor's layout, in order
  std::vector<int> entry_;    // of each column of Layout in the parameters; -1: none
};

template <class R>
std::unique_ptr<TaskRegressor> make_task_regressor_of(const Robot& robot) {
  return std::make_unique<TaskRegressorOf<R>>(robot);
}
}  // namespace deltadyn::detail
