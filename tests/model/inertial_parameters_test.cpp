#include "deltadyn/model/inertial_parameters.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "deltadyn/runtime/random.hpp"

namespace deltadyn {
namespace {

/// A cloud of point masses is a body by construction; sums over the points are an oracle without any matrix algebra.
template <class T>
InertialVector<T> cloud_body(std::mt19937& random, int points) {
  UniformDistribution place(-0.5, 1.0), mass(0.01, 0.5);
  InertialVector<double> p = InertialVector<double>::Zero();
  for (int i = 0; i < points; ++i) {
    const double m = mass(random), x = place(random), y = place(random), z = place(random);
    InertialVector<double> point;
    point << m, m * x, m * y, m * z, m * (y * y + z * z), m * (x * x + z * z), m * (x * x + y * y), -m * x * y,
        -m * y * z, -m * x * z;
    p += point;
  }
  return p.cast<T>();
}

template <class T>
class InertialParametersTest : public ::testing::Test {};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(InertialParametersTest, Scalars);

TYPED_TEST(InertialParametersTest, PseudoInertiaIsTheSumOfOuterProductsOfThePoints) {
  using T = TypeParam;
  std::mt19937 random(1);
  UniformDistribution place(-0.5, 1.0);
  for (int trial = 0; trial < 50; ++trial) {
    const Vector<T, 4> h(T(place(random)), T(place(random)), T(place(random)), T(1));
    const T m = T(0.7), x = h(0), y = h(1), z = h(2);
    InertialVector<T> p;
    p << m, m * x, m * y, m * z, m * (y * y + z * z), m * (x * x + z * z), m * (x * x + y * y), -m * x * y, -m * y * z,
        -m * x * z;
    const PseudoInertia<T> difference = to_pseudo_inertia(p) - m * h * h.transpose();
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), T(8) * std::numeric_limits<T>::epsilon());
  }
}

TYPED_TEST(InertialParametersTest, RoundTripThroughThePseudoInertia) {
  using T = TypeParam;
  std::mt19937 random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const InertialVector<T> p = cloud_body<T>(random, 6);
    const InertialVector<T> back = from_pseudo_inertia<T>(to_pseudo_inertia(p));
    EXPECT_LT((back - p).norm(), T(8) * std::numeric_limits<T>::epsilon() * p.norm());
  }
}

TYPED_TEST(InertialParametersTest, DualKeepsTheInnerProduct) {
  using T = TypeParam;
  std::mt19937 random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const InertialVector<T> p = cloud_body<T>(random, 5);
    const InertialVector<T> g = InertialVector<T>::Random();
    const T in_matrices = dual_pseudo_inertia(g).cwiseProduct(to_pseudo_inertia(p)).sum();
    EXPECT_NEAR(in_matrices, g.dot(p), T(50) * std::numeric_limits<T>::epsilon() * p.norm());
  }
}

TYPED_TEST(InertialParametersTest, CloudsAreConsistentAndAgreeWithEigenvalues) {
  using T = TypeParam;
  std::mt19937 random(4);
  int consistent = 0, inconsistent = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const InertialVector<T> p = cloud_body<T>(random, 6);
    EXPECT_TRUE(is_physically_consistent(p)) << p.transpose();
    InertialVector<T> disturbed = p;
    disturbed.array() *= T(1) + T(0.5) * InertialVector<T>::Random().array();
    const T smallest = Eigen::SelfAdjointEigenSolver<PseudoInertia<T>>(to_pseudo_inertia(disturbed)).eigenvalues()(0);
    if (std::abs(smallest) < T(100) * std::numeric_limits<T>::epsilon() * disturbed.norm()) continue;
    EXPECT_EQ(is_physically_consistent(disturbed), smallest > T(0)) << disturbed.transpose();
    (smallest > T(0) ? consistent : inconsistent) += 1;
  }
  EXPECT_GT(consistent, 20);
  EXPECT_GT(inconsistent, 20);
}

TYPED_TEST(InertialParametersTest, BrokenRulesAreSeen) {
  using T = TypeParam;
  InertialVector<T> p;
  p << T(1), T(0), T(0), T(0), T(0.1), T(0.1), T(0.1), T(0), T(0), T(0);
  ASSERT_TRUE(is_physically_consistent(p));
  InertialVector<T> negative_mass = p;
  negative_mass(inertial::kM) = T(-1);
  EXPECT_FALSE(is_physically_consistent(negative_mass));
  InertialVector<T> triangle = p;
  triangle(inertial::kIzz) = T(0.21);
  EXPECT_FALSE(is_physically_consistent(triangle));
  InertialVector<T> far_centre = p;  // S11 = 0.05, so |mcx| must stay below sqrt(0.05)
  far_centre(inertial::kMcx) = T(0.23);
  EXPECT_FALSE(is_physically_consistent(far_centre));
  far_centre(inertial::kMcx) = T(0.22);
  EXPECT_TRUE(is_physically_consistent(far_centre));
  InertialVector<T> not_a_number = p;
  not_a_number(inertial::kIxy) = std::numeric_limits<T>::quiet_NaN();
  EXPECT_FALSE(is_physically_consistent(not_a_number));
}

TYPED_TEST(InertialParametersTest, ToleranceIsFreeOfUnits) {
  using T = TypeParam;
  InertialVector<T> p;
  p << T(1), T(0.3), T(0), T(0), T(0.2), T(0.2), T(0.2), T(0), T(0), T(0);  // pivots 1, 1, 1, 1 - 0.09/0.1
  for (const T unit : {T(1), T(1e-3), T(1e3)}) {                            // metre, kilometre, millimetre
    InertialVector<T> q = p;
    q.template segment<3>(1) *= unit;
    q.template tail<6>() *= unit * unit;
    EXPECT_TRUE(is_physically_consistent(q, T(0.09)));
    EXPECT_FALSE(is_physically_consistent(q, T(0.11)));
  }
}

}  // namespace
}  // namespace deltadyn
