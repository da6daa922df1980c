#include "deltadyn/signal/log_check.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/signal/log_columns.hpp"
#include "deltadyn/signal/resample.hpp"
#include "deltadyn/signal/time_grid.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kLargestLimbAngle = 3.3;    // rad; no arm of a Delta turns beyond half a turn
constexpr double kLargestSampleTime = 0.2;   // s; slower sampling shows nothing of the dynamics
constexpr double kSmallestTravelRad = 0.01;  // less is not a motion
constexpr double kSmallestTravelM = 0.001;

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double quantile(std::vector<double> values, double share) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// One column of the log with its name.
struct Channel {
  Eigen::MatrixXd* block;
  Index drive;
  std::string name;
  bool position;
  [[nodiscard]] auto values() const { return block->col(drive); }
};

class Checker {
 public:
  Checker(Log& log, const RobotDescription& robot, const LogCheckOptions& options)
      : log_(log), robot_(robot), options_(options) {}

  LogFindings run() {
    check_counts();
    if (!options_.motion) {
      refuse_missing_numbers();
      check_positions();
      return findings_;
    }
    check_length();
    check_order();
    check_length();
    put_on_grid();
    fill_missing_numbers();
    move_to_grid();
    check_positions();
    repair_spikes();
    refuse_too_many_filled();
    check_excitation();
    check_stuck();
    check_saturation();
    return findings_;
  }

 private:
  [[nodiscard]] std::string where(Index sample, const std::string& column = {}) const {
    std::string text = log_.file.empty() ? "log" : log_.file;
    long line = 0;
    if (!log_.line.empty()) {
      // A sample that was filled in has no line of its own.
      for (Index i = sample; i >= 0 && line == 0; --i) line = log_.line[static_cast<std::size_t>(i)];
    }
    text += line > 0 ? fmt::format(", line {}", line) : fmt::format(", sample {}", sample + 1);
    if (!column.empty()) text += ", column " + column;
    return text;
  }

  void note(std::string text) {
    log_.notes.push_back(text);
    findings_.notes.push_back(std::move(text));
  }

  [[nodiscard]] std::vector<Channel> channels() {
    std::vector<Channel> result;
    for (Index d = 0; d < log_.q.cols(); ++d) {
      const DriveColumns names = drive_columns(robot_, static_cast<int>(d));
      result.push_back({&log_.q, d, names.q, true});
      if (log_.qd.size() > 0) result.push_back({&log_.qd, d, names.qd, true});
      if (log_.qdd.size() > 0) result.push_back({&log_.qdd, d, names.qdd, true});
      if (log_.tau.size() > 0) result.push_back({&log_.tau, d, names.tau, false});
    }
    return result;
  }

  void mark_filled(Index sample) {
    log_.filled.resize(static_cast<std::size_t>(log_.samples()), 0);
    char& flag = log_.filled[static_cast<std::size_t>(sample)];
    if (flag == 0) ++findings_.filled_samples;
    flag = 1;
  }

  /// Keeps the given samples, in this order.
  void keep(const std::vector<Index>& rows) {
    for (Eigen::MatrixXd* block : {&log_.q, &log_.qd, &log_.qdd, &log_.tau}) {
      if (block->size() > 0) *block = Eigen::MatrixXd((*block)(rows, Eigen::all));
    }
    log_.t_s = Eigen::VectorXd(log_.t_s(rows));
    if (!log_.line.empty()) {
      std::vector<long> lines;
      for (const Index row : rows) lines.push_back(log_.line[static_cast<std::size_t>(row)]);
      log_.line = std::move(lines);
    }
  }

  void check_counts() const {
    const Index n = log_.samples();
    const Index drives = robot_.drives();
    const auto fits = [&](const Eigen::MatrixXd& block, bool needed) {
      return (block.size() == 0 && !needed) || (block.rows() == n && block.cols() == drives);
    };
    if (n == 0) throw Error("the log has no samples", log_.file, "check that the recording is complete");
    if (!fits(log_.q, true) || !fits(log_.qd, false) || !fits(log_.qdd, false) || !fits(log_.tau, false)) {
      throw Error(fmt::format("the log has not one value a drive and sample ({} samples, {} drives)", n, drives), log_.file,
                  "give the robot file that fits the log");
    }
    if (!log_.line.empty() && static_cast<Index>(log_.line.size()) != n) {
      throw Error("the log has not one line number a sample", log_.file, "leave Log::line empty if it is not known");
    }
  }

  void refuse_missing_numbers() {
    for (const Channel& channel : channels()) {
      for (Index i = 0; i < log_.samples(); ++i) {
        if (!std::isfinite(channel.values()(i))) {
          throw Error("a number is missing or not finite", where(i, channel.name), "remove the row or correct the value");
        }
      }
    }
  }

  void check_length() const {
    const Index n = log_.samples();
    const double duration = n < 2 ? 0.0 : log_.t_s(n - 1) - log_.t_s(0);
    if (n < options_.min_samples || (std::isfinite(duration) && duration >= 0 && duration < options_.min_duration_s)) {
      throw Error(fmt::format("the log is too short: {} samples, {:.4g} s", n, std::isfinite(duration) ? duration : 0.0),
                  log_.file,
                  fmt::format("record at least {} samples and {:.4g} s; to identify a robot, some seconds of varied motion",
                              options_.min_samples, options_.min_duration_s));
    }
  }

  void check_order() {
    std::vector<Index> rows;
    for (Index i = 0; i < log_.samples(); ++i) {
      if (!std::isfinite(log_.t_s(i))) {
        throw Error("the time stamp is missing or not finite", where(i, "t_s"), "remove the row or correct the time");
      }
      if (!rows.empty()) {
        const Index previous = rows.back();
        if (log_.t_s(i) < log_.t_s(previous)) {
          throw Error(fmt::format("the time stamps decrease, from {:.9g} s to {:.9g} s", log_.t_s(previous), log_.t_s(i)),
                      where(i, "t_s"), "give every recording its own file, in the order of time");
        }
        if (log_.t_s(i) == log_.t_s(previous)) {
          if (!same_row(i, previous)) {
            throw Error(fmt::format("the time stamp {:.9g} s is repeated, with other values", log_.t_s(i)), where(i, "t_s"),
                        "write the time with more digits, or remove one of the rows");
          }
          ++findings_.dropped_duplicates;
          if (findings_.dropped_duplicates <= 5) note(fmt::format("{}: the row is there twice, once was enough", where(i)));
          continue;
        }
      }
      rows.push_back(i);
    }
    if (findings_.dropped_duplicates > 5) {
      note(fmt::format("{}: {} rows in all were there twice", log_.file, findings_.dropped_duplicates));
    }
    if (static_cast<Index>(rows.size()) != log_.samples()) keep(rows);
  }

  [[nodiscard]] bool same_row(Index a, Index b) {
    const auto all = channels();
    return std::all_of(all.begin(), all.end(), [&](const Channel& channel) {
      const double x = channel.values()(a);
      const double y = channel.values()(b);
      return x == y || (std::isnan(x) && std::isnan(y));
    });
  }

  /// Adds the samples that are missing in time, without values yet.
  void put_on_grid() {
    grid_ = fit_time_grid(log_.t_s);
    findings_.largest_jitter = grid_.jitter;
    if (grid_.step_s > kLargestSampleTime) {
      throw Error(fmt::format("the samples are {:.4g} s apart", grid_.step_s), where(0, "t_s"),
                  "give the time in seconds; record with at least 100 samples a second");
    }
    for (std::size_t i = 1; i < grid_.index.size(); ++i) {
      const Index missing = grid_.index[i] - grid_.index[i - 1] - 1;
      if (missing > options_.max_filled_gap) {
        const auto sample = static_cast<Index>(i);
        throw Error(fmt::format("a gap of {:.4g} s in the time stamps, where the samples are {:.4g} s apart",
                                log_.t_s(sample) - log_.t_s(sample - 1), grid_.step_s),
                    where(sample, "t_s"), "cut the log here into two files and give both");
      }
    }
    if (grid_.jitter > options_.max_resampled_jitter) {
      throw Error(fmt::format("the time stamps are uneven: this one is {:.4g} s away from an even step of {:.4g} s",
                              grid_.jitter * grid_.step_s, grid_.step_s),
                  where(grid_.worst, "t_s"), "record at a fixed rate, with the time stamps of the controller");
    }
    const Index wanted = grid_.index.back() + 1;
    if (wanted == log_.samples()) return;

    const Index had = log_.samples();
    Eigen::VectorXd t_s(wanted);
    for (Index k = 0; k < wanted; ++k) t_s(k) = grid_.start_s + static_cast<double>(k) * grid_.step_s;
    std::vector<long> lines(log_.line.empty() ? 0 : static_cast<std::size_t>(wanted), 0);
    std::vector<char> present(static_cast<std::size_t>(wanted), 0);
    for (std::size_t i = 0; i < grid_.index.size(); ++i) {
      const auto k = static_cast<std::size_t>(grid_.index[i]);
      present[k] = 1;
      t_s(grid_.index[i]) = log_.t_s(static_cast<Index>(i));
      if (!lines.empty()) lines[k] = log_.line[i];
      if (i > 0 && grid_.index[i] > grid_.index[i - 1] + 1) {
        note(fmt::format("{}: {} sample(s) missing before this one, filled in and left out of fits", where(static_cast<Index>(i)),
                         grid_.index[i] - grid_.index[i - 1] - 1));
      }
    }
    for (Eigen::MatrixXd* block : {&log_.q, &log_.qd, &log_.qdd, &log_.tau}) {
      if (block->size() == 0) continue;
      Eigen::MatrixXd wider = Eigen::MatrixXd::Constant(wanted, block->cols(), kNan);
      for (Index i = 0; i < had; ++i) wider.row(grid_.index[static_cast<std::size_t>(i)]) = block->row(i);
      *block = std::move(wider);
    }
    log_.t_s = std::move(t_s);
    log_.line = std::move(lines);
    for (Index k = 0; k < wanted; ++k) {
      if (present[static_cast<std::size_t>(k)] == 0) mark_filled(k);
    }
  }

  void fill_missing_numbers() {
    const Index n = log_.samples();
    for (Channel& channel : channels()) {
      auto values = channel.block->col(channel.drive);
      Index i = 0;
      while (i < n) {
        if (std::isfinite(values(i))) {
          ++i;
          continue;
        }
        Index end = i;
        while (end < n && !std::isfinite(values(end))) ++end;
        if (i == 0 || end == n) {
          throw Error("a number is missing or not finite at the very " + std::string(i == 0 ? "start" : "end"),
                      where(i, channel.name), "remove the rows without numbers");
        }
        if (end - i > options_.max_filled_gap) {
          throw Error(fmt::format("{} samples in a row without a number", end - i), where(i, channel.name),
                      "cut the log here into two files and give both");
        }
        fill(channel, i, end);
        for (Index k = i; k < end; ++k) {
          if (log_.is_filled(k)) continue;  // already told
          note(fmt::format("{}: no number, filled in and left out of fits", where(k, channel.name)));
          mark_filled(k);
        }
        i = end;
      }
    }
  }

  /// Replaces [begin, end) from the neighbours: positions by a cubic, torque by a line, as its noise would swing a cubic.
  void fill(Channel& channel, Index begin, Index end) {
    auto values = channel.block->col(channel.drive);
    std::vector<double> t;
    std::vector<double> v;
    const int each_side = channel.position ? 2 : 1;
    int count = 0;
    Index first = begin;
    for (Index k = begin - 1; k >= 0 && count < each_side; --k) {
      if (!std::isfinite(values(k))) continue;
      ++count;
      first = k;
    }
    count = 0;
    for (Index k = first; k < log_.samples() && count < each_side; ++k) {
      if (!std::isfinite(values(k)) || (k >= begin && k < end)) continue;
      t.push_back(log_.t_s(k));
      v.push_back(values(k));
      if (k >= end) ++count;
    }
    const Eigen::Map<const Eigen::VectorXd> knots(t.data(), static_cast<Index>(t.size()));
    const Eigen::Map<const Eigen::VectorXd> known(v.data(), static_cast<Index>(v.size()));
    for (Index k = begin; k < end; ++k) {
      values(k) = channel.position ? interpolate_cubic(knots, known, log_.t_s(k)) : interpolate_linear(knots, known, log_.t_s(k));
    }
  }

  void move_to_grid() {
    constexpr double kRounding = 1e-6;
    if (grid_.jitter <= kRounding && findings_.filled_samples == 0) return;
    Eigen::VectorXd even(log_.samples());
    for (Index k = 0; k < log_.samples(); ++k) even(k) = grid_.start_s + static_cast<double>(k) * grid_.step_s;
    if (grid_.jitter > options_.max_stamp_jitter) {
      for (Eigen::MatrixXd* block : {&log_.q, &log_.qd, &log_.qdd, &log_.tau}) {
        if (block->size() > 0) *block = resample(log_.t_s, *block, even);
      }
      findings_.resampled = true;
      note(fmt::format(
          "{}: the time stamps jitter by up to {:.2g} % of the sample time; the log was moved to even steps of {:.6g} s",
          where(grid_.worst, "t_s"), 100.0 * grid_.jitter, grid_.step_s));
    }
    log_.t_s = std::move(even);
  }

  void check_positions() const {
    for (Index d = 0; d < log_.q.cols(); ++d) {
      const auto drive = static_cast<int>(d);
      const std::string column = drive_columns(robot_, drive).q;
      const bool limb = static_cast<std::size_t>(d) < robot_.limbs.size();
      const bool delta = !robot_.parts.empty();
      Index at = 0;
      const double largest = log_.q.col(d).cwiseAbs().maxCoeff(&at);
      const double value = log_.q(at, d);
      if (limb && delta && robot_.kind_of_drive(drive) == DriveKind::revolute && largest > kLargestLimbAngle) {
        throw Error(fmt::format("an arm angle of {:.9g} rad is beyond half a turn; it looks like degrees", value),
                    where(at, column), fmt::format("name the column q{}_deg, or convert it to rad", d + 1));
      }
      if (limb && delta && robot_.kind_of_drive(drive) == DriveKind::prismatic) {
        const auto& geometry = robot_.limbs[static_cast<std::size_t>(d)];
        const double reach = 10.0 * (geometry.strut + geometry.p_WD.norm() + geometry.p_DE_0.norm());
        if (largest > reach) {
          throw Error(fmt::format("a carriage position of {:.9g} m is far beyond the robot; it looks like millimetres", value),
                      where(at, column), "convert the column to m");
        }
      }
      if (!options_.motion || log_.samples() < 3) continue;
      const double allowed = robot_.limits[static_cast<std::size_t>(d)].velocity;
      if (!std::isfinite(allowed) || allowed <= 0) continue;
      std::vector<double> speeds;
      for (Index i = 0; i + 1 < log_.samples(); ++i)
        speeds.push_back(std::abs(log_.q(i + 1, d) - log_.q(i, d)) / log_.sample_time_s());
      const double usual_largest = quantile(speeds, 0.95);
      if (usual_largest > 10.0 * allowed) {
        throw Error(
            fmt::format(
                "a velocity of {:.4g} is far beyond the drive's limit of {:.4g} (SI); positions or time have another unit",
                usual_largest, allowed),
            where(0, column), "give positions in rad or m, or name the column _deg; give the time in seconds");
      }
    }
  }

  /// Distance of each sample from the cubic through its four neighbours.
  [[nodiscard]] static double surprise(const Eigen::Ref<const Eigen::VectorXd>& v, Index i) {
    return v(i) - (4.0 * (v(i - 1) + v(i + 1)) - (v(i - 2) + v(i + 2))) / 6.0;
  }

  void repair_spikes() {
    const Index n = log_.samples();
    if (n < 12) return;
    for (Channel& channel : channels()) {
      if (channel.block != &log_.q && channel.block != &log_.tau) continue;
      Eigen::VectorXd values = channel.values();
      std::vector<double> size(static_cast<std::size_t>(n), 0.0);
      for (Index i = 2; i + 2 < n; ++i) size[static_cast<std::size_t>(i)] = std::abs(surprise(values, i));
      std::vector<double> moving;
      for (const double s : size) {
        if (s > 0) moving.push_back(s);
      }
      const double floor = options_.outlier_ratio * median(moving);
      for (Index i = 2; i + 2 < n; ++i) {
        const double here = size[static_cast<std::size_t>(i)];
        if (here <= floor || here <= 1e-12 * values.cwiseAbs().maxCoeff()) continue;
        const double nearby = largest_nearby(size, i);
        if (here <= options_.outlier_ratio * nearby / 5.0) continue;
        bool peak = true;
        for (Index k = i - 2; k <= i + 2; ++k) peak = peak && size[static_cast<std::size_t>(k)] <= here;
        if (!peak) continue;
        if (is_single_spike(values, i, here, nearby)) {
          note(fmt::format("{}: the value {:.9g} is a spike of one sample, replaced and left out of fits", where(i, channel.name),
                           values(i)));
          fill(channel, i, i + 1);
          values = channel.values();
          for (Index k = std::max<Index>(2, i - 2); k <= std::min(n - 3, i + 2); ++k) {
            size[static_cast<std::size_t>(k)] = std::abs(surprise(values, k));
          }
          mark_filled(i);
        } else if (channel.position && is_jump(values, i)) {
          check_stuck();  // an encoder that reads again jumps too, and then the cause is worth more than the jump
          throw Error(fmt::format("the position jumps, from {:.9g} to {:.9g}", values(i - 1), values(i + 1)),
                      where(i, channel.name),
                      "unwrap the angle if it was wrapped; else look for lost encoder counts and cut the log here");
        }
      }
    }
  }

  /// Largest surprise around sample i, without those that a spike at i causes itself.
  [[nodiscard]] static double largest_nearby(const std::vector<double>& size, Index i) {
    constexpr Index kWindow = 25;
    const auto n = static_cast<Index>(size.size());
    double largest = 0;
    for (Index k = std::max<Index>(2, i - kWindow); k <= std::min(n - 3, i + kWindow); ++k) {
      if (std::abs(k - i) > 3) largest = std::max(largest, size[static_cast<std::size_t>(k)]);
    }
    return largest;
  }

  /// A step or a kink also surprises, but stays when the sample is replaced.
  [[nodiscard]] static bool is_single_spike(const Eigen::Ref<const Eigen::VectorXd>& values, Index i, double size,
                                            double nearby) {
    const Index first = std::max<Index>(0, i - 4);
    Eigen::VectorXd mended = values.segment(first, std::min<Index>(9, values.size() - first));
    const Index centre = i - first;
    mended(centre) -= surprise(mended, centre);
    double left = 0;
    for (Index k = std::max<Index>(2, centre - 2); k <= std::min(mended.size() - 3, centre + 2); ++k) {
      left = std::max(left, std::abs(surprise(mended, k)));
    }
    return left < 0.1 * size + nearby;
  }

  /// A kink (a hard stop) surprises too, but its steps are no larger than those around it.
  [[nodiscard]] static bool is_jump(const Eigen::Ref<const Eigen::VectorXd>& values, Index i) {
    constexpr Index kWindow = 25;
    const auto step = [&](Index k) { return std::abs(values(k + 1) - values(k)); };
    double around = 0;
    for (Index k = std::max<Index>(0, i - kWindow); k < std::min(values.size() - 1, i + kWindow); ++k) {
      if (std::abs(k - i) > 3) around = std::max(around, step(k));
    }
    return std::max(step(i - 1), step(i)) > 4.0 * around;
  }

  void refuse_too_many_filled() const {
    const double share = static_cast<double>(findings_.filled_samples) / static_cast<double>(log_.samples());
    // One sample must be allowed in a log of any length.
    if (share > options_.max_filled_share && findings_.filled_samples > options_.max_filled_gap) {
      const auto first = std::find(log_.filled.begin(), log_.filled.end(), 1) - log_.filled.begin();
      throw Error(fmt::format("{:.2g} % of the samples are missing or spoilt, the first one here", 100.0 * share), where(first),
                  "look for lost packets or a loose encoder cable, and record again");
    }
  }

  [[nodiscard]] double travel(Index drive, Index begin, Index end) const {
    const auto part = log_.q.col(drive).segment(begin, end - begin);
    return part.maxCoeff() - part.minCoeff();
  }

  [[nodiscard]] bool moves(Index drive) const {
    const bool turns = robot_.kind_of_drive(static_cast<int>(drive)) == DriveKind::revolute;
    return travel(drive, 0, log_.samples()) > (turns ? kSmallestTravelRad : kSmallestTravelM);
  }

  void check_excitation() {
    std::vector<std::string> still;
    for (Index d = 0; d < log_.drives(); ++d) {
      if (!moves(d)) still.push_back(drive_columns(robot_, static_cast<int>(d)).q);
    }
    if (static_cast<Index>(still.size()) == log_.drives()) {
      throw Error("nothing moves, so nothing can be learned from the log", log_.file,
                  "record a motion that uses the workspace, for example one of delta-excite");
    }
    for (const std::string& column : still) note(fmt::format("{}: column {} hardly moves", log_.file, column));
  }

  void check_stuck() {
    const Index n = log_.samples();
    const auto shortest = std::max<Index>(5, static_cast<Index>(std::lround(options_.stuck_time_s / log_.sample_time_s())));
    for (Index d = 0; d < log_.drives(); ++d) {
      const Eigen::VectorXd q = log_.q.col(d);
      const std::string column = drive_columns(robot_, static_cast<int>(d)).q;
      std::vector<double> steps;
      std::vector<double> bends;
      for (Index i = 1; i < n; ++i) steps.push_back(std::abs(q(i) - q(i - 1)));
      for (Index i = 1; i + 1 < n; ++i) bends.push_back(std::abs(q(i + 1) - 2.0 * q(i) + q(i - 1)));
      const double largest_step = quantile(steps, 0.995);
      const double largest_bend = quantile(bends, 0.995);
      Index begin = 0;
      while (begin < n) {
        Index end = begin + 1;
        while (end < n && q(end) == q(begin)) ++end;
        if (end - begin >= shortest) {
          // A drive that stops by itself slows down; an encoder that fails freezes in motion, or jumps when it reads again.
          const double before = begin >= 4 ? std::abs(q(begin) - q(begin - 3)) / 3.0 : 0.0;
          const double after = end + 3 < n ? std::abs(q(end + 3) - q(end)) / 3.0 : 0.0;
          const double jump = end < n ? std::abs(q(end) - q(end - 1)) : 0.0;
          const bool frozen_in_motion = before > 8.0 * largest_bend || after > 8.0 * largest_bend;
          const bool jumps = jump > 2.0 * largest_step && jump > 8.0 * largest_bend;
          if (frozen_in_motion || jumps || others_move(d, begin, end)) {
            throw Error(fmt::format("the position stays at exactly {:.9g} for {:.4g} s while the robot moves: a stuck encoder",
                                    q(begin), static_cast<double>(end - begin) * log_.sample_time_s()),
                        where(begin, column),
                        "check the encoder and its cable, and record again; or cut this part out of the log");
          }
        }
        begin = end;
      }
    }
  }

  /// All other limb drives travel far while this one rests: the closed loops of a Delta make that a rare motion.
  [[nodiscard]] bool others_move(Index drive, Index begin, Index end) const {
    const auto limbs = static_cast<Index>(robot_.limbs.size());
    if (robot_.parts.empty() || drive >= limbs || limbs < 2) return false;
    for (Index other = 0; other < limbs; ++other) {
      if (other != drive && travel(other, begin, end) < 0.2 * travel(other, 0, log_.samples())) return false;
      if (other != drive && !moves(other)) return false;
    }
    return true;
  }

  void check_saturation() {
    const Index n = log_.samples();
    for (Index d = 0; d < log_.tau.cols(); ++d) {
      const Eigen::VectorXd tau = log_.tau.col(d);
      const std::string column = drive_columns(robot_, static_cast<int>(d)).tau;
      const double highest = tau.maxCoeff();
      const double lowest = tau.minCoeff();
      if (highest == lowest) {
        if (!moves(d)) continue;
        throw Error(fmt::format("the torque is always {:.9g} while the drive moves", highest), where(0, column),
                    "check that the torque was recorded");
      }
      // Rows in a run of at least three equal values at the extreme. Where the other values repeat too, equality means nothing.
      Index clipped = 0;
      Index first = -1;
      Index repeated_elsewhere = 0;
      std::vector<Index> rows;
      Index begin = 0;
      while (begin < n) {
        Index end = begin + 1;
        while (end < n && tau(end) == tau(begin)) ++end;
        const bool extreme = tau(begin) == highest || tau(begin) == lowest;
        if (extreme && end - begin >= 3) {
          if (first < 0) first = begin;
          clipped += end - begin;
          for (Index i = begin; i < end; ++i) rows.push_back(i);
        } else {
          repeated_elsewhere += end - begin - 1;
        }
        begin = end;
      }
      if (clipped < 6 || repeated_elsewhere > (n - clipped) / 5) continue;
      const double share = static_cast<double>(clipped) / static_cast<double>(n);
      if (share > options_.max_saturated_share) {
        throw Error(
            fmt::format(
                "the torque is at its extreme ({:.9g} or {:.9g}) in {:.2g} % of the samples, the first one here: it is cut off",
                lowest, highest, 100.0 * share),
            where(first, column), "record a gentler motion, or widen the range of the recorder");
      }
      for (const Index i : rows) mark_filled(i);
      note(fmt::format("{}: the torque is cut off at {:.9g} or {:.9g} from here on in {} samples, left out of fits",
                       where(first, column), lowest, highest, clipped));
    }
  }

  Log& log_;
  const RobotDescription& robot_;
  const LogCheckOptions& options_;
  LogFindings findings_;
  TimeGrid grid_;
};

}  // namespace

void LogCheckOptions::validate() const {
  const auto demand = [](bool fine, const char* what) {
    if (!fine) throw Error(what, "log check options", "", ExitCode::usage);
  };
  demand(max_filled_gap >= 0 && max_filled_gap <= 100, "max_filled_gap must be 0 to 100 samples");
  demand(max_filled_share >= 0 && max_filled_share <= 1, "max_filled_share must be 0 to 1");
  demand(max_stamp_jitter >= 0 && max_stamp_jitter <= max_resampled_jitter && max_resampled_jitter < 0.5,
         "the jitter limits must be 0 <= max_stamp_jitter <= max_resampled_jitter < 0.5");
  demand(min_samples >= 12, "min_samples must be at least 12");
  demand(min_duration_s >= 0, "min_duration_s must not be negative");
  demand(max_saturated_share >= 0 && max_saturated_share <= 1, "max_saturated_share must be 0 to 1");
  demand(stuck_time_s > 0, "stuck_time_s must be positive");
  demand(outlier_ratio >= 5, "outlier_ratio must be at least 5");
}

LogFindings check_and_repair(Log& log, const RobotDescription& robot, const LogCheckOptions& options) {
  options.validate();
  return Checker(log, robot, options).run();
}

}  // namespace deltadyn
