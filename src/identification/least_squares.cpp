#include "least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn {

namespace {

using Eigen::Index;

constexpr double kMemory_s = 0.2;  // time over which residual correlation is looked for
constexpr double kSilent = 1e-9;   // a column or direction this much weaker than the strongest one is rounding

/// Weighted factors of all drives, triangular again: A^T A = sum over the drives of w^2 R^T R.
void stack(const std::vector<DriveFold>& folds, const Eigen::VectorXd& weight, Eigen::MatrixXd& A, Eigen::VectorXd& b) {
  const Index P = folds.front().R.cols();
  Eigen::MatrixXd stacked(P * static_cast<Index>(folds.size()), P + 1);
  for (std::size_t j = 0; j < folds.size(); ++j) {
    const auto row = static_cast<Index>(j);
    stacked.middleRows(row * P, P) << weight(row) * folds[j].R, weight(row) * folds[j].d;
  }
  const Eigen::MatrixXd R = dense::r_factor(stacked);
  A = R.topLeftCorner(P, P);
  b = R.topRightCorner(P, 1);
}

void take_off(const BaseParameters& base, const NoiseBias& bias, const Eigen::VectorXd& weight, Eigen::MatrixXd& A,
              Eigen::VectorXd& b) {
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(base.count(), base.count());
  Eigen::VectorXd torque = Eigen::VectorXd::Zero(base.count());
  for (std::size_t j = 0; j < bias.information.size(); ++j) {
    const double w = weight(static_cast<Index>(j));
    information += w * w * bias.information[j];
    torque += w * w * bias.torque[j];
  }
  take_off_noise(base, information, torque, A, b);
}

/// Names what a direction of beta-space is made of, for messages.
std::string weakest(const BaseParameters& base, const Eigen::VectorXd& direction) {
  std::string text;
  for (Index k = 0; k < direction.size(); ++k) {
    if (std::abs(direction(k)) < 0.3) continue;
    text += (text.empty() ? "" : ", ") + base.expressions[static_cast<std::size_t>(k)];
  }
  return text;
}

}  // namespace

Eigen::VectorXd any_parameters(const BaseParameters& base, const Eigen::Ref<const Eigen::VectorXd>& beta,
                               Eigen::Index parameters) {
  Eigen::VectorXd p = Eigen::VectorXd::Zero(parameters);
  p(base.independent) = beta;
  return p;
}

BaseEstimate estimate_base_parameters(const BaseParameters& base, const std::vector<DriveFold>& folds,
                                      const std::vector<double>& correlation, const NoiseBias* bias) {
  const auto drives = static_cast<Index>(folds.size());
  const Index P = folds.front().R.cols();
  double rows = 0;
  for (const DriveFold& fold : folds) rows += static_cast<double>(fold.rows);
  if (rows < 2.0 * base.count()) {
    throw Error(fmt::format("{} usable rows are too few for {} base parameters", rows, base.count()), "",
                "record a longer log, or one with fewer velocity reversals");
  }
  Eigen::VectorXd weight(drives);
  for (Index j = 0; j < drives; ++j) weight(j) = 1.0 / std::max(folds[static_cast<std::size_t>(j)].tau_max, 1e-12);

  BaseEstimate out;
  out.noise.resize(folds.size());
  for (int pass = 0; pass < 4; ++pass) {
    stack(folds, weight, out.A, out.b);
    if (bias != nullptr) take_off(base, *bias, weight, out.A, out.b);
    Eigen::MatrixXd A_B = out.A(Eigen::all, base.independent);
    Eigen::VectorXd norm = A_B.colwise().norm().cwiseMax(1e-300);
    const double largest = norm.maxCoeff();
    A_B *= norm.cwiseInverse().asDiagonal();
    const dense::SingularValues svd = dense::svd(A_B);
    const Eigen::VectorXd& s = svd.values;
    out.condition_number = s(0) / std::max(s(s.size() - 1), 1e-300);
    std::string unseen;
    for (Index k = 0; k < norm.size(); ++k) {
      if (norm(k) < kSilent * largest)
        unseen += (unseen.empty() ? "" : ", ") + base.expressions[static_cast<std::size_t>(k)];
    }
    if (unseen.empty() && out.condition_number > 1 / kSilent) unseen = weakest(base, svd.V.rightCols<1>());
    if (!unseen.empty()) {
      throw Error("the motion does not excite every base parameter; it says nothing about " + unseen, "",
                  "record a motion that moves all drives, fast and slow, over the workspace", ExitCode::not_trusted);
    }
    const Eigen::MatrixXd root = norm.cwiseInverse().asDiagonal() * svd.V * s.cwiseInverse().asDiagonal();
    out.value = root * (svd.U.transpose() * out.b);
    out.covariance = root * root.transpose();
    out.log_det = 2 * (s.array().log().sum() + norm.array().log().sum());

    // Sigma from the residual; each drive bears its share of the fitted parameters.
    const Eigen::VectorXd p = any_parameters(base, out.value, P);
    for (Index j = 0; j < drives; ++j) {
      const DriveFold& fold = folds[static_cast<std::size_t>(j)];
      const double share =
          std::min(0.9, weight(j) * weight(j) * (fold.R(Eigen::all, base.independent) * root).squaredNorm() /
                            std::max<double>(1.0, static_cast<double>(fold.rows)));
      DriveNoise& noise = out.noise[static_cast<std::size_t>(j)];
      const double floor = 1e-9 * std::max(fold.tau_max, 1e-12);  // noise-free logs
      noise.std = std::max(floor, fold.rms(p) / std::sqrt(1 - share));
      noise.correlation = correlation.empty() ? 1.0 : correlation[static_cast<std::size_t>(j)];
      weight(j) = 1.0 / (noise.std * std::sqrt(noise.correlation));
    }
  }
  return out;
}

void add_uncertainty(const BaseParameters& base, const Eigen::MatrixXd& covariance, BaseEstimate& estimate) {
  // With A_B^T A_B the information, its inverse plus C has the information A_B^T (1 + A_B C A_B^T)^-1 A_B.
  const Eigen::MatrixXd A_B = estimate.A(Eigen::all, base.independent);
  const Eigen::MatrixXd sum = Eigen::MatrixXd::Identity(A_B.rows(), A_B.rows()) + A_B * covariance * A_B.transpose();
  const dense::Spectrum spectrum = dense::spectrum(sum);
  const Eigen::VectorXd root = spectrum.values.cwiseMax(1.0).cwiseSqrt();
  const Eigen::MatrixXd rest = root.cwiseInverse().asDiagonal() * spectrum.vectors.transpose() * A_B;
  estimate.covariance += covariance;
  estimate.log_det -= 2 * root.array().log().sum();
  estimate.A = rest * base.B;
  estimate.b = rest * estimate.value;
}

double noise_correlation(const Eigen::Ref<const Eigen::VectorXd>& residual,
                         const Eigen::Ref<const Eigen::Array<bool, Eigen::Dynamic, 1>>& usable, Eigen::Index lags,
                         double white) {
  const Eigen::VectorXd e = usable.select(residual.array(), 0.0).matrix();
  const auto count = static_cast<double>(usable.count());
  const double variance = e.squaredNorm() / std::max(count, 1.0);
  if (!(variance > 0)) return white;
  double sum = 1.0;
  double uncertainty = 0.0;
  for (Index lag = 1; lag <= std::min<Index>(lags, e.size() - 1); ++lag) {
    const Index length = e.size() - lag;
    const double rho = e.head(length).dot(e.tail(length)) / (count * variance);
    const double window = 1.0 - static_cast<double>(lag) / static_cast<double>(lags + 1);
    sum += 2 * window * rho;
    uncertainty += 4 * window * window / count;
  }
  // White noise gives `white` give or take the square root of `uncertainty`: then it is taken as white.
  return std::abs(sum - white) < 3 * white * std::sqrt(uncertainty) ? white : std::max(sum, 0.05);
}

double residual_memory(const Eigen::Ref<const Eigen::VectorXd>& residual,
                       const Eigen::Ref<const Eigen::Array<bool, Eigen::Dynamic, 1>>& usable, double row_rate_hz,
                       double white) {
  const auto lags = static_cast<Index>(std::ceil(kMemory_s * row_rate_hz));
  return noise_correlation(residual, usable, std::clamp<Index>(lags, 1, 50), white);
}

}  // namespace deltadyn
