#include "deltadyn/io/trajectory_file.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <vector>

#include "deltadyn/io/csv.hpp"
#include "deltadyn/io/log_file.hpp"
#include "deltadyn/io/output_file.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/signal/differentiate.hpp"
#include "deltadyn/signal/log_columns.hpp"
#include "deltadyn/signal/time_grid.hpp"
#include "deltadyn/trajectory/task_columns.hpp"

namespace deltadyn {
namespace {

constexpr Eigen::Index kStencil = 7;     // points of a difference of sixth order
constexpr double kLargestJitter = 0.02;  // of the stamps, share of the sample time, where differences still make sense

/// One column for each coordinate if the file has all of them, else nothing.
Eigen::MatrixXd read_block(const CsvTable& table, const std::vector<TaskColumns>& columns,
                           std::string TaskColumns::*name) {
  if (!std::ranges::all_of(
          columns, [&](const std::string& one) { return table.find(one).has_value(); }, name))
    return {};
  Eigen::MatrixXd block(static_cast<Eigen::Index>(table.rows()), static_cast<Eigen::Index>(columns.size()));
  for (Eigen::Index k = 0; k < block.cols(); ++k)
    block.col(k) = table.numbers(columns[static_cast<std::size_t>(k)].*name);
  return block;
}

Eigen::VectorXd read_times(const CsvTable& table) {
  const Eigen::VectorXd t = table.numbers("t_s");
  for (Eigen::Index i = 1; i < t.size(); ++i) {
    if (!(t(i) > t(i - 1)))
      throw Error(fmt::format("the time {} s is not after {} s of the row before", t(i), t(i - 1)),
                  place(table.path(), table.line(static_cast<std::size_t>(i)), "t_s"), "sort the rows by time");
  }
  return t;
}

/// Rates from positions, and accelerations with them, where the file does not hold them.
void fill_derivatives(const std::string& path, const Eigen::VectorXd& t_s, const Eigen::MatrixXd& x,
                      Eigen::MatrixXd& xd, Eigen::MatrixXd& xdd) {
  if (xd.size() > 0 && xdd.size() > 0) return;
  if (t_s.size() < kStencil)
    throw Error(fmt::format("{} rows are too few to compute the missing rates and accelerations", t_s.size()), path,
                fmt::format("give at least {} rows, or the columns of both derivatives", kStencil));
  const TimeGrid grid = fit_time_grid(t_s);
  if (grid.index.back() + 1 != t_s.size() || grid.jitter > kLargestJitter)
    throw Error("the samples are not evenly spaced, so the missing rates and accelerations cannot be computed", path,
                "give an evenly sampled trajectory, or the columns of both derivatives");
  if (xd.size() == 0) {
    xd = differentiate(x, grid.step_s, 1);
    xdd = differentiate(x, grid.step_s, 2);
  } else {
    xdd = differentiate(xd, grid.step_s, 1);
  }
}

bool has_drive_columns(const CsvTable& table) {
  return std::ranges::any_of(table.columns(), [](const std::string& name) { return name.starts_with("q1_"); });
}

void require_finite(const TrajectorySamples& samples, const Log& log, const RobotDescription& robot) {
  for (const auto& [block, column] : {std::pair{&samples.q, &DriveColumns::q},
                                      {&samples.qd, &DriveColumns::qd},
                                      {&samples.qdd, &DriveColumns::qdd}}) {
    for (Eigen::Index row = 0; row < block->rows(); ++row) {
      for (Eigen::Index drive = 0; drive < block->cols(); ++drive) {
        if (std::isfinite((*block)(row, drive))) continue;
        throw Error("the number is missing or not finite",
                    place(samples.file, log.line[static_cast<std::size_t>(row)],
                          drive_columns(robot, static_cast<int>(drive)).*column),
                    "fill in the number or remove the column");
      }
    }
  }
}

/// Where a file gives poses and drives, they must tell the same motion: a unit or an order that is wrong in one of them
/// would else decide which motion is meant. Lengths of another robot file, some per cent off, pass.
void require_one_motion(const Robot& robot, const CsvTable& table, const TrajectorySamples& samples) {
  constexpr double kAngle = 0.1, kShareOfStrut = 0.05;  // [rad] and of a carriage, that the two may differ
  const RobotDescription& description = robot.description();
  if (samples.q.rows() != samples.z.rows()) return;
  Eigen::VectorXd q(robot.drives());
  for (Eigen::Index row = 0; row < samples.z.rows(); ++row) {
    const auto line = table.line(static_cast<std::size_t>(row));
    const char* mend =
        "mend the units, the zero or the order of the columns, or leave out those of the pose or of the "
        "drives";
    if (const Status status = robot.inverse_kinematics(samples.z.row(row).transpose(), q); status != Status::ok)
      throw Error(
          fmt::format("the drives' columns hold a pose, but that of the pose's columns is none: {}", message(status)),
          place(samples.file, line, task_columns(description).front().z), mend);
    for (int drive = 0; drive < robot.drives(); ++drive) {
      const bool turns = description.kind_of_drive(drive) == DriveKind::revolute;
      const double given = samples.q(row, drive), off = std::abs(given - q(drive));
      if (off <= (turns ? kAngle : kShareOfStrut * description.limbs.front().strut)) continue;
      const std::string column = drive_columns(description, drive).q;
      throw Error(fmt::format("{} is {:.4g}, but the pose of the same row needs {:.4g}", column, given, q(drive)),
                  place(samples.file, line, column), mend);
    }
  }
}

}  // namespace

TrajectorySamples read_trajectory(const std::string& path, const Robot& robot) {
  const RobotDescription& description = robot.description();
  const CsvTable table = read_csv(path);
  TrajectorySamples samples;
  samples.file = path;
  samples.t_s = read_times(table);

  const std::vector<TaskColumns> columns = task_columns(description);
  if (!description.parts.empty()) samples.z = read_block(table, columns, &TaskColumns::z);
  const bool has_task = samples.z.size() > 0;
  const bool has_drives = has_drive_columns(table);
  if (!has_task && !has_drives) {
    std::string wanted = columns.front().z;
    for (std::size_t k = 1; k < columns.size() && !description.parts.empty(); ++k) wanted += ", " + columns[k].z;
    throw Error(fmt::format("the file has neither the columns {} nor those of the drives; it has {}", wanted,
                            fmt::join(table.columns(), ", ")),
                path, "name the columns of the motion with their units, e.g. " + wanted);
  }
  if (has_task) {
    samples.zd = read_block(table, columns, &TaskColumns::zd);
    samples.zdd = read_block(table, columns, &TaskColumns::zdd);
    fill_derivatives(path, samples.t_s, samples.z, samples.zd, samples.zdd);
  }
  if (has_drives) {
    LogReadOptions options;
    options.need_torque = false;
    options.check = false;
    const Log log = read_log(path, description, options);
    samples.q = log.q;
    samples.qd = log.qd;
    samples.qdd = log.qdd;
    require_finite(samples, log, description);
    fill_derivatives(path, samples.t_s, samples.q, samples.qd, samples.qdd);
  }
  if (has_drives && has_task) require_one_motion(robot, table, samples);
  if (!has_drives) complete_drives(robot, samples);
  if (!has_task) complete_task(robot, samples);
  return samples;
}

void write_trajectory(const std::string& path, const TrajectorySamples& samples, const RobotDescription& robot,
                      const std::string& note) {
  std::string text = note.empty() ? "" : "# " + note + "\n";
  text += "t_s";
  std::vector<const Eigen::MatrixXd*> blocks;
  if (!robot.parts.empty()) {
    const auto columns = task_columns(robot);
    for (const auto part : {&TaskColumns::z, &TaskColumns::zd, &TaskColumns::zdd})
      for (const TaskColumns& column : columns) text += "," + column.*part;
    blocks = {&samples.z, &samples.zd, &samples.zdd};
  }
  for (const auto part : {&DriveColumns::q, &DriveColumns::qd, &DriveColumns::qdd})
    for (int k = 0; k < robot.drives(); ++k) text += "," + drive_columns(robot, k).*part;
  blocks.insert(blocks.end(), {&samples.q, &samples.qd, &samples.qdd});
  write_table(path, text, samples.t_s, blocks);
}

}  // namespace deltadyn
