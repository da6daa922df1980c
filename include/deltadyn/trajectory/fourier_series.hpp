#pragma once

/// \file
/// Periodic motions as truncated Fourier series, paper (8), with exact derivatives of any order.

#include <Eigen/Core>

#include "deltadyn/runtime/robot.hpp"

namespace deltadyn {

/// Derivative by the phase of the basis (1, sin phi, cos phi, sin 2 phi, cos 2 phi, ...) at the given phases.
/// \return phases x (1 + 2 harmonics)
[[nodiscard]] Eigen::MatrixXd fourier_basis(const Eigen::Ref<const Eigen::VectorXd>& phases, int harmonics,
                                            int derivative);

/// n phases evenly over one period, the first one 0.
[[nodiscard]] Eigen::VectorXd even_phases(Eigen::Index n);

/// z_i(t) = b_i0 + sum_k a_ik sin(k omega t) + b_ik cos(k omega t), paper (8).
struct FourierSeries {
  double base_frequency_hz = 0;
  Eigen::MatrixXd coefficients;  ///< (1 + 2 harmonics) x coordinates; rows b_0, a_1, b_1, a_2, b_2, ...

  [[nodiscard]] int harmonics() const { return static_cast<int>(coefficients.rows() - 1) / 2; }
  [[nodiscard]] int coordinates() const { return static_cast<int>(coefficients.cols()); }
  [[nodiscard]] double omega() const { return 2 * 3.14159265358979323846 * base_frequency_hz; }
  [[nodiscard]] double period_s() const { return 1 / base_frequency_hz; }

  /// Derivative by time at the phases omega t; phases x coordinates.
  [[nodiscard]] Eigen::MatrixXd at_phases(const Eigen::Ref<const Eigen::VectorXd>& phases, int derivative = 0) const;
  /// z, zd, zdd at one phase while the phase runs at `rate` [rad/s] and changes its rate by `rate_d` [rad/s^2]; in the
  /// periodic motion rate = omega and rate_d = 0.
  [[nodiscard]] TaskState state(double phase, double rate, double rate_d) const;
  /// The series seen from `centre`, all deviations times `factor`.
  [[nodiscard]] FourierSeries scaled(const Eigen::Ref<const Eigen::VectorXd>& centre, double factor) const;
  /// Throws deltadyn::Error(bad_input) if a number is not finite, the frequency not positive, or the shape wrong.
  void validate(const std::string& where) const;
};

}  // namespace deltadyn
