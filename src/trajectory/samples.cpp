#include "deltadyn/trajectory/samples.hpp"

#include <fmt/format.h>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

[[noreturn]] void refuse(const TrajectorySamples& samples, Eigen::Index row, Status status) {
  throw Error(fmt::format("at t = {:.6g} s {}", samples.t_s(row), message(status)), samples.file,
              "check that the motion belongs to this robot and stays inside its workspace");
}

}  // namespace

void complete_drives(const Robot& robot, TrajectorySamples& samples) {
  const Eigen::Index n = samples.samples();
  samples.q = samples.qd = samples.qdd = Eigen::MatrixXd::Zero(n, robot.drives());
  Eigen::VectorXd q(robot.drives()), qd(robot.drives()), qdd(robot.drives());
  for (Eigen::Index row = 0; row < n; ++row) {
    if (const Status status = robot.to_drives(samples.task(row), q, qd, qdd); status != Status::ok)
      refuse(samples, row, status);
    samples.q.row(row) = q.transpose();
    samples.qd.row(row) = qd.transpose();
    samples.qdd.row(row) = qdd.transpose();
  }
}

void complete_task(const Robot& robot, TrajectorySamples& samples) {
  const Eigen::Index n = samples.samples();
  samples.z = samples.zd = samples.zdd = Eigen::MatrixXd::Zero(n, robot.drives());
  TaskState task;
  for (Eigen::Index row = 0; row < n; ++row) {
    const Status status = robot.to_task(samples.q.row(row).transpose(), samples.qd.row(row).transpose(),
                                        samples.qdd.row(row).transpose(), task);
    if (status != Status::ok) refuse(samples, row, status);
    samples.z.row(row) = task.z.transpose();
    samples.zd.row(row) = task.zd.transpose();
    samples.zdd.row(row) = task.zdd.transpose();
  }
}

}  // namespace deltadyn
