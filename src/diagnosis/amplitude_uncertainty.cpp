#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "diagnosis_steps.hpp"

namespace deltadyn::detail {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kShapeStep = 0.02;  // of a shape parameter, either way
constexpr double kBlock_s = 0.25;    // longer than any memory that counts as noise
constexpr double kLeastBlocks = 12;  // from which blocks say anything about the noise

/// Shape parameters that the search moves freely.
std::vector<Index> free_shapes(const Effect& effect) {
  const EffectKind& kind = effect_kind(effect.id);
  std::vector<Index> out;
  if (kind.tied || effect.id == EffectId::kinematic_offset) return out;
  for (std::size_t k = 0; k < kind.shapes.size(); ++k) {
    const EffectShape& shape = kind.shapes[k];
    if (shape.scale == ShapeScale::logs || shape.name == "recorded") continue;
    if (shape.name == "exponent" && effect.id != EffectId::convex_viscous) continue;
    if (effect.id == EffectId::shear_thinning && effect.shape(1) > 0) continue;
    out.push_back(static_cast<Index>(k));
  }
  return out;
}

/// The effect's torque with another shape, white and beside the base model.
VectorXd white_torque(const SearchContext& context, const WhiteProblem& problem, const Fit& fit, const VectorXd& shape) {
  Hypothesis one = context.search.hypotheses()[fit.hypothesis];
  one.shapes = {shape};
  PerLogAndDrive<MatrixXd> rows;
  for (const LogRows& log : context.logs) rows.push_back(hypothesis_rows(context.model, log, log.signals, one));
  const WhiteColumns white = problem.whiten(rows);
  const Index k = fit.effect.amplitude.size();
  if (white.cols < k) return VectorXd::Zero(problem.rows);
  return white.projected(problem.Q, problem.segments, 0, k) * fit.effect.amplitude;
}

}  // namespace

VectorXd amplitude_std(const SearchContext& context, const EffectSearch::State& state, const Fit& fit) {
  const WhiteProblem& problem = *state.problem;
  const Index k = fit.effect.amplitude.size();
  if (fit.white.cols < k) return VectorXd::Zero(k);
  const std::vector<Index> shapes = free_shapes(fit.effect);
  MatrixXd J(problem.rows, k + static_cast<Index>(shapes.size()));
  J.leftCols(k) = fit.white.projected(problem.Q, problem.segments, 0, k);
  const VectorXd r = problem.r - J.leftCols(k) * fit.effect.amplitude;
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    VectorXd up = fit.effect.shape, down = up;
    const double step = kShapeStep * std::abs(up(shapes[s]));
    up(shapes[s]) += step;
    down(shapes[s]) -= step;
    J.col(k + static_cast<Index>(s)) =
        (white_torque(context, problem, fit, up) - white_torque(context, problem, fit, down)) / (2 * kShapeStep);
  }
  const VectorXd scale = J.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  J = J * scale.asDiagonal();
  const MatrixXd inverse = MatrixXd(J.transpose() * J).completeOrthogonalDecomposition().pseudoInverse();
  VectorXd variance = inverse.diagonal();
  // White noise of unit size is the model's own opinion; blocks of rows tell what the residual says (White 1980, by clusters).
  MatrixXd scatter = MatrixXd::Zero(J.cols(), J.cols());
  double blocks = 0;
  for (const WhiteSegment& segment : problem.segments) {
    const LogRows& log = context.logs[segment.log];
    const auto& source = segment.whitener.source();
    for (std::size_t begin = 0; begin < source.size();) {
      std::size_t end = begin;
      while (end < source.size() && log.t_s(source[end]) - log.t_s(source[begin]) <= kBlock_s) ++end;
      const Index at = segment.offset + static_cast<Index>(begin), count = static_cast<Index>(end - begin);
      const VectorXd score = J.middleRows(at, count).transpose() * r.segment(at, count);
      scatter += score * score.transpose();
      ++blocks;
      begin = end;
    }
  }
  if (blocks >= kLeastBlocks) variance = variance.cwiseMax((inverse * scatter * inverse).diagonal() * (blocks / (blocks - 1)));
  return scale.head(k).cwiseProduct(variance.head(k).cwiseMax(0.0).cwiseSqrt());
}

}  // namespace deltadyn::detail
