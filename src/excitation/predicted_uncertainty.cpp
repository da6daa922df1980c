#include "deltadyn/excitation/predicted_uncertainty.hpp"

#include <fmt/format.h>
#include <limits>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd predicted_std(const Robot& robot, const std::vector<int>& base_columns, const TrajectorySamples& samples,
                       const VectorXd& torque_noise, int every) {
  const Index n = robot.drives(), p = static_cast<Index>(base_columns.size());
  if (torque_noise.size() != n || !(torque_noise.minCoeff() > 0))
    throw Error("the torque noise needs one positive number a drive", "--torque-noise",
                fmt::format("give {} numbers", n), ExitCode::usage);
  if (every < 1) throw Error("every how manieth sample counts must be 1 or more", "", "", ExitCode::usage);
  MatrixXd information = MatrixXd::Zero(p, p), Y(n, robot.parameters());
  for (Index row = 0; row < samples.samples(); row += every) {
    if (robot.regressor(samples.q.row(row).transpose(), samples.qd.row(row).transpose(),
                        samples.qdd.row(row).transpose(), Y) != Status::ok)
      continue;
    const MatrixXd A = Y(Eigen::all, base_columns).array().colwise() / torque_noise.array();
    information.selfadjointView<Eigen::Lower>().rankUpdate(A.transpose(), static_cast<double>(every));
  }
  information = MatrixXd(information.selfadjointView<Eigen::Lower>());
  // Scaled to a unit diagonal, the eigenvalues tell what is seen from what is not whatever the units.
  VectorXd scale = information.diagonal().cwiseSqrt();
  for (Index k = 0; k < p; ++k)
    if (!(scale(k) > 0)) scale(k) = 1;
  const MatrixXd scaled = scale.cwiseInverse().asDiagonal() * information * scale.cwiseInverse().asDiagonal();
  const auto [values, vectors] = dense::spectrum(scaled);
  constexpr double kUnseen = 1e-13;
  VectorXd variance = VectorXd::Zero(p);
  for (Index k = 0; k < p; ++k) {
    const VectorXd square = vectors.col(k).cwiseAbs2();
    const double value = values(k);
    for (Index j = 0; j < p; ++j) {
      if (value > kUnseen) {
        variance(j) += square(j) / value;
      } else if (square(j) > kUnseen) {
        variance(j) = std::numeric_limits<double>::infinity();
      }
    }
  }
  return variance.cwiseSqrt().cwiseQuotient(scale);
}

}  // namespace deltadyn
