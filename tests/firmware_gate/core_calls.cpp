// Calls every function of the core that firmware may want, for one scalar (GATE_SCALAR) and every robot.

#include "core_calls.hpp"

#include "deltadyn/dynamics/equations_of_motion.hpp"
#include "deltadyn/dynamics/forward_dynamics.hpp"
#include "deltadyn/dynamics/inverse_dynamics.hpp"
#include "deltadyn/dynamics/inverse_dynamics_derivatives.hpp"
#include "deltadyn/dynamics/joint_reactions.hpp"
#include "deltadyn/dynamics/mass_matrix.hpp"
#include "deltadyn/dynamics/regressor.hpp"
#include "deltadyn/firmware/feed_forward.hpp"
#include "deltadyn/kinematics/forward.hpp"
#include "deltadyn/kinematics/inverse.hpp"
#include "deltadyn/kinematics/motion.hpp"
#include "deltadyn/model/inertial_parameters.hpp"
#include "deltadyn/model/log_cholesky.hpp"

#include "plausible_geometry.hpp"

namespace deltadyn::firmware_gate {
namespace {

template <class T, class Derived>
double largest(const Eigen::MatrixBase<Derived>& values) {
  T result = T(0);
  for (int j = 0; j < values.cols(); ++j) {
    for (int i = 0; i < values.rows(); ++i) {
      const T magnitude = values(i, j) < T(0) ? -values(i, j) : values(i, j);
      if (!(magnitude <= result)) result = magnitude;
    }
  }
  return static_cast<double>(result);
}

template <class Layout, class T, class Robot>
T friction_torque_of_drive(const Motion<T, Robot>& motion, const Vector<T, Layout::kColumns>& p, int drive) {
  return p(Layout::viscous(drive)) * motion.qd(drive) + p(Layout::coulomb(drive)) * sign_of(motion.qd(drive));
}

template <class T, class Robot, Limbs kSharing>
void run_dynamics(const Geometry<T, Robot>& geometry, const Motion<T, Robot>& motion, T phase, Outcome& outcome) {
  constexpr int N = Robot::kDrives;
  using Layout = ParameterLayout<Robot, kSharing>;
  Vector<T, Layout::kColumns> p;
  for (int i = 0; i < Layout::kColumns; ++i) p(i) = T(0.1) + T(0.02) * T(i % 7) + T(0.001) * phase;
  for (int body = 0; body < Layout::kBodies; ++body) {  // masses large beside their moments: physically consistent
    p(kInertialParameters * body) += T(1);
    for (int k = 4; k < 7; ++k) p(kInertialParameters * body + k) += T(1);
  }

  const Vector<T, N> tau = inverse_dynamics<Layout>(geometry, motion, p);
  Matrix<T, N, Layout::kColumns> Y;
  regressor<Layout>(geometry, motion, Y);
  const Vector<T, N> tau_Y = Y.lazyProduct(p);
  const Matrix<T, N, N> M = mass_matrix<Layout>(geometry, motion.posture, p);

  const FeedForward<T, Robot, kSharing> feed_forward(geometry, p);
  Vector<T, N> q, qd, tau_task, tau_drives;
  const Status from_task = feed_forward.from_task(motion.posture.z, motion.zd, motion.zdd, q, qd, tau_task);
  const Status from_drives = feed_forward.from_drives(motion.posture.q, motion.qd, motion.qdd, tau_drives);
  outcome.ok = outcome.ok && from_task == Status::ok && from_drives == Status::ok;

  Vector<T, N> qdd;
  EquationsOfMotion<T, N> task;
  TorqueDerivatives<T, N> slopes;
  const EquationsOfMotion<T, N> terms = equations_of_motion<Layout>(geometry, motion, p);
  outcome.ok = outcome.ok &&
               forward_dynamics<Layout, T, Robot>(geometry, motion.posture, motion.qd, tau, p, qdd) == Status::ok &&
               equations_in_task(geometry, motion, terms, task) == Status::ok &&
               inverse_dynamics_derivatives<Layout>(geometry, motion, p, slopes) == Status::ok &&
               kinetic_energy<Layout>(geometry, motion, p) > T(0) &&
               potential_energy<Layout>(geometry, motion.posture, p) < T(1e6);
  const Vector<T, N> sum = terms.M.lazyProduct(motion.qdd) + terms.C.lazyProduct(motion.qd) + terms.g + terms.f;
  const auto keep_larger = [](double value, double& kept) {
    if (!(value <= kept)) kept = value;
  };
  const double scale = largest<T>(tau);
  keep_larger(scale, outcome.largest_torque);
  keep_larger(largest<T>(tau_Y - tau) / scale, outcome.regressor_gap);
  keep_larger(largest<T>(M - M.transpose()), outcome.mass_asymmetry);
  keep_larger(largest<T>(qdd - motion.qdd) / largest<T>(motion.qdd), outcome.acceleration_gap);
  keep_larger(largest<T>(sum - tau) / scale, outcome.equations_gap);
  keep_larger(largest<T>(slopes.by_qdd - M), outcome.slope_gap);
  JointReactions<T, Robot> loads;
  outcome.ok = outcome.ok && joint_reactions<Layout>(geometry, motion, p, loads) == Status::ok;
  // What the first drive's joint carries, and what its motor takes beside that.
  const Vector3<T> axis = motion.posture.limbs[0].R_WL * geometry.limbs[0].axis_L;
  const T carried =
      axis.dot(Robot::kDrive == DriveKind::revolute ? loads.limbs[0].drive.moment : loads.limbs[0].drive.force);
  const T motor =
      friction_torque_of_drive<Layout>(motion, p, 0) + p(Layout::kRotorInertia) * motion.qdd(0) + p(Layout::kOffset);
  keep_larger(largest<T>(Vector<T, 1>(carried + motor - tau(0))) / scale, outcome.reaction_gap);
  keep_larger(largest<T>(tau_task - tau) / scale, outcome.feed_forward_gap);
  keep_larger(largest<T>(tau_drives - tau) / scale, outcome.feed_forward_gap);
}

/// There and back through the log-Cholesky numbers (13) of a made-up body.
template <class T>
void run_inertia(T phase, Outcome& outcome) {
  LogCholeskyVector<T> pi, pi_again;
  for (int i = 0; i < pi.size(); ++i) pi(i) = T(0.05) * T(i) + T(0.01) * phase;
  const InertialVector<T> p = from_log_cholesky(pi);
  outcome.ok = outcome.ok && is_physically_consistent(p) && to_log_cholesky(p, pi_again) == Status::ok;
  outcome.inertia_round_trip = largest<T>(pi_again - pi);
  // The mass is exp(2 alpha), so the first derivative is twice the mass.
  outcome.inertia_jacobian_gap = largest<T>(Vector<T, 1>(log_cholesky_jacobian(pi)(0, 0) / (T(2) * p(0)) - T(1)));
}

template <class T, class Robot>
Outcome run(T phase) {
  constexpr int N = Robot::kDrives;
  using std::cos;
  using std::sin;
  const Geometry<T, Robot> geometry = plausible_geometry<T, Robot>();
  Vector<T, N> z, zd, zdd;
  for (int i = 0; i < N; ++i) {
    const T angle = phase + T(i);
    z(i) = T(0.1) * sin(angle) - (kHasPlate<Robot> && i == 2 ? T(0.8) : T(0));
    zd(i) = T(2) * cos(angle);
    zdd(i) = T(-20) * sin(T(2) * angle);
  }

  Outcome outcome;
  Vector<T, N> q, z_again;
  Motion<T, Robot> motion;
  outcome.ok = inverse_kinematics(geometry, z, q) == Status::ok &&
               forward_kinematics(geometry, q, z_again) == Status::ok &&
               motion_from_task(geometry, z, zd, zdd, motion) == Status::ok;
  if (!outcome.ok) return outcome;
  if constexpr (Robot::kTelescope) z_again(N - 1) = q(N - 1);
  outcome.round_trip = largest<T>(z_again - z);
  run_inertia(phase, outcome);
  run_dynamics<T, Robot, Limbs::shared>(geometry, motion, phase, outcome);
  run_dynamics<T, Robot, Limbs::individual>(geometry, motion, phase, outcome);
  return outcome;
}

template <class T>
Outcome run_robot(int robot, T phase) {
  switch (robot) {
    case 0: return run<T, Delta3>(phase);
    case 1: return run<T, LinearDelta3>(phase);
    case 2: return run<T, Delta4>(phase);
    case 3: return run<T, Axis>(phase);
    case 4: return run<T, LinearAxis>(phase);
    case 5: return run<T, Par4>(phase);
    default: return Outcome();
  }
}

}  // namespace

#define GATE_JOIN_(a, b) a##b
#define GATE_JOIN(a, b) GATE_JOIN_(a, b)
Outcome GATE_JOIN(run_, GATE_SCALAR)(int robot, GATE_SCALAR phase) {
  return run_robot<GATE_SCALAR>(robot, phase);
}

}  // namespace deltadyn::firmware_gate
