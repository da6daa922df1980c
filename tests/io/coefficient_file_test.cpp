#include "deltadyn/io/coefficient_file.hpp"

#include <gmock/gmock.h>

#include "deltadyn/io/csv.hpp"

#include "io/temporary_folder.hpp"
#include "support/descriptions.hpp"
#include "support/random_robot.hpp"

namespace deltadyn {
namespace {

using ::testing::HasSubstr;

TEST(CoefficientFile, HoldsExactlyWhatWasGiven) {
  const testing_support::TemporaryFolder folder;
  const RobotDescription robot = testing_support::delta_description("delta4");
  testing_support::Random random(1);
  std::vector<FourierSeries> segments;
  for (int k = 0; k < 2; ++k) {
    FourierSeries series{random.uniform(0.1, 1), Eigen::MatrixXd(3 + 4 * k, 4)};
    for (Eigen::Index i = 0; i < series.coefficients.size(); ++i) series.coefficients(i) = random.uniform(-1, 1);
    segments.push_back(series);
  }
  write_coefficients(folder.path("c.csv"), segments, robot);
  EXPECT_THAT(folder.read("c.csv"),
              HasSubstr("segment,harmonic,frequency_hz,x_sin_m,x_cos_m,y_sin_m,y_cos_m,z_sin_m,z_cos_m,"
                        "psi_sin_rad,psi_cos_rad\n1,0,"));
  const CsvTable table = read_csv(folder.path("c.csv"));
  ASSERT_EQ(table.rows(), 6U);  // harmonics 0 and 1, then 0 to 3
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const FourierSeries& series = segments[row < 2 ? 0 : 1];
    const auto h = static_cast<Eigen::Index>(row < 2 ? row : row - 2);
    EXPECT_EQ(table.number(row, 0), row < 2 ? 1 : 2);
    EXPECT_EQ(table.number(row, 1), static_cast<double>(h));
    EXPECT_EQ(table.number(row, 2), series.base_frequency_hz * static_cast<double>(std::max<Eigen::Index>(1, h)));
    for (Eigen::Index i = 0; i < 4; ++i) {
      const auto column = static_cast<std::size_t>(3 + 2 * i);
      EXPECT_EQ(table.number(row, column), h == 0 ? 0.0 : series.coefficients(2 * h - 1, i));
      EXPECT_EQ(table.number(row, column + 1), series.coefficients(2 * h, i));
    }
  }
}

}  // namespace
}  // namespace deltadyn
