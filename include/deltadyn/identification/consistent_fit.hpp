#pragma once

/// \file
/// Physically consistent parameters from folded data and a prior (Gnad et al. 2024, V, VI, VIII.B).
///
/// Minimises  J = ||A p - b||^2 + lambda D(p, p_reg)  over parameters p that a real robot can have: every body has a
/// positive definite pseudo-inertia (12), friction and rotor inertia are positive. This is (15) divided by its data
/// weight, with A and b weighted by the noise so that the first term is a chi-square and lambda has a statistical
/// meaning.
///
/// The problem is convex in p. An interior-point method in p finds the neighbourhood of the global optimum, Ceres
/// minimises (15) itself over the log-Cholesky variables pi from there, and the result is checked by the duality of the
/// problem in p.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "deltadyn/runtime/parameter_id.hpp"

namespace deltadyn {

/// Which variables are free.
enum class ParameterSet {
  /// Section VI: products of inertia and moments across a symmetric link are 0, unseen inertias follow the prior
  reduced,
  full,  ///< all ten parameters of every body
};

/// How far a parameter vector is from the prior.
enum class FitMetric {
  /// (15): sum of ((p - p_reg)/scale)^2, scale = |p_reg|; where p_reg is 0, the scale that the body's mass and size set
  relative,
  bregman,  ///< log-det divergence of the pseudo-inertias (Lee, Wensing, Park 2020), independent of frames and units
  /// Half the squared geodesic distance of the pseudo-inertias (Lee, Park 2018); not convex, so without certificate
  riemannian,
};

/// Data and prior. A has one column a parameter; its rows may be the triangular factor of any amount of folded samples.
struct ConsistentFitProblem {
  /// P, e.g. Robot::parameter_ids(); the ten of a body stand together and in order
  std::vector<ParameterId> parameters;
  Eigen::MatrixXd A;          ///< k x P, divided by the noise standard deviation
  Eigen::VectorXd b;          ///< k, divided by the noise standard deviation
  Eigen::VectorXd prior;      ///< P, SI units; 0 where nothing is known
  Eigen::VectorXd prior_std;  ///< P or empty (then prior_relative_std of the scale of each parameter)
};

struct ConsistentFitOptions {
  ParameterSet set = ParameterSet::reduced;
  FitMetric metric = FitMetric::relative;
  std::optional<double> regularization;  ///< lambda; chosen from the data when empty
  /// Chosen lambda: the largest one that raises chi^2 by no more than this over its minimum on the consistent set. The
  /// bias of everything the data determine is then below sqrt(kDataMisfitRise) standard deviations, all directions
  /// together.
  static constexpr double kDataMisfitRise = 0.001;
  /// Trust in the prior, for the uncertainties and as the upper end of the search for lambda
  double prior_relative_std = 0.3;
  /// Largest proven distance to the global optimum, in units of chi^2, that passes
  static constexpr double kCertificateGap = 0.01;
};

/// One point of the L-curve.
struct LCurvePoint {
  double lambda, data_cost, regularization_cost;
};

/// Evidence that p is a global optimum, from the gradient of J in the space of pseudo-inertias. The dual matrices are
/// those of p or of the centred point next to it, whichever proves more; the gap is that of p.
struct OptimalityCertificate {
  bool available = false;  ///< false for the metric that is not convex
  /// Smallest eigenvalue of all scaled dual matrices; >= 0 up to rounding at an optimum [chi^2]
  double min_dual_eigenvalue = 0;
  std::string min_dual_name;  ///< the body or parameter it belongs to
  double gap = 0;             ///< proven upper bound of J(p) - min J [chi^2]
  bool passed = false;        ///< gap <= ConsistentFitOptions::kCertificateGap
};

struct ConsistentFitSummary {
  std::vector<ParameterId> parameters;
  Eigen::VectorXd p;  ///< P, physically consistent; equal to p(pi)
  /// P: log-Cholesky variables (13) of each body, logarithm of positive scalars, offsets as they are
  Eigen::VectorXd pi;
  Eigen::VectorXd prior;       ///< P
  Eigen::VectorXd std;         ///< P: standard deviation from data and prior together
  Eigen::VectorXd data_share;  ///< P: 1 the data decided, 0 the prior decided (1 - variance / prior variance)
  /// P: the parameter enters data and regularisation; false for those that section VI drops
  std::vector<bool> fitted;
  double data_cost = 0;       ///< ||A p - b||^2
  double data_cost_free = 0;  ///< the smallest that any p has, consistent or not: that of the base parameters
  int data_rank = 0;          ///< of A: number of base parameters
  /// Smallest value on the consistent set; only when lambda was chosen, else equal to data_cost
  double data_cost_min = 0;
  double regularization_cost = 0;  ///< D(p, p_reg), without lambda
  double lambda = 0;
  bool lambda_from_data = false;
  std::vector<LCurvePoint> l_curve;  ///< the points visited while choosing lambda, in rising order of lambda
  int variables = 0;                 ///< free variables of Ceres
  int interior_point_iterations = 0;
  int iterations = 0;            ///< of Ceres
  double initial_data_cost = 0;  ///< chi^2 of the prior, made consistent where it was on the boundary
  double solve_time_s = 0;       ///< one solve at the final lambda
  double total_time_s = 0;       ///< with the choice of lambda and the uncertainties
  bool converged = false;        ///< Ceres found no descent any more, or the certificate says that none is left
  std::string message;           ///< of Ceres
  OptimalityCertificate certificate;
  std::vector<std::string> notes;  ///< what was done about the prior, in plain words

  /// True if chi^2 is above that of the base parameters by no more than the true parameters' would be (three standard
  /// deviations of a chi-square with data_rank degrees of freedom): the data then cannot tell the fit from the base
  /// parameters.
  [[nodiscard]] bool agrees_with_least_squares() const;

  [[nodiscard]] std::string brief_report() const;  ///< one line
};

/// Solves the problem. Throws deltadyn::Error for sizes, parameters or numbers that do not fit, options out of range,
/// and a prior that no body can have (negative mass, broken triangle inequality, first moments too large), naming the
/// body and the rule. A prior on the boundary (thin rod, point mass) is moved inside by a hair, which the notes say.
[[nodiscard]] ConsistentFitSummary fit_consistent_parameters(const ConsistentFitProblem& problem,
                                                             const ConsistentFitOptions& options = {});

}  // namespace deltadyn
