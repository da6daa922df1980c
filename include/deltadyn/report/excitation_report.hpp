#pragma once

/// \file
/// The page that shows an excitation trajectory: its path, how far it uses the limits, and what it will identify.

#include <Eigen/Core>
#include <string>

#include "deltadyn/excitation/optimize.hpp"
#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/report/assessment.hpp"
#include "deltadyn/report/report_context.hpp"
#include "deltadyn/trajectory/motion_plan.hpp"

namespace deltadyn {

struct ExcitationReportInput {
  const Robot& robot;
  const BaseParameters& base;
  const Excitation& excitation;
  const std::vector<PlanSegment>& segments;
  const MotionPlan& plan;
  const LimitCheck& check;  ///< of the plan
  const TrajectorySamples& samples;
  const DesignBound& bound;
  Eigen::VectorXd torque_noise = {};   ///< standard deviation a drive [N m | N]
  Eigen::VectorXd predicted_std = {};  ///< of each base parameter, for one run of the samples
  Eigen::VectorXd base_values = {};    ///< what the base parameters are expected to be
  /// Size that each base parameter may have [its unit]: what its standard deviation is judged by. The value alone would
  /// not do, because that of a symmetric part is zero.
  Eigen::VectorXd base_scale = {};
  bool values_are_nominal = true;  ///< from simple shapes, not from a known model
  const TrajectorySamples* validation = nullptr;
  /// Share of the samples of each segment away from velocity reversals, drives x segments; empty: not looked at.
  Eigen::MatrixXd away_from_reversals = {};
  double least_away = 0;          ///< that was asked for
  double reversal_cutoff_hz = 0;  ///< cut-off of the identification that these are shares for
};

/// What the motion is worth: one judgement for page, terminal and summary.
[[nodiscard]] Assessment assess_excitation(const ExcitationReportInput& input);

/// \return the page as HTML
/// Throws deltadyn::Error if the parts do not belong together, or gnuplot cannot draw.
[[nodiscard]] std::string excitation_report(const ExcitationReportInput& input, const ReportContext& context);

}  // namespace deltadyn
