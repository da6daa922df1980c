#include "deltadyn/identification/model_band.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/random.hpp"
#include "deltadyn/signal/log_part.hpp"

#include "data_fold.hpp"
#include "least_squares.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kBandSamples = 20'000;              // of each log
constexpr double kPartRatio = std::numbers::sqrt2;  // half an octave
// Of the model's torque: with less of it in the record, leaving the part out explains more than the model
constexpr double kHalfBand = 0.5;
constexpr double kNextToNothing = 0.25;
constexpr double kBandSigmas = 3;   // within which the record does not hold the whole of the model's torque
constexpr double kLeastSignal = 2;  // the model's torque over what noise makes of it
// Rows of half an octave are taken so many times closer than they are independent
constexpr double kRowsPerIndependent = 4;
constexpr double kLowest_hz = 2.5;    // machines that are built to move move faster than that
constexpr double kLeastPeriods = 20;  // of the cut-off in a log, as for the motion's
constexpr std::uint64_t kBandSeed = 1;
constexpr Index kFewestRowsOfPart = 20;  // of all drives in a part

ProcessingOptions at_cutoff(ProcessingOptions options, double cutoff_hz) {
  options.cutoff_hz = cutoff_hz;
  options.periods = Periods::ignore;
  options.stride = 0;
  return options;
}

/// Base parameters from the motion below a cut-off, if it shows them.
std::optional<BaseEstimate> fit_below(const Robot& robot, const BaseParameters& base, const std::vector<Log>& logs,
                                      const ProcessingOptions& options, int threads) {
  const DataFold fold = fold_logs(robot, prepare_logs(robot, logs, options), threads);
  try {
    return estimate_base_parameters(base, fold.to_begin_with());
  } catch (const Error&) {
    return std::nullopt;  // too few rows, or a motion that does not show every parameter
  }
}

/// What one drive's rows between two cut-offs say: sums over the rows.
struct DriveSums {
  double torque_model = 0;  ///< recorded torque times that of the model
  double model = 0;         ///< square of the model's, ...
  double chance = 0;        ///< ... of what uncertain parameters and encoder noise make of it, ...
  double torque = 0;        ///< ... of the recorded one, ...
  double all = 0;           ///< ... of the recorded one below the part's upper end
  Index rows = 0;

  void add(const DriveSums& other, double weight) {
    torque_model += weight * other.torque_model;
    model += weight * other.model;
    chance += weight * other.chance;
    torque += weight * other.torque;
    all += weight * other.all;
    rows += other.rows;
  }
};

/// The same rows under a low pass that ends lower.
void narrow_down(PreparedLog& wide, PreparedLog& narrow, double cutoff_hz) {
  narrow.low_pass = std::make_shared<FirDecimator>(wide.rate_hz, cutoff_hz, static_cast<int>(wide.stride));
  const Index reach = narrow.low_pass->half_width();
  const Index last = std::min(wide.first + (wide.rows - 1) * wide.stride, wide.t_s.size() - 1 - reach);
  const Index first = std::max(wide.first, reach);
  wide.first = narrow.first = first;
  wide.rows = narrow.rows = last > first ? (last - first) / wide.stride + 1 : 0;
}

/// Rows of a log between two cut-offs.
struct BandRows {
  std::vector<MatrixXd> Y;  ///< of each drive: rows x base parameters
  MatrixXd tau, all;        ///< rows x drives; all: with what is below the part
  RowUses use;

  BandRows(const Robot& robot, const BaseParameters& base, const Log& log, const ProcessingOptions& options,
           double low_hz) {
    PreparedLog wide = prepare_log(robot, log, options);
    PreparedLog narrow = wide;
    narrow_down(wide, narrow, options.torque_cutoff_ratio * low_hz);
    if (wide.rows == 0) return;
    RowBlock above, below;
    read_rows(robot, wide, narrow, 0, wide.rows, above, below);
    for (std::size_t j = 0; j < above.Y.size(); ++j)
      Y.emplace_back((above.Y[j] - below.Y[j])(Eigen::all, base.independent));
    tau = above.tau - below.tau;
    all = std::move(above.tau);
    use = std::move(below.use);
  }
};

/// The log with as much noise on its positions again as they have.
Log noisier(const Log& log, std::mt19937_64& random) {
  NormalDistribution normal;
  Log out = log;
  const VectorXd std = position_noise_std(log);
  out.q += MatrixXd::NullaryExpr(log.samples(), log.drives(), [&]() { return normal(random); }) * std.asDiagonal();
  return out;
}

/// 0 for the base parameters of Coulomb friction, 1 for the others.
VectorXd without_coulomb(const Robot& robot, const BaseParameters& base) {
  VectorXd out = VectorXd::Ones(base.count());
  for (const Index column : coulomb_columns(robot)) {
    if (const Index place = base.place_of(column); place >= 0) out(place) = 0;
  }
  return out;
}

/// Adds the rows of a log between two cut-offs. Coulomb friction is taken off the torque and no part of the model's:
/// its steps reach into every band, and how they really look is another question.
void add_part(const Robot& robot, const BaseParameters& base, const Log& log, const ProcessingOptions& options,
              double low_hz, const BaseEstimate& estimate, std::mt19937_64& random, std::vector<DriveSums>& sums) {
  const BandRows rows(robot, base, log, options, low_hz), noisy(robot, base, noisier(log, random), options, low_hz);
  const VectorXd smooth = without_coulomb(robot, base);
  for (Index j = 0; j < rows.tau.cols(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    const MatrixXd Y = rows.Y[at] * smooth.asDiagonal();
    const VectorXd model = Y * estimate.value;
    const VectorXd tau = rows.tau.col(j) - (rows.Y[at] * estimate.value - model);
    const VectorXd chance = (Y * estimate.covariance).cwiseProduct(Y).rowwise().sum() +
                            (noisy.Y[at] * smooth.cwiseProduct(estimate.value) - model).cwiseAbs2();
    for (Index k = 0; k < Y.rows(); ++k) {
      if (rows.use(k, j) == RowUse::unusable) continue;
      DriveSums& sum = sums[at];
      sum.torque_model += tau(k) * model(k);
      sum.model += model(k) * model(k);
      sum.chance += chance(k);
      sum.torque += tau(k) * tau(k);
      sum.all += rows.all(k, j) * rows.all(k, j);
      ++sum.rows;
    }
  }
}

/// The part of the band, or nothing if too few rows tell it.
std::optional<ModelBandPart> part_between(const Robot& robot, const BaseParameters& base, const std::vector<Log>& logs,
                                          const ProcessingOptions& options, double low_hz,
                                          const BaseEstimate& estimate) {
  std::vector<DriveSums> sums(static_cast<std::size_t>(robot.drives()));
  std::mt19937_64 random(kBandSeed);
  for (const Log& log : logs) add_part(robot, base, log, options, low_hz, estimate, random, sums);
  DriveSums total;
  for (const DriveSums& one : sums) {
    if (one.all > 0) total.add(one, static_cast<double>(one.rows) / one.all);  // a drive counts by its whole torque
  }
  if (total.rows < kFewestRowsOfPart || !(total.model > kLeastSignal * total.chance)) return std::nullopt;
  const double model = total.model - total.chance;
  ModelBandPart part{low_hz, options.cutoff_hz, total.torque_model / model, 0};
  const double left = total.torque - 2 * part.found * total.torque_model + part.found * part.found * total.model;
  part.std =
      std::sqrt(kRowsPerIndependent * std::max(left, 0.0) * total.model / static_cast<double>(total.rows)) / model;
  return part;
}

bool fails(const ModelBandPart& part) {
  return part.found + part.std < kHalfBand && part.found + kBandSigmas * part.std < 1;
}

}  // namespace

const ModelBandPart* ModelBand::beyond() const {
  const auto part = std::ranges::find(parts, limit_hz, &ModelBandPart::low_hz);
  return part != parts.end() ? &*part : nullptr;
}

ModelBand find_model_band(const Robot& robot, const BaseParameters& base, const std::vector<Log>& logs,
                          const ProcessingOptions& processing, double lowest_hz, double highest_hz, int threads) {
  ModelBand out;
  std::vector<Log> middles;
  double shortest_s = 1e300;
  for (const Log& log : logs) {
    middles.push_back(middle_of(log, kBandSamples));
    shortest_s = std::min(shortest_s, static_cast<double>(log.samples()) * log.sample_time_s());
  }
  // Appends a part; false if too little is known of it.
  const auto look = [&](double low, double high) {
    const std::optional<BaseEstimate> estimate = fit_below(robot, base, middles, at_cutoff(processing, low), threads);
    if (!estimate) return false;
    const std::optional<ModelBandPart> part =
        part_between(robot, base, middles, at_cutoff(processing, high), low, *estimate);
    if (part) out.parts.push_back(*part);
    return part.has_value();
  };
  for (double low = lowest_hz; low < 0.99 * highest_hz && out.limit_hz == 0;) {
    // No rest of a part that is too narrow to tell anything.
    const double high = low * kPartRatio * std::sqrt(kPartRatio) < highest_hz ? low * kPartRatio : highest_hz;
    if (!look(low, high)) return out;
    if (fails(out.parts.back())) out.limit_hz = low;
    low = high;
  }
  // Where the model fails from the first part on, it may fail below, too. But a lower cut-off costs rows near
  // reversals, and what friction makes of slow motions pulls at the model there: only where next to nothing of its
  // torque is in the record.
  const double floor_hz = std::max(kLowest_hz, kLeastPeriods / shortest_s);
  while (out.parts.size() > 0 && fails(out.parts.front()) && out.limit_hz / kPartRatio >= floor_hz) {
    if (!look(out.limit_hz / kPartRatio, out.limit_hz)) break;
    std::rotate(out.parts.begin(), out.parts.end() - 1, out.parts.end());
    const ModelBandPart& part = out.parts.front();
    if (fails(part) && part.found < kNextToNothing)
      out.limit_hz = part.low_hz;
    else
      break;
  }
  return out;
}

ModelCutoff choose_model_cutoff(const Robot& robot, const BaseParameters& base, const std::vector<Log>& logs,
                                const ProcessingOptions& processing, int threads) {
  ModelCutoff out;
  out.motion = choose_cutoff(logs);
  out.cutoff_hz = out.motion.cutoff_hz;
  out.model = find_model_band(robot, base, logs, processing, out.motion.lowest_hz, out.motion.cutoff_hz, threads);
  if (out.model.limit_hz > 0) out.cutoff_hz = std::min(out.cutoff_hz, out.model.limit_hz);
  return out;
}

}  // namespace deltadyn
