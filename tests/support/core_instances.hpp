#pragma once

/// \file
/// The core's templates for every robot and scalar that the tests use, compiled once for all of them (library
/// core_instances). A test that includes this calls them instead of compiling them again, which costs minutes and
/// gigabytes otherwise.

#include "deltadyn/dynamics/equations_of_motion.hpp"
#include "deltadyn/dynamics/forward_dynamics.hpp"
#include "deltadyn/dynamics/inverse_dynamics_derivatives.hpp"
#include "deltadyn/model/cast_geometry.hpp"

#include "support/random_robot.hpp"

namespace deltadyn::testing_support {

/// A number with its slopes by all drives of a robot.
template <class Robot>
using Slopes = Dual<double, Robot::kDrives>;
template <class Robot>
using AllColumns = ParameterLayout<Robot, Limbs::individual>;
template <class Robot>
using SharedColumns = ParameterLayout<Robot, Limbs::shared>;

}  // namespace deltadyn::testing_support

// NOLINTBEGIN(cppcoreguidelines-macro-usage, bugprone-macro-parentheses): a list of explicit instantiations has no
// other form.

#define DELTADYN_DRIVES(R, T) Vector<T, R::kDrives>
#define DELTADYN_SQUARE(R, T) Matrix<T, R::kDrives, R::kDrives>
#define DELTADYN_P(L, R, T) Vector<T, testing_support::L<R>::kColumns>

/// Kinematics and dynamics that every scalar has.
#define DELTADYN_INSTANCES_OF_ALL(kind, R, T)                                                                         \
  kind template Status assemble_posture<T, R>(const Geometry<T, R>&, const DELTADYN_DRIVES(R, T)&,                    \
                                              const DELTADYN_DRIVES(R, T)&, Posture<T, R>&);                          \
  kind template void set_drive_rates<T, R>(const Geometry<T, R>&, const DELTADYN_DRIVES(R, T)&,                       \
                                           const DELTADYN_DRIVES(R, T)&, Motion<T, R>&);                              \
  kind template DELTADYN_DRIVES(R, T) inverse_dynamics<testing_support::AllColumns<R>, T, R>(                         \
      const Geometry<T, R>&, const Motion<T, R>&, const DELTADYN_P(AllColumns, R, T)&);                               \
  kind template DELTADYN_SQUARE(R, T) mass_matrix<testing_support::AllColumns<R>, T, R>(                              \
      const Geometry<T, R>&, const Posture<T, R>&, const DELTADYN_P(AllColumns, R, T)&);                              \
  kind template T potential_energy<testing_support::AllColumns<R>, T, R>(const Geometry<T, R>&, const Posture<T, R>&, \
                                                                         const DELTADYN_P(AllColumns, R, T)&);

/// What plain numbers have besides.
#define DELTADYN_INSTANCES_OF_NUMBERS(kind, R, T)                                                                   \
  kind template Status inverse_kinematics<T, R>(const Geometry<T, R>&, const DELTADYN_DRIVES(R, T)&,                \
                                                DELTADYN_DRIVES(R, T)&);                                            \
  kind template Status drive_rates<T, R>(const Geometry<T, R>&, const Posture<T, R>&, const DELTADYN_DRIVES(R, T)&, \
                                         const DELTADYN_DRIVES(R, T)&, DELTADYN_DRIVES(R, T)&,                      \
                                         DELTADYN_DRIVES(R, T)&);                                                   \
  kind template Status motion_from_task<T, R>(const Geometry<T, R>&, const DELTADYN_DRIVES(R, T)&,                  \
                                              const DELTADYN_DRIVES(R, T)&, const DELTADYN_DRIVES(R, T)&,           \
                                              Motion<T, R>&);                                                       \
  kind template Status drive_jacobian<T, R>(const Geometry<T, R>&, const Posture<T, R>&, DELTADYN_SQUARE(R, T)&);   \
  kind template JacobianRates<T, R> jacobian_rates<T, R>(const Geometry<T, R>&, const Motion<T, R>&);               \
  kind template EquationsOfMotion<T, R::kDrives> equations_of_motion<testing_support::AllColumns<R>, T, R>(         \
      const Geometry<T, R>&, const Motion<T, R>&, const DELTADYN_P(AllColumns, R, T)&);                             \
  kind template Status equations_in_task<T, R>(const Geometry<T, R>&, const Motion<T, R>&,                          \
                                               const EquationsOfMotion<T, R::kDrives>&,                             \
                                               EquationsOfMotion<T, R::kDrives>&);                                  \
  kind template T kinetic_energy<testing_support::AllColumns<R>, T, R>(const Geometry<T, R>&, const Motion<T, R>&,  \
                                                                       const DELTADYN_P(AllColumns, R, T)&);        \
  kind template Status forward_dynamics<testing_support::AllColumns<R>, T, R>(                                      \
      const Geometry<T, R>&, const Posture<T, R>&, const DELTADYN_DRIVES(R, T)&, const DELTADYN_DRIVES(R, T)&,      \
      const DELTADYN_P(AllColumns, R, T)&, DELTADYN_DRIVES(R, T)&);

/// Shared limbs and the regressor.
#define DELTADYN_INSTANCES_OF_COLUMNS(kind, R, T, L)                                                    \
  kind template void regressor<testing_support::L<R>, T, R>(const Geometry<T, R>&, const Motion<T, R>&, \
                                                            Matrix<T, R::kDrives, testing_support::L<R>::kColumns>&);
#define DELTADYN_INSTANCES_OF_SHARED_LIMBS(kind, R, T)                                           \
  kind template DELTADYN_DRIVES(R, T) inverse_dynamics<testing_support::SharedColumns<R>, T, R>( \
      const Geometry<T, R>&, const Motion<T, R>&, const DELTADYN_P(SharedColumns, R, T)&);       \
  kind template DELTADYN_SQUARE(R, T) mass_matrix<testing_support::SharedColumns<R>, T, R>(      \
      const Geometry<T, R>&, const Posture<T, R>&, const DELTADYN_P(SharedColumns, R, T)&);

/// Two lists, so that they build side by side and none of them is too large.
#define DELTADYN_NUMBER_INSTANCES(kind, R)                      \
  DELTADYN_INSTANCES_OF_ALL(kind, R, double)                    \
  DELTADYN_INSTANCES_OF_ALL(kind, R, float)                     \
  DELTADYN_INSTANCES_OF_NUMBERS(kind, R, double)                \
  DELTADYN_INSTANCES_OF_NUMBERS(kind, R, float)                 \
  DELTADYN_INSTANCES_OF_COLUMNS(kind, R, double, AllColumns)    \
  DELTADYN_INSTANCES_OF_COLUMNS(kind, R, double, SharedColumns) \
  DELTADYN_INSTANCES_OF_COLUMNS(kind, R, float, SharedColumns)  \
  DELTADYN_INSTANCES_OF_SHARED_LIMBS(kind, R, double)           \
  DELTADYN_INSTANCES_OF_SHARED_LIMBS(kind, R, float)
#define DELTADYN_SLOPE_INSTANCES(kind, R)                                                             \
  DELTADYN_INSTANCES_OF_ALL(kind, R, testing_support::Slopes<R>)                                      \
  kind template Status inverse_dynamics_derivatives<testing_support::AllColumns<R>, double, R>(       \
      const Geometry<double, R>&, const Motion<double, R>&, const DELTADYN_P(AllColumns, R, double)&, \
      TorqueDerivatives<double, R::kDrives>&);
#define DELTADYN_CORE_INSTANCES(kind, R) \
  DELTADYN_NUMBER_INSTANCES(kind, R)     \
  DELTADYN_SLOPE_INSTANCES(kind, R)

namespace deltadyn {
DELTADYN_CORE_INSTANCES(extern, Delta3)
DELTADYN_CORE_INSTANCES(extern, LinearDelta3)
DELTADYN_CORE_INSTANCES(extern, Delta4)
DELTADYN_CORE_INSTANCES(extern, testing_support::TurningPlate)
DELTADYN_CORE_INSTANCES(extern, Axis)
DELTADYN_CORE_INSTANCES(extern, LinearAxis)
}  // namespace deltadyn

// NOLINTEND(cppcoreguidelines-macro-usage, bugprone-macro-parentheses)
