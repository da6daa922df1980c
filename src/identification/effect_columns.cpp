#include "deltadyn/identification/effect_columns.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/effects/aerodynamic_drag.hpp"
#include "deltadyn/effects/asymmetric_coulomb.hpp"
#include "deltadyn/effects/asymmetric_viscous.hpp"
#include "deltadyn/effects/backlash.hpp"
#include "deltadyn/effects/base_tilt.hpp"
#include "deltadyn/effects/convex_viscous.hpp"
#include "deltadyn/effects/current_lag.hpp"
#include "deltadyn/effects/directional_efficiency.hpp"
#include "deltadyn/effects/hose_force.hpp"
#include "deltadyn/effects/hysteresis.hpp"
#include "deltadyn/effects/joint_elasticity.hpp"
#include "deltadyn/effects/kinematic_offset.hpp"
#include "deltadyn/effects/limb_inertia_mismatch.hpp"
#include "deltadyn/effects/load_dependent_friction.hpp"
#include "deltadyn/effects/payload.hpp"
#include "deltadyn/effects/position_dependent_friction.hpp"
#include "deltadyn/effects/presliding.hpp"
#include "deltadyn/effects/rotor_inertia.hpp"
#include "deltadyn/effects/saturation.hpp"
#include "deltadyn/effects/shear_thinning.hpp"
#include "deltadyn/effects/stribeck.hpp"
#include "deltadyn/effects/telescope_side_load.hpp"
#include "deltadyn/effects/telescope_stribeck.hpp"
#include "deltadyn/effects/thermal_drift.hpp"
#include "deltadyn/effects/torque_constant_error.hpp"
#include "deltadyn/effects/torque_ripple.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/in_parallel.hpp"
#include "deltadyn/signal/differentiate.hpp"

namespace deltadyn {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLag = 1e-4;   // [rad | m], as small
constexpr double kTilt = 1e-3;  // [rad], small beside any gravity direction, large beside rounding

[[noreturn]] void refuse(const PreparedLog& log, Index sample, Status status) {
  throw Error(fmt::format("{} at t_s = {:.6g}", message(status), log.t_s(sample)), log.file,
              "check that the robot file belongs to this machine, and zero, sign and unit of the drive positions");
}

/// A drive's column from a function of the sample.
template <class Function>
std::vector<EffectColumn> one(int drive, Index samples, const Function& value) {
  EffectColumn column{drive, MatrixXd(samples, 1)};
  for (Index k = 0; k < samples; ++k) column.values(k, 0) = value(k);
  return {std::move(column)};
}

template <class Function>
std::vector<EffectColumn> pair_of(int drive, Index samples, const Function& value) {
  std::vector<EffectColumn> columns(2, EffectColumn{drive, MatrixXd(samples, 1)});
  for (Index k = 0; k < samples; ++k) {
    const auto both = value(k);
    columns[0].values(k, 0) = both.cosine;
    columns[1].values(k, 0) = both.sine;
  }
  return columns;
}

/// Drive torques of a force on the plate: J^T f at every sample.
template <class Function>
EffectColumn on_plate(const EffectSignals& s, const Function& force) {
  const Index n = s.q.cols();
  EffectColumn column{-1, MatrixXd(s.q.rows(), n)};
  for (Index k = 0; k < s.q.rows(); ++k) {
    const Eigen::Vector3d f = force(k);
    for (Index j = 0; j < n; ++j) column.values(k, j) = s.J.row(k).segment<3>(3 * j).dot(f);
  }
  return column;
}

template <class Function>
EffectColumn on_bar(const EffectSignals& s, const Function& force) {
  EffectColumn column{-1, MatrixXd(s.q.rows(), s.q.cols())};
  for (Index k = 0; k < s.q.rows(); ++k) column.values.row(k) = force(k) * s.J_bar.row(k);
  return column;
}

/// (what a changed torque is) - torque, per unit of the change: for the effects whose shape is their amplitude.
template <class Function>
std::vector<EffectColumn> changed_torque(const EffectSignals& s, int joint, double amount, const Function& change) {
  const Index first = joint >= 0 ? joint : 0;
  const Index count = joint >= 0 ? 1 : s.torque.cols();
  EffectColumn column{joint, MatrixXd(s.torque.rows(), count)};
  for (Index j = 0; j < count; ++j) {
    const VectorXd torque = s.torque.col(first + j);
    column.values.col(j) = (change(torque) - torque) / amount;
  }
  return {std::move(column)};
}

/// Inertia of each drive with the others held, in the middle of the workspace.
VectorXd drive_inertia(const Robot& robot, const VectorXd& p) {
  const Index n = robot.drives();
  VectorXd q = VectorXd::Zero(n);
  for (Index j = 0; j < n; ++j) {
    const DriveLimits& limits = robot.description().limits[static_cast<std::size_t>(j)];
    if (std::isfinite(limits.lower + limits.upper)) q(j) = 0.5 * (limits.lower + limits.upper);
  }
  MatrixXd M(n, n);
  if (robot.mass_matrix(q, p, M) != Status::ok && robot.mass_matrix(VectorXd::Zero(n), p, M) != Status::ok)
    return VectorXd::Ones(n);
  return M.diagonal().cwiseMax(1e-12);
}

EffectColumn elastic(const EffectSignals& s, int joint, const VectorXd& shape) {
  const Index n = s.q.cols(), N = s.q.rows();
  const double motor = shape(1) * s.inertia(joint);
  const VectorXd torque_dd = s.load_dd.col(joint) - motor * s.snap.col(joint);
  if (static_cast<ElasticEncoder>(std::lround(shape(0))) == ElasticEncoder::arm)
    return {joint, torque_dd.unaryExpr([](double x) { return joint_elasticity(x); })};
  const auto drive = static_cast<std::size_t>(joint);
  EffectColumn column{-1, MatrixXd(N, n)};
  for (Index k = 0; k < N; ++k) {
    for (Index i = 0; i < n; ++i) {
      const double along_lag = s.load_lag[drive](k, i) - shape(1) * s.inertia_lag[drive](k, i);
      column.values(k, i) = joint_elasticity(along_lag, i == joint ? motor * torque_dd(k) : 0.0, s.inertia(joint) - motor);
    }
  }
  return column;
}

VectorXd delayed(const VectorXd& x, double samples) {
  VectorXd out(x.size());
  for (Index k = 0; k < x.size(); ++k) {
    const double at = std::clamp(static_cast<double>(k) - samples, 0.0, static_cast<double>(x.size() - 1));
    const Index low = std::min(static_cast<Index>(at), x.size() - 2);
    const double share = at - static_cast<double>(low);
    out(k) = (1 - share) * x(low) + share * x(low + 1);
  }
  return out;
}

VectorXd lagged(const VectorXd& x, double time_constant, double dt) {
  VectorXd out(x.size());
  // A torque that is linear between the samples: the input's mean over the step.
  CurrentLag<double> lag(time_constant, x(0));
  out(0) = x(0);
  for (Index k = 1; k < x.size(); ++k) out(k) = lag.step(0.5 * (x(k) + x(k - 1)), dt);
  return out;
}

std::vector<EffectColumn> with_memory(const EffectSignals& s, EffectId id, int joint, const VectorXd& shape) {
  const auto q = s.q.col(joint);
  const auto v = s.qd.col(joint);
  const Index samples = q.size();
  if (id == EffectId::presliding) {
    Presliding<double> state(shape(0), coulomb_friction(v(0)));
    const double damping = shape.size() > 1 ? shape(1) : 0.0;
    return one(joint, samples, [&](Index k) {
      const double bristle = state.move(k > 0 ? q(k) - q(k - 1) : 0.0);
      return damped_presliding(v(k), bristle, shape(0), damping) - coulomb_friction(v(k));
    });
  }
  if (id == EffectId::hysteresis) {
    Hysteresis<double> state({shape(0), shape(1)}, coulomb_friction(v(0)));
    return one(joint, samples, [&](Index k) { return state.move(k > 0 ? q(k) - q(k - 1) : 0.0); });
  }
  Backlash<double> play(shape(0));
  return one(joint, samples,
             [&](Index k) { return backlash(play.move(k > 0 ? q(k) - q(k - 1) : 0.0, s.load(k, joint)), s.load(k, joint)); });
}

}  // namespace

EffectModel::EffectModel(const Robot& robot) : robot_(robot), states_(make_effect_states(robot.description())) {
  for (std::size_t k = 0; k < robot.parameter_names().size(); ++k) {
    const std::string& name = robot.parameter_names()[k];
    if (name.rfind("drive", 0) == 0) own_friction_.push_back(static_cast<int>(k));
    if (name.find(".viscous") != std::string::npos || name.find(".coulomb") != std::string::npos)
      friction_.push_back(static_cast<int>(k));
  }
  const RobotDescription& description = robot.description();
  if (description.parts.empty()) return;
  for (int axis = 0; axis < 2; ++axis) {
    RobotDescription tilted = description;
    tilted.gravity = tilted_gravity(description.gravity, axis == 0 ? kTilt : 0.0, axis == 1 ? kTilt : 0.0);
    tilted_[axis] = make_robot(tilted, robot.parameter_options());
  }
  for (const KinematicOffset kind : {KinematicOffset::arm, KinematicOffset::strut}) {
    for (std::size_t limb = 0; limb < description.limbs.size(); ++limb) {
      for (const double sign : {1.0, -1.0}) {
        RobotDescription longer = description;
        LimbGeometry<double>& geometry = longer.limbs[limb];
        const double step = sign * kinematic_step<double>();
        if (kind == KinematicOffset::strut) {
          geometry.strut += step;
        } else if (description.drive_kind == DriveKind::revolute) {
          geometry.p_DE_0.x() += step;
        } else {
          geometry.p_DE_0 += step * geometry.axis_L;
        }
        longer_.push_back(make_robot(longer, robot.parameter_options()));
      }
    }
  }
}

EffectModel::~EffectModel() = default;

EffectSignals EffectModel::signals(const PreparedLog& log, const VectorXd& p, bool with_errors, const EffectSignals* near) const {
  const Index N = log.t_s.size();
  const Index n = robot_.drives();
  EffectSignals out;
  out.t_s = log.t_s;
  out.q = log.q;
  out.qd = log.qd;
  out.qdd = log.qdd;
  out.sample_time_s = 1.0 / log.rate_hz;
  for (MatrixXd* m : {&out.torque, &out.load, &out.J_bar, &out.passive}) m->resize(N, n);
  for (MatrixXd* m : {&out.position, &out.velocity, &out.acceleration, &out.bar}) m->resize(N, 3);
  out.J.resize(N, 3 * n);
  out.bar_rate.resize(N);
  VectorXd whole = p, without = p;
  const std::vector<Index> coulomb = log.coulomb_share.size() > 0 ? coulomb_columns(robot_) : std::vector<Index>{};
  EffectState state;
  VectorXd tau(n);
  for (Index k = 0; k < N; ++k) {
    const VectorXd q = log.q.row(k), qd = log.qd.row(k), qdd = log.qdd.row(k);
    for (std::size_t joint = 0; joint < coulomb.size(); ++joint)
      whole(coulomb[joint]) = log.coulomb_share(k, static_cast<Index>(joint)) * p(coulomb[joint]);
    without = whole;
    for (const int column : own_friction_) without(column) = 0;
    if (const Status status = states_->at(q, qd, qdd, state); status != Status::ok) refuse(log, k, status);
    if (const Status status = robot_.inverse_dynamics(q, qd, qdd, whole, tau); status != Status::ok) refuse(log, k, status);
    out.torque.row(k) = tau.transpose();
    if (const Status status = robot_.inverse_dynamics(q, qd, qdd, without, tau); status != Status::ok) refuse(log, k, status);
    out.load.row(k) = tau.transpose();
    out.position.row(k) = state.position.transpose();
    out.velocity.row(k) = state.velocity.transpose();
    out.acceleration.row(k) = state.acceleration.transpose();
    out.bar.row(k) = state.bar.transpose();
    for (Index j = 0; j < n; ++j) out.J.row(k).segment<3>(3 * j) = state.J.col(j).transpose();
    out.bar_rate(k) = state.bar_rate;
    out.J_bar.row(k) = state.J_bar;
    out.passive.row(k) = state.passive.transpose();
  }
  add_lags(p, near, out);
  if (with_errors && !robot_.description().parts.empty()) add_errors(log, p, out);
  return out;
}

void EffectModel::add_lags(const VectorXd& p, const EffectSignals* near, EffectSignals& out) const {
  const Index N = out.q.rows(), n = out.q.cols();
  const double dt = out.sample_time_s;
  out.load_dd = differentiate(out.load, dt, 2, 3);
  out.snap = differentiate(out.qdd, dt, 2, 3);
  if (near != nullptr) {
    // Noise matters in the fourth derivative of the positions, which the mass matrix carries into the torques.
    out.inertia = near->inertia;
    out.load_lag = near->load_lag;
    out.inertia_lag = near->inertia_lag;
    for (Index j = 0; j < n; ++j) {
      const auto drive = static_cast<std::size_t>(j);
      const auto M_j = near->coupling.middleCols(n * j, n).array();
      out.load_lag[drive].array() += M_j.colwise() * (out.load_dd - near->load_dd).col(j).array();
      out.inertia_lag[drive].array() += M_j.colwise() * (out.inertia(j) * (out.snap - near->snap).col(j).array());
    }
    return;
  }
  out.inertia = drive_inertia(robot_, p);
  out.coupling.setZero(N, n * n);
  const MatrixXd load_d = differentiate(out.load, dt, 1, 3), jerk = differentiate(out.qdd, dt, 1, 3);
  // Steps that turn no joint by more than a tenth of a milliradian.
  const auto step_of = [](const VectorXd& lag) { return kLag / std::max(lag.cwiseAbs().maxCoeff(), 1e-300); };
  VectorXd load_step(n), inertia_step(n);
  for (Index j = 0; j < n; ++j) {
    load_step(j) = step_of(out.load.col(j));
    inertia_step(j) = step_of(out.inertia(j) * out.qdd.col(j));
  }
  VectorXd smooth = p;
  for (const int k : friction_) smooth(k) = 0;
  out.load_lag.assign(static_cast<std::size_t>(n), MatrixXd::Zero(N, n));
  out.inertia_lag = out.load_lag;
  in_parallel(N, [&](Index k) {
    VectorXd q = out.q.row(k), qd = out.qd.row(k), qdd = out.qdd.row(k), at(n), lagged(n);
    MatrixXd M(n, n);
    if (robot_.inverse_dynamics(q, qd, qdd, smooth, at) != Status::ok || robot_.mass_matrix(q, p, M) != Status::ok) return;
    for (Index j = 0; j < n; ++j) out.coupling.row(k).segment(n * j, n) = M.col(j).transpose();
    const auto along = [&](Index j, double step, double lag, double lag_d, double lag_dd, MatrixXd& to) {
      const double q_j = q(j), qd_j = qd(j), qdd_j = qdd(j);
      q(j) += step * lag;
      qd(j) += step * lag_d;
      qdd(j) += step * lag_dd;
      if (robot_.inverse_dynamics(q, qd, qdd, smooth, lagged) == Status::ok) to.row(k) = (lagged - at).transpose() / step;
      q(j) = q_j;
      qd(j) = qd_j;
      qdd(j) = qdd_j;
    };
    for (Index j = 0; j < n; ++j) {
      const auto drive = static_cast<std::size_t>(j);
      const double J = out.inertia(j);
      along(j, load_step(j), out.load(k, j), load_d(k, j), out.load_dd(k, j), out.load_lag[drive]);
      along(j, inertia_step(j), J * out.qdd(k, j), J * jerk(k, j), J * out.snap(k, j), out.inertia_lag[drive]);
    }
  });
}

void EffectModel::add_errors(const PreparedLog& log, const VectorXd& p, EffectSignals& out) const {
  const Index N = log.t_s.size();
  const Index n = robot_.drives();
  const auto limbs = static_cast<Index>(robot_.description().limbs.size());
  const double step = kinematic_step<double>();
  out.tilt_x.resize(N, n);
  out.tilt_y.resize(N, n);
  out.kinematic.assign(static_cast<std::size_t>(3 * limbs), MatrixXd(N, n));
  in_parallel(N, [&](Index k) {
    const VectorXd q = log.q.row(k), qd = log.qd.row(k), qdd = log.qdd.row(k);
    VectorXd plus(n), minus(n), shifted = q;
    const auto torque = [&](const Robot& robot, const VectorXd& at, VectorXd& tau) {
      // Right at the edge of the reach a changed length may not close: then the column says nothing there.
      if (robot.inverse_dynamics(at, qd, qdd, p, tau) != Status::ok) tau = out.torque.row(k);
    };
    for (int axis = 0; axis < 2; ++axis) {
      torque(*tilted_[axis], q, plus);
      (axis == 0 ? out.tilt_x : out.tilt_y).row(k) = (plus - out.torque.row(k).transpose()).transpose() / kTilt;
    }
    for (Index limb = 0; limb < limbs; ++limb) {
      shifted = q;
      shifted(limb) = q(limb) + step;
      torque(robot_, shifted, plus);
      shifted(limb) = q(limb) - step;
      torque(robot_, shifted, minus);
      out.kinematic[static_cast<std::size_t>(limb)].row(k) = kinematic_offset<Eigen::ArrayXd>(plus, minus, step).transpose();
    }
    for (Index kind = 1; kind < 3; ++kind) {
      for (Index limb = 0; limb < limbs; ++limb) {
        const auto at = static_cast<std::size_t>(2 * (limbs * (kind - 1) + limb));
        torque(*longer_[at], q, plus);
        torque(*longer_[at + 1], q, minus);
        out.kinematic[static_cast<std::size_t>(limbs * kind + limb)].row(k) =
            kinematic_offset<Eigen::ArrayXd>(plus, minus, step).transpose();
      }
    }
  });
}

std::vector<EffectColumn> EffectModel::columns(const EffectSignals& s, EffectId id, int joint, const VectorXd& shape,
                                               int log_number) const {
  const Index N = s.q.rows();
  const Index j = std::max(joint, 0);
  const auto v = [&s, j](Index k) { return s.qd(k, j); };
  const Eigen::Vector3d gravity = robot_.description().gravity;
  const auto axes = [&](const auto& force) {
    std::vector<EffectColumn> columns;
    for (int axis = 0; axis < 3; ++axis) columns.push_back(on_plate(s, [&](Index k) { return force(k, axis); }));
    return columns;
  };
  switch (id) {
    case EffectId::stribeck: return one(joint, N, [&](Index k) { return stribeck<double>(v(k), {shape(0), shape(1)}); });
    case EffectId::shear_thinning: {
      const ShearLaw law = shape(1) > 0 ? ShearLaw::power : ShearLaw::exponential;
      return one(joint, N, [&](Index k) { return shear_thinning<double>(v(k), {shape(0), shape(1)}, law); });
    }
    case EffectId::convex_viscous: return one(joint, N, [&](Index k) { return convex_viscous(v(k), shape(0)); });
    case EffectId::asymmetric_coulomb: return one(joint, N, [](Index) { return asymmetric_coulomb<double>(); });
    case EffectId::asymmetric_viscous: return one(joint, N, [&](Index k) { return asymmetric_viscous(v(k)); });
    case EffectId::load_dependent_friction:
      return one(joint, N, [&](Index k) { return load_dependent_friction(v(k), s.load(k, j)); });
    case EffectId::directional_efficiency: {
      std::vector<EffectColumn> columns;
      for (const auto side : {EfficiencyColumn::driving, EfficiencyColumn::back_driving}) {
        columns.push_back(one(joint, N, [&](Index k) { return directional_efficiency(v(k), s.load(k, j), side); }).front());
      }
      return columns;
    }
    case EffectId::presliding:
    case EffectId::hysteresis:
    case EffectId::backlash: return with_memory(s, id, joint, shape);
    case EffectId::torque_ripple: return pair_of(joint, N, [&](Index k) { return torque_ripple(s.q(k, j), shape(0)); });
    case EffectId::position_dependent_friction:
      return pair_of(joint, N, [&](Index k) { return position_dependent_friction(s.q(k, j), v(k), shape(0)); });
    case EffectId::joint_elasticity: return {elastic(s, joint, shape)};
    case EffectId::rotor_inertia: return one(joint, N, [&](Index k) { return rotor_inertia(s.qdd(k, j)); });
    case EffectId::limb_inertia_mismatch: {
      std::vector<EffectColumn> columns =
          one(joint, N, [&](Index k) { return limb_inertia_mismatch(s.q(k, j), s.qdd(k, j), -gravity.z()).moment; });
      columns.push_back(one(joint, N, [&](Index k) { return s.qdd(k, j); }).front());
      return columns;
    }
    case EffectId::base_tilt: return {EffectColumn{-1, s.tilt_x}, EffectColumn{-1, s.tilt_y}};
    case EffectId::payload: {
      const bool here = static_cast<int>(std::lround(shape(0))) == log_number;
      return {on_plate(s, [&](Index k) -> Eigen::Vector3d {
        return here ? payload_force<double>(s.acceleration.row(k).transpose(), gravity) : Eigen::Vector3d::Zero();
      })};
    }
    case EffectId::torque_constant_error: return one(joint, N, [&](Index k) { return torque_constant_error(s.torque(k, j)); });
    case EffectId::time_skew:
      return changed_torque(s, joint, shape(0), [&](const VectorXd& tau) { return delayed(tau, shape(0) / s.sample_time_s); });
    case EffectId::current_lag:
      if (shape(1) > 0) {  // the command before the lag was recorded
        return changed_torque(s, joint, shape(0), [&](const VectorXd& tau) -> VectorXd {
          const VectorXd rate = differentiate(tau, s.sample_time_s, 1, 3);
          return tau + shape(0) * rate.unaryExpr([](double x) { return current_lead(x); });
        });
      }
      return changed_torque(s, joint, shape(0), [&](const VectorXd& tau) { return lagged(tau, shape(0), s.sample_time_s); });
    case EffectId::saturation: return one(joint, N, [&](Index k) { return saturation(s.torque(k, j), shape(0)); });
    case EffectId::thermal_drift:
      return one(joint, N, [&](Index k) { return thermal_drift(v(k), s.t_s(k) - s.t_s(0), shape(0)); });
    case EffectId::passive_joint_friction: return {EffectColumn{-1, s.passive}};
    case EffectId::aerodynamic_drag:
      return {on_plate(s, [&](Index k) { return aerodynamic_drag<double>(s.velocity.row(k).transpose()); })};
    case EffectId::telescope_stribeck:
      return {on_bar(s, [&](Index k) { return telescope_stribeck<double>(s.bar_rate(k), {shape(0), shape(1)}); })};
    case EffectId::telescope_side_load:
      return {on_bar(s, [&](Index k) {
        return telescope_side_load<double>(s.bar_rate(k), s.bar.row(k).transpose(), s.acceleration.row(k).transpose(), gravity);
      })};
    case EffectId::hose_force: {
      std::vector<EffectColumn> columns = axes([](Index, int axis) -> Eigen::Vector3d { return Eigen::Vector3d::Unit(axis); });
      // Against the origin of the base: the fit finds the point without force by f0.
      for (EffectColumn& column : axes([&s](Index k, int axis) -> Eigen::Vector3d {
             const Eigen::Vector3d stretch = hose_stretch<double>(s.position.row(k).transpose(), Eigen::Vector3d::Zero());
             return stretch(axis) * Eigen::Vector3d::Unit(axis);
           })) {
        columns.push_back(std::move(column));
      }
      return columns;
    }
    case EffectId::kinematic_offset: {
      const auto limbs = static_cast<Index>(robot_.description().limbs.size());
      const auto kind = static_cast<Index>(std::lround(shape(0)));
      return {EffectColumn{-1, s.kinematic[static_cast<std::size_t>(limbs * kind + j)]}};
    }
  }
  return {};
}

MatrixXd low_passed_rows(const PreparedLog& log, const Eigen::Ref<const MatrixXd>& values) {
  MatrixXd rows(log.rows, values.cols());
  if (log.low_pass) {
    const Index reach = log.low_pass->half_width();
    const Index first = log.first - reach;
    const Index needed = (log.rows - 1) * log.stride + 2 * reach + 1;
    log.low_pass->apply(values.middleRows(first, needed), 0, log.rows, rows);
  } else {
    for (Index k = 0; k < log.rows; ++k) rows.row(k) = values.row(sample_of_row(log, k));
  }
  return rows;
}

std::vector<MatrixXd> effect_rows(const EffectModel& model, const PreparedLog& log, const VectorXd& p,
                                  const std::vector<Effect>& effects, int log_number) {
  const Index n = model.robot().drives();
  std::vector<MatrixXd> out(static_cast<std::size_t>(n), MatrixXd::Zero(log.rows, amplitude_count(effects)));
  if (effects.empty()) return out;
  const bool errors = std::any_of(effects.begin(), effects.end(), [](const Effect& e) {
    return e.id == EffectId::base_tilt || e.id == EffectId::kinematic_offset;
  });
  const EffectSignals signals = model.signals(log, p, errors);
  Index at = 0;
  for (const Effect& effect : effects) {
    for (const EffectColumn& column : model.columns(signals, effect.id, effect.joint, effect.shape, log_number)) {
      const MatrixXd rows = low_passed_rows(log, column.values);
      for (Index j = 0; j < n; ++j) {
        if (column.drive < 0 || column.drive == j) out[static_cast<std::size_t>(j)].col(at) = rows.col(column.drive < 0 ? j : 0);
      }
      ++at;
    }
  }
  return out;
}

Index amplitude_count(const std::vector<Effect>& effects) {
  std::size_t count = 0;
  for (const Effect& effect : effects) count += effect_kind(effect.id).amplitudes.size();
  return static_cast<Index>(count);
}

VectorXd amplitudes_of(const std::vector<Effect>& effects) {
  VectorXd all(amplitude_count(effects));
  Index at = 0;
  for (const Effect& effect : effects) {
    all.segment(at, effect.amplitude.size()) = effect.amplitude;
    at += effect.amplitude.size();
  }
  return all;
}

void set_amplitudes(const VectorXd& amplitudes, const VectorXd& std, std::vector<Effect>& effects) {
  Index at = 0;
  for (Effect& effect : effects) {
    const auto count = static_cast<Index>(effect_kind(effect.id).amplitudes.size());
    effect.amplitude = amplitudes.segment(at, count);
    effect.amplitude_std = std.segment(at, count);
    at += count;
  }
}

}  // namespace deltadyn
