#include "deltadyn/signal/fir_decimator.hpp"

#include <cmath>
#include <numbers>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using std::numbers::pi;

constexpr double kKaiserBeta = 7.857;       // 80 dB stop band
constexpr double kTransitionWidth = 5.017;  // (80 - 7.95) / 14.36: transition band times length
constexpr double kTransitionShare = 1.0;    // transition band as a share of the cut-off

double sinc(double x) {
  return std::abs(x) < 1e-12 ? 1.0 : std::sin(pi * x) / (pi * x);
}

}  // namespace

FirDecimator::FirDecimator(double sample_rate_hz, double cutoff_hz, int factor)
    : sample_rate_hz_(sample_rate_hz), factor_(factor) {
  if (!(sample_rate_hz > 0) || factor < 1 || !(cutoff_hz > 0) || !(cutoff_hz <= 0.5 * sample_rate_hz / factor)) {
    throw Error("the cut-off must be positive and not above half the rate after decimation", "decimation",
                "lower the cut-off or the decimation factor", ExitCode::usage);
  }
  // A cut-off at half the rate without decimation is no filter at all.
  if (factor == 1 && cutoff_hz >= 0.5 * sample_rate_hz) {
    taps_ = Eigen::VectorXd::Ones(1);
    return;
  }
  const double cutoff = cutoff_hz / sample_rate_hz;
  const auto half = static_cast<Index>(std::ceil(0.5 * kTransitionWidth / (kTransitionShare * cutoff)));
  taps_.resize(2 * half + 1);
  for (Index k = 0; k <= half; ++k) {
    const double x = static_cast<double>(k) / static_cast<double>(half + 1);
    const double tap = 2.0 * cutoff * sinc(2.0 * cutoff * static_cast<double>(k)) *
                       std::cyl_bessel_i(0, kKaiserBeta * std::sqrt(1.0 - x * x));
    taps_(half + k) = tap;
    taps_(half - k) = tap;
  }
  taps_ /= taps_.sum();
}

Index FirDecimator::outputs(Index samples) const {
  const Index room = samples - taps_.size();
  return room < 0 ? 0 : room / factor_ + 1;
}

Index FirDecimator::inputs(Index n_outputs) const {
  return n_outputs <= 0 ? 0 : (n_outputs - 1) * factor_ + taps_.size();
}

double FirDecimator::white_correlation() const {
  double sum = 1;
  for (Index lag = factor_; lag < taps_.size(); lag += factor_) {
    const Index common = taps_.size() - lag;
    sum += 2 * taps_.head(common).dot(taps_.tail(common)) / taps_.squaredNorm();
  }
  return sum;
}

double FirDecimator::gain(double frequency_hz) const {
  const Index half = half_width();
  double sum = taps_(half);
  for (Index k = 1; k <= half; ++k) {
    sum += 2.0 * taps_(half + k) * std::cos(2.0 * pi * frequency_hz / sample_rate_hz_ * static_cast<double>(k));
  }
  return sum;
}

void FirDecimator::apply(const Eigen::Ref<const Eigen::MatrixXd>& in, Eigen::Ref<Eigen::MatrixXd> out) const {
  if (inputs(out.rows()) > in.rows() || out.cols() != in.cols()) {
    throw Error("the block does not hold the samples that the outputs need", "decimation",
                "pass inputs(n_outputs) samples for n_outputs outputs", ExitCode::usage);
  }
  for (Index channel = 0; channel < in.cols(); ++channel) {
    for (Index k = 0; k < out.rows(); ++k) {
      out(k, channel) = taps_.dot(in.col(channel).segment(k * factor_, taps_.size()));
    }
  }
}

}  // namespace deltadyn
