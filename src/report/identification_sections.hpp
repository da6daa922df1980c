#pragma once

/// \file
/// Sections of the identification report.

#include "deltadyn/report/assessment.hpp"
#include "deltadyn/report/html_report.hpp"

namespace deltadyn {

/// Residual of each drive: free base parameters, consistent parameters, noise, rows.
void add_fit_table(HtmlReport& report, const Robot& robot, const Identification& identification);
/// Prior, estimate with interval and data share of each parameter; those not fitted folded away.
void add_parameter_tables(HtmlReport& report, const Robot& robot, const Identification& identification);
/// What the model holds beside these: how friction builds up after a reversal, waves of the torque; nothing if there is
/// nothing.
void add_extras_table(HtmlReport& report, const Robot& robot, const Identification& identification);
/// What is left to the prior, and what would replace it.
void add_gap_table(HtmlReport& report, const std::vector<PriorGap>& gaps);
/// Base parameters by least squares and from the consistent fit.
void add_base_parameters(HtmlReport& report, const Identification& identification);
/// Residual over the cut-off; nothing if the cut-off was given.
void add_cutoff_figure(HtmlReport& report, const Identification& identification);
/// Misfit and distance from the prior over the regularisation; nothing if the weight was given.
void add_regularization_figure(HtmlReport& report, const ConsistentFitSummary& fit);
/// Eigenvalues of the mass matrix over the workspace.
void add_mass_matrix(HtmlReport& report, const Robot& robot, const MassMatrixSurvey& survey);

}  // namespace deltadyn
