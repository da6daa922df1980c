#pragma once

/// \file
/// The consistent fit's view of the parameter vector: one block a body or scalar, with its cone, metric and free
/// variables.
///
/// Coordinates: p all parameters; y the fitted ones (a subset of p); x = (y, splits), the variables of the convex
/// problem. A split is S_aa - S_bb of a body of which only the sum S_aa + S_bb is fitted (upper arm, tool in the
/// reduced set).

#include <Eigen/Core>
#include <string>
#include <vector>

#include "deltadyn/identification/consistent_fit.hpp"
#include "deltadyn/model/log_cholesky.hpp"

namespace deltadyn::fit {

enum class BlockKind {
  spatial,   ///< a body whose fitted entries fill the 4 x 4 pseudo-inertia, others being 0
  planar,    ///< a body seen in one plane: mass, two first moments, one inertia
  point,     ///< a body of which only the mass is fitted
  positive,  ///< a scalar > 0
  free,      ///< a scalar of any sign
};

/// A symmetric matrix that is linear in the block's variables: base + sum x_i basis_i, in the leading size x size
/// corner.
struct LinearMatrix {
  int size = 0;
  Eigen::Matrix4d base = Eigen::Matrix4d::Zero();
  std::vector<Eigen::Matrix4d> basis;
  [[nodiscard]] Eigen::Matrix4d operator()(const Eigen::Ref<const Eigen::VectorXd>& x) const;
};

/// What is fitted of a body or scalar.
struct Fitted {
  BlockKind shape = BlockKind::free;
  std::vector<int> entries;    ///< fitted entries, counted from the block's first column
  std::vector<int> variables;  ///< free log-Cholesky variables
  int axes[2] = {0, 0};        ///< planar: the two axes of the plane
  int inertia = 0;             ///< planar: entry of the inertia about the plane's normal
};

struct Block : Fitted {
  std::string name;           ///< "strut2" or "drive1.viscous"
  int column = 0;             ///< first column of p
  int y = 0;                  ///< first index in y
  int split = -1;             ///< index in x, or -1
  bool fixed_alpha = false;   ///< planar: alpha is not a variable (upper arm, VI.b)
  bool has_reference = true;  ///< false: a positive scalar whose prior is 0, which no divergence can be taken from
  double mass_floor = 0;      ///< e^{2 alpha} of a fixed alpha: the mass stays above it
  /// Consistent body nearest to the prior; scalars: entry 0
  InertialVector<double> anchor = InertialVector<double>::Zero();
  LogCholeskyVector<double> pi = LogCholeskyVector<double>::Zero();  ///< of the anchor; scalars: entry 0
  LinearMatrix cone;    ///< positive definite on the consistent set, in (entries, split)
  LinearMatrix metric;  ///< what bregman and riemannian compare, in the entries; size 0: compared as in `relative`
  Eigen::Matrix4d metric_root = Eigen::Matrix4d::Zero();  ///< C with C C^T = inverse of the metric matrix of the anchor

  [[nodiscard]] bool is_body() const { return shape != BlockKind::positive && shape != BlockKind::free; }
  [[nodiscard]] int width() const { return is_body() ? 10 : 1; }
  [[nodiscard]] int fitted() const { return static_cast<int>(entries.size()); }
  /// The block's variables of the convex problem, entries then split.
  [[nodiscard]] Eigen::VectorXd gather(const Eigen::VectorXd& x) const;
};

struct Layout {
  std::vector<Block> blocks;
  int parameters = 0;  ///< size of p
  int fitted = 0;      ///< size of y
  int convex = 0;      ///< size of x
  int variables = 0;   ///< free variables of Ceres
  std::vector<int> y_to_p;
  Eigen::VectorXd prior;  ///< of y
  Eigen::VectorXd scale;  ///< of p: the metric `relative`
  std::vector<std::string> notes;
};

/// Checks sizes, parameters and prior; throws deltadyn::Error.
[[nodiscard]] Layout make_layout(const ConsistentFitProblem& problem, ParameterSet set);

/// The start of the convex problem, and the point that its barrier is centred on: the anchors, those next to the
/// boundary moved clear of it. From a thin body the way to any other is long, and far from it the barrier would
/// outweigh the data.
[[nodiscard]] Eigen::VectorXd convex_start(const Layout& layout);

/// Log-Cholesky variables of the block (scalars: entry 0) that give its fitted entries in x; the other variables stay
/// as in block.pi.
[[nodiscard]] LogCholeskyVector<double> variables_of(const Block& block, const Eigen::VectorXd& x);

/// Splits an inertia I = Sa + Sb so that a^2/Sa + b^2/Sb = mass with both positive; the smaller moment gets the room.
/// Needs (|a| + |b|)^2 <= mass I. Returns Sa.
[[nodiscard]] double split_inertia(double mass, double a, double b, double inertia);

}  // namespace deltadyn::fit
