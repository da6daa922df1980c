#pragma once

/// \file
/// The optimisation problem (9)-(11) in one vector of variables: value, exact gradient, and the limits in a smooth
/// form.

#include <Eigen/Core>
#include <vector>

#include "deltadyn/excitation/criterion.hpp"
#include "deltadyn/excitation/design_space.hpp"
#include "deltadyn/trajectory/fourier_series.hpp"

namespace deltadyn::detail {

struct ProblemSettings : MotionGoal {
  int samples = 100;  ///< of the period
  int windows = 4;    ///< parts of the period in which each limit is gathered into one constraint
  /// Of the smooth maximum over a window: it lies above the true one by log(samples)/sharpness at most
  double sharpness = 60;
  /// Width of the smooth Coulomb sign as a share of the joint's rate scale; 0: true sign
  double sign_share = 0.02;
  Eigen::MatrixXd other_information;  ///< of the other segments, times their shares of time; empty: none
  double share = 1;                   ///< share of time of this segment
};

/// Variables v: the coefficients in units of the largest amplitude that the limits allow them, then the base frequency
/// between 0 (lowest) and 1 (highest).
class DesignProblem {
 public:
  struct Evaluation {
    bool regular = false;         ///< false: a pose is out of reach or the information singular
    double value = 0;             ///< criterion + velocity term, to be made large
    Eigen::VectorXd gradient;     ///< by v
    Eigen::VectorXd constraints;  ///< one a limit and window, then one a drive for its reversals; kept if <= 0
    Eigen::MatrixXd jacobian;     ///< variables x constraints
    double worst = 0;             ///< largest load of any limit at the samples
    double lacks_away = 0;        ///< by how much some drive misses its share away from reversals
    Eigen::MatrixXd information;  ///< of this segment alone
  };

  DesignProblem(const DesignSpace& space, const MotionLimits& limits, const ProblemSettings& settings);

  [[nodiscard]] int variables() const { return static_cast<int>(scale_.size()) + 1; }
  [[nodiscard]] int constraints() const {
    return static_cast<int>(list_.size()) * settings_.windows + (minds_reversals() ? space_.regressor->drives() : 0);
  }
  [[nodiscard]] FourierSeries series(const Eigen::VectorXd& v) const;
  [[nodiscard]] Eigen::VectorXd variables_of(const FourierSeries& series) const;
  /// \param derivatives  false leaves gradient and jacobian empty
  void evaluate(const Eigen::VectorXd& v, bool derivatives, Evaluation& out) const;
  [[nodiscard]] const ProblemSettings& settings() const { return settings_; }

 private:
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  struct Samples;
  [[nodiscard]] bool minds_reversals() const { return settings_.reversal_reach_s > 0 && settings_.least_away > 0; }
  void add_reversals(const Samples& samples, bool derivatives, Evaluation& out) const;
  /// Adds the gradient by v of a quantity with the gradient g by the state of sample i.
  template <class Out>
  void chain(const Samples& samples, Eigen::Index i, const Eigen::VectorXd& g, Out&& out) const;
  void limit_gradient(const Limit& limit, const Samples& samples, Eigen::Index i, Eigen::VectorXd& g) const;

  const DesignSpace& space_;
  MotionLimits limits_;
  ProblemSettings settings_;
  std::vector<Limit> list_;
  Eigen::MatrixXd scale_matrix_;
  Eigen::VectorXd scale_;  ///< of the coefficients, column after column
  Eigen::VectorXd sign_width_;
  Eigen::VectorXd rate_unit_;  ///< of the drives: their limit, else the states' scale
  Eigen::MatrixXd basis_[3];   ///< samples x (1 + 2 harmonics)
};

}  // namespace deltadyn::detail
