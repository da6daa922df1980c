#include "hypothesis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "deltadyn/runtime/statistics.hpp"

namespace deltadyn {

namespace {

constexpr double kFinestWave = 0.5;  // spacing of the waves over the range: a quarter of a wave out of step at the ends
constexpr double kPassBand = 0.6;    // of the cut-off: a ripple above it at the usual speed is filtered away

/// What the motion of a joint is like over all logs.
struct MotionScale {
  double largest_rate = 0, usual_rate = 0, middle = 0, range = 0, largest_torque = 0;
};

MotionScale scale_of(const std::vector<LogRows>& logs, int joint) {
  MotionScale scale;
  std::vector<double> rates;
  double low = 1e300, high = -1e300;
  for (const LogRows& log : logs) {
    const auto& s = log.signals;
    for (Index k = 0; k < log.rows(); ++k) {
      const Index at = sample_of_row(log.log, k);
      rates.push_back(std::abs(joint >= 0 ? s.qd(at, joint) : s.inner_rate(at)));
      if (joint < 0) continue;
      low = std::min(low, s.q(at, joint));
      high = std::max(high, s.q(at, joint));
      scale.largest_torque = std::max(scale.largest_torque, std::abs(s.torque(at, joint)));
    }
  }
  scale.largest_rate = quantile(rates, 0.995);
  scale.usual_rate = upper_median(rates);
  scale.range = std::max(high - low, 0.0);
  scale.middle = joint >= 0 ? 0.5 * (low + high) : 0.0;
  return scale;
}

std::vector<double> waves(const MotionScale& scale, double cutoff_hz, double least, double most) {
  std::vector<double> n;
  if (!(scale.range > 0)) return n;
  const double per_wave = 2 * std::numbers::pi / scale.range;
  const double highest = 2 * std::numbers::pi * kPassBand * cutoff_hz / std::max(scale.usual_rate, 1e-9);
  for (double w = least; w <= most && w * per_wave <= highest; w += kFinestWave) n.push_back(w * per_wave);
  return n;
}

std::vector<double> grid_of(const ShapeTraits& shape, const Hypothesis& hypothesis, const MotionScale& scale,
                            const std::vector<LogRows>& logs, const Robot& robot) {
  const bool turns = hypothesis.joint < 0 || robot.description().kind_of_drive(hypothesis.joint) == DriveKind::revolute;
  std::vector<double> grid = start_values(shape);
  double unit = 1;
  switch (shape.scale) {
    case ShapeScale::absolute:
    case ShapeScale::choice: break;
    case ShapeScale::largest_rate: unit = scale.largest_rate; break;
    case ShapeScale::largest_torque: unit = scale.largest_torque; break;
    case ShapeScale::displacement: unit = std::max(turns ? 1.0 : 0.1, scale.range); break;
    case ShapeScale::range: unit = scale.range; break;
    case ShapeScale::place:
      for (double& value : grid) value = scale.middle + value * scale.range;
      return grid;
    case ShapeScale::waves: {
      double cutoff_hz = 1e9;
      for (const LogRows& log : logs) {
        // Half the rate of the rows stands for the pass band.
        cutoff_hz = std::min(cutoff_hz, 0.4 * log.log.rate_hz / static_cast<double>(log.log.stride));
      }
      return waves(scale, cutoff_hz, shape.start[0], shape.start[1]);
    }
    case ShapeScale::logs:
      for (const LogRows& log : logs) grid.push_back(log.number);
      return logs.size() > 1 ? grid : std::vector<double>{};
  }
  for (double& value : grid) value *= unit;
  return grid;
}

/// Of start values that differ in a mere unit only, the last serves.
void keep_one_unit(const EffectKind& kind, std::vector<VectorXd>& shapes) {
  if (kind.is_unit == nullptr || shapes.empty()) return;
  for (std::size_t k = 0; k < kind.shapes.size(); ++k) {
    const double last = shapes.back()(static_cast<Index>(k));
    std::erase_if(shapes,
                  [&](const VectorXd& s) { return kind.is_unit(k, s.data()) && s(static_cast<Index>(k)) != last; });
  }
}

bool base_holds(const Robot& robot, const Hypothesis& hypothesis) {
  const ParameterOptions& options = robot.parameter_options();
  switch (hypothesis.kind().base_term) {
    case BaseTerm::none: return false;
    case BaseTerm::offset: return options.offset;
    case BaseTerm::rotor_inertia:
      // An axis has one inertia only; the telescope's drive turns the tool, whose inertia stands in the model.
      return robot.description().parts.empty() ||
             hypothesis.joint >= static_cast<int>(robot.description().limbs.size()) ||
             std::count(options.rotor_inertia.begin(), options.rotor_inertia.end(), hypothesis.joint + 1) > 0;
    case BaseTerm::limb: return options.individual_limbs;
    // One drive alone: its torque constant scales all its parameters and cannot be seen.
    case BaseTerm::torque_scale: return robot.drives() == 1;
  }
  return false;
}

}  // namespace

Hypothesis hypothesis_of(const Effect& effect) {
  return {effect.id, effect.joint, {effect.shape}, static_cast<Index>(effect_kind(effect.id).amplitudes.size())};
}

bool shape_is_free(EffectId id, std::size_t parameter, const VectorXd& shape) {
  const EffectKind& kind = effect_kind(id);
  if (kind.shapes[parameter].search.kind == ShapeSearch::fixed) return false;
  return kind.is_unit == nullptr || !kind.is_unit(parameter, shape.data());
}

std::vector<Hypothesis> all_hypotheses(const Robot& robot, const std::vector<LogRows>& logs,
                                       const std::vector<Effect>& known) {
  std::vector<MotionScale> scales;
  for (int j = -1; j < robot.drives(); ++j) scales.push_back(scale_of(logs, j));
  std::vector<Hypothesis> all;
  for (const EffectKind& kind : effect_catalogue()) {
    for (const int joint : effect_joints(kind.id, robot.description())) {
      Hypothesis hypothesis{kind.id, joint, {VectorXd(0)}, static_cast<Index>(kind.amplitudes.size())};
      const bool is_known =
          std::any_of(known.begin(), known.end(), [&](const Effect& e) { return e.id == kind.id && e.joint == joint; });
      if (is_known || base_holds(robot, hypothesis)) continue;
      // Limbs that are alike move alike: the first one stands for all.
      const int typical = joint < 0 && kind.place == EffectPlace::limb_or_all ? 0 : joint;
      const MotionScale& scale = scales[static_cast<std::size_t>(typical + 1)];
      if (typical >= 0) hypothesis.largest_torque = scale.largest_torque;
      // Every combination of the shapes' start values.
      for (const ShapeTraits& shape : kind.shapes) {
        const std::vector<double> grid = grid_of(shape, hypothesis, scale, logs, robot);
        std::vector<VectorXd> combined;
        for (const VectorXd& so_far : hypothesis.shapes) {
          for (const double value : grid) {
            VectorXd next(so_far.size() + 1);
            next << so_far, value;
            combined.push_back(next);
          }
        }
        hypothesis.shapes = combined;
      }
      keep_one_unit(kind, hypothesis.shapes);
      if (!hypothesis.shapes.empty()) all.push_back(std::move(hypothesis));
    }
  }
  return all;
}

std::vector<MatrixXd> hypothesis_rows(const EffectModel& model, const LogRows& log, const EffectSignals& signals,
                                      const Hypothesis& hypothesis) {
  const Index n = log.tau.cols();
  const Index k = hypothesis.amplitudes;
  const Index N = signals.q.rows();
  const auto shapes = static_cast<Index>(hypothesis.shapes.size());
  std::vector<MatrixXd> raw(static_cast<std::size_t>(n)), out(static_cast<std::size_t>(n));
  for (Index s = 0; s < shapes; ++s) {
    const auto columns = model.columns(signals, hypothesis.id, hypothesis.joint,
                                       hypothesis.shapes[static_cast<std::size_t>(s)], log.number);
    for (Index c = 0; c < k; ++c) {
      const EffectColumn& column = columns[static_cast<std::size_t>(c)];
      for (Index j = 0; j < n; ++j) {
        if (column.drive >= 0 && column.drive != j) continue;
        MatrixXd& to = raw[static_cast<std::size_t>(j)];
        if (to.size() == 0) to.setZero(N, shapes * k);
        to.col(s * k + c) = column.values.col(column.drive < 0 ? j : 0);
      }
    }
  }
  for (std::size_t j = 0; j < raw.size(); ++j) {
    if (raw[j].size() > 0) out[j] = low_passed_rows(log.log, raw[j]);
  }
  return out;
}

PerLogAndDrive<MatrixXd> hypothesis_rows(const EffectModel& model, const std::vector<LogRows>& logs,
                                         const Hypothesis& hypothesis) {
  PerLogAndDrive<MatrixXd> out;
  for (const LogRows& log : logs) out.push_back(hypothesis_rows(model, log, log.signals, hypothesis));
  return out;
}

}  // namespace deltadyn
