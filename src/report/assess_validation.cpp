#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "assessment_parts.hpp"

namespace deltadyn {
namespace {

/// Residual of the rows near reversals alone, over that of the others.
double reversal_ratio(const ValidatedDrive& drive) {
  if (drive.reversal_rows == 0 || !(drive.rms_residual > 0)) return 1.0;
  const auto rows = static_cast<double>(drive.rows), reversal_rows = static_cast<double>(drive.reversal_rows);
  const double all = drive.rms_with_reversals * drive.rms_with_reversals * (rows + reversal_rows);
  const double regular = drive.rms_residual * drive.rms_residual * rows;
  return std::sqrt(std::max(0.0, all - regular) / reversal_rows) / drive.rms_residual;
}

}  // namespace

Assessment assess_validation(const Robot& robot, const Validation& validation) {
  std::vector<DriveFigures> drives;
  bool rows_everywhere = true;
  for (const ValidatedDrive& drive : validation.drives) {
    const auto all = static_cast<double>(drive.rows + drive.reversal_rows);
    drives.push_back({drive.rms_residual, drive.rms_torque, reversal_ratio(drive),
                      all > 0 ? static_cast<double>(drive.reversal_rows) / all : 0.0, drive.torque_noise,
                      drive.bristles});
    rows_everywhere = rows_everywhere && drive.rows > 0;
  }
  Assessment out;
  out.structure = structure_left(validation);
  if (!rows_everywhere) {
    out.checks.push_back(
        {"Rows to judge by", "a drive has none", Verdict::bad,
         "All rows of a drive are near velocity reversals or repaired: record a log in which every drive moves."});
  }
  const Check size = check_residual_size(robot, drives), shape = check_residual_shape(out.structure);
  out.checks.push_back(size);
  out.checks.push_back(shape);
  out.checks.push_back(check_reversals(drives));
  conclude({fmt::format("The model predicts these logs: the residual is at most {}.", size.figure),
            "The model predicts these logs with reservations", "The model does not predict these logs"},
           out);
  remark_on_rest(shape, out.checks.back(), out);
  return out;
}

}  // namespace deltadyn
