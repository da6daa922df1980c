#pragma once

/// \file
/// The list of ways in which recorded positions may have to be read: one function a kind of fault.

#include <string>
#include <vector>

#include "deltadyn/runtime/robot.hpp"

#include "rows.hpp"

namespace deltadyn::gate {

/// A hypothesis about the positions, with its words.
struct PositionHypothesis {
  Reading reading;
  std::string key;    ///< of the finding, e.g. "position_sign"
  std::string words;  ///< "the position of drive 2 has the wrong sign"
  std::string mend;
  int drive = -1;             ///< from 0; -1: several
  bool drives_moved = false;  ///< the torques are in the order of the positions
  bool odd = false;           ///< a factor that is neither a unit nor a whole ratio, a zero at no right angle
  double changes = 0;         ///< how much is assumed: of two that explain alike, the one with less comes first
};

/// A factor or an offset that must be searched for: family(x) is the reading for one value.
struct PositionFamily {
  std::string key;
  std::vector<int> drives;        ///< the drives that it changes
  std::vector<double> start;      ///< values to begin the search with
  bool geometric = true;          ///< neighbours of a value differ by a ratio, not by a difference
  double step = 0.05;             ///< of `start`, as ratio minus one or as difference
  std::vector<double> sign = {};  ///< factor of an offset family's drives
  double changes = 1;
};

[[nodiscard]] std::vector<PositionHypothesis> position_hypotheses(const RobotDescription& robot);
[[nodiscard]] std::vector<PositionFamily> position_families(const RobotDescription& robot);

/// One member of a family with its words; named units are recognised within `tolerance` of the value.
[[nodiscard]] PositionHypothesis member(const PositionFamily& family, const RobotDescription& robot, double value,
                                        double tolerance);

/// Units, whole ratios or right angles near a value of a family, the likeliest first.
[[nodiscard]] std::vector<double> plausible_values(const PositionFamily& family, const RobotDescription& robot,
                                                   double value);

/// First `inner`, then `outer` on what it gives.
[[nodiscard]] Reading compose(const Reading& outer, const Reading& inner);

/// "drive 2", "drives 1, 2 and 3", "all drives".
[[nodiscard]] std::string drives_in_words(const std::vector<int>& drives, int all);

}  // namespace deltadyn::gate
