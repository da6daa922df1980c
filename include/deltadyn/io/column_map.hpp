#pragma once

/// \file
/// Which column of a recording is which quantity of which drive, in which unit: read from a TOML file, guessed,
/// written.

#include <optional>
#include <string>
#include <vector>

#include "deltadyn/io/log_units.hpp"
#include "deltadyn/runtime/robot_description.hpp"

namespace deltadyn {

/// One channel. In SI units and on the drive's side it is sign * (scale * recorded + offset) [unit], brought to SI with
/// the constants below and through the gear: positions and their rates divided by gear_ratio, torques multiplied.
struct ChannelMap {
  int drive = 0;  ///< from 1
  Quantity quantity = Quantity::position;
  std::string source = {};  ///< name of the column
  std::string unit = {};    ///< as log_unit() knows it; empty: the one the recording states
  double scale = 1.0;
  double offset = 0.0;  ///< [unit]
  double sign = 1.0;    ///< 1 or -1
  /// Turns of the motor for one of the drive; where the recording is of the motor
  std::optional<double> gear_ratio = {};
  std::optional<double> torque_constant = {};  ///< [N m/A], of a prismatic drive without lead [N/A]
  std::optional<double> rated_torque = {};     ///< [N m], of a prismatic drive without lead [N]
  std::optional<double> counts_per_turn = {};  ///< of the encoder
  /// Of a spindle or belt [m per turn]: turns of a prismatic drive's motor to m
  std::optional<double> lead = {};
  std::optional<double> wrap = {};  ///< the recorded number begins again after this much (65536, 360, ...)
  double delay_s = 0.0;             ///< the recorded value is this much older than its time stamp
  long line = 0;                    ///< in the map file, for messages
};

struct ColumnMap {
  std::string file;               ///< where it was read from; empty: guessed
  std::string time_source;        ///< column of the time; empty: found by its name, or the recording's own
  std::string time_unit;          ///< "s", "ms", "us", "ns", "min", "filetime"; empty: as the recording states
  std::optional<double> rate_hz;  ///< of the rows where there is no time column
  std::optional<double> tick_s;   ///< length of a unit of the time column
  std::string topic;              ///< of a ROS bag
  std::vector<ChannelMap> channels;

  [[nodiscard]] const ChannelMap* find(Quantity quantity, int drive) const;
  [[nodiscard]] bool has(Quantity quantity) const;
};

/// Values for all channels, from flags; each list has one value for all drives or one for each. They win over the map.
struct MapDefaults {
  std::string time_source, time_unit, position_unit, velocity_unit, torque_unit, topic;
  std::optional<double> rate_hz;
  std::vector<double> gear_ratio, torque_constant, rated_torque, counts_per_turn, lead;

  /// That of a quantity; empty: not given.
  [[nodiscard]] std::string unit(Quantity quantity) const;
  /// Throws Error(usage) if a list has another number of values, or a value is not positive.
  void validate(int drives) const;
  /// Fills in the channels of a map.
  void apply(ColumnMap& map) const;
};

/// Reads
///     [time]
///     source = "Time"   # or rate_hz = 1000
///     unit = "ms"
///     [[channel]]
///     drive = 1
///     quantity = "position"
///     source = "Axis 1 [deg]"
/// with the further keys of ChannelMap (rated_torque_Nm, torque_constant_Nm_A, lead_m_turn, delay_s, ...). Throws
/// Error(bad_input) with file and line: no TOML, an unknown key, a drive that the robot does not have, one named twice.
[[nodiscard]] ColumnMap read_column_map(const std::string& path, const RobotDescription& robot);

/// One channel as lines of a map file.
[[nodiscard]] std::string to_toml(const ChannelMap& channel);
/// The whole map; `remarks` become comments at its top.
[[nodiscard]] std::string to_toml(const ColumnMap& map, const std::vector<std::string>& remarks);

/// Factor from [unit] to SI at the drive. Throws Error(bad_input) that names the constant that is missing, or the unit
/// that does not fit the drive. \param where  for messages
[[nodiscard]] double si_factor(const ChannelMap& channel, DriveKind kind, const std::string& where);

}  // namespace deltadyn
