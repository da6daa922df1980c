#pragma once

/// \file
/// Structure of any kind in a residual: how much of it the generic basis sees, and where.

#include <string>
#include <utility>
#include <vector>

#include "../evidence/generic_basis.hpp"
#include "../evidence/white_problem.hpp"

namespace deltadyn {

/// The generic basis of each drive in white rows, and how much a residual holds of it.
class Omnibus {
 public:
  Omnibus() = default;
  Omnibus(const WhiteProblem& problem, const GenericBasis& basis);
  [[nodiscard]] Index drives() const { return static_cast<Index>(white_.size()); }
  /// Fall of the sum of squares of a residual r, one value a drive.
  [[nodiscard]] VectorXd gains(const WhiteProblem& problem, const VectorXd& r, const VectorXd& Q_r) const;
  /// The same of the problem's own residual.
  [[nodiscard]] VectorXd gains(const WhiteProblem& problem) const { return gains(problem, problem.r, problem.Q_r); }
  /// Coefficients of the basis for the part of the structure of one drive that stands out of the noise.
  [[nodiscard]] VectorXd clear_part(const WhiteProblem& problem, std::size_t drive) const;
  /// Gain of each coordinate of the basis alone, for one drive: where the structure lies.
  [[nodiscard]] std::vector<std::pair<std::string, double>> by_coordinate(const WhiteProblem& problem,
                                                                          std::size_t drive) const;

 private:
  std::vector<WhiteColumns> white_;  ///< one a drive
  std::vector<MatrixXd> root_;       ///< gain = |root^T u|^2
  std::vector<std::vector<std::string>> coordinate_;
};

}  // namespace deltadyn
