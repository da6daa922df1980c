#include "deltadyn/excitation/design_bound.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "deltadyn/excitation/criterion.hpp"
#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/in_parallel.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kFirstStates = 600;  // in the working set at the start
constexpr Index kMoreStates = 200;   // added at a time
constexpr double kGap = 1e-3;        // of the bound to the efficiency of the design found, as a share: close enough
constexpr int kMostIterations = 20000;

/// Sensitivities d_k = tr(M_k M^-1) = |L^-1 A_k'|^2 of the blocks of rows A_k.
VectorXd sensitivities(const std::vector<MatrixXd>& blocks, const std::vector<Index>& which, const MatrixXd& M) {
  const dense::Cholesky factor = dense::cholesky(M);
  if (!factor.positive_definite)
    throw Error("the admissible states do not show all base parameters", "limits", "widen the limits or the workspace",
                ExitCode::no_convergence);
  const auto count = static_cast<Index>(which.size());
  VectorXd d(count);
  const auto pass = [&](Index k) {
    const MatrixXd& block = blocks[static_cast<std::size_t>(which[static_cast<std::size_t>(k)])];
    d(k) = dense::solve_lower(factor.L, block.transpose()).squaredNorm();
  };
  // Small sets are faster on one thread than the threads are to meet.
  in_parallel(count, pass, count > 2000 ? 0 : 1);
  return d;
}

MatrixXd information(const std::vector<MatrixXd>& blocks, const std::vector<Index>& which, const VectorXd& w, Index p) {
  MatrixXd M = MatrixXd::Zero(p, p);
  for (std::size_t k = 0; k < which.size(); ++k) {
    const double share = w(static_cast<Index>(k));
    if (share > 0)
      M.selfadjointView<Eigen::Lower>().rankUpdate(blocks[static_cast<std::size_t>(which[k])].transpose(), share);
  }
  return M.selfadjointView<Eigen::Lower>();
}

}  // namespace

double DesignBound::gap(int p) const {
  return 1 - std::exp((log_det_found - log_det) / p);
}

DesignBound design_bound(const DesignSpace& space) {
  const Index p = space.base_parameters(), n = space.regressor->drives(), count = space.states.x.cols();
  std::vector<MatrixXd> blocks(static_cast<std::size_t>(count), MatrixXd::Zero(n, p));
  for (Index k = 0; k < count; ++k) {
    if (space.weighted_columns(space.states.x.col(k), blocks[static_cast<std::size_t>(k)]) != Status::ok)
      blocks[static_cast<std::size_t>(k)].setZero();
  }
  std::vector<Index> all(static_cast<std::size_t>(count));
  std::iota(all.begin(), all.end(), Index{0});
  std::vector<Index> set(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(std::min(count, kFirstStates)));
  VectorXd w = VectorXd::Constant(static_cast<Index>(set.size()), 1.0 / static_cast<double>(set.size()));
  const double p_real = static_cast<double>(p), goal = p_real * (1 + kGap / 2);

  DesignBound result;
  int iterations = 0;
  for (;;) {
    // w_k <- w_k (d_k / p)^power keeps the sum and never lowers det M for power 1; a state that the optimum cannot hold
    // (Harman and Pronzato 2007) leaves the set.
    for (;;) {
      const VectorXd d = sensitivities(blocks, set, information(blocks, set, w, p));
      const double largest = d.maxCoeff();
      ++iterations;
      if (largest <= goal || iterations >= kMostIterations) break;
      const double excess = largest - p_real;
      const double least = p_real * (1 + excess / 2 - std::sqrt(excess * (4 + excess - 4 / p_real)) / 2);
      std::vector<Index> kept;
      VectorXd shares(w.size());
      for (std::size_t k = 0; k < set.size(); ++k) {
        const auto at = static_cast<Index>(k);
        if (d(at) < least || w(at) < 1e-14) continue;
        shares(static_cast<Index>(kept.size())) = w(at) * d(at) / p_real;
        kept.push_back(set[k]);
      }
      set = std::move(kept);
      w = shares.head(static_cast<Index>(set.size()));
      w /= w.sum();
    }
    const MatrixXd M = information(blocks, set, w, p);
    const VectorXd d = sensitivities(blocks, all, M);
    result.log_det_found = log_determinant(M);
    result.log_det = result.log_det_found + p_real * std::log(std::max(1.0, d.maxCoeff() / p_real));
    if (d.maxCoeff() <= p_real * (1 + kGap) || iterations >= kMostIterations) break;
    // The states that would gain most join with a small share.
    std::vector<Index> order = all;
    const auto more = static_cast<std::ptrdiff_t>(std::min<Index>(kMoreStates, count));
    std::partial_sort(order.begin(), order.begin() + more, order.end(), [&d](Index a, Index b) { return d(a) > d(b); });
    std::vector<char> in_set(static_cast<std::size_t>(count), 0);
    for (const Index k : set) in_set[static_cast<std::size_t>(k)] = 1;
    std::vector<Index> joining;
    for (auto it = order.begin(); it != order.begin() + more; ++it)
      if (in_set[static_cast<std::size_t>(*it)] == 0 && d(*it) > p_real) joining.push_back(*it);
    const auto before = static_cast<Index>(set.size()), joined = static_cast<Index>(joining.size());
    set.insert(set.end(), joining.begin(), joining.end());
    w.conservativeResize(before + joined);
    constexpr double kShareOfNew = 0.1;
    w.head(before) *= 1 - kShareOfNew;
    w.tail(joined).setConstant(kShareOfNew / static_cast<double>(std::max<Index>(1, joined)));
    w /= w.sum();
  }
  result.shares = VectorXd::Zero(count);
  for (std::size_t k = 0; k < set.size(); ++k) result.shares(set[k]) = w(static_cast<Index>(k));
  result.support = static_cast<int>((result.shares.array() > 1e-6).count());
  return result;
}

double d_efficiency(double log_det, const DesignBound& bound, int p) {
  return std::exp((log_det - bound.log_det) / p);
}

}  // namespace deltadyn
