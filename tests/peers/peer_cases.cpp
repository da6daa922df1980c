/// \file
/// Writes robots, parameters, states and a closed-loop motion for the tests against other people's simulators:
///     peer_cases FOLDER
/// For each type: TYPE.urdf, TYPE_params.csv, TYPE_states.csv (drives, joints of the tree, torques, mass matrix),
/// TYPE_motion.csv. For the delta4 effects and a trajectory, too: delta4_effects.csv, delta4_trajectory.csv.

#include <cmath>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <string>
#include <vector>

#include "deltadyn/dynamics/forward_dynamics.hpp"
#include "deltadyn/effects/some_effects.hpp"
#include "deltadyn/io/effect_file.hpp"
#include "deltadyn/io/output_file.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"
#include "deltadyn/io/trajectory_file.hpp"
#include "deltadyn/runtime/geometry_of.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"
#include "deltadyn/runtime/workspace.hpp"

#include "support/descriptions.hpp"
#include "support/random_robot.hpp"

namespace {

using namespace deltadyn;
using namespace deltadyn::testing_support;

constexpr int kStates = 1100;  // a few are left out where a joint hardly moves
constexpr double kTick = 1e-3, kDuration = 0.5;
constexpr int kSubsteps = 50;

template <class R>
class Case {
 public:
  using Layout = ParameterLayout<R, Limbs::individual>;
  using Drives = deltadyn::Vector<double, R::kDrives>;
  static constexpr int N = R::kDrives;

  explicit Case(std::string folder) : folder_(std::move(folder)) {
    if constexpr (R::kPlateTurns) {
      description_ = four_limb_description(R::kName, R::kDrive);
    } else {
      description_ = delta_description(R::kName);
    }
    if (description_.telescope) {
      description_.telescope->p_WU = Vector3<double>(0.01, -0.02, 0.05);
      description_.telescope->p_BV = Vector3<double>(0, 0, 0.03);
    }
    ParameterOptions options;
    options.individual_limbs = true;
    for (int drive = 1; drive <= N; ++drive) options.rotor_inertia.push_back(drive);
    robot_ = make_robot(description_, options);
    geometry_ = geometry_of<double, R>(description_);
    choose_parameters();
  }

  void write() {
    write_robot_file(path(".urdf"), description_);
    ParameterTable table;
    for (int k = 0; k < robot_->parameters(); ++k) {
      const auto i = static_cast<std::size_t>(k);
      table.entries.push_back({robot_->parameter_names()[i], values_(k), robot_->parameter_units()[i]});
    }
    write_parameters(path("_params.csv"), table);
    write_states();
    write_motion();
  }

  /// Friction that differs by direction, friction that bends, and a hose; a motion that shows them, with reversals.
  void write_effects_and_trajectory() {
    std::vector<Effect> effects(3);
    const auto choose = [&effects](std::size_t k, const char* name, int joint, std::vector<double> amplitude,
                                   std::vector<double> shape) {
      effects[k].id = effect_named(name);
      effects[k].joint = joint;
      effects[k].amplitude = Eigen::Map<Eigen::VectorXd>(amplitude.data(), static_cast<Eigen::Index>(amplitude.size()));
      effects[k].shape = Eigen::Map<Eigen::VectorXd>(shape.data(), static_cast<Eigen::Index>(shape.size()));
    };
    choose(0, "asymmetric_viscous", 0, {0.7}, {});
    choose(1, "stribeck", 1, {2}, {0.25, 2});
    choose(2, "hose_force", -1, {3, -2, 1, 25, 18, 8}, {});
    deltadyn::write_effects(path("_effects.csv"), effects, description_);
    TrajectorySamples samples;
    constexpr int kSamples = 4000;
    for (Eigen::MatrixXd* of : {&samples.z, &samples.zd, &samples.zdd}) of->setZero(kSamples, N);
    samples.t_s = Eigen::VectorXd::LinSpaced(kSamples, 0, (kSamples - 1) * kTick);
    const WorkspaceSampler sampler(*robot_);
    for (int k = 0; k < kSamples; ++k) {
      for (const double speed : {1.0, 0.37}) {  // the ratio of a motion that does not repeat
        const TaskState task = task_at(sampler, speed * samples.t_s(k));
        samples.z.row(k) += 0.5 * task.z.transpose();
        samples.zd.row(k) += 0.5 * speed * task.zd.transpose();
        samples.zdd.row(k) += 0.5 * speed * speed * task.zdd.transpose();
      }
    }
    complete_drives(*robot_, samples);
    write_trajectory(path("_trajectory.csv"), samples, description_);
  }

 private:
  static TaskState task_at(const WorkspaceSampler& sampler, double t) {
    TaskState task{Eigen::VectorXd::Zero(N), Eigen::VectorXd::Zero(N), Eigen::VectorXd::Zero(N)};
    const double amplitude[] = {0.1, 0.08, 0.05, R::kPlateTurns ? 0.5 : 2.0}, omega[] = {12, 15, 18, 14};
    for (int i = 0; i < N; ++i) {
      const double angle = omega[i] * t + 0.7 * i;
      task.z(i) = amplitude[i] * std::sin(angle) + (i < 3 ? sampler.ball().centre(i) : 0);
      task.zd(i) = amplitude[i] * omega[i] * std::cos(angle);
      task.zdd(i) = -amplitude[i] * omega[i] * omega[i] * std::sin(angle);
    }
    return task;
  }

  [[nodiscard]] std::string path(const std::string& ending) const { return folder_ + "/" + name() + ending; }
  [[nodiscard]] static std::string name() {
    const bool linear = R::kPlateTurns && R::kDrive == DriveKind::prismatic;
    return (linear ? "linear-" : "") + std::string(R::kName);
  }

  /// Nominal parameters, made crooked by a point mass on every body, with friction and rotor inertias.
  void choose_parameters() {
    values_ = nominal_parameters(*robot_, PartShapes(description_)).value;
    for (int body = 0; body < Layout::kBodies; ++body) {
      const double m = 0.1 * values_(kInertialParameters * body);
      values_.template segment<kInertialParameters>(kInertialParameters * body) += 0.2 * m * random_body(random_);
    }
    for (int k = Layout::kFriction; k < robot_->parameters(); ++k) {
      const bool rotor = k >= Layout::kRotorInertia;
      values_(k) = rotor ? random_.uniform(0.01, 0.05) : random_.uniform(0.5, 2);
      if (R::kPlateTurns && (k == Layout::viscous(N) || k == Layout::coulomb(N)))
        values_(k) = random_.uniform(0.05, 0.2);
    }
    if (R::kTelescope) values_(Layout::kRotorInertia + N - 1) = 0.002;
    p_.setZero();
    p_.head(values_.size()) = values_;  // all columns but the offsets, which come last
  }

  void write_states() {
    OutputFile file(path("_states.csv"));
    std::string header;
    const auto add = [&header](const std::string& stem) {
      for (int i = 1; i <= N; ++i) header += fmt::format("{}{},", stem, i);
    };
    for (const char* stem : {"q", "qd", "qdd", "tau"}) add(stem);
    for (int i = 1; i <= N; ++i) add(fmt::format("M{}_", i));
    file.print("{}x,y,z", header);
    for (int i = 1; i <= R::kLimbs; ++i) file.print(",beta{0},gamma{0}", i);
    file.print("{}\n", R::kTelescope
                           ? ",bar_a,bar_b,bar_length"
                           : (R::kPlateTurns ? ",theta,leader,half1_x,half1_y,half1_z,half2_x,half2_y,half2_z" : ""));
    WorkspaceSampler sampler(*robot_);
    for (int state = 0; state < kStates; ++state) {
      Eigen::VectorXd q, qd, qdd, tau(N);
      sampler.next(q, qd, qdd);
      Eigen::MatrixXd M(N, N);
      if (robot_->inverse_dynamics(q, qd, qdd, values_, tau) != Status::ok ||
          robot_->mass_matrix(q, values_, M) != Status::ok)
        throw std::runtime_error("a state is not regular");
      Posture<double, R> posture;
      if (posture_from_drives<double, R>(geometry_, q, posture) != Status::ok) throw std::runtime_error("no posture");
      for (const auto& v : {q, qd, qdd, tau})
        for (const double x : v) file.print("{},", x);
      for (const double x : M.reshaped()) file.print("{},", x);
      file.print("{},{},{}", posture.z(0), posture.z(1), posture.z(2));
      for (const auto& limb : posture.limbs)
        file.print(",{},{}", std::atan2(limb.beta.sin, limb.beta.cos), std::atan2(limb.gamma.sin, limb.gamma.cos));
      const auto& bar = posture.telescope;
      if (R::kTelescope)
        file.print(",{},{},{}", std::atan2(bar.a.sin, bar.a.cos), std::atan2(bar.b.sin, bar.b.cos), bar.length);
      if constexpr (R::kPlateTurns) {
        // The joint between the halves that leads the others in MuJoCo: the bar's turn, or the slide
        const double travel = (geometry_.parts[1].b - geometry_.parts[0].b).norm();
        file.print(",{},{}", posture.theta, travel > 0 ? travel * posture.theta : posture.theta);
        for (const int half : {0, 1}) {
          const PartPose<double> part = part_pose(geometry_.parts[half], posture.z(3), geometry_.yaw_ratio);
          const Vector3<double> p = posture.z.template head<3>() + part.p.value;
          file.print(",{},{},{}", p.x(), p.y(), p.z());
        }
      }
      file.write("\n");
    }
    file.commit();
  }

  /// Feed-forward and a digital PD controller at 1 kHz on a fast motion, integrated by Runge and Kutta in steps of 20
  /// us.
  void write_motion() {
    const WorkspaceSampler sampler(*robot_);
    const auto set_point = [&](double t, Eigen::VectorXd& q, Eigen::VectorXd& qd, Eigen::VectorXd& tau) {
      const TaskState task = task_at(sampler, t);
      Eigen::VectorXd qdd(N);
      if (robot_->to_drives(task, q, qd, qdd) != Status::ok ||
          robot_->inverse_dynamics(q, qd, qdd, values_, tau) != Status::ok)
        throw std::runtime_error("the motion leaves the workspace");
    };
    OutputFile file(path("_motion.csv"));
    file.write("t_s,k,d");
    for (const char* stem : {"ref", "refd", "ff", "q"}) {
      for (int i = 1; i <= N; ++i) file.print(",{}{}", stem, i);
    }
    file.write("\n");
    const double stiffness = R::kDrive == DriveKind::revolute ? 400 : 4000, damping = stiffness / 40;
    Eigen::VectorXd reference(N), rate(N), feed(N), torque(N);
    Drives q, qd;
    for (int tick = 0; tick <= std::lround(kDuration / kTick); ++tick) {
      set_point(tick * kTick, reference, rate, feed);
      feed *= 0.9;  // so that the controller has something to do
      if (tick == 0) {
        q = reference;
        qd = rate;
      }
      file.print("{},{},{}", tick * kTick, stiffness, damping);
      for (const Eigen::VectorXd& v : {reference, rate, feed, Eigen::VectorXd(q)})
        for (const double x : v) file.print(",{}", x);
      file.write("\n");
      Drives tau = feed + stiffness * (reference - q) + damping * (rate - qd);
      if (R::kTelescope)
        tau(N - 1) =
            feed(N - 1) + stiffness / 100 * (reference(N - 1) - q(N - 1)) + damping / 100 * (rate(N - 1) - qd(N - 1));
      for (int step = 0; step < kSubsteps; ++step) advance(kTick / kSubsteps, tau, q, qd);
    }
    file.commit();
  }

  [[nodiscard]] Drives acceleration(const Drives& q, const Drives& qd, const Drives& tau) const {
    Posture<double, R> posture;
    Drives qdd;
    if (posture_from_drives(geometry_, q, posture) != Status::ok ||
        forward_dynamics<Layout, double, R>(geometry_, posture, qd, tau, p_, qdd) != Status::ok)
      throw std::runtime_error("the simulated motion leaves the workspace");
    return qdd;
  }

  void advance(double h, const Drives& tau, Drives& q, Drives& qd) const {
    const Drives a1 = acceleration(q, qd, tau), v2 = qd + h / 2 * a1;
    const Drives a2 = acceleration(q + h / 2 * qd, v2, tau), v3 = qd + h / 2 * a2;
    const Drives a3 = acceleration(q + h / 2 * v2, v3, tau), v4 = qd + h * a3;
    const Drives a4 = acceleration(q + h * v3, v4, tau);
    q += h / 6 * (qd + 2 * v2 + 2 * v3 + v4);
    qd += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }

  std::string folder_;
  RobotDescription description_;
  std::unique_ptr<Robot> robot_;
  Geometry<double, R> geometry_;
  Random random_{5};
  Eigen::VectorXd values_;
  deltadyn::Vector<double, Layout::kColumns> p_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: peer_cases FOLDER\n");
    return 2;
  }
  try {
    Case<Delta3>(argv[1]).write();
    Case<LinearDelta3>(argv[1]).write();
    Case<H4>(argv[1]).write();
    Case<LinearH4>(argv[1]).write();
    Case<I4>(argv[1]).write();
    Case<LinearI4>(argv[1]).write();
    Case<Par4>(argv[1]).write();
    Case<LinearPar4>(argv[1]).write();
    Case<Delta4> delta4(argv[1]);
    delta4.write();
    delta4.write_effects_and_trajectory();
  } catch (const std::exception& e) {
    std::fprintf(stderr, "peer_cases: %s\n", e.what());
    return 1;
  }
  return 0;
}
