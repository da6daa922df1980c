#pragma once

/// \file
/// The posture at drive coordinates for every type, also where the library has no forward kinematics in closed form.

#include "deltadyn/kinematics/motion.hpp"

#include "support/oracle_of.hpp"

namespace deltadyn::testing_support {

/// \param guess  task coordinates near the solution
template <class R>
Status posture_at(const Geometry<double, R>& geometry, const Vector<double, R::kDrives>& q,
                  const Vector<double, R::kDrives>& guess, Posture<double, R>& posture) {
  Vector<double, R::kDrives> z = q;
  const auto y = oracles::plate(oracle_of(geometry), numbers(q), numbers(guess));
  for (std::size_t k = 0; k < y.size(); ++k) z(static_cast<Eigen::Index>(k)) = static_cast<double>(y[k]);
  return assemble_posture(geometry, q, z, posture);
}

}  // namespace deltadyn::testing_support
