#include "deltadyn/signal/motion_band.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/signal/spectrum.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;

constexpr double kBandRatio = 1.26;  // a third of an octave
constexpr double kSegment_s = 4;     // shows motion from half a hertz on
// Times the noise: less is no news of the motion, or the hump of an interpolated record
constexpr double kClear = 30;
constexpr double kSameFloor = 1.5;  // quantisation noise of a slow motion is not white: beside the motion it is lower
constexpr double kContent = 0.999;  // of the accelerations' power: what lies above moves no figure
constexpr double kSharp_hz = 20;    // below it the low pass smears a reversal over more than a tenth of a second
// Of an acceleration's power: as noise in the regressor it pulls an inertia down by as much
constexpr double kNoiseShare = 2e-5;
constexpr double kLowestCutoff_hz = 5;
constexpr double kLeastPeriods = 20;  // of the cut-off in a log: its ends are lost for 1.5 of them each
constexpr double kMostOfRate = 0.25;  // differentiation needs some samples a period of the highest frequency
constexpr double kTopBands = 0.45;    // of the rate: beyond, aliases and the recorder's own filter speak

Index segment_of(Index samples, double rate_hz) {
  Index segment = 16;
  while (2 * segment <= samples && static_cast<double>(2 * segment) <= kSegment_s * rate_hz) segment *= 2;
  return segment;
}

double width_of(double frequency_hz) {
  return frequency_hz * (std::sqrt(kBandRatio) - 1 / std::sqrt(kBandRatio));
}

double power_of_acceleration(double density, double frequency_hz) {
  return density * std::pow(2 * std::numbers::pi * frequency_hz, 4) * width_of(frequency_hz);
}

/// Acceleration power above the floor in the bands from `above` to `cutoff_hz`.
double power_between(const MotionBand& band, double above, double cutoff_hz, double power = 0) {
  for (Index k = 0; k < band.frequency_hz.size() && band.frequency_hz(k) <= cutoff_hz; ++k) {
    if (band.frequency_hz(k) > above)
      power += power_of_acceleration(std::max(0.0, band.density(k) - band.noise_density), band.frequency_hz(k));
  }
  return power;
}

/// Acceleration power below a frequency that is no motion: the floor, and what stands above it beyond the motion's band
/// (humps of an interpolated or jittering record).
double noise_power(const MotionBand& band, double cutoff_hz) {
  return power_between(band, band.top_hz, cutoff_hz,
                       band.noise_density * std::pow(2 * std::numbers::pi, 4) * std::pow(cutoff_hz, 5) / 5);
}

/// Acceleration power of the motion below a frequency.
double motion_power(const MotionBand& band, double cutoff_hz) {
  return power_between(band, 0, std::min(cutoff_hz, band.top_hz));
}

/// Mean density, over frequency, of the bands that are nearly as low as the lowest one: noise is much the same in all
/// of them.
double floor_of(const MotionBand& band) {
  if (band.density.size() == 0) return 0;
  const double lowest = band.density.minCoeff();
  double sum = 0, width = 0;
  for (Index k = 0; k < band.density.size(); ++k) {
    if (band.density(k) > kSameFloor * lowest) continue;
    sum += band.density(k) * band.frequency_hz(k);
    width += band.frequency_hz(k);
  }
  return width > 0 ? sum / width : lowest;
}

/// Lowest pass band that keeps nearly all of the motion's acceleration.
double content_of(const MotionBand& band) {
  const double all = motion_power(band, band.top_hz);
  for (Index i = 0; i < band.frequency_hz.size() && band.frequency_hz(i) < band.top_hz; ++i) {
    if (motion_power(band, band.frequency_hz(i)) >= kContent * all) return band.frequency_hz(i);
  }
  return band.top_hz;
}

/// Highest frequency that belongs to the motion, from low ones on: a resonance or an interpolation's own line higher up
/// is none.
double top_of(const MotionBand& band) {
  double clear = 0;
  for (Index i = 0; i < band.density.size(); ++i) {
    if (band.density(i) > kClear * band.noise_density) {
      clear = band.frequency_hz(i);
    } else if (clear > 0) {
      break;
    }
  }
  return clear;
}

/// Spectra of one drive over all logs.
struct DriveSpectra {
  std::vector<const MotionBand*> position;
  std::vector<MotionBand> torque;  ///< empty without torque; its noise_density is that of the torque sensor

  /// Inertia that the accelerations feel, squared: from the bands in which they are strongest.
  [[nodiscard]] double inertia_square() const {
    double tau_a = 0, a_a = 0;
    for (std::size_t l = 0; l < torque.size(); ++l) {
      const MotionBand& q = *position[l];
      for (Index k = 0; k < q.frequency_hz.size() && q.frequency_hz(k) <= q.top_hz; ++k) {
        const double a = q.density(k) * std::pow(2 * std::numbers::pi * q.frequency_hz(k), 4);
        tau_a += torque[l].density(k) * a;
        a_a += a * a;
      }
    }
    return a_a > 0 ? tau_a / a_a : 0;
  }

  /// Is the noise of the positions a small share of the accelerations, or below the torque's own noise where it ends
  /// up?
  [[nodiscard]] bool quiet(double cutoff, double inertia_square) const {
    double noise = 0, motion = 0, torque_noise = 0;
    for (std::size_t l = 0; l < position.size(); ++l) {
      noise += noise_power(*position[l], cutoff);
      motion += motion_power(*position[l], cutoff);
      if (!torque.empty()) torque_noise += torque[l].noise_density * cutoff;
    }
    return noise <= kNoiseShare * motion || inertia_square * noise <= torque_noise;
  }
};

/// Highest cut-off at which every drive that moves is quiet.
double noise_limit_hz(const std::vector<Log>& logs, const std::vector<std::vector<MotionBand>>& bands, double lowest,
                      double highest) {
  const double step = std::sqrt(kBandRatio);
  double limit = highest;
  for (std::size_t j = 0; j < bands.front().size(); ++j) {
    DriveSpectra drive;
    for (std::size_t l = 0; l < logs.size(); ++l) {
      drive.position.push_back(&bands[l][j]);
      if (logs[l].tau.size() > 0)
        drive.torque.push_back(motion_band(logs[l].tau.col(static_cast<Index>(j)), 1.0 / logs[l].sample_time_s()));
    }
    if (drive.torque.size() < logs.size()) drive.torque.clear();
    const double inertia_square = drive.inertia_square();
    double cutoff = lowest;
    // A drive that drowns in noise at the lowest cut-off does not move: it cannot ask for anything.
    if (!drive.quiet(cutoff, inertia_square)) continue;
    while (cutoff * step <= highest && drive.quiet(cutoff * step, inertia_square)) cutoff *= step;
    limit = std::min(limit, cutoff);
  }
  return limit;
}

}  // namespace

MotionBand motion_band(const Eigen::Ref<const Eigen::VectorXd>& position, double rate_hz) {
  // The steep spectrum of a motion would leak over the noise: the differences are flatter, and are set right
  // afterwards.
  const Eigen::VectorXd steps = position.tail(position.size() - 1) - position.head(position.size() - 1);
  const PowerSpectrum spectrum = welch_spectrum(steps, rate_hz, segment_of(steps.size(), rate_hz));
  std::vector<double> frequency, density;
  const Index bins = spectrum.frequency_hz.size();
  Index k = 1;
  double low = spectrum.resolution_hz;
  while (low * kBandRatio <= kTopBands * rate_hz) {
    double sum = 0;
    Index count = 0;
    for (; k < bins && spectrum.frequency_hz(k) < low * kBandRatio; ++k) {
      const double gain = 2 * std::sin(std::numbers::pi * spectrum.frequency_hz(k) / rate_hz);
      sum += spectrum.density(k) / (gain * gain);
      ++count;
    }
    if (count > 0) {
      frequency.push_back(low * std::sqrt(kBandRatio));
      density.push_back(sum / static_cast<double>(count));
    }
    low *= kBandRatio;
  }
  MotionBand band;
  band.frequency_hz = Eigen::Map<const Eigen::VectorXd>(frequency.data(), static_cast<Index>(frequency.size()));
  band.density = Eigen::Map<const Eigen::VectorXd>(density.data(), static_cast<Index>(density.size()));
  band.noise_density = floor_of(band);
  band.top_hz = top_of(band);
  band.content_hz = content_of(band);
  return band;
}

Eigen::VectorXd position_noise_std(const Log& log) {
  Eigen::VectorXd std(log.drives());
  const double rate_hz = 1.0 / log.sample_time_s();
  for (Index j = 0; j < log.drives(); ++j)
    std(j) = std::sqrt(motion_band(log.q.col(j), rate_hz).noise_density * rate_hz / 2);
  return std;
}

CutoffChoice choose_cutoff(const std::vector<Log>& logs) {
  if (logs.empty()) throw Error("there is no log", "", "give at least one log file", ExitCode::usage);
  CutoffChoice choice;
  double rate_hz = 1e300, shortest_s = 1e300;
  for (const Log& log : logs) {
    const double rate = 1.0 / log.sample_time_s();
    rate_hz = std::min(rate_hz, rate);
    shortest_s = std::min(shortest_s, static_cast<double>(log.samples()) * log.sample_time_s());
    choice.bands.emplace_back();
    for (Index j = 0; j < log.drives(); ++j) {
      choice.bands.back().push_back(motion_band(log.q.col(j), rate));
      choice.band_hz = std::max(choice.band_hz, choice.bands.back().back().content_hz);
    }
  }
  const double lowest = std::max(kLowestCutoff_hz, kLeastPeriods / shortest_s), highest = kMostOfRate * rate_hz;
  if (lowest > highest) {
    throw Error(fmt::format("the logs are too short, or sampled too slowly, to choose a cut-off: {:.3g} s at {:.4g} Hz",
                            shortest_s, rate_hz),
                logs.front().file, "record at 100 Hz or more for some seconds, or give --cutoff-hz");
  }
  choice.lowest_hz = lowest;
  choice.noise_limit_hz = noise_limit_hz(logs, choice.bands, lowest, highest);
  choice.cutoff_hz = std::clamp(std::min(std::max(choice.band_hz, kSharp_hz), choice.noise_limit_hz), lowest, highest);
  return choice;
}

}  // namespace deltadyn
