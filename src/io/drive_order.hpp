#pragma once

/// \file
/// Which drive each of several like-named joints or columns belongs to, as far as the names tell.

#include <string>
#include <vector>

namespace deltadyn {

struct DriveOrder {
  std::vector<long> places;  ///< drive of each name from 1; empty: the names tell no order
  std::string doubt;         ///< what was concluded beyond what the names say plainly, in words; empty: nothing
};

/// By the one number in which the names differ, wherever it stands in them (from 1 or from 0), or by letters a b c, u v
/// w, x y z. With `has_yaw` one name may stand apart ("yaw", "tool"): the last drive.
[[nodiscard]] DriveOrder order_by_names(const std::vector<std::string>& names, bool has_yaw);

/// Whether a joint is called as drive `drive` (from 1) in robot files, "drive2".
[[nodiscard]] bool is_named_as_drive(const std::string& joint, long drive);

}  // namespace deltadyn
