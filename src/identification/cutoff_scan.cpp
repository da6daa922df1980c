#include "cutoff_scan.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "deltadyn/runtime/error.hpp"

#include "data_fold.hpp"

namespace deltadyn {

namespace {

using Eigen::Index;

constexpr double kRatio = 1.26;     // a third of an octave
constexpr Index kRowsOfLog = 1000;  // enough to tell cut-offs apart
constexpr double kClearlyRisen = 1.5;

/// Root mean square of what no p explains, for one drive on its own.
double unexplained_rms(const DriveFold& fold) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(fold.R);
  const auto freedom = static_cast<double>(fold.rows - qr.rank());
  if (freedom < 1) return 0.0;
  return std::sqrt(((fold.R * qr.solve(fold.d) - fold.d).squaredNorm() + fold.remainder) / freedom);
}

bool lower_score(const CutoffPoint& a, const CutoffPoint& b) {
  return a.score < b.score;
}

}  // namespace

std::vector<CutoffPoint> scan_cutoffs(const Robot& robot, const std::vector<Log>& logs, const ProcessingOptions& processing,
                                      int threads, const std::function<void(double)>& progress) {
  double rate_hz = 1e300;
  double shortest_s = 1e300;
  for (const Log& log : logs) {
    rate_hz = std::min(rate_hz, 1.0 / log.sample_time_s());
    shortest_s = std::min(shortest_s, static_cast<double>(log.samples()) * log.sample_time_s());
  }
  const double lowest = std::max(5.0, 20.0 / shortest_s);  // the ends of a log are lost for 1.5 / cut-off
  const double highest = 0.25 * rate_hz;
  std::vector<CutoffPoint> points;
  for (double cutoff = lowest; cutoff < highest; cutoff *= kRatio) {
    if (progress) progress(std::log(cutoff / lowest) / std::log(highest / lowest));
    ProcessingOptions options = processing;
    options.cutoff_hz = cutoff;
    options.motion_over_pass = 1;  // it is the motion's own cut-off that is tried
    options.periods = Periods::ignore;
    options.low_pass_torque = false;  // one and the same torque for all cut-offs
    DataFold fold;
    for (const Log& log : logs) {
      options.stride = static_cast<int>(std::max<Index>(1, log.samples() / kRowsOfLog));
      fold.add(fold_log(robot, prepare_log(robot, log, options), threads));
    }
    CutoffPoint point{cutoff, 0.0, Eigen::VectorXd(robot.drives())};
    for (int j = 0; j < robot.drives(); ++j) point.rms(j) = unexplained_rms(fold.regular[static_cast<std::size_t>(j)]);
    point.score = std::exp(point.rms.cwiseMax(1e-15).array().log().mean());
    points.push_back(point);
    const auto best = std::min_element(points.begin(), points.end(), lower_score);
    if (point.score > kClearlyRisen * best->score && points.end() - best > 3) break;
  }
  if (points.empty()) {
    throw Error("the logs are too short, or sampled too slowly, to choose a cut-off", logs.front().file,
                "record at 100 Hz or more for some seconds, or give the cut-off");
  }
  return points;
}

double best_cutoff_hz(const std::vector<CutoffPoint>& points) {
  return std::min_element(points.begin(), points.end(), lower_score)->cutoff_hz;
}

}  // namespace deltadyn
