#pragma once

/// \file
/// The kinds of effects, each with what its law is given and what it must offer. An effect is a struct that derives
/// from its kind and has `static constexpr EffectTraits traits()`. Fits, the virtual robot, controllers and exporters
/// work on the kinds; effects/all.hpp lists the effects. The law gives torque or force PER UNIT OF EACH AMPLITUDE, so
/// that a fit is linear in the amplitudes.

#include <array>
#include <type_traits>

#include "deltadyn/core/types.hpp"
#include "deltadyn/effects/traits.hpp"

namespace deltadyn {

/// Values of the shape parameters, in the order of the traits.
template <class T>
using Shape = std::array<T, kMostShapes>;

/// What the law of a joint may depend on. `sign` is that of the rate as its user sees it: sharp in a fit, the sense of
/// sliding in a simulation (also at rate 0), smooth in a controller. The virtual robot finds its acceleration by the
/// law, so it leaves acceleration and gravity at 0: a law that uses one of them must have change() (MachineChange).
template <class T>
struct JointInput {
  T position = T(0), rate = T(0), acceleration = T(0);  ///< [rad | m] and per s, s^2
  T sign = T(0);
  T time = T(0);  ///< since the start of the log or of the motion [s]
  T load = T(0);  ///< what the drive's gear passes on: the rigid torque without the drive's friction [N m | N]
  T gravity_x = T(0), gravity_z = T(0);  ///< of a limb's drive: gravity outwards and upwards, in its limb frame [m/s^2]
  T side_load = T(0);                    ///< of the telescope's guide, per unit mass [m/s^2]
};

/// A law of a joint (places `drive`, `arm`, `limb`, `limb_or_all`, `telescope`, `passive_joints`):
///   template <class T> static std::array<T, N> columns(const JointInput<T>&, const Shape<T>&)
/// for N amplitudes, [N m | N] per unit.
/// A law of the load is homogeneous in it: columns(c load) = c columns(load) for c > 0.
struct JointLaw {};

/// A law of a joint (`drive`) with one number of memory, a function of the way:
///   T start(sign, shape)                 state of a joint that has slid long in the direction `sign` (0: at rest)
///   T moved(state, step, input, shape)   after a further `step` [rad | m]; two steps one way are as good as their sum
///   std::array<T, N> columns(state, input, shape)
struct JointMemory {};

/// State of the plate.
template <class T>
struct PlateInput {
  /// In W [m], [m/s], [m/s^2]
  Vector3<T> position = Vector3<T>::Zero(), velocity = Vector3<T>::Zero(), acceleration = Vector3<T>::Zero();
  Vector3<T> gravity = Vector3<T>::Zero();  ///< in W [m/s^2]
};

/// A force that the robot has to bear at the plate (`platform`):
///   template <class T> static std::array<Vector3<T>, N> columns(const PlateInput<T>&, const Shape<T>&)
/// in W, [N] per unit.
struct PlateForce {};

/// A change of the recorded torque (`drive`, `drive_or_robot`):
///   template <class V> static V record(const V& torque, double dt, double amplitude, const Shape<double>&)
/// what the log shows of evenly sampled torque that acted. An effect may have expected(), of the same form, for what a
/// fit takes in place of that. `kStage` orders them as a drive spoils its signal, smallest first.
struct RecordedChange {};

/// What an elastic drive's columns are computed from, at one sample.
template <class T>
struct ElasticInput {
  T load_dd = T(0);  ///< second derivative of the load of the elastic drive [N m/s^2 | N/s^2]
  T snap = T(0);     ///< second derivative of its acceleration
  T inertia = T(1);  ///< of the drive with the others held [kg m^2 | kg]
  T load_lag = T(0),
    inertia_lag = T(0);  ///< change of the torque of the drive asked for when the elastic drive lags by its load,
                         ///< and by its inertia times its acceleration
  bool own = true;       ///< is the drive asked for the elastic one?
};

/// A spring in a drive (`drive`), seen from all drives:
///   template <class T> static T column(const ElasticInput<T>&, const Shape<T>&)
struct ElasticJoint {};

/// A change of the machine (`arm`, `limb`, `robot`) that a fit sees by differences:
///   template <class Machine>
///   static void change(Machine&, int joint, const std::array<double, kMostAmplitudes>&, const Shape<double>&)
/// with a Machine as below; kStep is the amplitude that makes a difference, small beside any real one and large beside
/// rounding. Effects of the other kinds may have change(), too: then the virtual robot is built with it, and uses no
/// law.
///
/// Machine: void tilt(x, y) [rad], void shift_home(drive, d) [rad | m], void lengthen_arm(limb, d), void
/// lengthen_strut(limb, d) [m], void add_to_arm(limb, moment, inertia) [kg m, kg m^2], void add_rotor(drive, inertia)
/// [kg m^2 | kg], void add_to_plate(mass) [kg], void soften(drive, SpringInDrive).
struct MachineChange {};

/// A spring between a drive's motor and what it moves.
struct SpringInDrive {
  double motor_share = 0.6;           ///< of the drive's inertia that sits on the motor's side
  double inertia_over_stiffness = 0;  ///< [s^2], of the side away from the encoder; 0: as stiff as flank_hz says
  double flank_hz = 0;                ///< resonance of both sides while a flank carries [Hz]
  double gap = 0;                     ///< play [rad | m]
  bool encoder_on_motor = true;
};

template <class Effect>
constexpr std::size_t kAmplitudesOf = Effect::traits().amplitudes.size();

/// Values of the columns of an effect.
template <class T, class Effect>
using ColumnsOf = std::array<T, kAmplitudesOf<Effect>>;

template <class Effect, class Kind>
constexpr bool kIs = std::is_base_of_v<Kind, Effect>;

}  // namespace deltadyn
