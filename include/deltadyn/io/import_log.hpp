#pragma once

/// \file
/// From recordings of other tools to a log: what each column is, units, one time grid.

#include <string>
#include <vector>

#include "deltadyn/io/column_map.hpp"
#include "deltadyn/io/recording.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/signal/log.hpp"

namespace deltadyn {

struct ImportOptions {
  std::string map_file = {};  ///< column map; what it leaves open is guessed from the names
  MapDefaults defaults = {};  ///< from flags, win over the map
  bool need_torque = true;
  bool need_derivatives = false;
};

/// One line of what was taken for what.
struct TakenChannel {
  ChannelMap map;
  double factor = 1.0;   ///< from `map.unit` to SI at the drive, sign included
  double step_s = 0.0;   ///< usual sample time of the channel itself
  double rate_hz = 0.0;  ///< its rows over its time
  /// How it came to the grid: "as recorded", "interpolated from 4 ms", "low pass 400 Hz, then ..."
  std::string how;
};

struct ImportedLog {
  Log log;  ///< unchecked; time from zero; notes say what was taken for what
  ColumnMap map;
  std::vector<TakenChannel> taken;
  double step_s = 0.0;               ///< usual sample time of the grid
  std::string time_name, time_unit;  ///< where the grid's stamps are from
};

/// Recordings of one motion, read and understood as far as possible.
class LogImport {
 public:
  /// Reads the files: one, or several that hold different columns of the same motion.
  /// Throws Error(bad_input) for what cannot be read, and for files that are recordings of their own.
  LogImport(const std::vector<std::string>& files, const RobotDescription& robot, ImportOptions options);

  /// The map so far, with what was guessed.
  [[nodiscard]] const ColumnMap& map() const { return map_; }
  /// The map as a file to be mended: the guess, what is still open, and every column there is.
  [[nodiscard]] std::string map_text() const;
  /// Whether nothing is open that log() would ask for.
  [[nodiscard]] bool is_complete() const { return open_.empty(); }
  /// "text separated by ';' with decimal comma"
  [[nodiscard]] const std::string& form() const { return recording_.form; }
  [[nodiscard]] const Recording& recording() const { return recording_; }

  /// Brings all channels to SI units at the drives and to one grid, that of the positions.
  /// Throws Error(bad_input) with the next step for the first thing that is still open.
  [[nodiscard]] ImportedLog log() const;

 private:
  [[nodiscard]] bool is_taken(const RecordedChannel& channel) const;
  /// Says which joints of a machine with more of them than the robot has drives were taken, and which not.
  void note_joints_beyond(Quantity quantity);
  [[nodiscard]] std::string map_of_the_rest() const;
  [[nodiscard]] std::string open_time() const;

  const RobotDescription& robot_;
  ImportOptions options_;
  ColumnMap map_;
  Recording recording_;
  std::vector<Error> open_;  ///< what log() would ask for
};

/// The next step of an error, where a map to be mended is there already instead of one to be written.
/// \param map  its name
[[nodiscard]] std::string mend_in_map(std::string mend, const std::string& map);

}  // namespace deltadyn
