#include "deltadyn/identification/effect_columns.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>

#include "deltadyn/runtime/random.hpp"

#include "identification/synthetic_log.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

class SpringColumn : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    robot_ = make_robot(testing_support::delta_description(GetParam()));
    p_ = testing_support::delta_truth(*robot_);
    // The bar's dry friction passes the spring, too, and its steps have no second derivative to compare.
    for (int k = 0; k < robot_->parameters(); ++k) {
      if (robot_->parameter_names()[static_cast<std::size_t>(k)] == "telescope.coulomb") p_(k) = 0;
    }
    testing_support::SyntheticOptions options;
    options.duration_s = 2;
    ProcessingOptions processing;
    processing.cutoff_hz = 30;
    processing.periods = Periods::ignore;
    log_ = prepare_log(*robot_, testing_support::synthetic_log(*robot_, p_, options), processing);
  }
  /// Torques of the rigid model without friction at a sample of another motion.
  [[nodiscard]] VectorXd torque(const VectorXd& q, const VectorXd& qd, const VectorXd& qdd) const {
    VectorXd smooth = p_, tau(robot_->drives());
    for (int k = 0; k < robot_->parameters(); ++k) {
      const std::string& name = robot_->parameter_names()[static_cast<std::size_t>(k)];
      if (name.find("coulomb") != std::string::npos || name.find("viscous") != std::string::npos) smooth(k) = 0;
    }
    EXPECT_EQ(robot_->inverse_dynamics(q, qd, qdd, smooth, tau), Status::ok);
    return tau;
  }

  std::unique_ptr<Robot> robot_;
  VectorXd p_;
  PreparedLog log_;
};

TEST_P(SpringColumn, IsWhatTheArmsLagTakesFromTheRigidModel) {
  const EffectModel model(*robot_);
  const EffectSignals s = model.signals(log_, p_, false);
  const double dt = s.sample_time_s;
  const int n = robot_->drives(), joint = 1;
  const double share = 0.3, c = 1e-7;  // so stiff that first order is exact
  const MatrixXd column =
      model.columns(s, effect_id<effects::JointElasticity>, joint, Vector2d(1, share), 1).front().values;
  ASSERT_EQ(column.cols(), n);
  const double motor = share * s.inertia(joint), arm = s.inertia(joint) - motor;
  // The lag of the arm, k = arm/c, and its differences.
  const VectorXd lag = c / arm * (s.load.col(joint) - motor * s.qdd.col(joint));
  for (Index k = 100; k + 100 < lag.size(); k += 37) {
    const double lag_d = (lag(k + 1) - lag(k - 1)) / (2 * dt),
                 lag_dd = (lag(k + 1) - 2 * lag(k) + lag(k - 1)) / (dt * dt);
    VectorXd q = s.q.row(k), qd = s.qd.row(k), qdd = s.qdd.row(k);
    const VectorXd rigid = torque(q, qd, qdd);
    q(joint) -= lag(k);
    qd(joint) -= lag_d;
    qdd(joint) -= lag_dd;
    VectorXd elastic = torque(q, qd, qdd);
    elastic(joint) += motor * lag_dd;  // the motor does not lag
    const VectorXd expected = elastic - rigid;
    const double size = column.row(k).norm() * c;
    EXPECT_LT((c * column.row(k).transpose() - expected).norm(), 0.02 * size + 1e-9) << "sample " << k;
  }
}

TEST_P(SpringColumn, CarriesEncoderNoiseAsTheWholeComputationDoes) {
  const EffectModel model(*robot_);
  const EffectSignals still = model.signals(log_, p_, false);
  PreparedLog noisy = log_;
  std::mt19937_64 random(3);
  NormalDistribution normal;
  const double dt = 1 / log_.rate_hz;
  for (Index j = 0; j < noisy.q.cols(); ++j) {
    const double phase = normal(random), w = 2 * 3.14159 * (12 + 3 * normal(random));
    for (Index k = 0; k < noisy.q.rows(); ++k) {
      const double x = w * static_cast<double>(k) * dt + phase;
      noisy.q(k, j) += 1e-6 * std::sin(x);
      noisy.qd(k, j) += 1e-6 * w * std::cos(x);
      noisy.qdd(k, j) -= 1e-6 * w * w * std::sin(x);
    }
  }
  const EffectSignals whole = model.signals(noisy, p_, false), near = model.signals(noisy, p_, false, &still);
  for (const double encoder : {0.0, 1.0}) {
    const auto change = [&](const EffectSignals& s) {
      const Vector2d shape(encoder, 0.4);
      const MatrixXd column = model.columns(s, effect_id<effects::JointElasticity>, 0, shape, 1).front().values -
                              model.columns(still, effect_id<effects::JointElasticity>, 0, shape, 1).front().values;
      return MatrixXd(column.middleRows(50, column.rows() - 100));
    };
    EXPECT_LT((change(near) - change(whole)).norm(), 0.05 * change(whole).norm()) << "encoder " << encoder;
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, SpringColumn, testing::Values("delta3", "delta4", "linear-delta3"),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace deltadyn
