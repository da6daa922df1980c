#include "null_distribution.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace deltadyn {

namespace {

constexpr double kTailShare = 0.25;  // of the runs that the tail is fitted to

double rarity(double p) {
  return -std::log(std::max(p, 1e-300));
}

}  // namespace

NullDistribution::NullDistribution(std::vector<double> values) : sorted_(std::move(values)) {
  std::sort(sorted_.begin(), sorted_.end());
  if (sorted_.empty()) return;
  const auto first = static_cast<std::size_t>((1 - kTailShare) * static_cast<double>(sorted_.size()));
  knee_ = sorted_[std::min(first, sorted_.size() - 1)];
  double sum = 0;
  for (std::size_t k = first; k < sorted_.size(); ++k) sum += sorted_[k] - knee_;
  slope_ = std::max(sum / static_cast<double>(std::max<std::size_t>(1, sorted_.size() - first)), 1e-9);
}

double NullDistribution::p_value(double score) const {
  if (sorted_.empty()) return 1;
  if (score > knee_) return kTailShare * std::exp(-(score - knee_) / slope_);
  const auto below = static_cast<double>(std::lower_bound(sorted_.begin(), sorted_.end(), score) - sorted_.begin());
  return std::max(kTailShare, 1.0 - below / static_cast<double>(sorted_.size()));
}

double NullDistribution::quantile(double p) const {
  if (sorted_.empty()) return std::numeric_limits<double>::infinity();
  if (p < kTailShare) return knee_ + slope_ * std::log(kTailShare / p);
  return sorted_[static_cast<std::size_t>(
      std::min((1 - p) * static_cast<double>(sorted_.size()), static_cast<double>(sorted_.size() - 1)))];
}

NullFamily::NullFamily(const MatrixXd& scores) {
  for (const auto& column : scores.colwise()) each_.emplace_back(std::vector<double>(column.begin(), column.end()));
  std::vector<double> rarest;
  for (const auto& run : scores.rowwise()) rarest.push_back(rarity(smallest_p(run.transpose())));
  rarest_ = NullDistribution(std::move(rarest));
}

double NullFamily::smallest_p(const VectorXd& scores) const {
  double least = 1;
  for (std::size_t k = 0; k < each_.size(); ++k)
    least = std::min(least, each_[k].p_value(scores(static_cast<Index>(k))));
  return least;
}

double NullFamily::p_value(std::size_t k, double score) const {
  return std::min(1.0, rarest_.p_value(rarity(each_[k].p_value(score))));
}

double NullFamily::p_value(const VectorXd& scores) const {
  return std::min(1.0, rarest_.p_value(rarity(smallest_p(scores))));
}

}  // namespace deltadyn
