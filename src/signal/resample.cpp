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

struct Stencil {
  Eigen::Index first = 0;
  int count = 0;
  double weight[4] = {0, 0, 0, 0};
};

/// Lagrange weights of the four samples around t.
Stencil stencil(const Eigen::Ref<const Eigen::VectorXd>& t_s, double t) {
  Stencil s;
  s.count = static_cast<int>(std::min<Eigen::Index>(4, t_s.size()));
  s.first = std::clamp<Eigen::Index>(interval(t_s, t) - 1, 0, t_s.size() - s.count);
  for (int i = 0; i < s.count; ++i) {
    double weight = 1.0;
    for (int j = 0; j < s.count; ++j) {
      if (j != i) weight *= (t - t_s(s.first + j)) / (t_s(s.first + i) - t_s(s.first + j));
    }
    s.weight[i] = weight;
  }
  return s;
}

}  // namespace

double interpolate_cubic(const Eigen::Ref<const Eigen::VectorXd>& t_s, const Eigen::Ref<const Eigen::VectorXd>& values,
                         double t) {
  const Stencil s = stencil(t_s, t);
  double sum = 0;
  for (int i = 0; i < s.count; ++i) sum += s.weight[i] * values(s.first + i);
  return sum;
}

Eigen::MatrixXd resample(const Eigen::Ref<const Eigen::VectorXd>& t_s, const Eigen::Ref<const Eigen::MatrixXd>& columns,
                         const Eigen::Ref<const Eigen::VectorXd>& new_t_s) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(new_t_s.size(), columns.cols());
  for (Eigen::Index row = 0; row < new_t_s.size(); ++row) {
    const Stencil s = stencil(t_s, new_t_s(row));
    for (int i = 0; i < s.count; ++i) result.row(row) += s.weight[i] * columns.row(s.first + i);
  }
  return result;
}

}  // namespace deltadyn
