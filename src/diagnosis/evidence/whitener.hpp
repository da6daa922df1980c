#pragma once

/// \file
/// The filter that turns a torque residual white, over rows that are missing or partly unknown.

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <memory>
#include <vector>

#include "noise_model.hpp"
#include "unknown_torque.hpp"

namespace deltadyn {

/// Linear map from a series to white, unit-variance rows that does not see what is unknown: rows that are not present,
/// and the directions of unknown torque. They are projected out of the innovations, which is generalised least squares
/// with them as free parameters (Frisch and Waugh 1933): inner products of two mapped series are those of the parts
/// that can be known.
class Whitener {
 public:
  Whitener() = default;
  Whitener(const NoiseModel& noise, const RowMask& present, const std::vector<UnknownTorque>& unknown = {});

  [[nodiscard]] const NoiseModel& noise() const { return noise_; }
  [[nodiscard]] Index rows() const { return static_cast<Index>(source_.size()); }
  /// Rows less the unknown directions: what a sum of squares of noise comes to.
  [[nodiscard]] Index freedom() const { return freedom_; }
  /// \param x  one row a row of the log, any number of columns; what stands in rows that are not present does not
  ///           matter
  [[nodiscard]] MatrixXd apply(const Eigen::Ref<const MatrixXd>& x) const;
  /// The same without taking out what is unknown: enough for inner products with what it has been taken out of.
  [[nodiscard]] MatrixXd innovations(const Eigen::Ref<const MatrixXd>& x) const;
  /// Takes what is unknown out of white rows.
  [[nodiscard]] VectorXd known_part(const Eigen::Ref<const VectorXd>& white) const;
  /// Row of the log that each white row stands for (for maps of the residual).
  [[nodiscard]] const std::vector<Index>& source() const { return source_; }

 private:
  /// Orthonormal directions of the innovations of rows [first, first + basis.rows()).
  struct Directions {
    Index first;
    MatrixXd basis;

    [[nodiscard]] Index end() const { return first + basis.rows(); }
  };
  using Gram = Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>;

  void factorise();
  [[nodiscard]] MatrixXd innovations_of_all_rows(const Eigen::Ref<const MatrixXd>& x) const;
  void take_out(MatrixXd& innovations) const;
  [[nodiscard]] MatrixXd rows_of(const MatrixXd& innovations) const;

  NoiseModel noise_;
  RowMask present_;
  std::vector<Directions> taken_;     ///< out of the innovations; each meets only its neighbours
  std::shared_ptr<const Gram> gram_;  ///< of all directions with each other
  std::vector<Index> source_;
  Index freedom_ = 0;
};

}  // namespace deltadyn
