#include "deltadyn/report/log_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/report/format.hpp"

#include "drive_figures.hpp"

namespace deltadyn {
namespace {

constexpr double kEven = 1e-6;  // of the time between rows: rounding of the stamps
constexpr std::array<const char*, 8> kHead = {"drive",       "travel",       "position step",  "position noise",
                                              "torque step", "torque noise", "position fresh", "moving"};

/// Where the figure of a finding goes.
constexpr std::pair<const char*, double ChannelFigures::*> kFigures[] = {
    {"travel", &ChannelFigures::travel},
    {"step", &ChannelFigures::step},
    {"noise", &ChannelFigures::noise},
    {"torque_step", &ChannelFigures::torque_step},
    {"torque_noise", &ChannelFigures::torque_noise},
    {"stale", &ChannelFigures::fresh_every}};

void take(const LogFinding& f, LogFigures& log) {
  if (f.key == "rate_hz") log.rate_hz = f.value;
  if (f.key == "jitter" || f.key == "uneven_stamps") log.jitter = std::max(log.jitter, f.value);
  if (f.key == "lost_rows") log.lost_rows += f.value;
  if (f.key == "held_rows") log.held_rows += f.value;
  if (f.drive < 0 || static_cast<std::size_t>(f.drive) >= log.drives.size()) return;
  for (const auto& [key, figure] : kFigures) {
    double& place = log.drives[static_cast<std::size_t>(f.drive)].*figure;
    if (f.key == key) place = std::isnan(place) ? f.value : std::max(place, f.value);
  }
}

/// Share of the samples of all parts in which a drive moves.
void take_moving(const Log& part, LogFigures& log) {
  for (const LogFinding& f : part.findings) {
    if (f.key != "moving" || f.drive < 0 || static_cast<std::size_t>(f.drive) >= log.drives.size()) continue;
    double& share = log.drives[static_cast<std::size_t>(f.drive)].moving;
    const auto rows = static_cast<double>(part.samples()), before = static_cast<double>(log.rows);
    share = std::isnan(share) ? f.value : (share * before + f.value * rows) / (before + rows);
  }
}

/// A number with its unit in so many digits, as a page or a terminal shows it.
using Writer = std::string (*)(double, std::string_view, int);

std::string for_terminal(double value, std::string_view unit, int digits) {
  return std::isnan(value) ? "-" : fmt::format("{:.{}g} {}", value, digits, unit);
}

std::string rows_in_words(double every) {
  if (std::isnan(every)) return "-";
  return every > 1 ? fmt::format("every {:.3g} rows", every) : "every row";
}

std::array<std::string, 8> cells_of(const RobotDescription& robot, int j, const ChannelFigures& drive, Writer write) {
  const bool turning = robot.kind_of_drive(j) == DriveKind::revolute;
  const std::string length = turning ? "rad" : "m", effort = turning ? "N m" : "N";
  const auto step = [&](double value, const std::string& unit) {
    return value == 0 ? "not visible" : write(value, unit, 2);
  };
  return {std::to_string(j + 1),
          write(drive.travel, length, 3),
          step(drive.step, length),
          write(drive.noise, length, 2),
          step(drive.torque_step, effort),
          write(drive.torque_noise, effort, 2),
          rows_in_words(drive.fresh_every),
          write(100 * drive.moving, "%", 3)};
}

}  // namespace

std::vector<LogFigures> log_figures(const std::vector<Log>& logs) {
  std::vector<LogFigures> out;
  for (const Log& part : logs) {
    if (out.empty() || out.back().file != part.file || part.part <= 1) {
      out.emplace_back();
      out.back().file = part.file;
      out.back().drives.resize(static_cast<std::size_t>(part.drives()));
    }
    LogFigures& log = out.back();
    take_moving(part, log);
    for (const LogFinding& f : part.findings) take(f, log);
    log.rows += part.samples();
    log.seconds += part.samples() < 2 ? 0.0 : part.t_s(part.samples() - 1) - part.t_s(0);
  }
  return out;
}

std::string timing_in_words(const LogFigures& log) {
  const auto count = [](double rows, const char* what) {
    return rows > 0 ? fmt::format("{:.0f} {} {}", rows, rows == 1 ? "row" : "rows", what)
                    : fmt::format("no row {}", what);
  };
  return fmt::format("recorded at {:.6g} Hz, time stamps {}, {}, {}", log.rate_hz,
                     log.jitter <= kEven ? std::string("even")
                                         : fmt::format("even to {:.2g} % of the time between rows", 100 * log.jitter),
                     count(log.lost_rows, "lost"), count(log.held_rows, "repeated"));
}

std::vector<std::string> channel_lines(const RobotDescription& robot, const LogFigures& log) {
  std::vector<std::array<std::string, 8>> table(1);
  std::copy(kHead.begin(), kHead.end(), table.front().begin());
  for (std::size_t j = 0; j < log.drives.size(); ++j)
    table.push_back(cells_of(robot, static_cast<int>(j), log.drives[j], for_terminal));
  std::array<std::size_t, 8> width{};
  for (const auto& row : table) {
    for (std::size_t k = 0; k < row.size(); ++k) width[k] = std::max(width[k], row[k].size());
  }
  std::vector<std::string> lines = {
      fmt::format("{}: {} rows, {:.4g} s, {}", log.file, log.rows, log.seconds, timing_in_words(log))};
  for (const auto& row : table) {
    std::string line = " ";
    for (std::size_t k = 0; k < row.size(); ++k) {
      line += std::string((k == 0 ? 1 : 3) + width[k] - row[k].size(), ' ') + row[k];
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

void add_channel_table(HtmlReport& report, const RobotDescription& robot, const std::vector<LogFigures>& logs) {
  for (const LogFigures& log : logs) {
    std::vector<TableColumn> head;
    for (const char* name : kHead) head.push_back({name});
    Table table(std::move(head));
    for (std::size_t j = 0; j < log.drives.size(); ++j) {
      const auto cells = cells_of(robot, static_cast<int>(j), log.drives[j], format_number);
      table.row({cells.begin(), cells.end()});
    }
    if (!table.empty()) report.table(table, fmt::format("{}: {}.", short_name(log.file), timing_in_words(log)));
  }
}

}  // namespace deltadyn
