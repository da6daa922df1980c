#pragma once

/// \file
/// The page that says whether an identified model can be trusted, and why.

#include <string>

#include "deltadyn/identification/identify.hpp"
#include "deltadyn/identification/mass_matrix_survey.hpp"
#include "deltadyn/identification/validate.hpp"
#include "deltadyn/report/report_context.hpp"

namespace deltadyn {

/// \param training  torque prediction of the logs of the fit with its final parameters
/// \param survey    of the final parameters
/// \return the page as HTML
/// Throws deltadyn::Error if the parts do not belong to the robot, or gnuplot cannot draw.
[[nodiscard]] std::string identification_report(const Robot& robot, const Identification& identification,
                                                const Validation& training, const MassMatrixSurvey& survey,
                                                const ReportContext& context);

}  // namespace deltadyn
