#pragma once

/// \file
/// Rows tau = Y beta of the sample, for the logs as given or read in another way.

#include <Eigen/Core>
#include <vector>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/runtime/robot.hpp"

#include "sample.hpp"

namespace deltadyn::gate {

/// How recorded positions become those of the robot file: q_j = factor_j column(source_j) + offset_j.
struct Reading {
  std::vector<int> source;
  Eigen::VectorXd factor, offset;

  [[nodiscard]] static Reading as_given(int drives);
  /// \param derivative 0: positions; 1, 2: rates and accelerations, which an offset does not touch
  [[nodiscard]] Eigen::MatrixXd apply(const Eigen::MatrixXd& columns, int derivative) const;
};

/// A grid point of a stretch.
struct Place {
  int stretch = 0;
  Eigen::Index point = 0;
};

struct DriveRows {
  std::vector<Place> at;
  Eigen::MatrixXd Y;  ///< rows x base parameters

  [[nodiscard]] Eigen::Index count() const { return Y.rows(); }
  /// Of columns with a value a point, the values in these rows.
  [[nodiscard]] Eigen::MatrixXd of_points(const Eigen::MatrixXd& columns) const;
};

struct Rows {
  std::vector<DriveRows> drives;
  double unreachable = 0;  ///< share of the poses looked at that the robot cannot have
  /// Regressor at every point, not low-passed: [stretch][drive], points x base parameters; empty for rows_of_points().
  std::vector<std::vector<Eigen::MatrixXd>> Y_of_points;
};

/// Regressor under the Gaussian of the sample: for what needs precision (delays). Rows within reach of a reversal are
/// left out unless few others remain.
[[nodiscard]] Rows low_passed_rows(const Robot& robot, const BaseParameters& base, const Sample& sample,
                                   const Reading& reading);

/// Motion under the Gaussian at few points: cheap, good to some per cent, for signs, orders and units.
struct Points {
  double sigma_s = 0;  ///< of the low pass; 0: none
  std::vector<Place> at;
  Eigen::MatrixXd q, qd, qdd;                                     ///< points x columns, as recorded
  Eigen::MatrixXd tau;                                            ///< points x drives, under the same low pass
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> torque_out;  ///< points x drives: this torque is no evidence
};
[[nodiscard]] Points pick_points(const Sample& sample, Eigen::Index count);
[[nodiscard]] Rows rows_of_points(const Robot& robot, const BaseParameters& base, const Points& points,
                                  const Reading& reading);

/// Values of one column a stretch and their time derivatives at places shifted by the log's `shift_s` (later ones for a
/// positive shift; none if it is empty), under a Gaussian of `sigma_s`, at most three times that of the sample: rows x
/// (1 + derivatives).
[[nodiscard]] Eigen::MatrixXd values_at(const Sample& sample, const std::vector<Eigen::VectorXd>& column,
                                        const std::vector<Place>& at, const std::vector<double>& shift_s_of_log,
                                        int derivatives, double sigma_s);

}  // namespace deltadyn::gate
