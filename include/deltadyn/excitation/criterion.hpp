#pragma once

/// \file
/// How good an information matrix is: criteria of optimal design (paper (9); Lee, Lee, Park, Automatica 131, 2021).

#include <Eigen/Core>
#include <string>

namespace deltadyn {

/// M is the information matrix p x p a sample, in columns scaled to a root mean square of one over the admissible
/// states.
enum class Criterion {
  log_det,        ///< log det M: the volume of the confidence ellipsoid (D)
  det,            ///< (det M)^(1/p), the determinant of the paper in a scale that does not overflow
  cond,           ///< -log of the condition number of M, the other criterion of the paper
  trace,          ///< -log tr M^-1: the mean variance (A)
  min_eigenvalue  ///< log of the smallest eigenvalue: the worst direction (E)
};

/// logdet, det, cond, trace, min-eigenvalue. Throws deltadyn::Error(usage) for another word.
[[nodiscard]] Criterion criterion_of(const std::string& word);
[[nodiscard]] const char* word_of(Criterion criterion);

/// What makes a periodic motion a good one.
struct MotionGoal {
  Criterion criterion = Criterion::log_det;
  double velocity_weight = 0;  ///< w of (9)
  int harmonics = 5;
  double lowest_hz = 0.1, highest_hz = 1;  ///< base frequency
  double reversal_reach_s = 0;  ///< what counts as near a velocity reversal (reversals.hpp); 0: reversals are no matter
  double least_away = 0.4;      ///< share of the time that every drive is away from them in every segment, at least
};

/// Value to be made large, and its gradient by M (symmetric). The eigenvalue criteria are smooth where the extreme
/// eigenvalues are simple.
struct CriterionValue {
  bool regular = false;  ///< false: M is singular, nothing else is set
  double value = 0;
  Eigen::MatrixXd by_M;
};
[[nodiscard]] CriterionValue evaluate(Criterion criterion, const Eigen::MatrixXd& M);

/// log det of a positive definite matrix; -infinity if it is not.
[[nodiscard]] double log_determinant(const Eigen::MatrixXd& M);

}  // namespace deltadyn
