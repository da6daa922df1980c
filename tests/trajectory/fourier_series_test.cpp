#include "deltadyn/trajectory/fourier_series.hpp"

#include <cmath>
#include <gmock/gmock.h>

#include "deltadyn/runtime/error.hpp"

#include "support/matchers.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using testing_support::IsNear;
using testing_support::Random;

FourierSeries random_series(std::uint64_t seed, int harmonics = 4, int coordinates = 3) {
  Random random(seed);
  FourierSeries series{0.7, Eigen::MatrixXd(1 + 2 * harmonics, coordinates)};
  for (Eigen::Index k = 0; k < series.coefficients.size(); ++k) series.coefficients(k) = random.uniform(-1, 1);
  return series;
}

TEST(FourierSeries, ValuesAreThoseOfEquationEight) {
  const FourierSeries series = random_series(1);
  const double t = 0.321, w = 2 * 3.14159265358979323846 * 0.7;
  const TaskState state = series.state(w * t, w, 0);
  for (int i = 0; i < 3; ++i) {
    double z = series.coefficients(0, i), zd = 0, zdd = 0;
    for (int k = 1; k <= 4; ++k) {
      const double a = series.coefficients(2 * k - 1, i), b = series.coefficients(2 * k, i), s = std::sin(k * w * t),
                   c = std::cos(k * w * t);
      z += a * s + b * c;
      zd += k * w * (a * c - b * s);
      zdd -= k * w * k * w * (a * s + b * c);
    }
    EXPECT_NEAR(state.z(i), z, 1e-12);
    EXPECT_NEAR(state.zd(i), zd, 1e-11);
    EXPECT_NEAR(state.zdd(i), zdd, 1e-9);
  }
}

TEST(FourierSeries, DerivativesOfAnyOrderAreSlopes) {
  const FourierSeries series = random_series(2);
  constexpr double kStep = 1e-4;
  const Eigen::VectorXd at = Eigen::VectorXd::LinSpaced(9, 0, 6);
  for (int n = 0; n < 4; ++n) {
    const Eigen::MatrixXd up = series.at_phases(at.array() + kStep * series.omega(), n),
                          down = series.at_phases(at.array() - kStep * series.omega(), n);
    const Eigen::MatrixXd slope = (up - down) / (2 * kStep), exact = series.at_phases(at, n + 1);
    EXPECT_THAT(slope, IsNear(exact, 1e-4 * exact.cwiseAbs().maxCoeff()));
  }
}

TEST(FourierSeries, AChangingPhaseRateObeysTheChainRule) {
  const FourierSeries series = random_series(3);
  const auto phase = [](double t) { return 0.3 + 2 * t + 1.5 * t * t; };
  constexpr double kStep = 1e-5;
  const double t = 0.4;
  const auto z = [&](double time) -> Eigen::VectorXd { return series.state(phase(time), 0, 0).z; };
  const TaskState state = series.state(phase(t), 2 + 3 * t, 3);
  EXPECT_THAT(state.zd, IsNear(((z(t + kStep) - z(t - kStep)) / (2 * kStep)).eval(), 1e-7));
  EXPECT_THAT(state.zdd, IsNear(((z(t + kStep) - 2 * z(t) + z(t - kStep)) / (kStep * kStep)).eval(), 1e-3));
}

TEST(FourierSeries, ScalesAboutACentre) {
  const FourierSeries series = random_series(4);
  const Eigen::Vector3d centre(1, -2, 3);
  const Eigen::VectorXd at = even_phases(7);
  const Eigen::MatrixXd expected = (0.25 * series.at_phases(at)).rowwise() + 0.75 * centre.transpose();
  EXPECT_THAT(series.scaled(centre, 0.25).at_phases(at), IsNear(expected, 1e-12));
}

TEST(FourierSeries, RefusesWhatIsNoSeries) {
  FourierSeries series = random_series(5);
  EXPECT_NO_THROW(series.validate("x"));
  series.base_frequency_hz = 0;
  EXPECT_THROW(series.validate("x"), Error);
  series = random_series(5);
  series.coefficients(2, 1) = std::nan("");
  EXPECT_THROW(series.validate("x"), Error);
  series.coefficients = Eigen::MatrixXd::Zero(4, 2);
  EXPECT_THROW(series.validate("x"), Error);
}

}  // namespace
}  // namespace deltadyn
