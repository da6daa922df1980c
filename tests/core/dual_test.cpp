#include "deltadyn/core/dual.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <gtest/gtest.h>

#include "support/matchers.hpp"

namespace deltadyn {
namespace {

using testing_support::IsNear;
using Pair = Dual<double, 2>;

/// x and y as numbers with slopes by x and y.
const Pair x(0.7, Vector<double, 2>::UnitX()), y(-1.3, Vector<double, 2>::UnitY());

void expect_number(const Pair& found, double value, double by_x, double by_y) {
  EXPECT_NEAR(found.value, value, 1e-15);
  EXPECT_THAT(found.slope, IsNear((Vector<double, 2>(by_x, by_y)), 1e-14));
}

TEST(Dual, HasTheDerivativesOfTheFourOperations) {
  expect_number(x + y, -0.6, 1, 1);
  expect_number(x - y, 2.0, 1, -1);
  expect_number(-x, -0.7, -1, 0);
  expect_number(x * y, -0.91, -1.3, 0.7);
  expect_number(x / y, 0.7 / -1.3, 1 / -1.3, -0.7 / 1.69);
  expect_number(2 * x - 3 / y, 1.4 + 3 / 1.3, 2, 3 / 1.69);
}

TEST(Dual, HasTheDerivativesOfTheFunctions) {
  expect_number(sin(x * y), std::sin(-0.91), -1.3 * std::cos(-0.91), 0.7 * std::cos(-0.91));
  expect_number(cos(x * y), std::cos(-0.91), 1.3 * std::sin(-0.91), -0.7 * std::sin(-0.91));
  expect_number(sqrt(x), std::sqrt(0.7), 0.5 / std::sqrt(0.7), 0);
  expect_number(abs(y), 1.3, 0, -1);
  expect_number(abs(x), 0.7, 1, 0);
}

TEST(Dual, AssignsAsItCalculates) {
  Pair z = x;
  z += y;
  z *= x;
  z -= 0.5;
  z /= y;
  const Pair expected = ((x + y) * x - 0.5) / y;
  expect_number(z, expected.value, expected.slope.x(), expected.slope.y());
  z *= z;  // a number times itself
  expect_number(z, expected.value * expected.value, 2 * expected.value * expected.slope.x(),
                2 * expected.value * expected.slope.y());
}

TEST(Dual, ComparesValuesOnly) {
  const Pair same(0.7, Vector<double, 2>(5, 6));
  EXPECT_TRUE(x == same);
  EXPECT_FALSE(x != same);
  EXPECT_TRUE(y < x && x > y && x <= same && x >= same);
  EXPECT_FALSE(x < same || x > same);
}

TEST(Dual, DifferentiatesAMatrixProductAndAnInverse) {
  Matrix<Pair, 2, 2> A;
  A << x, y, 1.0, x * y;
  const Matrix<Pair, 2, 2> one = A * A.inverse();
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) expect_number(one(i, j), i == j ? 1 : 0, 0, 0);
  }
  expect_number(A.determinant(), 0.7 * -0.91 + 1.3, 2 * 0.7 * -1.3, 0.49 - 1);
}

TEST(Dual, WorksInSinglePrecision) {
  const Dual<float, 1> t(2.0F, Vector<float, 1>::Ones());
  const Dual<float, 1> f = t * t * t;
  EXPECT_FLOAT_EQ(f.value, 8);
  EXPECT_FLOAT_EQ(f.slope(0), 12);
}

}  // namespace
}  // namespace deltadyn
