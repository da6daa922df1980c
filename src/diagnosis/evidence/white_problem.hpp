#pragma once

/// \file
/// The regression of all logs and drives in white, unit-variance rows, with the base model projected out: a candidate
/// counts only by its part orthogonal to what a re-fit of the base parameters would absorb.

#include <vector>

#include "log_rows.hpp"
#include "noise_model.hpp"
#include "whitener.hpp"

namespace deltadyn {

/// White rows of one drive in one log.
struct WhiteSegment {
  std::size_t log = 0, drive = 0;
  Index offset = 0;  ///< of its rows among all rows
  Whitener whitener;

  [[nodiscard]] Index rows() const { return whitener.rows(); }
};

/// Of a column's square: below, rounding alone is left of it beside the base model.
inline constexpr double kAbsorbed = 1e-5;

/// Columns in white rows, one block a segment (empty where the column is zero).
struct WhiteColumns {
  std::vector<MatrixXd> blocks;
  MatrixXd base;  ///< Q^T C

  [[nodiscard]] Index cols() const { return base.cols(); }

  /// C_perp^T C_perp.
  [[nodiscard]] MatrixXd gram(Index first, Index count) const;
  /// The same, zero in rows and columns of which the projection leaves rounding only.
  [[nodiscard]] MatrixXd clear_gram(Index first, Index count) const;
  /// C^T C without projection.
  [[nodiscard]] MatrixXd raw_gram(Index first, Index count) const;
  /// Columns [first, first + count) alone.
  [[nodiscard]] WhiteColumns part(Index first, Index count) const;
};

/// a^T b between the projected columns of two sets.
[[nodiscard]] MatrixXd cross_gram(const WhiteColumns& a, const WhiteColumns& b);

class WhiteProblem {
 public:
  /// \param extra_columns  of effects that the model holds already, [log][drive] rows x e; may be empty
  WhiteProblem(const std::vector<LogRows>& logs, const PerLogAndDrive<NoiseModel>& noise,
               const PerLogAndDrive<MatrixXd>& extra_columns = {});

  [[nodiscard]] WhiteColumns whiten(const PerLogAndDrive<MatrixXd>& columns) const;
  /// C_perp over all rows.
  [[nodiscard]] MatrixXd projected(const WhiteColumns& C) const;
  /// C_perp^T r for a residual with its Q^T r, and for the problem's own.
  [[nodiscard]] VectorXd inner(const WhiteColumns& C, const VectorXd& residual, const VectorXd& Q_residual) const;
  [[nodiscard]] VectorXd inner(const WhiteColumns& C) const { return inner(C, r, Q_r); }

  std::vector<WhiteSegment> segments;
  Index rows = 0;
  Index freedom = 0;  ///< rows less the directions that nothing is known of
  MatrixXd X;         ///< white regressor
  MatrixXd Q;         ///< orthonormal basis of its columns: rows x rank
  VectorXd y, r;      ///< white torque, and its part orthogonal to Q
  VectorXd Q_r;       ///< Q^T r
  /// Base parameters, then amplitudes of `extra` (least norm where the logs do not tell)
  VectorXd beta;
  PerLogAndDrive<MatrixXd> extra;  ///< as given
};

}  // namespace deltadyn
