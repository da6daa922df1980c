#include "deltadyn/io/coefficient_file.hpp"

#include <gmock/gmock.h>

#include "deltadyn/io/csv.hpp"

#include "io/temporary_folder.hpp"
#include "support/descriptions.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using ::testing::HasSubstr;

TEST(CoefficientFile, HoldsEveryCoefficientExactly) {
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
  const CsvTable read = read_csv(folder.path("c.csv"));
  std::size_t row = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    for (int h = 0; h <= segments[k].harmonics(); ++h, ++row) {
      ASSERT_LT(row, read.rows());
      EXPECT_EQ(read.number(row, 0), static_cast<double>(k + 1));
      EXPECT_EQ(read.number(row, 1), h);
      EXPECT_EQ(read.number(row, 2), segments[k].base_frequency_hz * std::max(1, h));
      for (int i = 0; i < 4; ++i) {
        const auto column = static_cast<std::size_t>(3 + 2 * i);
        EXPECT_EQ(read.number(row, column), h == 0 ? 0.0 : segments[k].coefficients(2 * h - 1, i));
        EXPECT_EQ(read.number(row, column + 1), segments[k].coefficients(2 * h, i));
      }
    }
  }
  EXPECT_EQ(read.rows(), row);
}

}  // namespace
}  // namespace deltadyn
