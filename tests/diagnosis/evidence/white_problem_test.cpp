#include "../../../src/diagnosis/evidence/white_problem.hpp"

#include <gtest/gtest.h>

namespace deltadyn {
namespace {

using Eigen::MatrixXd;

TEST(WhiteColumns, HaveNoSquareWhereOnlyRoundingIsLeft) {
  WhiteColumns columns;
  columns.blocks = {MatrixXd::Random(40, 2)};
  MatrixXd Q = columns.blocks[0].col(0).normalized();  // the first column is the base's
  columns.base = Q.transpose() * columns.blocks[0];
  const MatrixXd gram = columns.clear_gram(0, 2);
  EXPECT_EQ(gram(0, 0), 0);
  EXPECT_EQ(gram(0, 1), 0);
  EXPECT_EQ(gram(1, 1), columns.gram(0, 2)(1, 1));
}

}  // namespace
}  // namespace deltadyn
