#pragma once

/// \file
/// Pictures and tables of torque prediction that both reports show.

#include <vector>

#include "deltadyn/identification/residual_structure.hpp"
#include "deltadyn/identification/validate.hpp"
#include "deltadyn/report/assessment.hpp"
#include "deltadyn/report/html_report.hpp"
#include "deltadyn/report/report_context.hpp"

namespace deltadyn {

/// Measured and model torque of each drive with the residual below, one figure a log.
void add_torque_figures(HtmlReport& report, const Robot& robot, const Validation& validation);

/// Power spectrum of the residual of each drive, one curve a log.
void add_residual_spectra(HtmlReport& report, const Robot& robot, const Validation& validation);

enum class Coordinate { velocity, position };

/// Residual of each drive over its own velocity or position: rows and their means in intervals.
void add_residual_over(HtmlReport& report, const Robot& robot, const Validation& validation, Coordinate coordinate);

/// What the residual of each drive follows.
void add_structure_table(HtmlReport& report, const std::vector<ResidualStructure>& residual);

/// Positions, velocities and accelerations that the logs reached: where the model was tried.
void add_motion_table(HtmlReport& report, const Robot& robot, const Validation& validation);

/// Name, finding and meaning of every check.
void add_check_table(HtmlReport& report, const Assessment& assessment);

/// The files, and how the logs were filtered.
/// \param model  name and file of the parameters that the torque was predicted or fitted with
[[nodiscard]] Facts source_facts(const ReportContext& context, const std::string& model, const std::string& model_file,
                                 const Validation& validation);

/// File name without folders.
[[nodiscard]] std::string short_name(const std::string& path);

}  // namespace deltadyn
