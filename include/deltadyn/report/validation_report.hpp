#pragma once

/// \file
/// The page that shows how well a model predicts logs that took no part in its fit.

#include <Eigen/Core>
#include <string>

#include "deltadyn/identification/validate.hpp"
#include "deltadyn/report/report_context.hpp"

namespace deltadyn {

/// \param p  parameters of the prediction, in the robot's layout
/// \return the page as HTML
/// Throws deltadyn::Error if the parts do not belong to the robot, or gnuplot cannot draw.
[[nodiscard]] std::string validation_report(const Robot& robot, const Validation& validation, const Eigen::VectorXd& p,
                                            const ReportContext& context);

}  // namespace deltadyn
