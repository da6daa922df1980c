#pragma once

/// \file
/// All hypotheses about signs, order, units and zeros of positions and torques, judged together: the one whose residual
/// falls most, and to that of a sound fit, wins; others that explain as much are said beside it.

#include <algorithm>
#include <string>
#include <vector>

#include "readings.hpp"
#include "torque_form.hpp"

namespace deltadyn::gate {

/// One way to read the log: positions by `reading`, torque of drive j is factor_j times column assignment[j].
struct Explanation {
  Reading reading;
  std::vector<int> assignment;
  Eigen::VectorXd factor;
  double residual = 1;     ///< relative, over all drives
  double unreachable = 0;  ///< share of the poses
  /// Residual of each drive with parameters of its own: what one machine for all drives could reach
  double alone = 0;
  double changes = 0;
  std::string key, words, mend;
  int drive = -1;
  bool odd = false;           ///< PositionHypothesis::odd
  double value = 0, std = 0;  ///< of a scale

  /// Adds what it says; key and mend are those of what is said first.
  void say(const std::string& key_of_it, const std::string& words_of_it, const std::string& mend_of_it) {
    words += (words.empty() ? "" : ", and ") + words_of_it;
    if (key.empty()) key = key_of_it;
    if (mend.empty()) mend = mend_of_it;
  }
  [[nodiscard]] bool torques_as_given() const {
    return std::ranges::is_sorted(assignment) && (factor.array() == 1.0).all();
  }
};

struct Judgement {
  Explanation as_given;
  double with_springs = 1;           ///< residual as given with a spring on every drive
  bool sound = true;                 ///< as given
  std::vector<Explanation> winners;  ///< empty: nothing explains the log clearly better than as it is
};

[[nodiscard]] Judgement judge(const Robot& robot, const BaseParameters& base, const Points& points);

}  // namespace deltadyn::gate
