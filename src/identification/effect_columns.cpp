#include "deltadyn/identification/effect_columns.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/core/sign.hpp"
#include "deltadyn/effects/side_load.hpp"
#include "deltadyn/runtime/changed_machine.hpp"
#include "deltadyn/runtime/drive_inertia.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/in_parallel.hpp"
#include "deltadyn/signal/differentiate.hpp"

namespace deltadyn {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLag = 1e-4;  // [rad | m], as small

[[noreturn]] void refuse(const PreparedLog& log, Index sample, Status status) {
  throw Error(fmt::format("{} at t_s = {:.6g}", message(status), log.t_s(sample)), log.file,
              "check that the robot file belongs to this machine, and zero, sign and unit of the drive positions");
}

/// Places for the columns of one effect.
std::vector<EffectColumn> empty_columns(std::size_t count, int drive, Index samples, Index drives) {
  return std::vector<EffectColumn>(count, EffectColumn{drive, MatrixXd::Zero(samples, drives)});
}

/// What a law of any joint sees at one sample.
JointInput<double> input_at_rate(const EffectSignals& s, double rate, Index k) {
  JointInput<double> in;
  in.rate = rate;
  in.sign = sign_of(rate);
  in.time = s.t_s(k) - s.t_s(0);
  return in;
}

JointInput<double> input_of_drive(const EffectSignals& s, const MatrixXd& gravity, Index j, Index k) {
  JointInput<double> in = input_at_rate(s, s.qd(k, j), k);
  in.position = s.q(k, j);
  in.acceleration = s.qdd(k, j);
  in.load = s.load(k, j);
  in.gravity_x = gravity(0, j);
  in.gravity_z = gravity(1, j);
  return in;
}

JointInput<double> input_of_bar(const EffectSignals& s, const Eigen::Vector3d& gravity, Index k) {
  JointInput<double> in = input_at_rate(s, s.inner_rate(k), k);
  in.side_load = side_load<double>(s.bar.row(k).transpose(), s.acceleration.row(k).transpose(), gravity);
  return in;
}

/// Columns of a law of a drive, with or without memory, from what it sees at each sample.
template <class E, class Input>
std::vector<EffectColumn> columns_of_law(int drive, const Shape<double>& shape, Index samples, const Input& input) {
  std::vector<EffectColumn> out = empty_columns(kAmplitudesOf<E>, drive, samples, 1);
  double state = 0, before = 0;
  for (Index k = 0; k < samples; ++k) {
    const JointInput<double> in = input(k);
    ColumnsOf<double, E> values;
    if constexpr (kIs<E, JointMemory>) {
      state = k == 0 ? E::start(in.sign, shape) : E::moved(state, in.position - before, in, shape);
      before = in.position;
      values = E::columns(state, in, shape);
    } else {
      values = E::columns(in, shape);
    }
    for (std::size_t c = 0; c < values.size(); ++c) out[c].values(k, 0) = values[c];
  }
  return out;
}

/// A law of a joint that the drives move through a row of its Jacobian.
void spread(const std::vector<EffectColumn>& law, const auto& J, std::vector<EffectColumn>& out) {
  for (std::size_t c = 0; c < law.size(); ++c) {
    for (Index k = 0; k < out[c].values.rows(); ++k) out[c].values.row(k) += law[c].values(k, 0) * J(k);
  }
}

template <class E>
std::vector<EffectColumn> columns_on_plate(const EffectSignals& s, const Shape<double>& shape,
                                           const Eigen::Vector3d& gravity) {
  const Index n = s.q.cols();
  std::vector<EffectColumn> out = empty_columns(kAmplitudesOf<E>, -1, s.q.rows(), n);
  PlateInput<double> in;
  in.gravity = gravity;
  for (Index k = 0; k < s.q.rows(); ++k) {
    in.position = s.position.row(k);
    in.velocity = s.velocity.row(k);
    in.acceleration = s.acceleration.row(k);
    const auto forces = E::columns(in, shape);
    for (std::size_t c = 0; c < forces.size(); ++c) {
      for (Index j = 0; j < n; ++j) out[c].values(k, j) = s.J.row(k).segment<3>(3 * j).dot(forces[c]);
    }
  }
  return out;
}

/// (what is recorded of the torque) - torque, per unit of the change.
template <class E>
std::vector<EffectColumn> columns_of_record(const EffectSignals& s, int joint, const Shape<double>& shape) {
  const double amount = E::traits().tied ? shape[0] : 1.0;
  const Index first = joint >= 0 ? joint : 0, count = joint >= 0 ? 1 : s.torque.cols();
  std::vector<EffectColumn> out = empty_columns(1, joint, s.torque.rows(), count);
  for (Index j = 0; j < count; ++j) {
    const VectorXd torque = s.torque.col(first + j);
    if constexpr (requires { E::expected(torque, s.sample_time_s, amount, shape); }) {
      out[0].values.col(j) = (E::expected(torque, s.sample_time_s, amount, shape) - torque) / amount;
    } else {
      out[0].values.col(j) = (E::record(torque, s.sample_time_s, amount, shape) - torque) / amount;
    }
  }
  return out;
}

template <class E>
std::vector<EffectColumn> columns_of_spring(const EffectSignals& s, int joint, const Shape<double>& shape) {
  const Index n = s.q.cols();
  const auto drive = static_cast<std::size_t>(joint);
  std::vector<EffectColumn> out = empty_columns(1, -1, s.q.rows(), n);
  for (Index k = 0; k < s.q.rows(); ++k) {
    for (Index i = 0; i < n; ++i) {
      ElasticInput<double> in;
      in.load_dd = s.load_dd(k, joint);
      in.snap = s.snap(k, joint);
      in.inertia = s.inertia(joint);
      in.load_lag = s.load_lag[drive](k, i);
      in.inertia_lag = s.inertia_lag[drive](k, i);
      in.own = i == joint;
      out[0].values(k, i) = E::column(in, shape);
    }
  }
  const MatrixXd& all = out[0].values;
  if (all.col(joint).cwiseAbs().sum() == all.cwiseAbs().sum()) return {EffectColumn{joint, all.col(joint)}};
  return out;
}

/// Gravity outwards and upwards in the frame of the limb that each drive moves; 0 for drives without one.
MatrixXd gravity_of_limbs(const RobotDescription& robot) {
  MatrixXd gravity = MatrixXd::Zero(2, robot.drives());
  for (std::size_t i = 0; i < robot.limbs.size() && static_cast<int>(i) < robot.drives(); ++i) {
    const Eigen::Matrix3d R_WL = limb_frame(robot.limbs[i]);
    gravity.col(static_cast<Index>(i)) << R_WL.col(0).dot(robot.gravity), R_WL.col(2).dot(robot.gravity);
  }
  return gravity;
}

/// All combinations of the start values of an effect's shapes: machines change by choices only.
std::vector<Shape<double>> choices_of(const EffectTraits& traits) {
  std::vector<Shape<double>> all(1, Shape<double>{});
  for (std::size_t k = 0; k < traits.shapes.size(); ++k) {
    std::vector<Shape<double>> next;
    for (Shape<double> one : all) {
      for (const double value : start_values(traits.shapes[k])) {
        one[k] = value;
        next.push_back(one);
      }
    }
    all = next;
  }
  return all;
}

template <class E>
void add_differences_of(const Robot& robot, std::vector<MachineDifference>& all) {
  constexpr EffectTraits traits = E::traits();
  const auto changed = [&](int joint, const Shape<double>& shape, std::size_t amplitude, double by) {
    ChangedMachine machine(robot.description());
    std::array<double, kMostAmplitudes> amplitudes{};
    amplitudes[amplitude] = by;
    E::change(machine, joint, amplitudes, shape);
    return MachineDifference::Side{make_robot(machine.description, robot.parameter_options()), machine.home_offset};
  };
  for (const int joint : effect_joints(effect_id<E>, robot.description())) {
    for (const Shape<double>& shape : choices_of(traits)) {
      for (std::size_t a = 0; a < traits.amplitudes.size(); ++a) {
        all.push_back({effect_id<E>, joint, shape, a, E::kStep, changed(joint, shape, a, E::kStep),
                       changed(joint, shape, a, -E::kStep)});
      }
    }
  }
}

template <class... Effects>
std::vector<MachineDifference> differences_of(EffectList<Effects...>, const Robot& robot) {
  std::vector<MachineDifference> all;
  const auto add = [&](auto effect) {
    using E = decltype(effect);
    if constexpr (kIs<E, MachineChange>) add_differences_of<E>(robot, all);
  };
  (add(Effects()), ...);
  return all;
}

std::vector<EffectColumn> columns_of_changes(const EffectSignals& s, const std::vector<MachineDifference>& differences,
                                             EffectId id, int joint, const Shape<double>& shape) {
  std::vector<EffectColumn> out;
  for (std::size_t d = 0; d < differences.size(); ++d) {
    const MachineDifference& one = differences[d];
    if (one.id == id && one.joint == joint && one.shape == shape) out.push_back({-1, s.changed.at(d)});
  }
  return out;
}

template <class E>
std::vector<EffectColumn> columns_of_joint_law(const EffectSignals& s, const RobotDescription& robot, int joint,
                                               const Shape<double>& shape) {
  const Index N = s.q.rows(), n = s.q.cols();
  const MatrixXd of_limbs = gravity_of_limbs(robot);
  if (joint >= 0)
    return columns_of_law<E>(joint, shape, N, [&](Index k) { return input_of_drive(s, of_limbs, joint, k); });
  std::vector<EffectColumn> out = empty_columns(kAmplitudesOf<E>, -1, N, n);
  for (Index j = 0; j < n; ++j) {
    if (!acts_on_all(effect_id<E>, static_cast<int>(j), robot)) continue;
    const auto one = columns_of_law<E>(0, shape, N, [&](Index k) { return input_of_drive(s, of_limbs, j, k); });
    for (std::size_t c = 0; c < one.size(); ++c) out[c].values.col(j) = one[c].values;
  }
  if constexpr (E::traits().place == EffectPlace::telescope) {
    spread(
        columns_of_law<E>(0, shape, N, [&](Index k) { return input_of_bar(s, robot.gravity, k); }),
        [&](Index k) { return s.J_inner.row(k); }, out);
  } else if constexpr (E::traits().place == EffectPlace::passive_joints) {
    for (Index m = 0; m < s.passive_rate.cols(); ++m) {
      spread(
          columns_of_law<E>(0, shape, N, [&](Index k) { return input_at_rate(s, s.passive_rate(k, m), k); }),
          [&](Index k) { return s.J_passive.row(k).segment(m * n, n); }, out);
    }
  }
  return out;
}

}  // namespace

EffectModel::EffectModel(const Robot& robot) : robot_(robot), states_(make_effect_states(robot.description())) {
  for (int k = 0; k < robot.parameters(); ++k) {
    const ParameterId& id = robot.parameter_ids()[static_cast<std::size_t>(k)];
    if (id.kind != ParameterKind::inertial && id.number > 0) own_friction_.push_back(k);
    if (id.is_friction()) friction_.push_back(k);
  }
  differences_ = differences_of(AllEffects(), robot);
}

EffectModel::~EffectModel() = default;

EffectSignals EffectModel::signals(const PreparedLog& log, const VectorXd& p, bool with_differences,
                                   const EffectSignals* near) const {
  const Index N = log.t_s.size();
  const Index n = robot_.drives();
  EffectSignals out;
  out.t_s = log.t_s;
  out.q = log.q;
  out.qd = log.qd;
  out.qdd = log.qdd;
  out.sample_time_s = 1.0 / log.rate_hz;
  for (MatrixXd* m : {&out.torque, &out.load, &out.J_inner}) m->resize(N, n);
  for (MatrixXd* m : {&out.position, &out.velocity, &out.acceleration, &out.bar}) m->resize(N, 3);
  out.J.resize(N, 3 * n);
  out.inner_rate.resize(N);
  VectorXd whole = p, without = p;
  const std::vector<Index> coulomb = log.coulomb_share.size() > 0 ? coulomb_columns(robot_) : std::vector<Index>{};
  EffectState state;
  PathPose path;
  VectorXd tau(n);
  for (Index k = 0; k < N; ++k) {
    const VectorXd q = log.q.row(k), qd = log.qd.row(k), qdd = log.qdd.row(k);
    for (std::size_t joint = 0; joint < coulomb.size(); ++joint)
      whole(coulomb[joint]) = log.coulomb_share(k, static_cast<Index>(joint)) * p(coulomb[joint]);
    without = whole;
    for (const int column : own_friction_) without(column) = 0;
    if (const Status status = states_->at(q, qd, qdd, state, &path); status != Status::ok) refuse(log, k, status);
    for (const auto& [parameters, torque] : {std::pair(&whole, &out.torque), {&without, &out.load}}) {
      if (const Status status = robot_.inverse_dynamics(q, qd, qdd, *parameters, tau, &path); status != Status::ok)
        refuse(log, k, status);
      torque->row(k) = tau.transpose();
    }
    out.position.row(k) = state.position.transpose();
    out.velocity.row(k) = state.velocity.transpose();
    out.acceleration.row(k) = state.acceleration.transpose();
    out.bar.row(k) = state.bar.transpose();
    for (Index j = 0; j < n; ++j) out.J.row(k).segment<3>(3 * j) = state.J.col(j).transpose();
    out.inner_rate(k) = state.inner_rate;
    out.J_inner.row(k) = state.J_inner;
    if (k == 0) {
      out.passive_rate.resize(N, state.passive_rate.size());
      out.J_passive.resize(N, state.J_passive.size());
    }
    out.passive_rate.row(k) = state.passive_rate.transpose();
    for (Index m = 0; m < state.J_passive.rows(); ++m) out.J_passive.row(k).segment(m * n, n) = state.J_passive.row(m);
  }
  add_lags(p, near, out);
  if (with_differences) add_differences(log, p, out);
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
  // A free fit to a slow log may have an inertia below zero, which no spring carries.
  out.inertia = drive_inertia(robot_, p).cwiseMax(1e-12);
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
    PathPose path;
    if (robot_.inverse_dynamics(q, qd, qdd, smooth, at, &path) != Status::ok ||
        robot_.mass_matrix(q, p, M, &path) != Status::ok)
      return;
    for (Index j = 0; j < n; ++j) out.coupling.row(k).segment(n * j, n) = M.col(j).transpose();
    const auto along = [&](Index j, double step, double lag, double lag_d, double lag_dd, MatrixXd& to) {
      const double q_j = q(j), qd_j = qd(j), qdd_j = qdd(j);
      q(j) += step * lag;
      qd(j) += step * lag_d;
      qdd(j) += step * lag_dd;
      if (robot_.inverse_dynamics(q, qd, qdd, smooth, lagged, &path) == Status::ok)
        to.row(k) = (lagged - at).transpose() / step;
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

void EffectModel::add_differences(const PreparedLog& log, const VectorXd& p, EffectSignals& out) const {
  const Index N = log.t_s.size();
  const Index n = robot_.drives();
  out.changed.assign(differences_.size(), MatrixXd(N, n));
  in_parallel(N, [&](Index k) {
    const VectorXd q = log.q.row(k), qd = log.qd.row(k), qdd = log.qdd.row(k);
    VectorXd plus(n), minus(n);
    PathPose path;  // the changes are small: from one machine to the next the plate hardly moves
    const auto torque = [&](const MachineDifference::Side& side, VectorXd& tau) {
      // Right at the edge of the reach a changed length may not close: then the column says nothing there.
      if (side.robot->inverse_dynamics(q + side.home_offset, qd, qdd, p, tau, &path) != Status::ok)
        tau = out.torque.row(k);
    };
    for (std::size_t d = 0; d < differences_.size(); ++d) {
      torque(differences_[d].plus, plus);
      torque(differences_[d].minus, minus);
      out.changed[d].row(k) = (plus - minus).transpose() / (2 * differences_[d].step);
    }
  });
}

std::vector<EffectColumn> EffectModel::columns(const EffectSignals& s, EffectId id, int joint, const VectorXd& given,
                                               int log_number) const {
  const Shape<double> shape = shape_of(id, given);
  std::vector<EffectColumn> out;
  visit_effect(id, [&](auto effect) {
    using E = decltype(effect);
    if constexpr (kIs<E, JointLaw> || kIs<E, JointMemory>) {
      out = columns_of_joint_law<E>(s, robot_.description(), joint, shape);
    } else if constexpr (kIs<E, PlateForce>) {
      out = columns_on_plate<E>(s, shape, robot_.description().gravity);
    } else if constexpr (kIs<E, RecordedChange>) {
      out = columns_of_record<E>(s, joint, shape);
    } else if constexpr (kIs<E, ElasticJoint>) {
      out = columns_of_spring<E>(s, joint, shape);
    } else {
      static_assert(kIs<E, MachineChange>, "an effect is of one of the kinds");
      out = columns_of_changes(s, differences_, id, joint, shape);
    }
  });
  const EffectKind& kind = effect_kind(id);
  for (std::size_t k = 0; k < kind.shapes.size(); ++k) {
    if (kind.shapes[k].scale != ShapeScale::logs || std::lround(shape[k]) == log_number) continue;
    for (EffectColumn& column : out) column.values.setZero();
  }
  return out;
}

MatrixXd low_passed_rows(const PreparedLog& log, const Eigen::Ref<const MatrixXd>& values) {
  MatrixXd rows(log.rows, values.cols());
  if (log.low_pass) {
    const Index first = log.first - log.low_pass->half_width(), needed = log.low_pass->inputs(log.rows);
    log.low_pass->apply(values.middleRows(first, needed), rows);
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
  const EffectSignals signals = model.signals(log, p, needs_differences(effects));
  Index at = 0;
  for (const Effect& effect : effects_in_log(effects, log.file, log_number)) {
    for (const EffectColumn& column : model.columns(signals, effect.id, effect.joint, effect.shape, log_number)) {
      const MatrixXd rows = low_passed_rows(log, column.values);
      for (Index j = 0; j < n; ++j) {
        if (column.drive < 0 || column.drive == j)
          out[static_cast<std::size_t>(j)].col(at) = rows.col(column.drive < 0 ? j : 0);
      }
      ++at;
    }
  }
  return out;
}

bool needs_differences(const std::vector<Effect>& effects) {
  bool any = false;
  for (const Effect& one : effects)
    visit_effect(one.id, [&any](auto effect) { any |= kIs<decltype(effect), MachineChange>; });
  return any;
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
