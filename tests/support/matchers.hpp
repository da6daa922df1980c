#pragma once

/// \file
/// Matrices compared as wholes, with both printed when they differ.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <sstream>
#include <string>

namespace deltadyn::testing_support {

/// All numbers of a matrix with many digits.
template <class Derived>
std::string print(const Eigen::MatrixBase<Derived>& matrix) {
  std::ostringstream stream;
  stream << matrix.template cast<double>().format(Eigen::IOFormat(12));
  return stream.str();
}

namespace matchers {

MATCHER_P2(IsNearMatrix, expected, tolerance,
           (negation ? "differs from\n" : "is near\n") + print(expected) + "\nto " +
               ::testing::PrintToString(tolerance)) {
  if (arg.rows() != expected.rows() || arg.cols() != expected.cols()) {
    *result_listener << "which is " << arg.rows() << " x " << arg.cols();
    return false;
  }
  double largest = 0;
  bool numbers = true;
  for (Eigen::Index j = 0; j < arg.cols(); ++j) {
    for (Eigen::Index i = 0; i < arg.rows(); ++i) {
      const double difference = std::abs(static_cast<double>(arg(i, j)) - static_cast<double>(expected(i, j)));
      numbers = numbers && difference == difference;
      largest = std::max(largest, difference);
    }
  }
  *result_listener << "which is\n"
                   << print(arg) << "\nwith a largest difference of " << largest << (numbers ? "" : " and NaN");
  return numbers && largest <= tolerance;
}

}  // namespace matchers

/// Every entry within `tolerance` (absolute) of `expected`, and the same shape. NaN matches nothing.
template <class Derived>
auto IsNear(const Eigen::MatrixBase<Derived>& expected, double tolerance) {
  // A copy, because an expression may hold on to what is gone by the time the matcher is used.
  return matchers::IsNearMatrix(typename Derived::PlainObject(expected), tolerance);
}

}  // namespace deltadyn::testing_support
