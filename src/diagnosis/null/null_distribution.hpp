#pragma once

/// \file
/// Chance of a score on logs that miss nothing, and of the rarest of a family of scores.

#include <vector>

#include "../evidence/eigen_names.hpp"

namespace deltadyn {

/// Distribution of one score: empirical below its upper quarter, exponential above (the tail of a chi-square or of a
/// supremum of some).
class NullDistribution {
 public:
  NullDistribution() = default;
  explicit NullDistribution(std::vector<double> values);
  /// Chance of a score this large or larger.
  [[nodiscard]] double p_value(double score) const;
  /// Score with this chance.
  [[nodiscard]] double quantile(double p) const;

 private:
  std::vector<double> sorted_;
  double knee_ = 0, slope_ = 1;
};

/// Scores of which the rarest counts (Westfall and Young 1993).
class NullFamily {
 public:
  NullFamily() = default;
  /// \param scores  runs x scores
  explicit NullFamily(const MatrixXd& scores);
  [[nodiscard]] const NullDistribution& operator[](std::size_t k) const { return each_[k]; }
  /// Chance that any score of the family is as rare as this one is at its place.
  [[nodiscard]] double p_value(std::size_t k, double score) const;
  /// The same of the rarest of all.
  [[nodiscard]] double p_value(const VectorXd& scores) const;

 private:
  [[nodiscard]] double smallest_p(const VectorXd& scores) const;

  std::vector<NullDistribution> each_;
  NullDistribution rarest_;  ///< of -log of the smallest chance of a run
};

}  // namespace deltadyn
