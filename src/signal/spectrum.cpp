#include "deltadyn/signal/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

using Index = Eigen::Index;
constexpr Index kShortest = 16;
constexpr Index kLongest = 4096;

Index automatic_segment(Index samples) {
  Index segment = kShortest;
  while (2 * segment <= std::min(samples / 4, kLongest)) segment *= 2;
  return segment;
}

/// The periodic Hann window: shifted by half its length it adds up to one.
Eigen::VectorXd hann(Index n) {
  return Eigen::VectorXd::NullaryExpr(n, [n](Index i) {
    return 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n));
  });
}

}  // namespace

PowerSpectrum welch_spectrum(const Eigen::VectorXd& signal, double rate_hz, Index segment) {
  if (!std::isfinite(rate_hz) || rate_hz <= 0.0)
    throw Error(fmt::format("a sampling rate of {} Hz", rate_hz), "power spectrum", "give a positive rate",
                ExitCode::usage);
  if (segment == 0) segment = automatic_segment(signal.size());
  if (segment < kShortest || segment > signal.size()) {
    throw Error(fmt::format("{} samples cannot be cut into pieces of {}", signal.size(), segment), "power spectrum",
                fmt::format("use a longer log, or pieces of {} samples up to the length of the signal", kShortest));
  }
  const Eigen::VectorXd window = hann(segment);
  const Index bins = segment / 2 + 1;
  PowerSpectrum result;
  result.density = Eigen::VectorXd::Zero(bins);
  result.resolution_hz = rate_hz / static_cast<double>(segment);
  result.frequency_hz =
      Eigen::VectorXd::NullaryExpr(bins, [&](Index k) { return static_cast<double>(k) * result.resolution_hz; });

  Eigen::FFT<double> fft;
  Eigen::VectorXd piece(segment);
  Eigen::VectorXcd transformed(segment);
  const Index step = (segment + 1) / 2;
  for (Index begin = 0; begin + segment <= signal.size(); begin += step) {
    piece = signal.segment(begin, segment);
    if (!piece.allFinite()) continue;
    piece.array() -= piece.mean();
    piece.array() *= window.array();
    fft.fwd(transformed, piece);
    result.density += transformed.head(bins).cwiseAbs2();
    ++result.segments;
  }
  if (result.segments == 0) {
    throw Error(fmt::format("each piece of {} samples contains a gap", segment), "power spectrum",
                "use a log with fewer gaps, or shorter pieces");
  }
  const auto averages = static_cast<double>(result.segments);
  result.density *= 2.0 / (rate_hz * window.squaredNorm() * averages);
  result.density(0) *= 0.5;  // zero and half the sampling rate have no mirror image
  if (segment % 2 == 0) result.density(bins - 1) *= 0.5;
  return result;
}

}  // namespace deltadyn
