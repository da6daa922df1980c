#include "deltadyn/identification/presliding_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "deltadyn/effects/coulomb_friction.hpp"
#include "deltadyn/effects/presliding.hpp"
#include "deltadyn/identification/data_fold.hpp"
#include "deltadyn/identification/effect_columns.hpp"
#include "deltadyn/identification/least_squares.hpp"
#include "deltadyn/identification/prediction.hpp"

#include "log_middle.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kSamples = 20'000;  // of each log; reversals enough, and a log of hours costs no more
constexpr int kPasses = 4;          // displacements and base parameters settle in three
constexpr double kSmallest = 2e-5;  // of the joint's range: no filter shows less
constexpr double kLargest =
    0.02;                  // of the joint's range: what builds up over more is no bristle but a spring or Stribeck's curve
constexpr int kGrid = 13;  // displacements tried from the smallest to the largest, refined afterwards
constexpr double kClearGain = 25;  // of the squared residual in units of its noise: five standard deviations for one parameter
constexpr double kForm =
    0.02;  // of a displacement: the filter rounds the reversals of the positions, and no bristle is quite Dahl's
constexpr double kMemory_s = 0.2;  // of the residual, as in identify()

/// One log with what the search needs of it.
struct SearchLog {
  PreparedLog prepared;             ///< with the presliding of the present pass
  MatrixXd rates;                   ///< N x joints with friction
  std::vector<MatrixXd> direction;  ///< of each joint N x drives: torque of unit friction of positive sign
  MatrixXd residual;                ///< rows x drives
  Eigen::Array<RowUse, Eigen::Dynamic, Eigen::Dynamic> use;
};

class Search {
 public:
  Search(const Robot& robot, const BaseParameters& base, const std::vector<Log>& logs, const ProcessingOptions& processing,
         int threads)
      : robot_(robot), base_(base), processing_(processing), threads_(threads), coulomb_(coulomb_columns(robot)) {
    processing_.presliding.setZero(robot.friction_joints());
    processing_.periods = Periods::ignore;  // the bristles' memory runs along the log as it was
    for (const Log& log : logs) logs_.push_back(middle_of(log, kSamples));
    range_.setZero(robot.friction_joints());
    noise_.setOnes(robot.drives());
  }

  std::vector<PreslidingJoint> run() {
    std::vector<PreslidingJoint> out(coulomb_.size());
    for (int pass = 0; pass < kPasses; ++pass) {
      fit();
      if (pass == 0) look_along();
      const VectorXd before = processing_.presliding;
      for (std::size_t joint = 0; joint < out.size(); ++joint) {
        out[joint] = best(static_cast<Index>(joint));
        processing_.presliding(static_cast<Index>(joint)) = out[joint].displacement;
      }
      if (pass > 0 && ((processing_.presliding - before).array().abs() <= 0.01 * before.array()).all()) break;
    }
    return out;
  }

 private:
  /// Base parameters with the present displacements, and what they leave.
  void fit() {
    DataFold fold;
    std::vector<PreparedLog> prepared;
    for (const Log& log : logs_) {
      prepared.push_back(prepare_log(robot_, log, processing_));
      fold.add(fold_log(robot_, prepared.back(), threads_));
    }
    std::vector<DriveFold> folds = fold.regular;
    for (std::size_t j = 0; j < folds.size(); ++j) {
      if (folds[j].rows < fold.reversal[j].rows) folds[j].add(fold.reversal[j]);  // else too little is left to start from
    }
    const BaseEstimate estimate = estimate_base_parameters(base_, folds);
    p_ = any_parameters(base_, estimate.value, robot_.parameters());
    if (searched_.empty()) searched_.resize(logs_.size());
    for (Index j = 0; j < robot_.drives(); ++j) noise_(j) = estimate.noise[static_cast<std::size_t>(j)].std;
    for (std::size_t l = 0; l < logs_.size(); ++l) {
      SearchLog& log = searched_[l];
      log.prepared = std::move(prepared[l]);
      const Prediction prediction = predict(robot_, log.prepared, p_, threads_);
      log.residual = prediction.residual();
      log.use = prediction.use;
      const auto lags =
          static_cast<Index>(std::ceil(kMemory_s * log.prepared.rate_hz / static_cast<double>(log.prepared.stride)));
      for (Index j = 0; j < robot_.drives(); ++j) {
        const double memory =
            noise_correlation(log.residual.col(j), prediction.usable(static_cast<int>(j), false), std::min<Index>(lags, 50));
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
      log.rates.resize(samples, robot_.friction_joints());
      log.direction.assign(coulomb_.size(), MatrixXd::Zero(samples, robot_.drives()));
      for (Index k = 0; k < samples; ++k) {
        const VectorXd q = log.prepared.q.row(k), qd = log.prepared.qd.row(k), qdd = log.prepared.qdd.row(k);
        if (robot_.friction_joint_rates(q, qd, v) != Status::ok || robot_.regressor(q, qd, qdd, Y) != Status::ok) continue;
        log.rates.row(k) = v.transpose();
        for (std::size_t joint = 0; joint < coulomb_.size(); ++joint)
          log.direction[joint].row(k) = coulomb_friction(v(static_cast<Index>(joint))) * Y.col(coulomb_[joint]).transpose();
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
  [[nodiscard]] MatrixXd column(const SearchLog& log, Index joint, double displacement) const {
    const MatrixXd& direction = log.direction[static_cast<std::size_t>(joint)];
    MatrixXd values = direction;
    Presliding<double> bristle(std::max(displacement, 1e-12), coulomb_friction(log.rates(0, joint)));
    for (Index k = 0; k < direction.rows(); ++k) {
      const double share =
          displacement > 0 ? bristle.move(k > 0 ? step(log, joint, k) : 0.0) : coulomb_friction(log.rates(k, joint));
      values.row(k) *= share;
    }
    return low_passed_rows(log.prepared, values);
  }

  /// Squared residual over the noise with the friction of one joint replaced by that of another displacement, its amplitude fitted.
  [[nodiscard]] double cost(Index joint, double displacement, const std::vector<MatrixXd>& target) const {
    double aa = 0, ab = 0, bb = 0;
    for (std::size_t l = 0; l < searched_.size(); ++l) {
      const SearchLog& log = searched_[l];
      const MatrixXd c = column(log, joint, displacement);
      for (Index j = 0; j < c.cols(); ++j) {
        const double weight = 1 / (noise_(j) * noise_(j));
        for (Index k = 0; k < c.rows(); ++k) {
          if (c(k, j) == 0 || log.use(k, j) == RowUse::unusable) continue;
          aa += weight * c(k, j) * c(k, j);
          ab += weight * c(k, j) * target[l](k, j);
        }
      }
      bb += ((log.use != RowUse::unusable).cast<double>() * target[l].array().square())
                .matrix()
                .colwise()
                .sum()
                .dot(noise_.cwiseAbs2().cwiseInverse());
    }
    const double amplitude = aa > 0 ? std::max(0.0, ab / aa) : 0.0;
    return bb - 2 * amplitude * ab + amplitude * amplitude * aa;
  }

  [[nodiscard]] PreslidingJoint best(Index joint) const {
    PreslidingJoint out;
    const double coulomb = p_(coulomb_[static_cast<std::size_t>(joint)]);
    if (!(range_(joint) > 0) || !(coulomb > 0)) return out;
    std::vector<MatrixXd> target;
    for (const SearchLog& log : searched_)
      target.push_back(log.residual + coulomb * column(log, joint, processing_.presliding(joint)));
    const double smallest = kSmallest * range_(joint), ratio = std::pow(kLargest / kSmallest, 1.0 / (kGrid - 1));
    std::vector<double> tried, costs;
    for (int k = 0; k < kGrid; ++k) {
      tried.push_back(smallest * std::pow(ratio, k));
      costs.push_back(cost(joint, tried.back(), target));
    }
    const auto at = std::min_element(costs.begin(), costs.end()) - costs.begin();
    const double without = cost(joint, 0, target);
    if (at == 0 || without - costs[static_cast<std::size_t>(at)] < kClearGain) return out;
    double low = tried[static_cast<std::size_t>(at - 1)],
           high = tried[static_cast<std::size_t>(std::min<std::ptrdiff_t>(at + 1, kGrid - 1))];
    // Golden section in the logarithm.
    const double golden = 0.5 * (std::sqrt(5.0) - 1);
    double a = high * std::pow(low / high, golden), b = low * std::pow(high / low, golden);
    double cost_a = cost(joint, a, target), cost_b = cost(joint, b, target);
    while (high > 1.01 * low) {
      if (cost_a < cost_b) {
        high = b;
        b = a;
        cost_b = cost_a;
        a = high * std::pow(low / high, golden);
        cost_a = cost(joint, a, target);
      } else {
        low = a;
        a = b;
        cost_a = cost_b;
        b = low * std::pow(high / low, golden);
        cost_b = cost(joint, b, target);
      }
    }
    out.displacement = std::sqrt(low * high);
    const double found = cost(joint, out.displacement, target);
    out.gain = without - found;
    // A parabola through the costs a tenth apart: one unit of cost is one standard deviation.
    const double bend = (cost(joint, 1.1 * out.displacement, target) + cost(joint, out.displacement / 1.1, target) - 2 * found) /
                        std::pow(std::log(1.1), 2);
    out.std = bend > 0 ? out.displacement * std::hypot(std::sqrt(2 / bend), kForm) : out.displacement;
    return out;
  }

  const Robot& robot_;
  const BaseParameters& base_;
  ProcessingOptions processing_;
  int threads_;
  std::vector<Index> coulomb_;
  std::vector<Log> logs_;
  std::vector<SearchLog> searched_;
  VectorXd p_, range_, noise_;
};

}  // namespace

std::vector<PreslidingJoint> find_presliding(const Robot& robot, const BaseParameters& base, const std::vector<Log>& logs,
                                             const ProcessingOptions& processing, int threads) {
  return Search(robot, base, logs, processing, threads).run();
}

VectorXd displacements(const std::vector<PreslidingJoint>& joints) {
  VectorXd out(static_cast<Index>(joints.size()));
  for (std::size_t k = 0; k < joints.size(); ++k) out(static_cast<Index>(k)) = joints[k].displacement;
  return out;
}

}  // namespace deltadyn
