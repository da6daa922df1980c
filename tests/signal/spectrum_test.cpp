#include "deltadyn/signal/spectrum.hpp"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/random.hpp"

namespace deltadyn {
namespace {

constexpr double kSampleRate = 1000.0;

Eigen::VectorXd white_noise(Eigen::Index n, double sigma, unsigned seed = 3) {
  std::mt19937 generator(seed);
  NormalDistribution normal(0.0, sigma);
  return Eigen::VectorXd::NullaryExpr(n, [&](Eigen::Index) { return normal(generator); });
}

Eigen::VectorXd sine(Eigen::Index n, double amplitude, double frequency_hz) {
  return Eigen::VectorXd::NullaryExpr(n, [=](Eigen::Index i) {
    return amplitude * std::sin(2.0 * std::numbers::pi * frequency_hz * static_cast<double>(i) / kSampleRate);
  });
}

double power(const PowerSpectrum& spectrum) {
  return spectrum.density.sum() * spectrum.resolution_hz;
}

TEST(WelchSpectrum, ASineStandsAtItsFrequencyWithHalfItsSquaredAmplitude) {
  const double frequency = 50.0 * kSampleRate / 1024.0;  // exactly on the grid
  const PowerSpectrum spectrum = welch_spectrum(sine(10'240, 3.0, frequency), kSampleRate, 1024);
  Eigen::Index peak = 0;
  spectrum.density.maxCoeff(&peak);
  EXPECT_NEAR(spectrum.frequency_hz(peak), frequency, 1e-9);
  EXPECT_NEAR(power(spectrum), 4.5, 1e-9);
  // A Hann window spreads the line over three values: 2/3 of the power in the middle, 1/6 on each side.
  EXPECT_NEAR(spectrum.density(peak) * spectrum.resolution_hz, 3.0, 1e-9);
  EXPECT_NEAR(spectrum.density(peak + 1) * spectrum.resolution_hz, 0.75, 1e-9);
  EXPECT_NEAR(spectrum.density(peak + 3), 0.0, 1e-12);
}

TEST(WelchSpectrum, WhiteNoiseIsFlatAtItsVarianceOverTheBand) {
  const double sigma = 0.7;
  const PowerSpectrum spectrum = welch_spectrum(white_noise(400'000, sigma), kSampleRate, 512);
  const Eigen::VectorXd inside = spectrum.density.segment(2, 253);
  const double expected = sigma * sigma / (0.5 * kSampleRate);
  EXPECT_NEAR(inside.mean() / expected, 1.0, 0.01);
  const double scatter = std::sqrt((inside.array() / expected - 1.0).square().mean());
  // Neighbouring pieces share half their samples: the correlation of their Hann-windowed noise is 1/6.
  const auto pieces = static_cast<double>(spectrum.segments);
  const double relative_std = std::sqrt((1.0 + 2.0 / 36.0 * (pieces - 1.0) / pieces) / pieces);
  EXPECT_NEAR(scatter / relative_std, 1.0, 0.2);
  EXPECT_LT((inside.array() / expected - 1.0).abs().maxCoeff(), 5.0 * relative_std);
}

TEST(WelchSpectrum, TheIntegralIsTheVariance) {
  for (const Eigen::Index segment : {64, 250, 333, 4096}) {
    const PowerSpectrum spectrum = welch_spectrum(white_noise(200'000, 2.0), kSampleRate, segment);
    EXPECT_NEAR(power(spectrum), 4.0, 0.1) << segment;
    EXPECT_EQ(spectrum.density.size(), segment / 2 + 1);
  }
}

TEST(WelchSpectrum, AConstantIsTakenOut) {
  const PowerSpectrum spectrum = welch_spectrum(Eigen::VectorXd::Constant(1000, 12.0), kSampleRate);
  EXPECT_LT(spectrum.density.maxCoeff(), 1e-20);
}

TEST(WelchSpectrum, PiecesWithGapsAreLeftOut) {
  Eigen::VectorXd signal = sine(10'240, 3.0, 50.0 * kSampleRate / 1024.0);
  signal(5000) = std::numeric_limits<double>::quiet_NaN();
  const PowerSpectrum spectrum = welch_spectrum(signal, kSampleRate, 1024);
  EXPECT_EQ(spectrum.segments, 17);
  EXPECT_NEAR(power(spectrum), 4.5, 1e-9);
}

TEST(WelchSpectrum, ChoosesThePieceFromTheLength) {
  EXPECT_NEAR(welch_spectrum(white_noise(100, 1.0), kSampleRate).resolution_hz, kSampleRate / 16.0, 1e-9);
  EXPECT_NEAR(welch_spectrum(white_noise(10'000, 1.0), kSampleRate).resolution_hz, kSampleRate / 2048.0, 1e-9);
  EXPECT_NEAR(welch_spectrum(white_noise(100'000, 1.0), kSampleRate).resolution_hz, kSampleRate / 4096.0, 1e-9);
}

TEST(WelchSpectrum, BadInputIsRefused) {
  EXPECT_THROW(static_cast<void>(welch_spectrum(white_noise(100, 1.0), 0.0)), Error);
  EXPECT_THROW(static_cast<void>(welch_spectrum(white_noise(100, 1.0), std::nan(""))), Error);
  EXPECT_THROW(static_cast<void>(welch_spectrum(white_noise(15, 1.0), kSampleRate)), Error);
  EXPECT_THROW(static_cast<void>(welch_spectrum(white_noise(100, 1.0), kSampleRate, 101)), Error);
  EXPECT_THROW(static_cast<void>(welch_spectrum(white_noise(100, 1.0), kSampleRate, -4)), Error);
  const Eigen::VectorXd gaps = Eigen::VectorXd::Constant(100, std::nan(""));
  EXPECT_THROW(static_cast<void>(welch_spectrum(gaps, kSampleRate)), Error);
}

}  // namespace
}  // namespace deltadyn
