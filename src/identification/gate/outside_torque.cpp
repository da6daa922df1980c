#include "outside_torque.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "deltadyn/identification/prediction.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/statistics.hpp"
#include "deltadyn/signal/fir_decimator.hpp"

#include "../data_fold.hpp"
#include "../least_squares.hpp"

namespace deltadyn::gate {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Pushes last some tenths of a second; encoder noise and vibration are far below them here
constexpr double kBand_hz = 3;
constexpr double kThin_hz = 60;     // rate that this band needs: long logs cost no more than they must
constexpr double kThinPass = 0.3;   // of that rate: the low pass in front of it
constexpr double kStrong = 8;       // robust standard deviations of the residual, and the largest torque of the drive
constexpr double kWeak = 6;         // the same in a log in which somebody pushes, and ...
constexpr double kWeakShare = 0.5;  // ... this share of the rms torque
constexpr double kEnd = 2.5;        // a stretch goes on as long as the residual stays above
constexpr double kMostOfMotion = 0.25;
constexpr int kRobustPasses = 12;  // of the robust fit
constexpr double kTukey = 4.685;   // 95 % efficient for normal noise
constexpr Index kFewestFitRows = 30;
constexpr Index kRowsPerBlock = 256;

/// The log at the rate that the band needs.
Log thinned(const Log& log) {
  const double rate_hz = 1.0 / log.sample_time_s();
  const int factor = static_cast<int>(rate_hz / kThin_hz);
  if (factor < 2) return log;
  const FirDecimator pass(rate_hz, kThinPass * rate_hz / factor, factor);
  const Index rows = pass.outputs(log.samples());
  if (rows < 2) return log;
  Eigen::MatrixXd in(log.samples(), 2 * log.drives()), out(rows, 2 * log.drives());
  in << log.q, log.tau;
  pass.apply(in, out);
  Log thin;
  thin.file = log.file;
  thin.q = out.leftCols(log.drives());
  thin.tau = out.rightCols(log.drives());
  thin.t_s.resize(rows);
  if (log.torque_out.size() > 0) thin.torque_out.resize(rows, log.drives());
  const Index width = 2 * pass.half_width() + 1;
  for (Index k = 0; k < rows; ++k) {
    const Index first = pass.centre(k) - pass.half_width();
    thin.t_s(k) = log.t_s(pass.centre(k));
    if (log.torque_out.size() > 0) thin.torque_out.row(k) = log.torque_out.middleRows(first, width).colwise().any();
    if (log.any_left_out(first, width)) thin.leave_out(k, k + 1);
  }
  return thin;
}

/// One log under the low pass.
struct Seen {
  std::size_t log = 0;
  PreparedLog prepared;
  Prediction rows;
  std::vector<Eigen::MatrixXd> Y;  ///< one a drive: rows x parameters; every pass of the fit needs them

  Seen(const Robot& robot, std::size_t number, PreparedLog ready)
      : log(number),
        prepared(std::move(ready)),
        rows(predict(robot, prepared, VectorXd::Zero(robot.parameters()), 1)),
        Y(static_cast<std::size_t>(robot.drives()), Eigen::MatrixXd(prepared.rows, robot.parameters())) {
    for (Index first = 0; first < prepared.rows; first += kRowsPerBlock) {
      RowBlock block;
      read_rows(robot, prepared, first, std::min(kRowsPerBlock, prepared.rows - first), block);
      for (std::size_t j = 0; j < Y.size(); ++j) Y[j].middleRows(first, block.rows()) = block.Y[j];
    }
  }

  /// Adds the rows of one drive that may be used, scaled by the square root of their weight.
  void fold(int drive, const RowWeight& weight, DriveFold& out) const {
    const Eigen::MatrixXd& all = Y[static_cast<std::size_t>(drive)];
    for (Index first = 0; first < all.rows(); first += kRowsPerBlock) {
      const Index end = std::min(all.rows(), first + kRowsPerBlock);
      Eigen::MatrixXd used(end - first, all.cols());
      VectorXd tau(end - first);
      Index count = 0;
      for (Index k = first; k < end; ++k) {
        if (rows.use(k, drive) == RowUse::unusable) continue;
        const double scale = weight ? std::sqrt(weight(drive, rows.tau(k, drive) - rows.model(k, drive))) : 1.0;
        used.row(count) = scale * all.row(k);
        tau(count++) = scale * rows.tau(k, drive);
      }
      if (count > 0) out.add(used.topRows(count), tau.head(count));
    }
  }
};

/// A fit that a minority of rows cannot pull.
class RobustFit {
 public:
  RobustFit(const Robot& robot, const BaseParameters& base, std::vector<Seen>& seen)
      : robot_(robot), base_(base), seen_(seen) {}

  /// False if the motion does not tell the parameters.
  bool run() {
    try {
      VectorXd p = solve({});
      for (int pass = 0; pass < kRobustPasses; ++pass) {
        look(p);
        // The first half of the passes only damps what stands out (Huber's weights), the others leave it out (Tukey's).
        const bool damp = 2 * pass < kRobustPasses;
        p = solve([&](int drive, double residual) {
          const double u = std::abs(residual) / (kTukey * scale_[static_cast<std::size_t>(drive)]);
          if (damp) return u < 0.3 ? 1.0 : 0.3 / u;
          return u < 1 ? std::pow(1 - u * u, 2) : 0.0;
        });
      }
      look(p);
      return true;
    } catch (const Error&) {
      return false;  // too few rows; a pose out of reach is refused by others, with its line
    }
  }

  [[nodiscard]] double scale(int drive) const { return scale_[static_cast<std::size_t>(drive)]; }

 private:
  [[nodiscard]] VectorXd solve(const RowWeight& weight) const {
    std::vector<DriveFold> folds(static_cast<std::size_t>(robot_.drives()), DriveFold(robot_.parameters()));
    for (const Seen& one : seen_) {
      for (std::size_t j = 0; j < folds.size(); ++j) one.fold(static_cast<int>(j), weight, folds[j]);
    }
    return any_parameters(base_, estimate_base_parameters(base_, folds).value, robot_.parameters());
  }

  /// Residuals with these parameters and their robust deviations.
  void look(const VectorXd& p) {
    std::vector<std::vector<double>> size(static_cast<std::size_t>(robot_.drives()));
    for (Seen& one : seen_) {
      for (std::size_t j = 0; j < one.Y.size(); ++j) one.rows.model.col(static_cast<Index>(j)) = one.Y[j] * p;
      const Eigen::MatrixXd r = one.rows.residual();
      for (Index k = 0; k < r.rows(); ++k) {
        for (Index j = 0; j < r.cols(); ++j) {
          if (one.rows.use(k, j) != RowUse::unusable) size[static_cast<std::size_t>(j)].push_back(std::abs(r(k, j)));
        }
      }
    }
    scale_.clear();
    for (const std::vector<double>& one : size) scale_.push_back(std::max(kMedianToSigma * upper_median(one), 1e-12));
  }

  const Robot& robot_;
  const BaseParameters& base_;
  std::vector<Seen>& seen_;
  std::vector<double> scale_;
};

/// Consecutive rows that somebody pushes in.
struct Push {
  Index first = 0, last = 0;
  double largest = 0;
};

/// What one drive gave and did not give in a log.
class DriveRowsSeen {
 public:
  DriveRowsSeen(const Seen& seen, int drive, double scale)
      : residual_(seen.rows.residual().col(drive).cwiseAbs()),
        recorded_(residual_.size()),
        moves_(residual_.size()),
        scale_(scale) {
    // Rows at rest count as recorded, too: a push often begins there, and what is missing is more than static friction
    // can hold. Where the machine moves and the torque is left out (servo off), it is missing anyway.
    const PreparedLog& log = seen.prepared;
    const Index reach = log.low_pass->half_width(), inner = reach / 2;  // most of the low pass' weight is on this half
    for (Index k = 0; k < residual_.size(); ++k) {
      const Index at = sample_of_row(log, k), first = at - inner, count = 2 * inner + 1;
      const bool rests = log.rest.col(drive).segment(first, count).any();
      const bool out = log.torque_out.size() > 0 && log.torque_out.col(drive).segment(first, count).any();
      recorded_(k) = (rests || !out) && !log.any_left_out(at - reach, 2 * reach + 1);
      moves_(k) = recorded_(k) && !rests && !out;
    }
    const VectorXd tau = recorded_.select(seen.rows.tau.col(drive).array(), 0.0).matrix();
    moving_ = moves_.count();
    largest_torque_ = tau.size() > 0 ? tau.cwiseAbs().maxCoeff() : 0.0;
    rms_torque_ = std::sqrt(tau.squaredNorm() / std::max<double>(1.0, static_cast<double>(recorded_.count())));
  }

  [[nodiscard]] Index moving() const { return moving_; }
  [[nodiscard]] double largest_torque() const { return largest_torque_; }

  [[nodiscard]] std::vector<Push> pushes() const {
    std::vector<Push> out;
    const double strong = std::max(largest_torque_, kStrong * scale_);
    if (moving_ < kFewestFitRows || !(recorded_ && residual_.array() > strong).any()) return out;
    const double least = std::max(kWeakShare * rms_torque_, kWeak * scale_);
    for (Index k = 0; k < residual_.size(); ++k) {
      if (!above(k, least, strong)) continue;
      Push push{k, k, residual_(k)};
      while (push.first > 0 && above(push.first - 1, kEnd * scale_, strong)) --push.first;
      while (push.last + 1 < residual_.size() && above(push.last + 1, kEnd * scale_, strong)) ++push.last;
      push.largest = residual_.segment(push.first, push.last - push.first + 1).maxCoeff();
      k = push.last;
      out.push_back(push);
    }
    return out;
  }

  [[nodiscard]] Index moving_in(const Push& push) const {
    return moves_.segment(push.first, push.last - push.first + 1).count();
  }

 private:
  /// At rest static friction makes residuals that are no push.
  [[nodiscard]] bool above(Index row, double moving, double at_rest) const {
    return recorded_(row) && residual_(row) > (moves_(row) ? moving : at_rest);
  }

  VectorXd residual_;
  Eigen::Array<bool, Eigen::Dynamic, 1> recorded_, moves_;
  double scale_, largest_torque_ = 0, rms_torque_ = 0;
  Index moving_ = 0;
};

/// Marks the pushes in the log and puts them into words.
LogFinding leave_out(Log& log, int drive, const char* unit, const Prediction& rows, const DriveRowsSeen& seen,
                     const std::vector<Push>& pushes) {
  const double spacing = rows.rows() > 1 ? rows.t_s(1) - rows.t_s(0) : 0.0;
  std::string times;
  double largest = 0, length_s = 0;
  for (const Push& push : pushes) {
    const double from = rows.t_s(push.first) - spacing, to = rows.t_s(push.last) + spacing;
    largest = std::max(largest, push.largest);
    length_s += to - from;
    times += fmt::format("{}{:.4g} to {:.4g}", times.empty() ? "" : ", ", from, to);
    log.leave_torque_out(drive, std::ranges::lower_bound(log.t_s, from) - log.t_s.begin(),
                         std::ranges::upper_bound(log.t_s, to) - log.t_s.begin());
  }
  return {
      .level = FindingLevel::mended,
      .key = "outside_torque",
      .file = log.file,
      .drive = drive,
      .value = length_s,
      .unit = "s",
      .text = fmt::format("drive {} was pushed from outside (a hand, a stop, an impact): {:.3g} {} are missing where "
                          "the drive gives at most {:.3g}; left out: t_s = {} ({:.2g} s)",
                          drive + 1, largest, unit, seen.largest_torque(), times, length_s)};
}

std::vector<Seen> see(const Robot& robot, const std::vector<Log>& logs) {
  std::vector<Seen> seen;
  ProcessingOptions options;
  options.cutoff_hz = kBand_hz;
  options.periods = Periods::ignore;
  for (std::size_t l = 0; l < logs.size(); ++l) {
    try {
      seen.emplace_back(robot, l, prepare_log(robot, thinned(logs[l]), options));
    } catch (const Error&) {
      continue;  // too short for this band, or refused by others with better words
    }
  }
  return seen;
}

}  // namespace

std::vector<LogFinding> leave_out_outside_torque(const Robot& robot, const BaseParameters& base,
                                                 std::vector<Log>& logs) {
  std::vector<LogFinding> findings;
  std::vector<Seen> seen = see(robot, logs);
  if (seen.empty()) return findings;
  RobustFit fit(robot, base, seen);
  if (!fit.run()) return findings;
  for (const Seen& one : seen) {
    for (int j = 0; j < robot.drives(); ++j) {
      const DriveRowsSeen rows(one, j, fit.scale(j));
      const std::vector<Push> pushes = rows.pushes();
      Index out = 0;
      for (const Push& push : pushes) out += rows.moving_in(push);
      const double share = static_cast<double>(out) / std::max<double>(1.0, static_cast<double>(rows.moving()));
      if (pushes.empty() || share > kMostOfMotion) continue;
      const char* unit = robot.description().kind_of_drive(j) == DriveKind::revolute ? "N m" : "N";
      findings.push_back(leave_out(logs[one.log], j, unit, one.rows, rows, pushes));
    }
  }
  return findings;
}

}  // namespace deltadyn::gate
