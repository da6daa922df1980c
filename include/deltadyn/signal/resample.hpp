#pragma once

/// \file
/// Interpolation of sampled signals, even or uneven in time.

#include <Eigen/Core>

namespace deltadyn {

/// Value at `t` of the polynomial through all samples.
/// \param t_s     strictly increasing times of the samples [s]
/// \param values  one value a sample
/// \param t       where the value is wanted [s]
[[nodiscard]] double interpolate(const Eigen::Ref<const Eigen::VectorXd>& t_s,
                                 const Eigen::Ref<const Eigen::VectorXd>& values, double t);

/// Every column at every new time: value of the cubic polynomial through the four samples around it (exact for cubics);
/// with fewer samples, of the polynomial through all of them. Outside the samples the outermost polynomial is
/// continued.
/// \param t_s      N strictly increasing times [s]
/// \param columns  N x channels
/// \param new_t_s  M times [s]
/// \return         M x channels
[[nodiscard]] Eigen::MatrixXd resample(const Eigen::Ref<const Eigen::VectorXd>& t_s,
                                       const Eigen::Ref<const Eigen::MatrixXd>& columns,
                                       const Eigen::Ref<const Eigen::VectorXd>& new_t_s);

}  // namespace deltadyn
