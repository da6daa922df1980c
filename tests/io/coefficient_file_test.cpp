#include "deltadyn/io/coefficient_file.hpp"

#include <gmock/gmock.h>

#include "deltadyn/runtime/error.hpp"

#include "io/temporary_folder.hpp"
#include "support/descriptions.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using ::testing::HasSubstr;

TEST(CoefficientFile, ReadsBackExactlyWhatItWrote) {
  const testing::TemporaryFolder folder;
  const RobotDescription robot = testing_support::delta_description("delta4");
  testing_support::Random random(1);
  std::vector<FourierSeries> segments;
  for (int k = 0; k < 2; ++k) {
    FourierSeries series{random.uniform(0.1, 1), Eigen::MatrixXd(3 + 4 * k, 4)};
    for (Eigen::Index i = 0; i < series.coefficients.size(); ++i) series.coefficients(i) = random.uniform(-1, 1);
    segments.push_back(series);
  }
  write_coefficients(folder.path("c.csv"), segments, robot);
  EXPECT_THAT(folder.read("c.csv"), HasSubstr("segment,harmonic,frequency_hz,x_sin_m,x_cos_m,y_sin_m,y_cos_m,z_sin_m,z_cos_m,"
                                              "psi_sin_rad,psi_cos_rad\n1,0,"));
  const auto read = read_coefficients(folder.path("c.csv"), robot);
  ASSERT_EQ(read.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(read[k].base_frequency_hz, segments[k].base_frequency_hz);
    EXPECT_EQ(read[k].coefficients, segments[k].coefficients);
  }
}

TEST(CoefficientFile, RefusesRowsOutOfOrder) {
  const testing::TemporaryFolder folder;
  const RobotDescription robot = testing_support::axis_description(DriveKind::revolute);
  const std::string header = "segment,harmonic,frequency_hz,q1_sin_rad,q1_cos_rad\n";
  const auto message_of = [&](const std::string& rows) -> std::string {
    try {
      (void)read_coefficients(folder.write("bad.csv", header + rows), robot);
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_EQ(message_of("1,0,0.5,0,1\n1,1,0.5,1,1\n"), "no error");
  EXPECT_THAT(message_of("1,1,0.5,1,1\n"), HasSubstr("line 2: segments and harmonics are out of order"));
  EXPECT_THAT(message_of("1,0,0.5,0,1\n1,2,0.5,1,1\n"), HasSubstr("line 3"));
  EXPECT_THAT(message_of("1,0,0.5,0,1\n1,1.5,0.5,1,1\n"), HasSubstr("column harmonic"));
  EXPECT_THAT(message_of("1,0,-1,0,1\n1,1,0.5,1,1\n"), HasSubstr("base frequency"));
}

}  // namespace
}  // namespace deltadyn
