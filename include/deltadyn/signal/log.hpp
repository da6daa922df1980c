#pragma once

/// \file
/// A recorded motion in memory, SI units.

#include <Eigen/Core>
#include <algorithm>
#include <string>
#include <vector>

#include "deltadyn/signal/log_finding.hpp"

namespace deltadyn {

struct Log {
  /// Marks of single samples.
  static constexpr char kMeasured = 0;
  static constexpr char kLeftOut = 1;  ///< filled in or spoilt: a row that feels this sample is no evidence
  /// Filled in, as good as measured: the error of the filling is no more than the noise
  static constexpr char kBridged = 2;

  std::string file;     ///< where it came from, for messages
  int part = 0;         ///< of a file that was split at its gaps: 1, 2, ...; 0: the file as a whole
  Eigen::VectorXd t_s;  ///< N time stamps, strictly increasing, even to rounding
  Eigen::MatrixXd q;    ///< N x drives [rad | m]
  Eigen::MatrixXd qd;   ///< N x drives or empty [rad/s | m/s]
  Eigen::MatrixXd qdd;  ///< N x drives or empty [rad/s^2 | m/s^2]
  Eigen::MatrixXd tau;  ///< N x drives [N m | N]; empty if the file holds a motion only
  /// Line of each sample in `file` (1 is the first line, 0: filled in); empty if not read from a file
  std::vector<long> line;
  std::vector<char> filled;  ///< mark of each sample; empty: all measured
  /// N x drives: the torque of this drive says nothing about the machine's motion here (cut off, servo off, drive at
  /// rest, where static friction takes any value); empty: nowhere.
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> torque_out;
  std::vector<std::string> notes;    ///< what the reader repaired or wants to say, with line numbers
  std::vector<LogFinding> findings;  ///< what checks found out about this log

  [[nodiscard]] Eigen::Index samples() const { return t_s.size(); }
  [[nodiscard]] Eigen::Index drives() const { return q.cols(); }
  [[nodiscard]] bool is_filled(Eigen::Index sample) const {
    return !filled.empty() && filled[static_cast<std::size_t>(sample)] != kMeasured;
  }
  [[nodiscard]] bool is_left_out(Eigen::Index sample) const {
    return !filled.empty() && filled[static_cast<std::size_t>(sample)] == kLeftOut;
  }
  /// Is one of samples [first, first + count) left out?
  [[nodiscard]] bool any_left_out(Eigen::Index first, Eigen::Index count) const {
    if (filled.empty()) return false;
    const auto begin = filled.begin() + first;
    return std::find(begin, begin + count, kLeftOut) != begin + count;
  }
  /// Marks samples [first, last) as no evidence.
  void leave_out(Eigen::Index first, Eigen::Index last) {
    filled.resize(static_cast<std::size_t>(samples()), kMeasured);
    std::fill(filled.begin() + first, filled.begin() + last, kLeftOut);
  }
  /// Marks samples [first, last) whose torque of one drive is no evidence.
  void leave_torque_out(Eigen::Index drive, Eigen::Index first, Eigen::Index last) {
    if (torque_out.size() == 0) torque_out.setConstant(samples(), drives(), false);
    torque_out.col(drive).segment(first, last - first).setConstant(true);
  }
  [[nodiscard]] double sample_time_s() const {
    return samples() < 2 ? 0.0 : (t_s(samples() - 1) - t_s(0)) / static_cast<double>(samples() - 1);
  }
};

}  // namespace deltadyn
