#include "torque_scale.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "deltadyn/runtime/dense.hpp"

namespace deltadyn::gate {

namespace {

using Eigen::Index;

constexpr Index kPoses = 60;        // of the log, to average gravity and inertia over
constexpr double kMemory = 3.0;     // of the residual at the spacing of the points, a cautious guess
constexpr double kFullTrust = 0.7;  // a prior's relative deviation above this says no more than this

struct Estimate {
  Eigen::VectorXd beta;
  Eigen::MatrixXd covariance;
};

std::optional<Estimate> estimate(const Robot& robot, const BaseParameters& base, const Points& points) {
  const int n = robot.drives();
  const Rows rows = rows_of_points(robot, base, points, Reading::as_given(n));
  const int B = base.count();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(B, B);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(B), weight = Eigen::VectorXd::Ones(n);
  std::vector<Eigen::VectorXd> tau;
  Index total = 0;
  for (int j = 0; j < n; ++j) {
    const DriveRows& drive = rows.drives[static_cast<std::size_t>(j)];
    tau.emplace_back(drive.of_points(points.tau.col(j)));
    weight(j) = static_cast<double>(drive.count()) / std::max(tau.back().squaredNorm(), 1e-300);
    total += drive.count();
  }
  if (total < 3 * B) return std::nullopt;
  Estimate out;
  for (int pass = 0; pass < 3; ++pass) {
    A.setZero();
    b.setZero();
    for (int j = 0; j < n; ++j) {
      const Eigen::MatrixXd& Y = rows.drives[static_cast<std::size_t>(j)].Y;
      A += weight(j) * Y.transpose() * Y;
      b += weight(j) * Y.transpose() * tau[static_cast<std::size_t>(j)];
    }
    const Eigen::VectorXd scale = A.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    Eigen::MatrixXd scaled = scale.asDiagonal() * A * scale.asDiagonal();
    scaled.diagonal().array() += 1e-11;
    const Eigen::MatrixXd inverse = dense::solve_symmetric(scaled, Eigen::MatrixXd(Eigen::MatrixXd::Identity(B, B)));
    out.covariance = scale.asDiagonal() * inverse * scale.asDiagonal();
    out.beta = out.covariance * b;
    for (int j = 0; j < n; ++j) {
      const Eigen::VectorXd r =
          tau[static_cast<std::size_t>(j)] - rows.drives[static_cast<std::size_t>(j)].Y * out.beta;
      weight(j) = static_cast<double>(std::max<Index>(1, r.size())) /
                  std::max(r.squaredNorm(), 1e-12 * tau[static_cast<std::size_t>(j)].squaredNorm() + 1e-300);
    }
  }
  out.covariance *= kMemory;
  return out;
}

/// Rows of the base regressor at a state.
Eigen::MatrixXd base_rows(const Robot& robot, const BaseParameters& base, const Eigen::VectorXd& q,
                          const Eigen::VectorXd& qdd, bool& reached) {
  Eigen::MatrixXd full(robot.drives(), robot.parameters());
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(robot.drives());
  reached = robot.regressor(q, rest, qdd, full) == Status::ok && full.allFinite();
  return full(Eigen::all, base.independent);
}

/// How large the estimate of G beta is beside that of the prior.
Ratio compare(const Eigen::MatrixXd& G, const BaseParameters& base, const Estimate& estimate,
              const Eigen::VectorXd& prior, const Eigen::VectorXd& prior_std, double* relative_std) {
  Ratio out;
  if (G.rows() == 0) return out;
  const Eigen::VectorXd expected = G * (base.B * prior);
  const double square = expected.squaredNorm();
  if (!(square > 0)) return out;
  const Eigen::RowVectorXd a = expected.transpose() * G / square;
  out.value = a * estimate.beta;
  out.data_std = std::sqrt(std::max(0.0, (a * estimate.covariance * a.transpose())(0)));
  // Errors of a prior go together: all parts are heavier, or lighter, than thought. Where the prior is 0, they do not.
  const Eigen::RowVectorXd share = a * base.B;
  double together = 0, apart = 0;
  for (Index k = 0; k < prior.size(); ++k) {
    const double part = std::abs(share(k)) * prior_std(k);
    (prior(k) != 0 ? together : apart) += prior(k) != 0 ? part : part * part;
  }
  const double relative = std::min(kFullTrust, std::sqrt(together * together + apart));
  if (relative_std != nullptr) *relative_std = relative;
  out.std = std::hypot(out.data_std, relative * out.value);
  out.known = true;
  return out;
}

}  // namespace

TorqueScale estimate_scale(const Robot& robot, const BaseParameters& base, const Points& points,
                           const Eigen::VectorXd& prior, const Eigen::VectorXd& prior_std) {
  TorqueScale out;
  const int n = robot.drives();
  out.inertia.resize(static_cast<std::size_t>(n));
  const std::optional<Estimate> found = estimate(robot, base, points);
  if (!found || prior.size() != robot.parameters()) return out;
  const auto limbs = static_cast<Index>(robot.description().limbs.size());
  const Index step = std::max<Index>(1, points.q.rows() / kPoses);
  std::vector<Eigen::MatrixXd> gravity;
  std::vector<std::vector<Eigen::RowVectorXd>> inertia(static_cast<std::size_t>(n));
  for (Index k = 0; k < points.q.rows(); k += step) {
    bool reached = false;
    const Eigen::VectorXd q = points.q.row(k);
    const Eigen::MatrixXd at_rest = base_rows(robot, base, q, Eigen::VectorXd::Zero(n), reached);
    if (!reached) continue;
    gravity.push_back(at_rest.topRows(limbs));
    for (int j = 0; j < n; ++j) {
      const Eigen::MatrixXd moving = base_rows(robot, base, q, Eigen::VectorXd::Unit(n, j), reached);
      inertia[static_cast<std::size_t>(j)].push_back(moving.row(j) - at_rest.row(j));
    }
  }
  Eigen::MatrixXd G(static_cast<Index>(gravity.size()) * limbs, base.count());
  for (std::size_t k = 0; k < gravity.size(); ++k) G.middleRows(static_cast<Index>(k) * limbs, limbs) = gravity[k];
  // A torque offset looks like the mean of gravity; only limbs of a delta, whose gravity changes with the pose, are
  // free of that.
  out.gravity = compare(G, base, *found, prior, prior_std, &out.prior_std);
  for (int j = 0; j < n; ++j) {
    const auto& rows = inertia[static_cast<std::size_t>(j)];
    Eigen::MatrixXd M(static_cast<Index>(rows.size()), base.count());
    for (std::size_t k = 0; k < rows.size(); ++k) M.row(static_cast<Index>(k)) = rows[k];
    double relative = 0;
    out.inertia[static_cast<std::size_t>(j)] = compare(M, base, *found, prior, prior_std, &relative);
    if (!out.gravity.known) out.prior_std = std::max(out.prior_std, relative);
  }
  return out;
}

}  // namespace deltadyn::gate
