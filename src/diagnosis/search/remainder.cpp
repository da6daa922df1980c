#include "remainder.hpp"

#include "deltadyn/runtime/dense.hpp"

namespace deltadyn::detail {

Remainder remainder_of(const SearchContext& context, const WhiteProblem& problem,
                       const PerLogAndDrive<MatrixXd>& columns, const VectorXd& amplitude) {
  VectorXd white = VectorXd::Zero(problem.rows);
  for (const WhiteSegment& segment : problem.segments) {
    const MatrixXd& raw = columns[segment.log][segment.drive];
    if (raw.size() > 0) white.segment(segment.offset, segment.rows()) = segment.whitener.apply(raw * amplitude);
  }
  const VectorXd norm = problem.X.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  const MatrixXd scaled = problem.X * norm.asDiagonal();
  Remainder out;
  out.beta = norm.asDiagonal() * dense::least_norm(scaled.transpose() * scaled, scaled.transpose() * white);
  const Index b = context.base.count();
  for (std::size_t l = 0; l < context.logs.size(); ++l) {
    out.torque.emplace_back();
    for (std::size_t j = 0; j < context.logs[l].usable.size(); ++j) {
      VectorXd torque = -context.logs[l].Y[j] * out.beta.head(b);
      if (columns[l][j].size() > 0) torque += columns[l][j] * amplitude;
      if (out.beta.size() > b) torque -= problem.extra[l][j] * out.beta.tail(out.beta.size() - b);
      out.torque.back().push_back(std::move(torque));
    }
  }
  return out;
}

VectorXd remaining_torque(const WhiteProblem& problem, const Fit& fit) {
  const WhiteColumns white = problem.whiten(fit.rows);
  if (white.cols() < fit.effect.amplitude.size()) return VectorXd::Zero(problem.rows);
  return problem.projected(white) * fit.effect.amplitude;
}

VectorXd remaining_squares_by_drive(const SearchContext& context, const WhiteProblem& problem, const Fit& fit) {
  VectorXd out = VectorXd::Zero(context.robot.drives());
  const VectorXd left = remaining_torque(problem, fit);
  for (const WhiteSegment& segment : problem.segments)
    out(static_cast<Index>(segment.drive)) += left.segment(segment.offset, segment.rows()).squaredNorm();
  return out;
}

VectorXd noise_shares(const SearchContext& context, const Remainder& remainder, const PerLogAndDrive<double>& floor) {
  const std::size_t drives = context.logs.front().usable.size();
  VectorXd out(static_cast<Index>(drives));
  for (std::size_t j = 0; j < drives; ++j) {
    double square = 0, noise = 0;
    for (std::size_t l = 0; l < context.logs.size(); ++l) {
      const RowMask& usable = context.logs[l].usable[j];
      square += usable.select(remainder.torque[l][j].array(), 0.0).square().sum();
      noise += static_cast<double>(usable.count()) * floor[l][j] * floor[l][j];
    }
    out(static_cast<Index>(j)) = square / std::max(noise, 1e-300);
  }
  return out;
}

}  // namespace deltadyn::detail
