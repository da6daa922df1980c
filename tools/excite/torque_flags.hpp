#pragma once

/// \file
/// Torque in delta-excite: the known model, the margin that it leaves of the limits, the scale and the noise of the
/// torques.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <vector>

#include "deltadyn/identification/consistent_fit.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"
#include "deltadyn/runtime/robot.hpp"
#include "deltadyn/runtime/workspace.hpp"
#include "deltadyn/trajectory/motion_limits.hpp"

#include "excite/list_flags.hpp"
#include "processing_flags.hpp"
#include "tool_support.hpp"

namespace deltadyn::tools {

class TorqueFlags {
 public:
  void add_to(CLI::App& app) {
    app.option_defaults()->group("Torque");
    app.add_option("--params", params_file_,
                   "known model name,value,unit (CSV): limits the torque, and gives relative figures")
        ->type_name("FILE");
    app.add_option("--torque-margin", margin_,
                   "share of the torque limits left for a model that is off, 0..0.9 [the model's uncertainty and 5 %]");
    add_list(app, "--torque-scale", scale_,
             "weights of (9): largest torque a drive [N m | N] [effort of the robot file]");
    add_list(app, "--torque-noise", noise_,
             "standard deviation of the torque noise a drive, for the report [N m | N] [0.5 % of the scale]");
  }

  [[nodiscard]] const std::string& model_file() const { return params_file_; }
  [[nodiscard]] bool has_model() const { return !params_file_.empty(); }

  /// Values of --params; a value whose standard deviation the file does not give is as uncertain as a prior of the fit.
  [[nodiscard]] NominalParameters model(const Robot& robot) const {
    const ParameterMatch match = match_parameters(read_parameters(params_file_, robot.description()),
                                                  robot.parameter_names(), robot.parameter_units());
    for (const std::string& warning : match.warnings) fmt::print("note: {}\n", warning);
    NominalParameters model{match.value, match.std};
    const Eigen::VectorXd usual = ConsistentFitOptions{}.prior_relative_std * match.value.cwiseAbs();
    model.std = model.std.array().isFinite().select(model.std, usual);
    return model;
  }

  /// Takes the margin off the torque limits, and refuses limits that friction alone exceeds.
  void keep_margin(const Robot& robot, const NominalParameters& model, MotionLimits& limits) const {
    constexpr double kForTheLoop = 0.05;  // what the controller adds to the model's torque
    constexpr double kLargest = 0.5;      // a model that is further off does not limit a torque at all
    if (margin_ && !(*margin_ >= 0 && *margin_ < 0.9))
      throw Error("--torque-margin is out of range", "", "give 0 to 0.9, the share of the torque limits to keep free",
                  ExitCode::usage);
    const double margin = margin_.value_or(std::min(kLargest, uncertainty(robot, model) + kForTheLoop));
    refuse_friction(robot, model.value, limits.tau, margin);
    if (!limits.tau.array().isFinite().any()) return;
    limits.tau *= 1 - margin;
    fmt::print("torque limits planned with a margin of {:.0f} % for a model that is off{}\n", 100 * margin,
               margin_ ? "" : " (its uncertainty and 5 %; --torque-margin)");
  }

  /// Weight of each drive's torque: the flag, else the efforts of the robot file, else what nominal parameters need.
  [[nodiscard]] Eigen::VectorXd scale(const Robot& robot, const Eigen::VectorXd& nominal) const {
    const int n = robot.drives();
    if (!scale_.empty()) return spread_vector(scale_, n, "--torque-scale");
    Eigen::VectorXd scale = MotionLimits(robot.description()).tau;
    if (scale.allFinite()) return scale;
    WorkspaceSampler sampler(robot);
    Eigen::VectorXd q, qd, qdd, tau(n), squares = Eigen::VectorXd::Zero(n);
    for (int k = 0; k < kStates; ++k) {
      sampler.next(q, qd, qdd);
      if (robot.inverse_dynamics(q, qd, qdd, nominal, tau) == Status::ok) squares += tau.cwiseAbs2();
    }
    scale = 2 * (squares / kStates).cwiseSqrt().cwiseMax(1e-6);
    fmt::print(
        "note: no --torque-scale and no effort in the robot file; twice the usual torque of nominal parameters is "
        "used\n");
    return scale;
  }

  /// Says where a drive's scale is less than its friction in the model.
  static void tell_scale_below_friction(const Robot& robot, const Eigen::VectorXd& parameters,
                                        const Eigen::VectorXd& scale) {
    for (int i = 0; i < robot.drives(); ++i) {
      const double friction = std::abs(parameters(coulomb_columns(robot)[static_cast<std::size_t>(i)]));
      const char* unit = torque_unit(robot.description(), i);
      if (friction > scale(i))
        fmt::print(
            "note: the torque scale of drive {} is {:.4g} {}, less than its Coulomb friction in the model, {:.4g} {}: "
            "check "
            "the unit of --torque-scale or of the model\n",
            i + 1, scale(i), unit, friction, unit);
    }
  }

  [[nodiscard]] Eigen::VectorXd noise(const Robot& robot, const Eigen::VectorXd& scale) const {
    constexpr double kOfScale = 0.005;
    return noise_.empty() ? Eigen::VectorXd(kOfScale * scale) : spread_vector(noise_, robot.drives(), "--torque-noise");
  }

 private:
  static constexpr int kStates = 500;  // random states that torques are looked at in

  /// Share of the torque that the model's uncertainty may make of a drive's torque, all parameters off the same way, as
  /// those of a prior that is too light are.
  [[nodiscard]] static double uncertainty(const Robot& robot, const NominalParameters& model) {
    WorkspaceSampler sampler(robot);
    Eigen::VectorXd q, qd, qdd;
    Eigen::MatrixXd Y(robot.drives(), robot.parameters());
    Eigen::VectorXd off = Eigen::VectorXd::Zero(robot.drives()), all = off;
    for (int k = 0; k < kStates; ++k) {
      sampler.next(q, qd, qdd);
      if (robot.regressor(q, qd, qdd, Y) != Status::ok) continue;
      off += Y.cwiseAbs() * model.std;
      all += Y.cwiseAbs() * model.value.cwiseAbs();
    }
    return off.cwiseQuotient(all.cwiseMax(1e-300)).maxCoeff();
  }

  void refuse_friction(const Robot& robot, const Eigen::VectorXd& parameters, const Eigen::VectorXd& limits,
                       double margin) const {
    for (int i = 0; i < robot.drives(); ++i) {
      const double friction = std::abs(parameters(coulomb_columns(robot)[static_cast<std::size_t>(i)]));
      const char* unit = torque_unit(robot.description(), i);
      if (!std::isfinite(limits(i)) || friction < (1 - margin) * limits(i)) continue;
      throw Error(
          fmt::format(
              "the model's Coulomb friction of drive {} is {:.4g} {}, of {:.4g} {} that the drive may give ({:.4g} {} "
              "less a margin of {:.0f} %): nothing may move",
              i + 1, friction, unit, (1 - margin) * limits(i), unit, limits(i), unit, 100 * margin),
          params_file_,
          "check unit and scale of the friction in the model, and of the torque limits; --torque-margin 0 "
          "keeps nothing free");
    }
  }

  std::string params_file_;
  std::optional<double> margin_;
  std::vector<double> scale_, noise_;
};

}  // namespace deltadyn::tools
