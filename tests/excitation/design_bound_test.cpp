#include "deltadyn/excitation/design_bound.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <gmock/gmock.h>

#include "deltadyn/excitation/criterion.hpp"
#include "deltadyn/runtime/error.hpp"

#include "excitation/excitation_setup.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using testing_support::excitation_setup;
using testing_support::ExcitationSetup;
using testing_support::Random;

Eigen::MatrixXd information(const DesignSpace& space, const Eigen::VectorXd& shares) {
  const int p = space.base_parameters();
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(p, p), A(space.regressor->drives(), p);
  for (Eigen::Index k = 0; k < shares.size(); ++k) {
    if (shares(k) <= 0) continue;
    EXPECT_EQ(space.weighted_columns(space.states.x.col(k), A), Status::ok);
    M += shares(k) * A.transpose() * A;
  }
  return M;
}

TEST(DesignBound, TheDesignFoundIsADesignAndMeetsTheEquivalenceTheorem) {
  for (const char* type : {"delta4", "axis"}) {
    const ExcitationSetup setup = excitation_setup(type, 1500);
    const DesignBound bound = design_bound(setup.space);
    const int p = setup.space.base_parameters();
    EXPECT_NEAR(bound.shares.sum(), 1, 1e-9);
    EXPECT_GE(bound.shares.minCoeff(), 0);
    const Eigen::MatrixXd M = information(setup.space, bound.shares);
    EXPECT_NEAR(log_determinant(M), bound.log_det_found, 1e-8);
    EXPECT_LE(bound.gap(p), 1.1e-3) << type;
    // Kiefer and Wolfowitz: at the optimum no state has tr(M_k M^-1) above p, and those with a share have p.
    const Eigen::MatrixXd inverse = M.llt().solve(Eigen::MatrixXd::Identity(p, p));
    Eigen::MatrixXd A(setup.robot->drives(), p);
    for (Eigen::Index k = 0; k < bound.shares.size(); ++k) {
      ASSERT_EQ(setup.space.weighted_columns(setup.space.states.x.col(k), A), Status::ok);
      const double d = (A * inverse * A.transpose()).trace();
      EXPECT_LE(d, p * 1.0011);
      if (bound.shares(k) > 0.01) {
        EXPECT_GT(d, p * 0.97);
      }
    }
  }
}

TEST(DesignBound, NoOtherSharesOfTheStatesGiveMore) {
  const ExcitationSetup setup = excitation_setup("delta3", 800);
  const DesignBound bound = design_bound(setup.space);
  Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    // Near the best design and far from it.
    Eigen::VectorXd shares = bound.shares;
    const double mix = trial % 2 == 0 ? 0.02 : 1.0;
    for (Eigen::Index k = 0; k < shares.size(); ++k)
      shares(k) += mix * random.uniform(0, 1) / static_cast<double>(shares.size());
    shares /= shares.sum();
    EXPECT_LT(log_determinant(information(setup.space, shares)), bound.log_det);
  }
  EXPECT_NEAR(d_efficiency(bound.log_det, bound, 18), 1, 1e-12);
  EXPECT_NEAR(d_efficiency(bound.log_det - 18 * std::log(2.0), bound, 18), 0.5, 1e-12);
}

}  // namespace
}  // namespace deltadyn
