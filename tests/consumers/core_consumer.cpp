// Uses the header-only core as firmware does: feed-forward torques in single precision.

#include <cmath>
#include <cstdio>

#include "deltadyn/firmware/feed_forward.hpp"

int main() {
  using FeedForward = deltadyn::FeedForward<float, deltadyn::Axis>;
  deltadyn::Geometry<float, deltadyn::Axis> geometry;
  FeedForward::Parameters p = FeedForward::Parameters::Zero();
  p(5) = 0.25F;  // Iyy of the arm, about its drive axis
  const FeedForward feed_forward(geometry, p);

  const FeedForward::Drives z(0.0F), zd(1.0F), zdd(2.0F);
  FeedForward::Drives q, qd, tau;
  const deltadyn::Status status = feed_forward.from_task(z, zd, zdd, q, qd, tau);
  std::printf("torque of 0.25 kg m^2 at 2 rad/s^2: %g N m\n", static_cast<double>(tau(0)));
  return status == deltadyn::Status::ok && std::abs(tau(0) - 0.5F) < 1e-6F ? 0 : 1;
}
