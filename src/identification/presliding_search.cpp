#include "deltadyn/identification/presliding_search.hpp"

#include <algorithm>
#include <cmath>

#include "deltadyn/core/sign.hpp"
#include "deltadyn/effects/bristle.hpp"
#include "deltadyn/identification/effect_columns.hpp"
#include "deltadyn/runtime/golden_section.hpp"
#include "deltadyn/signal/log_part.hpp"
#include "deltadyn/signal/requantise.hpp"
#include "deltadyn/signal/reversal_mask.hpp"

#include "data_fold.hpp"
#include "least_squares.hpp"
#include "partial_fit.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kPreslidingSamples = 20'000;  // of each log; reversals enough, and a log of hours costs no more
constexpr int kPasses = 4;                    // displacements and base parameters settle in three
constexpr double kSmallest = 2e-5;            // of the joint's range: no filter shows less
// Of the position's noise: what jitters within it rounds a reversal like a bristle
constexpr double kOverNoise = 1;
// Of the joint's range: what builds up over more is no bristle but a spring or Stribeck's curve
constexpr double kLargest = 0.02;
constexpr int kGrid = 13;  // displacements tried from the smallest to the largest, refined afterwards
// Of the squared residual in units of its noise: five standard deviations for one parameter
constexpr double kClearGain = 25;
// Of a displacement: the filter rounds the reversals of the positions, and no bristle is quite Dahl's
constexpr double kForm = 0.02;
constexpr double kWider = 3;                // displacements on either side that are tried with damping
constexpr double kLongestDamping_s = 0.02;  // what lasts longer is no bristle

VectorXd all_of(const std::vector<PreslidingJoint>& joints, double PreslidingJoint::*value) {
  return VectorXd::NullaryExpr(std::ssize(joints), [&](Index k) { return joints[static_cast<std::size_t>(k)].*value; });
}

/// One log with what the search needs of it.
struct SearchLog {
  PreparedLog prepared;             ///< with the presliding of the present pass
  MatrixXd rates;                   ///< N x joints with friction
  std::vector<MatrixXd> direction;  ///< of each joint N x drives: torque of unit friction of positive sign
  BaseRows rows;                    ///< with the presliding of the present pass
  RowUses use;
};

class Search {
 public:
  Search(const Robot& robot, const BaseParameters& base, const std::vector<Log>& logs,
         const ProcessingOptions& processing, int threads)
      : robot_(robot), base_(base), processing_(processing), threads_(threads), coulomb_(coulomb_columns(robot)) {
    processing_.presliding.setZero(robot.friction_joints());
    processing_.presliding_damping_s.setZero(robot.friction_joints());
    processing_.periods = Periods::ignore;  // the bristles' memory runs along the log as it was
    jitter_.setZero(robot.friction_joints());
    for (const Log& log : logs) {
      logs_.push_back(middle_of(log, kPreslidingSamples));
      const VectorXd steps = position_steps(logs_.back());
      for (Index j = 0; j < robot.drives(); ++j)
        jitter_(j) = std::max({jitter_(j), position_noise(logs_.back().q.col(j)), steps(j) / std::sqrt(12.0)});
    }
    range_.setZero(robot.friction_joints());
    noise_.setOnes(robot.drives());
  }

  std::vector<PreslidingJoint> run() {
    std::vector<PreslidingJoint> out(coulomb_.size());
    for (int pass = 0; pass < kPasses; ++pass) {
      fit();
      if (pass == 0) look_along();
      const VectorXd before = processing_.presliding;
      for (std::size_t joint = 0; joint < out.size(); ++joint) out[joint] = best(static_cast<Index>(joint));
      processing_.presliding = displacements(out);
      processing_.presliding_damping_s = bristle_dampings(out);
      if (pass > 0 && ((processing_.presliding - before).array().abs() <= 0.01 * before.array()).all()) break;
    }
    return out;
  }

 private:
  /// Base parameters with the present displacements, the noise that they leave, and the rows.
  void fit() {
    std::vector<PreparedLog> prepared = prepare_logs(robot_, logs_, processing_);
    const BaseEstimate estimate =
        estimate_base_parameters(base_, fold_logs(robot_, prepared, threads_).to_begin_with());
    searched_.resize(logs_.size());
    for (Index j = 0; j < robot_.drives(); ++j) noise_(j) = estimate.noise[static_cast<std::size_t>(j)].std;
    for (std::size_t l = 0; l < logs_.size(); ++l) {
      SearchLog& log = searched_[l];
      log.prepared = std::move(prepared[l]);
      log.rows = base_rows(robot_, base_, log.prepared, log.use);
      for (Index j = 0; j < robot_.drives(); ++j) {
        const double memory =
            residual_memory(log.rows.tau.col(j) - log.rows.X[static_cast<std::size_t>(j)] * estimate.value,
                            usable_rows(log.use, j, false), log.prepared.row_rate_hz());
        noise_(j) = std::max(noise_(j), estimate.noise[static_cast<std::size_t>(j)].std * std::sqrt(memory));
      }
    }
  }

  /// Rates, and where a joint's friction shows, once: they do not depend on the displacements.
  void look_along() {
    MatrixXd Y(robot_.drives(), robot_.parameters());
    VectorXd v(robot_.friction_joints());
    for (SearchLog& log : searched_) {
      const Index samples = log.prepared.t_s.size();
      PathPose path;
      log.rates.resize(samples, robot_.friction_joints());
      log.direction.assign(coulomb_.size(), MatrixXd::Zero(samples, robot_.drives()));
      for (Index k = 0; k < samples; ++k) {
        const VectorXd q = log.prepared.q.row(k), qd = log.prepared.qd.row(k), qdd = log.prepared.qdd.row(k);
        if (robot_.friction_joint_rates(q, qd, v, &path) != Status::ok ||
            robot_.regressor(q, qd, qdd, Y, &path) != Status::ok)
          continue;
        log.rates.row(k) = v.transpose();
        for (std::size_t joint = 0; joint < coulomb_.size(); ++joint)
          log.direction[joint].row(k) = sign_of(v(static_cast<Index>(joint))) * Y.col(coulomb_[joint]).transpose();
      }
      for (Index joint = 0; joint < range_.size(); ++joint) {
        double at = 0, low = 0, high = 0;
        for (Index k = 1; k < samples; ++k) {
          at += step(log, joint, k);
          low = std::min(low, at);
          high = std::max(high, at);
        }
        range_(joint) = std::max(range_(joint), high - low);
      }
    }
  }

  [[nodiscard]] static double step(const SearchLog& log, Index joint, Index k) {
    const MatrixXd& q = log.prepared.q;
    if (joint < q.cols()) return q(k, joint) - q(k - 1, joint);
    return 0.5 * (log.rates(k, joint) + log.rates(k - 1, joint)) / log.prepared.rate_hz;
  }

  /// Rows of the friction of one joint, of size one: of its bristle, or of Coulomb's law for displacement 0.
  /// \param damped  with the rate of the bristle's state as a second column
  [[nodiscard]] Columns columns(const SearchLog& log, Index joint, double displacement, bool damped) const {
    const MatrixXd& direction = log.direction[static_cast<std::size_t>(joint)];
    MatrixXd values = direction, of_rate = direction;
    Bristle<double> bristle(std::max(displacement, 1e-12), sign_of(log.rates(0, joint)));
    for (Index k = 0; k < direction.rows(); ++k) {
      const double rate = log.rates(k, joint);
      const double state = displacement > 0 ? bristle.move(k > 0 ? step(log, joint, k) : 0.0) : sign_of(rate);
      values.row(k) *= state;
      if (damped) of_rate.row(k) *= bristle_rate(rate, state, displacement);
    }
    Columns out = {low_passed_rows(log.prepared, values)};
    if (damped) out.push_back(low_passed_rows(log.prepared, of_rate));
    return out;
  }

  [[nodiscard]] PartialFit::Result result(const PartialFit& fit, Index joint, double displacement, bool damped) const {
    std::vector<Columns> all;
    for (const SearchLog& log : searched_) all.push_back(columns(log, joint, displacement, damped));
    PartialFit::Result out = fit.with(all);
    // Friction that drives, or bristles that do so, are no explanation.
    if (out.amplitude.minCoeff() < 0) out.cost = fit.square();
    return out;
  }

  /// Rows near reversals count where the friction of this joint is felt; elsewhere that of another joint spoils them.
  [[nodiscard]] MatrixXd weights(const SearchLog& log, Index joint) const {
    MatrixXd weight(log.rows.tau.rows(), log.rows.tau.cols());
    const MatrixXd& felt = log.direction[static_cast<std::size_t>(joint)];
    for (Index j = 0; j < weight.cols(); ++j) {
      const bool feels = (felt.col(j).array() != 0).any();
      weight.col(j) = usable_rows(log.use, j, feels).cast<double>() / (noise_(j) * noise_(j));
    }
    return weight;
  }

  [[nodiscard]] PreslidingJoint best(Index joint) const {
    PreslidingJoint out;
    // The joint's Coulomb friction among the base parameters, if the motion shows it
    const Index own = base_.place_of(coulomb_[static_cast<std::size_t>(joint)]);
    if (!(range_(joint) > 0) || own < 0) return out;
    std::vector<BaseRows> rows;
    for (const SearchLog& log : searched_) {
      rows.push_back(log.rows);
      rows.back().weight = weights(log, joint);
    }
    const PartialFit fit(std::move(rows), own);
    const auto cost = [&](double displacement) { return result(fit, joint, displacement, false).cost; };
    const double smallest = std::max(kSmallest * range_(joint), kOverNoise * jitter_(joint));
    if (smallest >= kLargest * range_(joint)) return out;
    const double ratio = std::pow(kLargest * range_(joint) / smallest, 1.0 / (kGrid - 1));
    const auto tried = [&](Index k) { return smallest * std::pow(ratio, k); };
    Index at = 0;
    const VectorXd costs = VectorXd::NullaryExpr(kGrid, [&](Index k) { return cost(tried(k)); });
    const double least = costs.minCoeff(&at);
    const double without = cost(0);
    if (at == 0 || without - least < kClearGain) return out;
    out.displacement = golden_section_in_logarithm(cost, tried(at - 1), tried(std::min<Index>(at + 1, kGrid - 1)));
    const double found = cost(out.displacement);
    out.gain = without - found;
    out.std = deviation(cost, out.displacement);
    add_damping(fit, joint, found, out);
    return out;
  }

  /// A parabola through the costs a tenth apart: one unit of cost is one standard deviation.
  template <class Function>
  [[nodiscard]] static double deviation(const Function& cost, double displacement) {
    const double bend =
        (cost(1.1 * displacement) + cost(displacement / 1.1) - 2 * cost(displacement)) / std::pow(std::log(1.1), 2);
    return bend > 0 ? displacement * std::hypot(std::sqrt(2 / bend), kForm) : displacement;
  }

  /// Damping of the bristles where that explains clearly more. Without it their displacement comes out too small.
  void add_damping(const PartialFit& fit, Index joint, double undamped, PreslidingJoint& found) const {
    const auto cost = [&](double displacement) { return result(fit, joint, displacement, true).cost; };
    const double displacement =
        golden_section_in_logarithm(cost, found.displacement / kWider, found.displacement * kWider);
    const PartialFit::Result best = result(fit, joint, displacement, true);
    if (undamped - best.cost < kClearGain || !(best.amplitude(0) > 0)) return;
    const double damping_s = best.amplitude(1) / best.amplitude(0);
    if (damping_s > kLongestDamping_s) return;
    found.gain += undamped - best.cost;
    found.displacement = displacement;
    found.std = deviation(cost, displacement);
    found.damping_s = damping_s;
    found.damping_std_s = best.std(1) / best.amplitude(0);
  }

  const Robot& robot_;
  const BaseParameters& base_;
  ProcessingOptions processing_;
  int threads_;
  std::vector<Index> coulomb_;
  std::vector<Log> logs_;
  std::vector<SearchLog> searched_;
  VectorXd range_, noise_, jitter_;
};

}  // namespace

std::vector<PreslidingJoint> find_presliding(const Robot& robot, const BaseParameters& base,
                                             const std::vector<Log>& logs, const ProcessingOptions& processing,
                                             int threads) {
  return Search(robot, base, logs, processing, threads).run();
}

VectorXd displacements(const std::vector<PreslidingJoint>& joints) {
  return all_of(joints, &PreslidingJoint::displacement);
}

VectorXd bristle_dampings(const std::vector<PreslidingJoint>& joints) {
  return all_of(joints, &PreslidingJoint::damping_s);
}

}  // namespace deltadyn
