#include "white_problem.hpp"

#include <algorithm>
#include <cmath>

#include "deltadyn/runtime/dense.hpp"

namespace deltadyn {

namespace {

constexpr double kRank = 1e-7;  // a direction of the regressor this much weaker than the strongest is rounding

}  // namespace

MatrixXd WhiteColumns::raw_gram(Index first, Index count) const {
  MatrixXd G = MatrixXd::Zero(count, count);
  for (const MatrixXd& block : blocks) {
    if (block.size() > 0) G.noalias() += block.middleCols(first, count).transpose() * block.middleCols(first, count);
  }
  return G;
}

MatrixXd WhiteColumns::gram(Index first, Index count) const {
  const auto part_of_base = base.middleCols(first, count);
  return raw_gram(first, count) - part_of_base.transpose() * part_of_base;
}

MatrixXd WhiteColumns::clear_gram(Index first, Index count) const {
  MatrixXd G = gram(first, count);
  const VectorXd raw = raw_gram(first, count).diagonal();
  for (Index c = 0; c < count; ++c) {
    if (G(c, c) >= kAbsorbed * raw(c)) continue;
    G.row(c).setZero();
    G.col(c).setZero();
  }
  return G;
}

WhiteColumns WhiteColumns::part(Index first, Index count) const {
  WhiteColumns out;
  out.base = base.middleCols(first, count);
  for (const MatrixXd& block : blocks)
    out.blocks.push_back(block.size() > 0 ? MatrixXd(block.middleCols(first, count)) : MatrixXd());
  return out;
}

MatrixXd cross_gram(const WhiteColumns& a, const WhiteColumns& b) {
  MatrixXd G = -a.base.transpose() * b.base;
  for (std::size_t s = 0; s < a.blocks.size(); ++s) {
    if (a.blocks[s].size() > 0 && b.blocks[s].size() > 0) G.noalias() += a.blocks[s].transpose() * b.blocks[s];
  }
  return G;
}

WhiteProblem::WhiteProblem(const std::vector<LogRows>& logs, const PerLogAndDrive<NoiseModel>& noise,
                           const PerLogAndDrive<MatrixXd>& extra_columns)
    : extra(extra_columns) {
  for (std::size_t l = 0; l < logs.size(); ++l) {
    for (std::size_t j = 0; j < logs[l].usable.size(); ++j) {
      WhiteSegment segment{l, j, rows, Whitener(noise[l][j], logs[l].present[j], logs[l].unknown[j])};
      rows += segment.rows();
      freedom += segment.whitener.freedom();
      segments.push_back(std::move(segment));
    }
  }
  const Index b = logs.front().Y.front().cols();
  const Index e = extra.empty() ? 0 : extra.front().front().cols();
  X.resize(rows, b + e);
  y.resize(rows);
  for (const WhiteSegment& segment : segments) {
    const LogRows& log = logs[segment.log];
    auto target = X.middleRows(segment.offset, segment.rows());
    target.leftCols(b) = segment.whitener.apply(log.Y[segment.drive]);
    if (e > 0) target.rightCols(e) = segment.whitener.apply(extra[segment.log][segment.drive]);
    y.segment(segment.offset, segment.rows()) = segment.whitener.apply(log.tau.col(static_cast<Index>(segment.drive)));
  }
  const VectorXd norm = X.colwise().norm().transpose().cwiseMax(1e-300);
  const dense::PivotedQr qr(X * norm.cwiseInverse().asDiagonal(), kRank);
  Q = qr.basis();
  beta = norm.cwiseInverse().asDiagonal() * qr.solve(y);
  r = y - Q * (Q.transpose() * y);
  Q_r = Q.transpose() * r;
}

WhiteColumns WhiteProblem::whiten(const PerLogAndDrive<MatrixXd>& columns) const {
  WhiteColumns out;
  Index cols = 0;
  for (const auto& log : columns) {
    for (const MatrixXd& drive : log) cols = std::max(cols, drive.cols());
  }
  out.base = MatrixXd::Zero(Q.cols(), cols);
  for (const WhiteSegment& segment : segments) {
    const MatrixXd& raw = columns[segment.log][segment.drive];
    out.blocks.push_back(raw.size() > 0 ? segment.whitener.apply(raw) : MatrixXd());
    if (raw.size() > 0)
      out.base.noalias() += Q.middleRows(segment.offset, segment.rows()).transpose() * out.blocks.back();
  }
  return out;
}

MatrixXd WhiteProblem::projected(const WhiteColumns& C) const {
  MatrixXd out = -Q * C.base;
  for (std::size_t s = 0; s < C.blocks.size(); ++s) {
    if (C.blocks[s].size() > 0) out.middleRows(segments[s].offset, segments[s].rows()) += C.blocks[s];
  }
  return out;
}

VectorXd WhiteProblem::inner(const WhiteColumns& C, const VectorXd& residual, const VectorXd& Q_residual) const {
  VectorXd u = -C.base.transpose() * Q_residual;
  for (std::size_t s = 0; s < C.blocks.size(); ++s) {
    if (C.blocks[s].size() > 0)
      u.noalias() += C.blocks[s].transpose() * residual.segment(segments[s].offset, segments[s].rows());
  }
  return u;
}

}  // namespace deltadyn
