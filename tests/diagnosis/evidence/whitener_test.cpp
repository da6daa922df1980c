#include "../../../src/diagnosis/evidence/whitener.hpp"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "diagnosis/evidence/autoregression.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing_support::autoregression;

/// Two smooth bumps that overlap, one hundred times as large as the noise.
UnknownTorque bumps(Index first) {
  UnknownTorque out;
  out.first = first;
  out.directions.resize(12, 2);
  for (Index k = 0; k < 12; ++k) {
    const double x = (static_cast<double>(k) - 5.5) / 3;
    out.directions(k, 0) = 100 * std::exp(-x * x);
    out.directions(k, 1) = 100 * x * std::exp(-x * x);
  }
  return out;
}

TEST(Whitener, MakesWhiteRowsAroundGapsAndLosesNoRow) {
  NoiseModel model;
  model.ar = VectorXd::Constant(1, 0.95);
  RowMask present = RowMask::Constant(4000, true);
  for (Index t = 50; t + 30 < present.size(); t += 100) present.segment(t, 20).setConstant(false);
  const Whitener whitener(model, present);
  // One row of memory goes at the start and one after each of 40 gaps.
  EXPECT_EQ(whitener.freedom(), present.count() - 1 - 40);
  const VectorXd white = whitener.apply(autoregression(model.ar, 4000, 3));
  EXPECT_NEAR(white.squaredNorm() / static_cast<double>(whitener.freedom()), 1.0, 0.08);
  const Index n = white.size();
  EXPECT_NEAR(white.head(n - 1).dot(white.tail(n - 1)) / white.squaredNorm(), 0.0, 0.06);
}

TEST(Whitener, DoesNotCareWhatStandsInAGap) {
  NoiseModel model;
  model.ar = Eigen::Vector2d(1.2, -0.4);
  model.std = 0.5;
  for (const Index length : {1, 2, 25}) {  // shorter than the memory, as long, longer
    RowMask present = RowMask::Constant(300, true);
    present.segment(100, length).setConstant(false);
    const Whitener whitener(model, present);
    const VectorXd e = autoregression(model.ar, 300, 4);
    VectorXd other = e;
    other.segment(100, length).setConstant(1e6);
    EXPECT_LT((whitener.apply(e) - whitener.apply(other)).norm(), 1e-6);
  }
}

TEST(Whitener, DoesNotSeeUnknownDirectionsAndLosesNothingElse) {
  NoiseModel model;
  model.ar = Eigen::Vector2d(0.9, -0.3);
  const RowMask present = RowMask::Constant(400, true);
  // The second and the third overlap; the last one is cut by the end of the log.
  const std::vector<UnknownTorque> unknown = {bumps(60), bumps(200), bumps(206), bumps(388)};
  const Whitener whitener(model, present, unknown);
  EXPECT_EQ(whitener.freedom(), 400 - 2 - 8);
  VectorXd x = VectorXd::Zero(400);
  for (std::size_t k = 0; k < unknown.size(); ++k)
    x.segment(unknown[k].first, 12) += unknown[k].directions * Eigen::Vector2d(1.0 + static_cast<double>(k), -2.0);
  EXPECT_LT(whitener.apply(x).norm(), 1e-9 * x.norm());
  EXPECT_EQ(whitener.rows(), 398);

  // Inner products are those of the residuals of an ordinary fit of the directions to the innovations.
  const VectorXd e = autoregression(model.ar, 400, 5), other = autoregression(model.ar, 400, 6);
  const Whitener plain(model, present);
  MatrixXd U = MatrixXd::Zero(400, 8);
  for (std::size_t k = 0; k < unknown.size(); ++k)
    U.block(unknown[k].first, 2 * static_cast<Index>(k), 12, 2) = unknown[k].directions;
  const MatrixXd W = plain.apply(U);
  const VectorXd a = plain.apply(e), b = plain.apply(other);
  const MatrixXd normal = W.transpose() * W;
  const VectorXd inner_a = W.transpose() * a, inner_b = W.transpose() * b;
  const VectorXd solved = normal.ldlt().solve(inner_b);
  const double expected = a.dot(b) - inner_a.dot(solved);
  const VectorXd mapped = whitener.apply(e), mapped_other = whitener.apply(other);
  EXPECT_NEAR(mapped.dot(mapped_other), expected, 1e-8);
}

TEST(Whitener, NeedsToTakeTheUnknownOutOfOneSideOfAnInnerProductOnly) {
  NoiseModel model;
  model.ar = Eigen::Vector2d(0.9, -0.3);
  RowMask present = RowMask::Constant(400, true);
  present.segment(300, 30).setConstant(false);
  const Whitener whitener(model, present, {bumps(60), bumps(66), bumps(200)});
  const VectorXd e = autoregression(model.ar, 400, 7), other = autoregression(model.ar, 400, 8);
  const VectorXd a = whitener.apply(e), b = whitener.apply(other), plain = whitener.innovations(other);
  EXPECT_NEAR(a.dot(plain), a.dot(b), 1e-9);
  EXPECT_LT((whitener.known_part(plain) - b).norm(), 1e-9);
  EXPECT_GT((plain - b).norm(), 1);
}

TEST(Whitener, KeepsDirectionsThatTheNoiseHides) {
  const RowMask present = RowMask::Constant(100, true);
  NoiseModel loud;
  loud.std = 1e4;
  EXPECT_EQ(Whitener(loud, present, {bumps(40)}).freedom(), 100);
}

}  // namespace
}  // namespace deltadyn
