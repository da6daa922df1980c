#pragma once

/// \file
/// The regression of all logs and drives in white, unit-variance rows, with the base model projected out: a candidate
/// counts only by its part orthogonal to what a re-fit of the base parameters would absorb.

#include <vector>

#include "hypothesis.hpp"
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

/// The whitened signatures of one hypothesis, all shapes.
struct Signature {
  WhiteColumns white;
  std::vector<MatrixXd> gram;  ///< of each shape, projected
  /// Of each shape: share of gram that is not encoder noise in the columns (1: none is known)
  std::vector<double> clean;
  std::vector<double> kept;  ///< of each shape: share of its (smallest direction's) square that a re-fit cannot absorb
};

[[nodiscard]] Signature make_signature(const WhiteProblem& problem, const Hypothesis& hypothesis,
                                       const PerLogAndDrive<MatrixXd>& rows);

struct Score {
  double gain = 0;
  std::size_t shape = 0;
  VectorXd amplitude;
};

/// Supremum of the gain over the shapes. Shapes that a re-fit absorbs count as nothing.
/// \param inner  C_perp^T r of all columns, WhiteProblem::inner
[[nodiscard]] Score best_score(const Hypothesis& hypothesis, const Signature& signature, const VectorXd& inner);

}  // namespace deltadyn
