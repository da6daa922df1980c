#include "deltadyn/simulation/stick_slip.hpp"

#include <algorithm>
#include <cmath>

namespace deltadyn {

StickSlip solve_stick_slip(const Eigen::Ref<const Eigen::MatrixXd>& A, const JointVector& b, const JointVector& low,
                           const JointVector& high) {
  const Eigen::Index n = b.size();
  StickSlip result;
  result.force = (0.5 * (low + high)).eval();
  result.direction.setZero(n);
  // Projected Gauss-Seidel converges for every positive semi-definite A. There are a handful of joints, and they seldom
  // rest.
  constexpr int kSweeps = 5000;
  constexpr double kSmall = 1e-13;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double change = 0, size = 1e-300;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double a = A.row(i).dot(result.force) + b(i);
      const double next = std::clamp(result.force(i) - a / A(i, i), low(i), high(i));
      change = std::max(change, std::abs(next - result.force(i)));
      size = std::max(size, std::abs(next));
      result.force(i) = next;
    }
    if (change <= kSmall * size) break;
  }
  result.acceleration = A * result.force + b;
  for (Eigen::Index i = 0; i < n; ++i) {
    // At a bound with an acceleration that rounding alone could make, the joint counts as held.
    const double scale = std::abs(b(i)) + A.row(i).cwiseAbs().dot(result.force.cwiseAbs());
    const bool moves = std::abs(result.acceleration(i)) > 1e-9 * scale + 1e-14;
    if (moves && result.force(i) <= low(i) && result.acceleration(i) > 0) result.direction(i) = 1;
    if (moves && result.force(i) >= high(i) && result.acceleration(i) < 0) result.direction(i) = -1;
    if (result.direction(i) == 0) result.acceleration(i) = 0;
  }
  return result;
}

}  // namespace deltadyn
