#include "ripple_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "deltadyn/effects/wave.hpp"
#include "deltadyn/identification/effect_columns.hpp"
#include "deltadyn/runtime/golden_section.hpp"
#include "deltadyn/signal/log_part.hpp"

#include "least_squares.hpp"
#include "partial_fit.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kPi = std::numbers::pi;
constexpr Index kRippleSamples = 20'000;  // of each log, as for presliding
// Over the drive's range; slower ones are the shape of gravity and wrong lengths
constexpr double kFewestWaves = 4;
constexpr double kSlowShare = 0.25;  // of the rows whose speed keeps the fastest waves within the pass band
constexpr Index kMostWaves = 2000;   // over the range
constexpr Index kMostOfDrive = 4;    // ripples
constexpr Index kFinePhase = 8;      // bins a wave of the fastest ripple
constexpr Index kPadding = 4;        // points of the spectrum a wave over the range
// Of chi^2: chance in thousands of waves tried gives 33 once in ten thousand if what is left is white; of the logs of
// robots without ripples (some 200 drives of the study of the family) the largest has 45
constexpr double kClearWaveGain = 60;
constexpr double kHalfShare = 0.3;  // of a half's own gain that the amplitude of the other half must bring there
constexpr double kLeastHalf = 0.1;  // of the rows, from which a half has a say
constexpr Index kPieces = 16;       // of each log, taken in turn by the halves
// Of what is left, as where structure is told: what else the model lacks can pass for a wave
constexpr double kMostMemory = 3;

class RippleSearch {
 public:
  RippleSearch(const Robot& robot, const BaseParameters& base, const std::vector<Log>& logs,
               const ProcessingOptions& processing)
      : robot_(robot), pass_hz_(processing.torque_cutoff_ratio * processing.cutoff_hz) {
    ProcessingOptions options = processing;
    options.ripples.clear();
    options.periods = Periods::ignore;  // each sample at its own position
    for (const Log& log : logs) {
      PreparedLog one = prepare_log(robot, middle_of(log, kRippleSamples), options);
      RowUses use;
      rows_.push_back(base_rows(robot, base, one, use));
      rows_.back().weight.resize(one.rows, robot.drives());
      for (Index j = 0; j < robot.drives(); ++j) rows_.back().weight.col(j) = usable_rows(use, j, false).cast<double>();
      logs_.push_back(std::move(one));
    }
    weigh_by_residual(rows_, 3);
    // Noise behind the low pass is no wider than its band: a wave in it meets more of it than white rows would show.
    for (std::size_t l = 0; l < logs_.size(); ++l) {
      const double band_hz = 2 * std::min(pass_hz_, 0.5 * logs_[l].row_rate_hz());
      rows_[l].weight *= band_hz / logs_[l].row_rate_hz();
    }
  }

  std::vector<Ripple> run() {
    std::vector<Ripple> out;
    for (int drive = 0; drive < robot_.drives(); ++drive) {
      const std::vector<BaseRows> before = rows_;
      const std::vector<Ripple> found = ripples_of(drive);
      if (!found.empty() && memory_left(drive) > kMostMemory) {
        rows_ = before;
        continue;
      }
      out.insert(out.end(), found.begin(), found.end());
    }
    fill_in_amplitudes(out);
    return out;
  }

 private:
  /// The ripples of one drive one after the other; they belong to the base parameters from then on.
  std::vector<Ripple> ripples_of(int drive) {
    std::vector<Ripple> out;
    for (Index k = 0; k < kMostOfDrive; ++k) {
      const PartialFit fit(rows_);
      const double n = candidate(fit, drive);
      if (!(n > 0)) break;
      const double refined = refine(fit, drive, n);
      const std::vector<Columns> waves = columns(drive, refined);
      if (fit.square() - fit.with(waves).cost < kClearWaveGain || !holds_everywhere(waves, drive)) break;
      Ripple found;
      found.drive = drive;
      found.n = refined;
      found.n_std = deviation(fit, drive, refined);
      out.push_back(found);
      adopt(waves);
    }
    return out;
  }

  /// Memory of what is left of a drive's torque, mean over the logs: 1 for white noise. Beside other structure a wave
  /// is no finding.
  [[nodiscard]] double memory_left(int drive) const {
    const PartialFit fit(rows_);
    double sum = 0, rows = 0;
    for (std::size_t l = 0; l < logs_.size(); ++l) {
      const Eigen::Array<bool, Eigen::Dynamic, 1> usable = rows_[l].weight.col(drive).array() > 0;
      const auto count = static_cast<double>(usable.count());
      sum += residual_memory(fit.residual(l).col(drive), usable, rows_[l].rate_hz) * count;
      rows += count;
    }
    return rows > 0 ? sum / rows : 1.0;
  }

  /// Cosine and sine under the low pass of the rows.
  [[nodiscard]] std::vector<Columns> columns(int drive, double n) const {
    std::vector<Columns> out;
    for (const PreparedLog& log : logs_) {
      MatrixXd raw(log.q.rows(), 2);
      for (Index k = 0; k < raw.rows(); ++k) {
        const Wave<double> pair = wave(log.q(k, drive), n);
        raw.row(k) << pair.cosine, pair.sine;
      }
      const MatrixXd low = low_passed_rows(log, raw);
      Columns both(2, MatrixXd::Zero(low.rows(), robot_.drives()));
      for (std::size_t c = 0; c < 2; ++c) both[c].col(drive) = low.col(static_cast<Index>(c));
      out.push_back(std::move(both));
    }
    return out;
  }

  /// The residual of a drive with its weights, back through the low pass to the samples, so that its product with a
  /// wave at the samples is that of the rows with the wave behind the low pass.
  [[nodiscard]] VectorXd at_samples(const PartialFit& fit, std::size_t l, int drive) const {
    const PreparedLog& log = logs_[l];
    const VectorXd e = rows_[l].weight.col(drive).cwiseProduct(fit.residual(l).col(drive));
    VectorXd out = VectorXd::Zero(log.q.rows());
    for (Index row = 0; row < e.size(); ++row) {
      const Index centre = sample_of_row(log, row);
      if (!log.low_pass) {
        out(centre) += e(row);
        continue;
      }
      const Index half = log.low_pass->half_width();
      out.segment(centre - half, 2 * half + 1) += e(row) * log.low_pass->taps();
    }
    return out;
  }

  /// The wave that about explains most of a drive's residual; 0 if there is none to look for.
  [[nodiscard]] double candidate(const PartialFit& fit, int drive) const {
    double low = 1e300, high = -1e300;
    std::vector<std::pair<double, double>> speeds;  // of the rows, with their weights
    for (std::size_t l = 0; l < logs_.size(); ++l) {
      const PreparedLog& log = logs_[l];
      for (Index row = 0; row < log.rows; ++row) {
        const double weight = rows_[l].weight(row, drive);
        if (!(weight > 0)) continue;
        const Index k = sample_of_row(log, row);
        low = std::min(low, log.q(k, drive));
        high = std::max(high, log.q(k, drive));
        speeds.emplace_back(std::abs(log.qd(k, drive)), weight);
      }
    }
    const double range = high - low;
    if (speeds.size() < 100 || !(range > 0)) return 0;
    std::sort(speeds.begin(), speeds.end());
    const double slow = speeds[static_cast<std::size_t>(kSlowShare * static_cast<double>(speeds.size()))].first;
    const auto most = static_cast<Index>(std::min<double>(kMostWaves, pass_hz_ / std::max(slow, 1e-12) * range));
    const VectorXd gain = gains(fit, drive, low, range, most, speeds);
    Index best = 0;
    if (gain.size() == 0 || !(gain.maxCoeff(&best) > 0)) return 0;
    return 2 * kPi * static_cast<double>(best) / (static_cast<double>(kPadding) * range);
  }

  /// Gain of each wave, by the spectrum of the residual over the position: point k is wave number 2 pi k / (padding x
  /// range).
  [[nodiscard]] VectorXd gains(const PartialFit& fit, int drive, double low, double range, Index most,
                               const std::vector<std::pair<double, double>>& speeds) const {
    if (static_cast<double>(most) <= kFewestWaves) return {};
    const Index bins = kFinePhase * most;
    VectorXd over_position = VectorXd::Zero(kPadding * bins);
    for (std::size_t l = 0; l < logs_.size(); ++l) {
      const VectorXd e = at_samples(fit, l, drive);
      const VectorXd q = logs_[l].q.col(drive);
      for (Index k = 0; k < e.size(); ++k) {
        const double at = (q(k) - low) / range * static_cast<double>(bins);
        if (at >= 0 && at < static_cast<double>(bins)) over_position(static_cast<Index>(at)) += e(k);
      }
    }
    Eigen::FFT<double> fft;
    Eigen::VectorXcd spectrum(over_position.size());
    fft.fwd(spectrum, over_position);
    VectorXd gain = VectorXd::Zero(kPadding * most);
    double information = 0;
    std::size_t passing = speeds.size();
    for (const auto& [speed, weight] : speeds) information += weight;
    for (auto k = static_cast<Index>(kFewestWaves * kPadding); k < gain.size(); ++k) {
      const double n = 2 * kPi * static_cast<double>(k) / (static_cast<double>(kPadding) * range);
      while (passing > 0 && n * speeds[passing - 1].first > 2 * kPi * pass_hz_) information -= speeds[--passing].second;
      if (static_cast<double>(passing) < 0.5 * kSlowShare * static_cast<double>(speeds.size())) break;
      gain(k) = std::norm(spectrum(k)) / (0.5 * information);
    }
    return gain;
  }

  /// Distance of the points of the spectrum.
  [[nodiscard]] double peak_width(int drive) const {
    double low = 1e300, high = -1e300;
    for (const PreparedLog& log : logs_) {
      low = std::min(low, log.q.col(drive).minCoeff());
      high = std::max(high, log.q.col(drive).maxCoeff());
    }
    return 2 * kPi / (static_cast<double>(kPadding) * (high - low));
  }

  /// A parabola through the costs about the least one: one unit of cost is one standard deviation.
  [[nodiscard]] double deviation(const PartialFit& fit, int drive, double n) const {
    const double step = 0.1 * peak_width(drive);
    const auto cost = [&](double at) { return fit.with(columns(drive, at)).cost; };
    const double bend = (cost(n + step) + cost(n - step) - 2 * cost(n)) / (step * step);
    return bend > 0 ? std::sqrt(2 / bend) : peak_width(drive);
  }

  [[nodiscard]] double refine(const PartialFit& fit, int drive, double n) const {
    const double width = peak_width(drive);
    return golden_section_in_logarithm([&](double at) { return fit.with(columns(drive, at)).cost; },
                                       std::max(n - width, 0.5 * n), n + width, 1 + 0.01 * width / n);
  }

  /// A ripple holds all along the log, and on the way there as on the way back. What else the model lacks comes again
  /// with every period of the motion, so that parts of the log agree on a wave that is none; but in the other direction
  /// it is another torque.
  [[nodiscard]] bool holds_everywhere(const std::vector<Columns>& waves, int drive) const {
    const auto turn = [this](std::size_t l, Index k) { return (k * kPieces / rows_[l].weight.rows()) % 2 == 0; };
    const auto forward = [&](std::size_t l, Index k) { return logs_[l].qd(sample_of_row(logs_[l], k), drive) > 0; };
    return halves_agree(waves, drive, turn) && halves_agree(waves, drive, forward);
  }

  /// Does the amplitude of either half of the rows serve the other one? True if there is hardly another one.
  template <class InFirstHalf>
  [[nodiscard]] bool halves_agree(const std::vector<Columns>& waves, int drive, const InFirstHalf& first) const {
    std::vector<BaseRows> half[2] = {rows_, rows_};
    double weight[2] = {0, 0};
    for (std::size_t l = 0; l < rows_.size(); ++l) {
      for (Index k = 0; k < rows_[l].weight.rows(); ++k) {
        const int h = first(l, k) ? 0 : 1;
        weight[h] += rows_[l].weight(k, drive);
        half[1 - h][l].weight.row(k).setZero();
      }
    }
    if (std::min(weight[0], weight[1]) < kLeastHalf * (weight[0] + weight[1])) return true;
    const PartialFit whole(rows_);
    VectorXd amplitude[2];
    for (int h = 0; h < 2; ++h) amplitude[h] = PartialFit(half[h]).with(waves).amplitude;
    for (int h = 0; h < 2; ++h) {
      double crossed = 0, own = 0;
      for (std::size_t l = 0; l < rows_.size(); ++l) {
        const VectorXd e = whole.residual(l).col(drive), w = half[h][l].weight.col(drive);
        const auto fall = [&](const VectorXd& a) {
          const VectorXd wave = a(0) * waves[l][0].col(drive) + a(1) * waves[l][1].col(drive);
          return w.dot(e.cwiseAbs2() - (e - wave).cwiseAbs2());
        };
        crossed += fall(amplitude[1 - h]);
        own += fall(amplitude[h]);
      }
      if (!(crossed > kHalfShare * own)) return false;
    }
    return true;
  }

  /// From here on the waves belong to the base parameters.
  void adopt(const std::vector<Columns>& waves) {
    for (std::size_t l = 0; l < rows_.size(); ++l) {
      for (std::size_t j = 0; j < rows_[l].X.size(); ++j) {
        MatrixXd& X = rows_[l].X[j];
        X.conservativeResize(Eigen::NoChange, X.cols() + 2);
        X.rightCols(2) << waves[l][0].col(static_cast<Index>(j)), waves[l][1].col(static_cast<Index>(j));
      }
    }
  }

  /// Of all ripples together, with the base parameters.
  void fill_in_amplitudes(std::vector<Ripple>& ripples) const {
    if (ripples.empty()) return;
    std::vector<BaseRows> without = rows_;
    const auto own = static_cast<Index>(2 * ripples.size());
    std::vector<Columns> waves(rows_.size());
    for (std::size_t l = 0; l < rows_.size(); ++l) {
      const Index kept = rows_[l].X.front().cols() - own;
      for (Index c = 0; c < own; ++c) {
        MatrixXd column(rows_[l].tau.rows(), robot_.drives());
        for (Index j = 0; j < column.cols(); ++j) column.col(j) = rows_[l].X[static_cast<std::size_t>(j)].col(kept + c);
        waves[l].push_back(std::move(column));
      }
      for (MatrixXd& X : without[l].X) X.conservativeResize(Eigen::NoChange, kept);
    }
    const PartialFit::Result result = PartialFit(std::move(without)).with(waves);
    for (std::size_t k = 0; k < ripples.size(); ++k) {
      const auto at = static_cast<Index>(2 * k);
      ripples[k].cosine = result.amplitude(at);
      ripples[k].sine = result.amplitude(at + 1);
      ripples[k].amplitude_std = std::max(result.std(at), result.std(at + 1));
    }
  }

  const Robot& robot_;
  double pass_hz_;
  std::vector<PreparedLog> logs_;
  std::vector<BaseRows> rows_;
};

}  // namespace

std::vector<Ripple> find_ripples(const Robot& robot, const BaseParameters& base, const std::vector<Log>& logs,
                                 const ProcessingOptions& processing) {
  return RippleSearch(robot, base, logs, processing).run();
}

}  // namespace deltadyn
