#include "deltadyn/simulation/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

constexpr double kLost = 1.0;  // a drive this far from its reference [rad | m] is not controlled any more

/// Ratio of two rates, which must be a whole number.
int whole_ratio(double high, double low) {
  const double ratio = high / low;
  const double whole = std::round(ratio);
  if (!(whole >= 1 && whole < 1e6 && std::abs(ratio - whole) < 1e-9 * whole)) {
    throw Error(fmt::format("the controller's rate of {} Hz is no whole multiple of the log's {} Hz", high, low), "",
                "give --control-rate-hz as a multiple of --rate-hz", ExitCode::usage);
  }
  return static_cast<int>(whole);
}

/// The log row by row, with the torque that acts.
class Recorder {
 public:
  Recorder(Eigen::Index rows, int drives, double rate_hz) : rate_hz_(rate_hz) {
    log_.t_s.resize(rows);
    for (Eigen::MatrixXd* block : {&log_.q, &log_.qd, &log_.qdd, &log_.tau}) block->resize(rows, drives);
  }

  void set(Eigen::Index row, const Eigen::VectorXd& reading, const Eigen::VectorXd& qd, const Eigen::VectorXd& qdd,
           const Eigen::VectorXd& tau) {
    log_.t_s(row) = static_cast<double>(row) / rate_hz_;
    log_.q.row(row) = reading;
    log_.qd.row(row) = qd;
    log_.qdd.row(row) = qdd;
    log_.tau.row(row) = tau;
  }

  void finish(const std::vector<Effect>& effects, const SimulationOptions& options, SimulationResult& result) const {
    const std::uint64_t seed = options.seed + 0x9e3779b97f4a7c15ULL;
    result.log = log_;
    result.log.tau = recorded_torque(log_.t_s, log_.tau, effects, options.sensors, seed);
    result.largest_torque = log_.tau.cwiseAbs().colwise().maxCoeff();
  }

 private:
  double rate_hz_;
  Log log_;
};

[[noreturn]] void lost(double time, double error, long clipped) {
  const std::string loop = "give a lower --bandwidth-hz (or a higher one, if a drive was left behind) or other gains";
  const std::string why = clipped > 0 ? fmt::format("the drives met their torque limits at {} control samples", clipped)
                                      : "the loop is unstable or too weak";
  throw Error(
      fmt::format("at {:.3f} s the robot is {:.2g} rad or m away from where it should be: {}", time, error, why),
      "simulation",
      clipped > 0 ? "plan a motion within the torque (delta-excite --params FILE --drive-torque-n-m LIMITS), give the "
                    "robot file the drives' true effort, or, if the loop is unstable, " +
                        loop
                  : loop,
      ExitCode::no_convergence);
}

SimulationResult along(Plant& plant, const ReferenceMotion& reference, const std::vector<Effect>& effects,
                       const SimulationOptions& options, Eigen::Index first, Eigen::Index samples) {
  const int n = reference.drives();
  SimulationResult result;
  Recorder record(samples - first, n, options.log_rate_hz);
  Encoders encoders(n, options.sensors, options.seed);
  ReferenceMotion::State state;
  for (Eigen::Index k = 0; k < samples; ++k) {
    const double time = static_cast<double>(k) / options.log_rate_hz;
    reference.at(time, state);
    const DriveVector tau = plant.inverse(time, state.q, state.qd, state.qdd);
    if (k < first) continue;
    record.set(k - first, encoders.read(state.q), state.qd, state.qdd, tau);
  }
  record.finish(effects, options, result);
  result.rms_error = result.largest_error = Eigen::VectorXd::Zero(n);
  return result;
}

}  // namespace

void SimulationOptions::validate(int drives) const {
  const auto positive = [](double value, const char* what) {
    if (!(value > 0 && std::isfinite(value))) {
      throw Error(fmt::format("{} of {} Hz", what, value), "", "give a positive number", ExitCode::usage);
    }
  };
  positive(log_rate_hz, "a rate of the log");
  positive(control_rate_hz, "a rate of the controller");
  if (!inverse) (void)whole_ratio(control_rate_hz, log_rate_hz);
  if (!(discard_s >= 0)) throw Error(fmt::format("{} s of the start to leave out", discard_s), "", "", ExitCode::usage);
  sensors.validate(drives);
  controller.validate(drives);
}

SimulationResult simulate(Plant& plant, const Robot& model, const Eigen::VectorXd& p, const ReferenceMotion& reference,
                          const std::vector<Effect>& effects, const SimulationOptions& options) {
  const int n = reference.drives();
  options.validate(n);
  const auto samples = static_cast<Eigen::Index>(std::floor(reference.duration_s() * options.log_rate_hz + 1e-6)) + 1;
  const auto first = static_cast<Eigen::Index>(std::ceil(options.discard_s * options.log_rate_hz - 1e-6));
  if (samples - first < 2) {
    throw Error(
        fmt::format("the motion of {:.4g} s leaves no log after {:.4g} s", reference.duration_s(), options.discard_s),
        "", "give a longer motion, a higher rate, or discard less", ExitCode::usage);
  }
  if (options.inverse) return along(plant, reference, effects, options, first, samples);

  SimulationResult result;
  Recorder record(samples - first, n, options.log_rate_hz);
  const int ratio = whole_ratio(options.control_rate_hz, options.log_rate_hz);
  const double period = 1 / options.control_rate_hz;
  ReferenceMotion::State wanted;
  reference.at(0, wanted);
  Controller controller(model, p, options.controller, period, wanted.q);
  Encoders encoders(n, options.sensors, options.seed);
  DriveVector limit(n);
  for (int j = 0; j < n; ++j) limit(j) = model.description().limits[static_cast<std::size_t>(j)].effort;
  plant.start(wanted.q, wanted.qd);
  const double energy = plant.energy();
  DriveVector tau_before, qdd_before;
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(n);
  result.largest_error = Eigen::VectorXd::Zero(n);
  const Eigen::Index controls = (samples - 1) * ratio + 1;
  for (Eigen::Index k = 0; k < controls; ++k) {
    const double time = static_cast<double>(k) * period;
    reference.at(time, wanted);
    const Eigen::VectorXd reading = encoders.read(plant.q());
    DriveVector tau = controller.torque(wanted, reading);
    for (int j = 0; j < n; ++j) {
      if (std::abs(tau(j)) <= limit(j)) continue;
      tau(j) = std::clamp(tau(j), -limit(j), limit(j));
      ++result.clipped;
    }
    plant.command(tau);
    const DriveVector tau_now = plant.torque(), qdd_now = plant.qdd();
    if (k == 0) {
      tau_before = tau_now;
      qdd_before = qdd_now;
    }
    const Eigen::Index row = k / ratio - first;
    if (k % ratio == 0 && row >= 0) {
      record.set(row, reading, plant.qd(), 0.5 * (qdd_before + qdd_now), 0.5 * (tau_before + tau_now));
      const Eigen::VectorXd error = wanted.q - plant.q();
      if (!(error.cwiseAbs().maxCoeff() < kLost)) lost(time, error.cwiseAbs().maxCoeff(), result.clipped);
      squares += error.cwiseAbs2();
      result.largest_error = result.largest_error.cwiseMax(error.cwiseAbs());
    }
    if (k + 1 < controls) plant.advance(period);
    tau_before = plant.torque();
    qdd_before = plant.qdd();
    if (options.progress && k % 256 == 0) options.progress(static_cast<double>(k) / static_cast<double>(controls));
  }
  record.finish(effects, options, result);
  result.rms_error = (squares / static_cast<double>(samples - first)).cwiseSqrt();
  result.counts = plant.counts();
  result.work = plant.work();
  result.losses = plant.losses();
  result.energy_change = plant.energy() - energy;
  return result;
}

}  // namespace deltadyn
