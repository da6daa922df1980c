#include "omnibus.hpp"

#include <algorithm>
#include <cmath>

#include "deltadyn/identification/non_negative_least_squares.hpp"
#include "deltadyn/runtime/dense.hpp"

namespace deltadyn {

namespace {

constexpr double kClear = 3.5;  // standard deviations by which a part of the structure stands out of the noise

}  // namespace

Omnibus::Omnibus(const WhiteProblem& problem, const GenericBasis& basis) : coordinate_(basis.coordinate) {
  const std::size_t n = basis.coordinate.size();
  for (std::size_t j = 0; j < n; ++j) {
    PerLogAndDrive<MatrixXd> columns(basis.columns.size(), std::vector<MatrixXd>(n));
    for (std::size_t l = 0; l < basis.columns.size(); ++l) columns[l][j] = basis.columns[l][j];
    white_.push_back(problem.whiten(columns));
    MatrixXd G = white_.back().gram(0, white_.back().cols());
    const VectorXd raw = white_.back().raw_gram(0, white_.back().cols()).diagonal().cwiseMax(1e-300);
    const VectorXd scale = raw.cwiseSqrt().cwiseInverse();
    G = scale.asDiagonal() * G * scale.asDiagonal();
    const dense::Spectrum spectrum = dense::spectrum(G);
    const VectorXd& values = spectrum.values;
    std::vector<Index> kept;
    for (Index k = 0; k < values.size(); ++k) {
      if (values(k) > 1e-4 * values(values.size() - 1)) kept.push_back(k);
    }
    MatrixXd root(values.size(), static_cast<Index>(kept.size()));
    for (std::size_t k = 0; k < kept.size(); ++k) {
      root.col(static_cast<Index>(k)) = scale.asDiagonal() * spectrum.vectors.col(kept[k]) / std::sqrt(values(kept[k]));
    }
    root_.push_back(root);
  }
}

VectorXd Omnibus::gains(const WhiteProblem& problem, const VectorXd& r, const VectorXd& Q_r) const {
  VectorXd out(static_cast<Index>(white_.size()));
  for (std::size_t j = 0; j < white_.size(); ++j)
    out(static_cast<Index>(j)) = (root_[j].transpose() * problem.inner(white_[j], r, Q_r)).squaredNorm();
  return out;
}

VectorXd Omnibus::clear_part(const WhiteProblem& problem, std::size_t drive) const {
  // Of unit variance if there is nothing but noise.
  VectorXd t = root_[drive].transpose() * problem.inner(white_[drive]);
  t = (t.array().abs() > kClear).select(t, 0.0);
  return root_[drive] * t;
}

std::vector<std::pair<std::string, double>> Omnibus::by_coordinate(const WhiteProblem& problem,
                                                                   std::size_t drive) const {
  std::vector<std::pair<std::string, double>> out;
  const auto& names = coordinate_[drive];
  for (std::size_t first = 0; first < names.size();) {
    std::size_t end = first;
    while (end < names.size() && names[end] == names[first]) ++end;
    const auto count = static_cast<Index>(end - first);
    const WhiteColumns white = white_[drive].part(static_cast<Index>(first), count);
    const std::vector<bool> positive(end - first, false);
    const double gain = non_negative_least_squares(white.clear_gram(0, count), problem.inner(white), positive).gain;
    // What chance alone gives each column is taken off.
    out.emplace_back(names[first], std::max(0.0, gain - static_cast<double>(count)));
    first = end;
  }
  return out;
}

}  // namespace deltadyn
