#pragma once

/// \file
/// The report of delta-diagnose: six steps from "does the model fit" to "what to do next", plain language on top,
/// statistics below.

#include <string>

#include "deltadyn/diagnosis/diagnose.hpp"
#include "deltadyn/report/report_context.hpp"

namespace deltadyn {

/// \returns one HTML page. Throws deltadyn::Error if gnuplot fails.
[[nodiscard]] std::string diagnosis_report(const Robot& robot, const Diagnosis& diagnosis,
                                           const ReportContext& context);

}  // namespace deltadyn
