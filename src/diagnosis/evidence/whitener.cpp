#include "whitener.hpp"

#include <algorithm>

#include "deltadyn/runtime/dense.hpp"

namespace deltadyn {

namespace {

constexpr double kNegligible = 0.2;   // size of an unknown direction in white rows, in standard deviations of the noise
constexpr double kGramRidge = 1e-10;  // on the Gram matrix of unit vectors, as neighbours may share a direction
constexpr double kShared = 1e-6;      // pivot of a direction that its neighbours hold already

/// Innovations of rows of which all before are zero, as many more as the noise remembers.
MatrixXd innovations_after(const NoiseModel& noise, const MatrixXd& x) {
  const Index p = noise.order();
  MatrixXd out = MatrixXd::Zero(x.rows() + p, x.cols());
  out.topRows(x.rows()) = x;
  for (Index k = 0; k < p; ++k) out.middleRows(k + 1, x.rows()) -= noise.ar(k) * x;
  return out;
}

/// The orthonormal directions along which white noise would not hide them.
MatrixXd that_matter(const MatrixXd& white) {
  const dense::Spectrum spectrum = dense::spectrum(white.transpose() * white);
  const VectorXd& squares = spectrum.values;
  Index kept = 0;
  while (kept < squares.size() && squares(squares.size() - 1 - kept) > kNegligible * kNegligible) ++kept;
  return white * spectrum.vectors.rightCols(kept) * squares.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
}

}  // namespace

Whitener::Whitener(const NoiseModel& noise, const RowMask& present, const std::vector<UnknownTorque>& unknown)
    : noise_(noise), present_(present) {
  const Index N = present.size();
  const Index p = noise.order();
  const auto add = [&](Index first, const MatrixXd& basis) {
    // Innovations are known from row p on.
    const Index skip = std::max<Index>(0, p - first), rows = std::min(N - first, basis.rows()) - skip;
    if (rows <= 0) return;
    MatrixXd orthonormal = that_matter(basis.middleRows(skip, rows));
    if (orthonormal.cols() > 0) taken_.push_back({first + skip, std::move(orthonormal)});
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
      for (Index k = t; k < end; ++k) add(k, innovations_after(noise, MatrixXd::Ones(1, 1)));
    }
    t = end;
  }
  for (const UnknownTorque& stretch : unknown) {
    MatrixXd directions = stretch.directions;
    for (Index k = 0; k < directions.rows(); ++k) {
      if (!present(stretch.first + k)) directions.row(k).setZero();
    }
    add(stretch.first, innovations_after(noise, directions) / noise.std);
  }
  for (Directions& one : taken_) {
    for (Index k = 0; k < one.basis.rows(); ++k) {
      if (lost(one.first + k)) one.basis.row(k).setZero();
    }
  }
  std::sort(taken_.begin(), taken_.end(), [](const Directions& a, const Directions& b) { return a.first < b.first; });
  for (Index t = p; t < N; ++t) {
    if (!lost(t)) source_.push_back(t);
  }
  freedom_ = rows();
  factorise();
}

void Whitener::factorise() {
  if (taken_.empty()) return;
  std::vector<Eigen::Triplet<double>> entries;
  Index column = 0;
  std::vector<Index> start;
  for (const Directions& one : taken_) {
    start.push_back(column);
    column += one.basis.cols();
  }
  for (std::size_t a = 0; a < taken_.size(); ++a) {
    // Sorted by their first rows: only the next few meet this one.
    for (std::size_t b = a; b < taken_.size() && taken_[b].first < taken_[a].end(); ++b) {
      const Index first = taken_[b].first, end = std::min(taken_[a].end(), taken_[b].end());
      const MatrixXd block = taken_[b].basis.topRows(end - first).transpose() *
                             taken_[a].basis.middleRows(first - taken_[a].first, end - first);
      for (Index r = 0; r < block.rows(); ++r) {
        for (Index c = 0; c < block.cols(); ++c) {
          if (a != b || r >= c)
            entries.emplace_back(start[b] + r, start[a] + c, block(r, c) + (a == b && r == c ? kGramRidge : 0.0));
        }
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(column, column);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const auto gram = std::make_shared<Gram>(matrix);
  const VectorXd pivots = VectorXd(Eigen::SparseMatrix<double>(gram->matrixL()).diagonal()).cwiseAbs2();
  freedom_ -= (pivots.array() > kShared).count();
  gram_ = gram;
}

MatrixXd Whitener::innovations_of_all_rows(const Eigen::Ref<const MatrixXd>& x) const {
  const Index p = noise_.order(), N = x.rows();
  MatrixXd known = x / noise_.std;
  for (Index t = 0; t < N; ++t) {
    if (!present_(t)) known.row(t).setZero();
  }
  MatrixXd out = known.bottomRows(N - p);  // of rows p, p + 1, ...
  for (Index k = 0; k < p; ++k) out -= noise_.ar(k) * known.middleRows(p - 1 - k, N - p);
  return out;
}

void Whitener::take_out(MatrixXd& innovations) const {
  if (gram_ == nullptr) return;
  const Index p = noise_.order();
  MatrixXd parts(gram_->rows(), innovations.cols());
  Index at = 0;
  for (const Directions& one : taken_) {
    parts.middleRows(at, one.basis.cols()).noalias() =
        one.basis.transpose() * innovations.middleRows(one.first - p, one.basis.rows());
    at += one.basis.cols();
  }
  parts = gram_->solve(parts).eval();
  at = 0;
  for (const Directions& one : taken_) {
    innovations.middleRows(one.first - p, one.basis.rows()).noalias() -=
        one.basis * parts.middleRows(at, one.basis.cols());
    at += one.basis.cols();
  }
}

MatrixXd Whitener::rows_of(const MatrixXd& innovations) const {
  if (rows() == innovations.rows()) return innovations;
  MatrixXd out(rows(), innovations.cols());
  for (Index c = 0; c < out.cols(); ++c) {
    for (Index k = 0; k < rows(); ++k)
      out(k, c) = innovations(source_[static_cast<std::size_t>(k)] - noise_.order(), c);
  }
  return out;
}

MatrixXd Whitener::apply(const Eigen::Ref<const MatrixXd>& x) const {
  if (rows() == 0) return MatrixXd(0, x.cols());
  MatrixXd all = innovations_of_all_rows(x);
  take_out(all);
  return rows_of(all);
}

MatrixXd Whitener::innovations(const Eigen::Ref<const MatrixXd>& x) const {
  return rows() == 0 ? MatrixXd(0, x.cols()) : rows_of(innovations_of_all_rows(x));
}

VectorXd Whitener::known_part(const Eigen::Ref<const VectorXd>& white) const {
  if (rows() == 0) return white;
  MatrixXd all = MatrixXd::Zero(present_.size() - noise_.order(), 1);
  for (Index k = 0; k < rows(); ++k) all(source_[static_cast<std::size_t>(k)] - noise_.order(), 0) = white(k);
  take_out(all);
  return rows_of(all);
}

}  // namespace deltadyn
