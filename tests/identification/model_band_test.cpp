#include "deltadyn/identification/model_band.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "../../src/identification/least_squares.hpp"
#include "identification/axis_log.hpp"
#include "support/descriptions.hpp"

namespace deltadyn {
namespace {

using namespace testing_support;

const std::unique_ptr<Robot>& axis() {
  static const std::unique_ptr<Robot> robot = make_robot(axis_description(DriveKind::revolute));
  return robot;
}

ModelBand band_of(const std::vector<Log>& logs, double highest_hz = 20) {
  return find_model_band(*axis(), find_base_parameters(*axis()), logs, ProcessingOptions{}, 5, highest_hz);
}

/// The encoder also shows a vibration that takes no torque of the drive, as behind a spring.
Log vibrating(AxisLog how, double hz, double acceleration) {
  Log log = how.make();
  const double omega = 2 * std::numbers::pi * hz;
  log.q += (acceleration / (omega * omega) * (omega * log.t_s.array() + 0.3).sin()).matrix();
  return log;
}

std::vector<DriveFold> regular_and_reversal(const DataFold& fold) {
  std::vector<DriveFold> folds = fold.regular;
  for (std::size_t j = 0; j < folds.size(); ++j) folds[j].add(fold.reversal[j]);
  return folds;
}

TEST(ModelBand, IsTheWholeBandOfARigidDrive) {
  std::uint64_t seed = 0;
  for (const double rate : {200.0, 500.0, 1000.0}) {
    for (const int bits : {12, 14, 19}) {
      for (const double presliding : {0.0, 4e-3}) {
        AxisLog log;
        log.rate_hz = rate;
        log.encoder_bits = bits;
        log.presliding = presliding;
        log.seed = ++seed;
        EXPECT_EQ(band_of({log.make()}).limit_hz, 0) << rate << " Hz, " << bits << " bits, presliding " << presliding;
      }
    }
  }
}

TEST(ModelBand, EndsBelowAVibrationWithoutTorque) {
  for (const double hz : {8.0, 12.0, 16.0}) {
    for (const std::uint64_t seed : {21U, 22U}) {
      AxisLog log;
      log.seed = seed;
      const ModelBand band = band_of({vibrating(log, hz, 1.0)});
      EXPECT_GT(band.limit_hz, 0) << hz;
      EXPECT_LT(band.limit_hz, hz);
      ASSERT_NE(band.beyond(), nullptr);
      EXPECT_LT(band.beyond()->found, 0.5);
    }
  }
}

// The lowest part is no floor: a machine whose own motion ends below it and that swings above says so.
TEST(ModelBand, IsLookedForBelowTheLowestPartIfThatFails) {
  AxisLog log;
  log.base_hz = 0.2;
  log.duration_s = 20;
  log.seed = 5;
  const ModelBand slow = band_of({vibrating(log, 4.9, 1.5)}, 10);
  EXPECT_GT(slow.limit_hz, 2.4);
  EXPECT_LT(slow.limit_hz, 4.9);
}

TEST(ModelBand, SaysNothingOfALogThatTellsTooLittle) {
  AxisLog log;
  log.duration_s = 4;
  log.torque_noise = 30;  // ten times what the drive needs
  EXPECT_EQ(band_of({log.make()}).limit_hz, 0);
}

TEST(ModelCutoffChoice, LeavesOutWhatPullsTheInertiaDown) {
  AxisLog log;
  log.encoder_bits = 16;
  log.seed = 9;
  const Log shaken = vibrating(log, 11, 4.0);
  const BaseParameters base = find_base_parameters(*axis());
  const ModelCutoff choice = choose_model_cutoff(*axis(), base, {shaken}, ProcessingOptions{});
  EXPECT_LT(choice.cutoff_hz, choice.motion.cutoff_hz);
  const auto inertia_at = [&](double cutoff_hz) {
    ProcessingOptions options;
    options.cutoff_hz = cutoff_hz;
    const BaseEstimate estimate =
        estimate_base_parameters(base, regular_and_reversal(fold_log(*axis(), prepare_log(*axis(), shaken, options))));
    for (int b = 0; b < base.count(); ++b) {
      if (base.expressions[static_cast<std::size_t>(b)].find("Iyy") != std::string::npos) return estimate.value(b);
    }
    return 0.0;
  };
  EXPECT_NEAR(inertia_at(choice.cutoff_hz), log.inertia, 0.02 * log.inertia);
  EXPECT_LT(inertia_at(choice.motion.cutoff_hz), 0.97 * log.inertia);
}

}  // namespace
}  // namespace deltadyn
