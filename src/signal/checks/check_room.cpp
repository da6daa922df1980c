#include "check_room.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>

#include "deltadyn/signal/log_columns.hpp"

namespace deltadyn::checks {
namespace {

constexpr double kSmallestTravelRad = 0.01;  // less is not a motion
constexpr double kSmallestTravelM = 0.001;
constexpr double kLongestFilled_s = 0.004;  // as many missing samples as fit into it are filled in

}  // namespace

std::vector<Channel> CheckRoom::channels() const {
  std::vector<Channel> result;
  for (Index d = 0; d < log.q.cols(); ++d) {
    const DriveColumns names = drive_columns(robot, static_cast<int>(d));
    result.push_back({&log.q, d, names.q, true});
    if (log.qd.size() > 0) result.push_back({&log.qd, d, names.qd, true});
    if (log.qdd.size() > 0) result.push_back({&log.qdd, d, names.qdd, true});
    if (log.tau.size() > 0) result.push_back({&log.tau, d, names.tau, false});
  }
  return result;
}

Index CheckRoom::longest_filled(double step_s) const {
  return std::max<Index>(kLongestFilledRows, static_cast<Index>(kLongestFilled_s / std::max(step_s, 1e-9)));
}

std::string CheckRoom::where(Index sample, const std::string& column) const {
  std::string text = log.file.empty() ? "log" : log.file;
  long line = 0;
  if (!log.line.empty()) {
    // A sample that was filled in has no line of its own.
    for (Index i = sample; i >= 0 && line == 0; --i) line = log.line[static_cast<std::size_t>(i)];
  }
  text += line > 0 ? fmt::format(", line {}", line) : fmt::format(", sample {}", sample + 1);
  if (!column.empty()) text += ", column " + column;
  return text;
}

void CheckRoom::tell(LogFinding finding, bool with_note) const {
  if (finding.file.empty()) finding.file = log.file;
  if (with_note && finding.level != FindingLevel::fine) log.notes.push_back(finding.text);
  log.findings.push_back(std::move(finding));
}

void CheckRoom::tell(FindingLevel level, const std::string& key, Index sample, const std::string& column, int drive,
                     double value, const std::string& unit, const std::string& sentence,
                     const std::string& mend) const {
  tell({.level = level,
        .key = key,
        .drive = drive,
        .value = value,
        .unit = unit,
        .text = where(sample, column) + ": " + sentence,
        .mend = mend});
}

void CheckRoom::mark_filled(Index sample, char mark) const {
  log.filled.resize(static_cast<std::size_t>(log.samples()), Log::kMeasured);
  char& flag = log.filled[static_cast<std::size_t>(sample)];
  if (flag != Log::kLeftOut) flag = mark;
}

double CheckRoom::travel(Index drive, Index begin, Index end) const {
  const auto part = log.q.col(drive).segment(begin, end - begin);
  return part.maxCoeff() - part.minCoeff();
}

bool CheckRoom::moves(Index drive) const {
  return travel(drive, 0, log.samples()) > (turns(drive) ? kSmallestTravelRad : kSmallestTravelM);
}

Log rows_of(const Log& log, const std::vector<Index>& rows) {
  Log out;
  out.file = log.file;
  out.part = log.part;
  out.t_s = log.t_s(rows);
  for (const auto& [from, to] :
       {std::pair{&log.q, &out.q}, {&log.qd, &out.qd}, {&log.qdd, &out.qdd}, {&log.tau, &out.tau}}) {
    if (from->size() > 0) *to = (*from)(rows, Eigen::all);
  }
  if (log.torque_out.size() > 0) out.torque_out = log.torque_out(rows, Eigen::all);
  for (const Index row : rows) {
    const auto at = static_cast<std::size_t>(row);
    if (!log.line.empty()) out.line.push_back(log.line[at]);
    if (!log.filled.empty()) out.filled.push_back(log.filled[at]);
  }
  out.notes = log.notes;
  out.findings = log.findings;
  return out;
}

Log rows_of(const Log& log, Index first, Index last) {
  std::vector<Index> rows(static_cast<std::size_t>(last - first));
  std::iota(rows.begin(), rows.end(), first);
  return rows_of(log, rows);
}

void CheckRoom::keep(const std::vector<Index>& rows) const {
  log = rows_of(log, rows);
}

}  // namespace deltadyn::checks
