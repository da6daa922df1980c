#include <algorithm>
#include <cmath>

#include "deltadyn/runtime/dense.hpp"

#include "remainder.hpp"

namespace deltadyn::detail {

namespace {

constexpr double kShapeStep = 0.02;  // of a shape parameter, either way
constexpr double kBlock_s = 0.25;    // longer than any memory that counts as noise
constexpr double kLeastBlocks = 12;  // from which blocks say anything about the noise

/// Shape parameters that are fitted beside the amplitudes.
std::vector<Index> free_shapes(const Effect& effect) {
  const EffectKind& kind = effect_kind(effect.id);
  std::vector<Index> out;
  if (kind.tied) return out;
  for (std::size_t k = 0; k < kind.shapes.size(); ++k) {
    if (shape_is_free(effect.id, k, effect.shape)) out.push_back(static_cast<Index>(k));
  }
  return out;
}

/// The effect's torque with another shape, white and beside the base model.
VectorXd white_torque(const SearchContext& context, const WhiteProblem& problem, const Fit& fit,
                      const VectorXd& shape) {
  Fit other = fit;
  other.effect.shape = shape;
  other.rows = hypothesis_rows(context.model, context.logs, hypothesis_of(other.effect));
  return remaining_torque(problem, other);
}

}  // namespace

std::vector<std::pair<Index, Index>> row_blocks(const SearchContext& context, const WhiteSegment& segment) {
  const VectorXd& t_s = context.logs[segment.log].t_s;
  const auto& source = segment.whitener.source();
  std::vector<std::pair<Index, Index>> out;
  for (std::size_t begin = 0; begin < source.size();) {
    std::size_t end = begin;
    while (end < source.size() && t_s(source[end]) - t_s(source[begin]) <= kBlock_s) ++end;
    out.emplace_back(segment.offset + static_cast<Index>(begin), static_cast<Index>(end - begin));
    begin = end;
  }
  return out;
}

void set_uncertainty(const SearchContext& context, const EffectSearch::State& state, Fit& fit) {
  const WhiteProblem& problem = *state.problem;
  const Index k = fit.effect.amplitude.size();
  fit.effect.amplitude_std = VectorXd::Zero(k);
  fit.effect.shape_std = VectorXd::Constant(fit.effect.shape.size(), std::nan(""));
  if (fit.white.cols() < k) return;
  const std::vector<Index> shapes = free_shapes(fit.effect);
  MatrixXd J(problem.rows, k + static_cast<Index>(shapes.size()));
  J.leftCols(k) = problem.projected(fit.white);
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
  const MatrixXd inverse = dense::pseudo_inverse(J.transpose() * J);
  VectorXd variance = inverse.diagonal();
  // White noise of unit size is the model's own opinion; blocks of rows tell what the residual says (White 1980, by
  // clusters).
  MatrixXd scatter = MatrixXd::Zero(J.cols(), J.cols());
  double blocks = 0;
  for (const WhiteSegment& segment : problem.segments) {
    for (const auto& [first, count] : row_blocks(context, segment)) {
      const VectorXd score = J.middleRows(first, count).transpose() * r.segment(first, count);
      scatter += score * score.transpose();
      ++blocks;
    }
  }
  if (blocks >= kLeastBlocks)
    variance = variance.cwiseMax((inverse * scatter * inverse).diagonal() * (blocks / (blocks - 1)));
  const VectorXd std = scale.cwiseProduct(variance.cwiseMax(0.0).cwiseSqrt());
  const double form = effect_kind(fit.effect.id).form.amplitude;
  fit.effect.amplitude_std = (std.head(k).cwiseAbs2() + (form * fit.effect.amplitude).cwiseAbs2()).cwiseSqrt();
  if (effect_kind(fit.effect.id).tied) fit.effect.shape_std(0) = fit.effect.amplitude_std(0);
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    // The columns are derivatives by the logarithm of the shape.
    fit.effect.shape_std(shapes[s]) =
        std::hypot(std(k + static_cast<Index>(s)), form) * std::abs(fit.effect.shape(shapes[s]));
  }
}

}  // namespace deltadyn::detail
