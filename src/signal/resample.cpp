#include "deltadyn/signal/resample.hpp"

#include <algorithm>

namespace deltadyn {
namespace {

/// Index of the last sample not after t, within [0, N - 2].
Eigen::Index interval(const Eigen::Ref<const Eigen::VectorXd>& t_s, double t) {
  const double* begin = t_s.data();
  const double* after = std::upper_bound(begin, begin + t_s.size(), t);
  return std::clamp<Eigen::Index>(after - begin - 1, 0, std::max<Eigen::Index>(t_s.size() - 2, 0));
}

}  // namespace

double interpolate(const Eigen::Ref<const Eigen::VectorXd>& t_s, const Eigen::Ref<const Eigen::VectorXd>& values,
                   double t) {
  double sum = 0;
  for (Eigen::Index i = 0; i < t_s.size(); ++i) {
    double weight = 1.0;
    for (Eigen::Index j = 0; j < t_s.size(); ++j) {
      if (j != i) weight *= (t - t_s(j)) / (t_s(i) - t_s(j));
    }
    sum += weight * values(i);
  }
  return sum;
}

Eigen::MatrixXd resample(const Eigen::Ref<const Eigen::VectorXd>& t_s, const Eigen::Ref<const Eigen::MatrixXd>& columns,
                         const Eigen::Ref<const Eigen::VectorXd>& new_t_s) {
  Eigen::MatrixXd result(new_t_s.size(), columns.cols());
  const auto count = std::min<Eigen::Index>(4, t_s.size());
  for (Eigen::Index row = 0; row < new_t_s.size(); ++row) {
    const double t = new_t_s(row);
    const auto first = std::clamp<Eigen::Index>(interval(t_s, t) - 1, 0, t_s.size() - count);
    for (Eigen::Index c = 0; c < columns.cols(); ++c)
      result(row, c) = interpolate(t_s.segment(first, count), columns.col(c).segment(first, count), t);
  }
  return result;
}

}  // namespace deltadyn
