#pragma once

/// \file
/// What a recorder exported, in whatever form: named channels with their own time. Nothing here knows about robots.

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace deltadyn {

/// Rows that several channels share.
struct Timeline {
  std::string name;  ///< of the time column or topic, for messages; empty: none
  std::string unit;  ///< what the stamps were given in, for messages
  /// N stamps after `origin_ns` [s]; empty: the recording does not say when its rows were taken
  Eigen::VectorXd t_s;
  std::int64_t origin_ns = 0;  ///< kept apart, as a double cannot hold nanoseconds since 1970
  std::vector<long> line;      ///< line (or message) of each row in the file, the first is 1
  [[nodiscard]] Eigen::Index rows() const { return static_cast<Eigen::Index>(line.size()); }
};

struct RecordedChannel {
  std::string name;                  ///< as the file has it
  std::vector<std::string> aliases;  ///< other names a column map may use
  std::string unit;                  ///< as the file or the custom of its form says; empty: unknown
  std::string quantity;              ///< if the form itself says so: "position", "velocity", "torque"
  int place = 0;                     ///< place of the joint in the recording from 1, if the form itself says so; else 0
  std::string joint;                 ///< its name, if the form itself says so
  std::size_t timeline = 0;          ///< index in Recording::timelines
  Eigen::VectorXd values;            ///< one a row of the timeline, NaN where the field is empty or no number
  /// To be added to every value: integers too long for a double are kept after their first
  std::int64_t origin = 0;
  double sample_time_s = 0.0;  ///< of the channel itself where the form says so, else 0
  long text_line = 0;          ///< line of the first field that is no number; 0: none
  std::string text;            ///< that field
  /// What the file says of the channel that was not applied, and why; empty: nothing
  std::string remark;
  bool clock = false;  ///< dates or times of day: values in s, origin in ns since 1970 (or midnight)
};

struct Recording {
  std::string file;
  std::string form;         ///< in plain words: "text separated by ';' with decimal comma"
  bool headerless = false;  ///< the columns have no names, only numbers from 1
  std::vector<Timeline> timelines;
  std::vector<RecordedChannel> channels;
  std::vector<std::string> notes;  ///< what was left out or mended, with line numbers
};

/// Reads an export, whose form is recognised from its content: delimited text (separator, decimal comma, quotes,
/// byte-order mark, UTF-16, preamble, units below or in the header), TwinCAT Scope, LinuxCNC halscope, rosbag2 (.db3 or
/// its folder, joint states). Throws Error(bad_input): unreadable or empty file, a binary form that is not read (with
/// the program that converts it), rows that do not fit the header (with the line).
/// \param topic  of a ROS bag with several topics of joint states; empty: the only one
[[nodiscard]] Recording read_recording(const std::string& path, const std::string& topic = {});

}  // namespace deltadyn
