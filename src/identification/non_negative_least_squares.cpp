#include "deltadyn/identification/non_negative_least_squares.hpp"

#include <algorithm>

#include "deltadyn/runtime/dense.hpp"

namespace deltadyn {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kAtRest = 1e-9;  // of the largest inner product: a smaller slope at a bound is rounding

/// The problem in columns of norm 1.
class ActiveSet {
 public:
  ActiveSet(const MatrixXd& gram, const VectorXd& inner, const std::vector<bool>& positive, double singular)
      : positive_(positive),
        singular_(singular),
        scale_(gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse()),
        G_(scale_.asDiagonal() * gram * scale_.asDiagonal()),
        u_(scale_.asDiagonal() * inner),
        free_(positive.size(), false),
        x_(VectorXd::Zero(inner.size())) {
    for (Index i = 0; i < inner.size(); ++i) used_.push_back(gram(i, i) > 0);
  }

  /// All columns, and of those with the wrong sign the worst leaves until there is none. Most often that is the answer
  /// already.
  void start() {
    free_ = used_;
    while (true) {
      x_ = solved(free_);
      Index worst = -1;
      for (Index i = 0; i < x_.size(); ++i) {
        if (is_bounded(free_, i) && x_(i) < (worst < 0 ? 0.0 : x_(worst))) worst = i;
      }
      if (worst < 0) break;
      free_[static_cast<std::size_t>(worst)] = false;
    }
    gain_ = u_.dot(x_);
  }

  /// Takes back columns at their bound as long as that lowers the sum of squares, which it does finitely often: no set
  /// comes twice.
  void finish() {
    std::vector<bool> refused(free_.size(), false);
    const double at_rest = kAtRest * u_.cwiseAbs().maxCoeff();
    while (true) {
      const VectorXd slope = u_ - G_ * x_;
      Index best = -1;
      for (Index i = 0; i < x_.size(); ++i) {
        const auto at = static_cast<std::size_t>(i);
        if (used_[at] && !free_[at] && !refused[at] && slope(i) > (best < 0 ? at_rest : slope(best))) best = i;
      }
      if (best < 0) return;
      if (take_back(best)) {
        refused.assign(refused.size(), false);
      } else {
        refused[static_cast<std::size_t>(best)] = true;
      }
    }
  }

  [[nodiscard]] NonNegativeSolution solution() const { return {scale_.asDiagonal() * x_, free_, std::max(0.0, gain_)}; }

 private:
  [[nodiscard]] bool is_bounded(const std::vector<bool>& set, Index i) const {
    return set[static_cast<std::size_t>(i)] && positive_[static_cast<std::size_t>(i)];
  }

  /// Least squares over a set of columns, 0 elsewhere.
  [[nodiscard]] VectorXd solved(const std::vector<bool>& set) const {
    std::vector<Index> columns;
    for (std::size_t i = 0; i < set.size(); ++i) {
      if (set[i]) columns.push_back(static_cast<Index>(i));
    }
    VectorXd x = VectorXd::Zero(u_.size());
    if (columns.empty()) return x;
    x(columns) = dense::least_norm(G_(columns, columns), u_(columns), singular_);
    return x;
  }

  /// Frees a column and goes towards the least squares of the free ones; those that come to their bound on the way stay
  /// there.
  /// \return false, with nothing changed, if the sum of squares did not fall
  bool take_back(Index column) {
    std::vector<bool> set = free_;
    set[static_cast<std::size_t>(column)] = true;
    VectorXd at = x_, target = solved(set);
    while (set[static_cast<std::size_t>(column)]) {
      double step = 1;
      Index first = -1;
      for (Index i = 0; i < at.size(); ++i) {
        if (!is_bounded(set, i) || target(i) >= 0) continue;
        const double way = at(i) / (at(i) - target(i));
        if (way < step) {
          step = way;
          first = i;
        }
      }
      if (first < 0) break;
      at += step * (target - at);
      at(first) = 0;
      set[static_cast<std::size_t>(first)] = false;
      target = solved(set);
    }
    const double gain = u_.dot(target);
    if (!set[static_cast<std::size_t>(column)] || !(gain > gain_)) return false;
    free_ = set;
    x_ = target;
    gain_ = gain;
    return true;
  }

  const std::vector<bool>& positive_;
  double singular_;
  VectorXd scale_;
  MatrixXd G_;
  VectorXd u_;
  std::vector<bool> used_, free_;
  VectorXd x_;
  double gain_ = 0;
};

}  // namespace

NonNegativeSolution non_negative_least_squares(const MatrixXd& gram, const VectorXd& inner,
                                               const std::vector<bool>& positive, double singular) {
  if (inner.size() == 0) return {VectorXd(0), {}, 0.0};
  ActiveSet set(gram, inner, positive, singular);
  set.start();
  set.finish();
  return set.solution();
}

}  // namespace deltadyn
