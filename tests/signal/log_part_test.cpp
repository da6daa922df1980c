#include "deltadyn/signal/log_part.hpp"

#include <gtest/gtest.h>

namespace deltadyn {
namespace {

Log numbered(Eigen::Index samples) {
  Log log;
  log.file = "log.csv";
  log.t_s = Eigen::VectorXd::LinSpaced(samples, 0, static_cast<double>(samples - 1));
  log.q = log.t_s;
  log.tau = 2 * log.t_s;
  log.filled.assign(static_cast<std::size_t>(samples), Log::kMeasured);
  log.filled[5] = Log::kLeftOut;
  return log;
}

TEST(LogPart, HoldsItsSamplesAndTheirMarks) {
  const Log part = part_of(numbered(20), 4, 6);
  EXPECT_EQ(part.file, "log.csv");
  EXPECT_EQ(part.samples(), 6);
  EXPECT_EQ(part.t_s(0), 4);
  EXPECT_EQ(part.tau(5, 0), 18);
  EXPECT_EQ(part.filled[1], Log::kLeftOut);
  EXPECT_EQ(part.torque_out.size(), 0);
}

TEST(LogPart, OfTheMiddle) {
  EXPECT_EQ(middle_of(numbered(20), 30).samples(), 20);
  const Log middle = middle_of(numbered(21), 5);
  EXPECT_EQ(middle.samples(), 5);
  EXPECT_EQ(middle.t_s(2), 10);
}

}  // namespace
}  // namespace deltadyn
