#pragma once

#include "deltadyn/report/excitation_report.hpp"
#include "deltadyn/report/html_report.hpp"

namespace deltadyn {

/// The path of the plate, seen at an angle and along the three axes, inside the workspace. Nothing for an axis.
void add_path_figures(HtmlReport& report, const ExcitationReportInput& input);

/// Share of each limit over time: task space, drives; torque if it is limited.
void add_limit_figures(HtmlReport& report, const ExcitationReportInput& input);

}  // namespace deltadyn
