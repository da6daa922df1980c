#include "deltadyn/diagnosis/whitener.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace deltadyn {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kNegligible = 0.2;  // size of an unknown direction in white rows, in standard deviations of the noise
constexpr double kRank = 1e-6;

/// Directions of the innovations of rows [first, first + basis.rows()).
struct Directions {
  Index first;
  MatrixXd basis;

  [[nodiscard]] Index end() const { return first + basis.rows(); }
};

/// Innovations of rows of which all before are zero, as many more as the noise remembers.
MatrixXd innovations(const NoiseModel& noise, const MatrixXd& x) {
  const Index p = noise.order();
  MatrixXd out = MatrixXd::Zero(x.rows() + p, x.cols());
  out.topRows(x.rows()) = x;
  for (Index k = 0; k < p; ++k) out.middleRows(k + 1, x.rows()) -= noise.ar(k) * x;
  return out;
}

/// Innovations of rows [earliest, end) only.
Directions inside(Index first, const MatrixXd& basis, Index earliest, Index end) {
  const Index skip = std::max<Index>(0, earliest - first);
  const Index rows = std::max<Index>(0, std::min(end - first, basis.rows()) - skip);
  return {first + skip, basis.middleRows(std::min(skip, basis.rows()), rows)};
}

/// The orthonormal directions along which white noise would not hide them.
MatrixXd that_matter(const MatrixXd& white) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(white.transpose() * white);
  const VectorXd& squares = eigen.eigenvalues();
  Index kept = 0;
  while (kept < squares.size() && squares(squares.size() - 1 - kept) > kNegligible * kNegligible) ++kept;
  return white * eigen.eigenvectors().rightCols(kept) * squares.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
}

}  // namespace

Whitener::Whitener(const NoiseModel& noise, const RowMask& present, const std::vector<UnknownTorque>& unknown)
    : noise_(noise), present_(present) {
  const Index N = present.size();
  const Index p = noise.order();
  std::vector<Directions> all;
  const auto add = [&](Index first, const MatrixXd& basis) {
    Directions one = inside(first, basis, p, N);
    if (one.basis.size() > 0) all.push_back(std::move(one));
  };
  // Rows that are not there. Of a run longer than the memory, and of the memory after it, nothing is left.
  RowMask lost = RowMask::Constant(N, false);
  for (Index t = 0; t < N; ++t) {
    if (present(t)) continue;
    Index end = t;
    while (end < N && !present(end)) ++end;
    if (end - t >= p) {
      lost.segment(t, std::min(end + p, N) - t).setConstant(true);
    } else {
      for (Index k = t; k < end; ++k) add(k, innovations(noise, MatrixXd::Ones(1, 1)));
    }
    t = end;
  }
  for (const UnknownTorque& stretch : unknown) {
    MatrixXd directions = stretch.directions;
    for (Index k = 0; k < directions.rows(); ++k) {
      if (!present(stretch.first + k)) directions.row(k).setZero();
    }
    const Directions one = inside(stretch.first, innovations(noise, directions) / noise.std, p, N);
    if (one.basis.size() > 0) add(one.first, that_matter(one.basis));
  }
  std::sort(all.begin(), all.end(), [](const Directions& a, const Directions& b) { return a.first < b.first; });
  for (std::size_t k = 0; k < all.size();) {
    Index end = all[k].end(), columns = 0;
    std::size_t last = k;
    for (; last < all.size() && all[last].first < end; ++last) {
      end = std::max(end, all[last].end());
      columns += all[last].basis.cols();
    }
    const Index first = all[k].first;
    MatrixXd together = MatrixXd::Zero(end - first, columns);
    for (Index at = 0; k < last; ++k) {
      together.block(all[k].first - first, at, all[k].basis.rows(), all[k].basis.cols()) = all[k].basis;
      at += all[k].basis.cols();
    }
    for (Index row = 0; row < together.rows(); ++row) {
      if (lost(first + row)) together.row(row).setZero();
    }
    Eigen::ColPivHouseholderQR<MatrixXd> qr(together);
    qr.setThreshold(kRank);
    clusters_.push_back({first, qr.householderQ() * MatrixXd::Identity(together.rows(), qr.rank())});
    freedom_ -= qr.rank();
  }
  for (Index t = p; t < N; ++t) {
    if (!lost(t)) source_.push_back(t);
  }
  freedom_ += rows();
}

MatrixXd Whitener::apply(const Eigen::Ref<const MatrixXd>& x) const {
  const Index p = noise_.order(), N = x.rows();
  MatrixXd out = MatrixXd::Zero(rows(), x.cols());
  if (rows() == 0) return out;
  MatrixXd known = x;
  for (Index t = 0; t < N; ++t) {
    if (!present_(t)) known.row(t).setZero();
  }
  MatrixXd innovation = known.bottomRows(N - p);  // of rows p, p + 1, ...
  for (Index k = 0; k < p; ++k) innovation -= noise_.ar(k) * known.middleRows(p - 1 - k, N - p);
  innovation /= noise_.std;
  MatrixXd part;
  for (const Cluster& cluster : clusters_) {
    auto seen = innovation.middleRows(cluster.first - p, cluster.basis.rows());
    part.noalias() = cluster.basis.transpose() * seen;
    seen.noalias() -= cluster.basis * part;
  }
  for (Index k = 0; k < rows(); ++k) out.row(k) = innovation.row(source_[static_cast<std::size_t>(k)] - p);
  return out;
}

}  // namespace deltadyn
