#pragma once

/// \file
/// A plant for the blind study of delta-diagnose. Its effects act inside the forward simulation and have forms of their
/// own: nothing of effects/, diagnosis/ or simulation/ is used, only the rigid robot.

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "deltadyn/runtime/random.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/signal/log.hpp"

namespace deltadyn::blind {

/// What an effect may look at while the plant runs.
struct Moment {
  double t = 0;
  int log = 0;                   ///< 0 fast, 1 slow, 2 hold-out
  Eigen::VectorXd q, qd, motor;  ///< motor: torque on the shafts before losses
  Eigen::VectorXd transmitted;   ///< what the drives' own Coulomb and viscous friction leave of it
  Eigen::Vector3d r = Eigen::Vector3d::Zero(), v = Eigen::Vector3d::Zero();
  Eigen::MatrixXd J;  ///< dz/dq
};

/// A spring between rotor and arm. The rotor, a body of its own, carries the drive's friction; its inertia is a share
/// of what the drive sees in all, so that the inertia of both together is what the model says.
struct Spring {
  int drive = 0;
  double resonance_hz = 20;  ///< of the side that the encoder does not see, with the encoder's side held
  bool encoder_on_motor = true;
};

/// One hidden effect. Every hook may be empty.
struct Hidden {
  std::string truth, joint;  ///< name and joint that a diagnosis should give; "unknown" if the catalogue has none
  /// Adds resisting torque to `load`. `memory` has memory_size entries, zero at the start; `memory_d` takes their
  /// rates.
  std::function<void(const Moment&, const Eigen::VectorXd& memory, Eigen::VectorXd& memory_d, Eigen::VectorXd& load)>
      resist;
  int memory_size = 0;
  /// Changes the machine itself
  std::function<void(RobotDescription&)> robot;
  /// Of the limbs' own layout
  std::function<void(const Robot&, int log, Eigen::VectorXd& p)> parameters;
  /// Changes what is recorded
  std::function<void(int log, Eigen::MatrixXd& tau, Eigen::MatrixXd& q, double dt)> record;
  /// first-order lag between the recorded command and the shaft
  double motor_lag_s = 0;
  /// Size as the catalogue states it, if the form has one
  double amplitude = std::numeric_limits<double>::quiet_NaN();
  std::optional<Spring> spring = std::nullopt;
};

struct Noise {
  double torque_share = 0.006;  ///< of the largest torque of the drive, standard deviation
  double correlation = 0;       ///< of neighbouring samples
  double encoder_rad = 3e-6;    ///< white, standard deviation
};

struct Case {
  RobotDescription robot;
  Eigen::VectorXd parameters;  ///< shared layout: what the user's model has
  std::vector<Hidden> hidden;
  Noise noise;
  std::uint64_t seed = 1;
  double duration_s = 10;
  int harmonics = 5;  ///< of 0.1 to 0.3 Hz: more shake a spring
};

/// Three logs: fast, slow, hold-out. \param strength  if given, rms torque of the hidden effects over the noise,
/// largest over the drives
inline std::vector<Log> record(const Case& blind, double* strength = nullptr) {
  constexpr double kStep = 5e-4;
  constexpr int kPerSample = 2;
  RobotDescription machine = blind.robot;
  for (const Hidden& hidden : blind.hidden) {
    if (hidden.robot) hidden.robot(machine);
  }
  ParameterOptions own;
  own.individual_limbs = !machine.parts.empty();
  for (int j = 1; j <= machine.drives(); ++j) own.rotor_inertia.push_back(j);
  const auto plant = make_robot(machine, own);
  const auto model = make_robot(blind.robot);
  const int n = machine.drives();
  std::mt19937_64 random(blind.seed);
  UniformDistribution uniform(-1, 1);
  NormalDistribution normal;

  // The plant's own parameters: those of the model, limb by limb, without friction, which acts in the loop below.
  Eigen::VectorXd p_own(plant->parameters());
  std::vector<double> viscous(static_cast<std::size_t>(n) + 1, 0), coulomb = viscous;
  for (int k = 0; k < plant->parameters(); ++k) {
    std::string name = plant->parameter_names()[static_cast<std::size_t>(k)];
    double value = 0;
    for (const std::string& part : {std::string("upper_arm"), std::string("strut")}) {
      if (name.rfind(part, 0) == 0) name = part + name.substr(name.find('.'));
    }
    for (int i = 0; i < model->parameters(); ++i) {
      if (model->parameter_names()[static_cast<std::size_t>(i)] == name) value = blind.parameters(i);
    }
    const bool friction = name.find(".viscous") != std::string::npos || name.find(".coulomb") != std::string::npos;
    if (friction) {
      const auto joint = static_cast<std::size_t>(name[0] == 't' ? n : name[5] - '1');
      (name.find(".viscous") != std::string::npos ? viscous : coulomb)[joint] = value;
      value = 0;
    }
    p_own(k) = value;
  }

  std::optional<Spring> spring = std::nullopt;
  for (const Hidden& hidden : blind.hidden) {
    if (hidden.spring) spring = hidden.spring;
  }

  std::vector<Log> logs;
  double worst = 0;
  for (int l = 0; l < 3; ++l) {
    Eigen::VectorXd p = p_own;
    for (const Hidden& hidden : blind.hidden) {
      if (hidden.parameters) hidden.parameters(*plant, l, p);
    }
    // A random Fourier path in the workspace, from rest on.
    const double base_hz = l == 0 ? 0.3 : (l == 1 ? 0.1 : 0.2);
    const double speed = l == 1 ? 0.35 : 1.0;
    Eigen::MatrixXd a(n, 2 * blind.harmonics);
    for (int i = 0; i < a.size(); ++i) a(i) = uniform(random);
    const auto reference = [&](double t) {
      TaskState s;
      s.z = s.zd = s.zdd = Eigen::VectorXd::Zero(n);
      for (int i = 0; i < n; ++i) {
        const double size = i < 2 ? 0.16 : (i == 2 ? 0.09 : 7.0);
        for (int h = 1; h <= blind.harmonics; ++h) {
          const double w = 2 * 3.14159265358979 * base_hz * h, c = size * std::pow(speed, 0.3) / std::sqrt(h);
          const double A = c * a(i, 2 * h - 2) * 0.6, B = c * a(i, 2 * h - 1) * 0.6;
          s.z(i) += A * std::sin(w * t) + B * (std::cos(w * t) - 1);
          s.zd(i) += w * (A * std::cos(w * t) - B * std::sin(w * t));
          s.zdd(i) += -w * w * (A * std::sin(w * t) + B * std::cos(w * t));
        }
      }
      s.z(2) -= 0.82;
      return s;
    };
    // Start on the path, moving with it.
    Moment now;
    now.log = l;
    Eigen::VectorXd q(n), qd(n), qdd(n), q_r(n), qd_r(n), qdd_r(n);
    if (model->to_drives(reference(0), q, qd, qdd) != Status::ok) return {};
    Eigen::MatrixXd M(n, n);
    if (model->mass_matrix(q, blind.parameters, M) != Status::ok) return {};
    const Eigen::VectorXd inertia = M.diagonal();
    constexpr double kRotorShare = 0.3, kDampingRatio = 0.05;
    double rotor = 0, stiffness = 0, damping = 0;
    if (spring) {
      const double whole = inertia(spring->drive);
      rotor = kRotorShare * whole;
      const double w = 2 * 3.14159265358979 * spring->resonance_hz;
      stiffness = w * w * (spring->encoder_on_motor ? whole - rotor : rotor);
      damping = 2 * kDampingRatio * std::sqrt(stiffness * rotor * (whole - rotor) / whole);
      for (int k = 0; k < plant->parameters(); ++k) {
        if (plant->parameter_names()[static_cast<std::size_t>(k)] ==
            "drive" + std::to_string(spring->drive + 1) + ".rotor_inertia")
          p(k) -= rotor;
      }
    }
    int memory_total = 0;
    for (const Hidden& hidden : blind.hidden) memory_total += hidden.memory_size;
    Eigen::VectorXd memory = Eigen::VectorXd::Zero(memory_total), command(n), shaft = Eigen::VectorXd::Zero(n);
    double lag = 0;
    for (const Hidden& hidden : blind.hidden) lag = std::max(lag, hidden.motor_lag_s);

    const int samples = static_cast<int>(blind.duration_s * 1000);
    Log log;
    log.file = l == 0 ? "fast" : (l == 1 ? "slow" : "holdout");
    log.t_s = Eigen::VectorXd::LinSpaced(samples, 0, (samples - 1) * 1e-3);
    log.q.resize(samples, n);
    log.tau.resize(samples, n);
    Eigen::VectorXd effect_square = Eigen::VectorXd::Zero(n), torque_max = Eigen::VectorXd::Zero(n);
    Eigen::VectorXd last_effect = Eigen::VectorXd::Zero(n);
    const auto derivative = [&](double t, const Eigen::VectorXd& x, Eigen::VectorXd& xd) {
      const Eigen::VectorXd position = x.head(n), rate = x.segment(n, n), state = x.segment(2 * n, memory_total),
                            motor = lag > 0 ? Eigen::VectorXd(x.tail(n)) : command;
      Eigen::VectorXd turning = rate;  // of what carries the drives' friction
      const Eigen::Index at_rotor = 2 * n + memory_total;
      if (spring) turning(spring->drive) = x(at_rotor + 1);
      now.t = t;
      now.q = position;
      now.qd = rate;
      now.motor = motor;
      Eigen::VectorXd load = Eigen::VectorXd::Zero(n), state_d = Eigen::VectorXd::Zero(memory_total);
      for (int j = 0; j < n; ++j) {
        load(j) = viscous[static_cast<std::size_t>(j)] * turning(j) +
                  coulomb[static_cast<std::size_t>(j)] * std::tanh(turning(j) / (j == 3 ? 0.12 : 0.008));
      }
      now.transmitted = motor - load;  // a gear passes on all but its own friction
      if (!machine.parts.empty()) {
        Eigen::MatrixXd J(n, n);
        Eigen::VectorXd z(n);
        if (plant->jacobian(position, J) != Status::ok || plant->forward_kinematics(position, z) != Status::ok)
          return false;
        now.J = J;
        now.r = z.head<3>();
        now.v = (J * rate).head<3>();
      }
      if (model->description().telescope) {
        // The bar's rate and its Jacobian, from the plate's own.
        const Eigen::Vector3d along =
            (now.r + model->description().telescope->p_BV - model->description().telescope->p_WU).normalized();
        const double bar_rate = along.dot(now.v);
        load += (viscous.back() * bar_rate + coulomb.back() * std::tanh(bar_rate / 0.005)) *
                (now.J.topRows<3>().transpose() * along);
      }
      const Eigen::VectorXd plain = load;
      int at = 0;
      for (const Hidden& hidden : blind.hidden) {
        if (hidden.resist) {
          Eigen::VectorXd own_d = Eigen::VectorXd::Zero(hidden.memory_size);
          hidden.resist(now, state.segment(at, hidden.memory_size), own_d, load);
          state_d.segment(at, hidden.memory_size) = own_d;
        }
        at += hidden.memory_size;
      }
      last_effect = load - plain;
      Eigen::VectorXd acceleration(n), torque = motor - load;
      double rotor_acceleration = 0;
      if (spring) {
        const int j = spring->drive;
        const double passed = stiffness * (x(at_rotor) - position(j)) + damping * (x(at_rotor + 1) - rate(j));
        rotor_acceleration = (torque(j) - passed) / rotor;
        torque(j) = passed;
      }
      if (plant->forward_dynamics(position, rate, torque, p, acceleration) != Status::ok) return false;
      if (spring) {
        const int j = spring->drive;
        xd(at_rotor) = x(at_rotor + 1);
        xd(at_rotor + 1) = rotor_acceleration;
        // What a rigid drive that moves like the encoder would not have needed.
        last_effect(j) += spring->encoder_on_motor ? (inertia(j) - rotor) * (acceleration(j) - rotor_acceleration)
                                                   : rotor * (rotor_acceleration - acceleration(j));
      }
      xd.head(n) = rate;
      xd.segment(n, n) = acceleration;
      xd.segment(2 * n, memory_total) = state_d;
      if (lag > 0) xd.tail(n) = (command - motor) / lag;
      return true;
    };
    const Eigen::Index springs = spring ? 2 : 0;
    const Eigen::Index size = 2 * n + memory_total + springs + (lag > 0 ? n : 0);
    Eigen::VectorXd x(size), k1(size), k2(size), k3(size), k4(size);
    x << q, qd, memory, Eigen::VectorXd::Zero(springs), (lag > 0 ? Eigen::VectorXd(shaft) : Eigen::VectorXd(0));
    const auto measured = [&] {
      Eigen::VectorXd both = x.head(2 * n);
      if (spring && spring->encoder_on_motor) {
        both(spring->drive) = x(2 * n + memory_total);
        both(n + spring->drive) = x(2 * n + memory_total + 1);
      }
      return both;
    };
    const int lead = 500;  // half a second to settle before the record begins
    for (int k = -lead; k < samples; ++k) {
      const double t = k * 1e-3;
      if (model->to_drives(reference(t), q_r, qd_r, qdd_r) != Status::ok) return {};
      Eigen::VectorXd feed(n);
      if (model->inverse_dynamics(q_r, qd_r, qdd_r, blind.parameters, feed) != Status::ok) return {};
      if (k == -lead) {
        x.head(n) = q_r;
        x.segment(n, n) = qd_r;
        if (spring) {
          x(2 * n + memory_total) = q_r(spring->drive) + feed(spring->drive) / stiffness;
          x(2 * n + memory_total + 1) = qd_r(spring->drive);
        }
      }
      // Against a spring that it does not see, a controller must be soft.
      const double w =
          2 * 3.14159265358979 * (spring && !spring->encoder_on_motor ? std::min(9.0, spring->resonance_hz / 20) : 9.0);
      const Eigen::VectorXd seen = measured();
      command = feed + inertia.cwiseProduct(w * w * (q_r - seen.head(n)) + 1.4 * w * (qd_r - seen.tail(n)));
      if (lag > 0 && k == -lead) x.tail(n) = command;
      if (k >= 0) {
        log.q.row(k) = seen.head(n).transpose();
        log.tau.row(k) = command.transpose();
      }
      for (int s = 0; s < kPerSample; ++s) {
        const double begin = t + s * kStep;
        if (!derivative(begin, x, k1) || !derivative(begin + kStep / 2, x + kStep / 2 * k1, k2) ||
            !derivative(begin + kStep / 2, x + kStep / 2 * k2, k3) || !derivative(begin + kStep, x + kStep * k3, k4)) {
          return {};
        }
        x += kStep / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      }
      if (k >= 0) effect_square += last_effect.cwiseAbs2() / samples;
    }
    torque_max = log.tau.cwiseAbs().colwise().maxCoeff().transpose();
    // The command holds over a sample: it belongs to the middle of it.
    const Eigen::MatrixXd held = log.tau;
    for (int k = 1; k < samples; ++k) log.tau.row(k) = 0.5 * (held.row(k) + held.row(k - 1));
    const Eigen::MatrixXd tau_true = log.tau;
    for (const Hidden& hidden : blind.hidden) {
      if (hidden.record) hidden.record(l, log.tau, log.q, 1e-3);
    }
    for (int j = 0; j < n; ++j) {
      const double sigma = blind.noise.torque_share * torque_max(j), rho = blind.noise.correlation;
      const double recorded = (log.tau.col(j) - tau_true.col(j)).squaredNorm() / samples;
      worst = std::max(worst, std::sqrt(effect_square(j) + recorded) / sigma);
      double e = sigma * normal(random);
      for (int k = 0; k < samples; ++k) {
        e = rho * e + sigma * std::sqrt(1 - rho * rho) * normal(random);
        log.tau(k, j) += e;
        log.q(k, j) += blind.noise.encoder_rad * (j == 3 ? 10.0 : 1.0) * normal(random);
      }
    }
    logs.push_back(std::move(log));
  }
  if (strength != nullptr) *strength = worst;
  return logs;
}

}  // namespace deltadyn::blind
