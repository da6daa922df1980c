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
  [[nodiscard]] Eigen::Index rows() const { return static_cast<Eigen::Index>(source_.size()); }
  /// Rows less the unknown directions: what a sum of squares of noise comes to.
  [[nodiscard]] Eigen::Index freedom() const { return freedom_; }
  /// \param x  one row a row of the log, any number of columns; what stands in rows that are not present does not
  ///           matter
  [[nodiscard]] Eigen::MatrixXd apply(const Eigen::Ref<const Eigen::MatrixXd>& x) const;
  /// The same without taking out what is unknown: enough for inner products with what it has been taken out of.
  [[nodiscard]] Eigen::MatrixXd innovations(const Eigen::Ref<const Eigen::MatrixXd>& x) const;
  /// Takes what is unknown out of white rows.
  [[nodiscard]] Eigen::VectorXd known_part(const Eigen::Ref<const Eigen::VectorXd>& white) const;
  /// Row of the log that each white row stands for (for maps of the residual).
  [[nodiscard]] const std::vector<Eigen::Index>& source() const { return source_; }

 private:
  /// Orthonormal directions of the innovations of rows [first, first + basis.rows()).
  struct Directions {
    Eigen::Index first;
    Eigen::MatrixXd basis;

    [[nodiscard]] Eigen::Index end() const { return first + basis.rows(); }
  };
  using Gram = Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>;

  void factorise();
  [[nodiscard]] Eigen::MatrixXd innovations_of_all_rows(const Eigen::Ref<const Eigen::MatrixXd>& x) const;
  void take_out(Eigen::MatrixXd& innovations) const;
  [[nodiscard]] Eigen::MatrixXd rows_of(const Eigen::MatrixXd& innovations) const;

  NoiseModel noise_;
  RowMask present_;
  std::vector<Directions> taken_;     ///< out of the innovations; each meets only its neighbours
  std::shared_ptr<const Gram> gram_;  ///< of all directions with each other
  std::vector<Eigen::Index> source_;
  Eigen::Index freedom_ = 0;
};

}  // namespace deltadyn
