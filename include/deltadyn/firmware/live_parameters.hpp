#pragma once

/// \file
/// Parameters of which a controller changes some while it works: what the robot carries, and the friction of its
/// joints.

#include "deltadyn/core/rotation.hpp"
#include "deltadyn/core/status.hpp"
#include "deltadyn/model/inertial_parameters.hpp"
#include "deltadyn/model/parameter_layout.hpp"

namespace deltadyn {

/// Ten parameters of a body of mass m about the origin of the frame that holds it (parallel axes).
/// \param mass      [kg]
/// \param position  of its centre of mass [m]
/// \param inertia   about its centre of mass, along the frame's axes [kg m^2]
template <class T>
[[nodiscard]] InertialVector<T> body_at(const T& mass, const Vector3<T>& position, const Matrix3<T>& inertia) {
  const Matrix3<T> S = skew(position);
  const Matrix3<T> I = inertia - mass * S.lazyProduct(S);
  InertialVector<T> p;
  p << mass, mass * position.x(), mass * position.y(), mass * position.z(), I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(1, 2),
      I(0, 2);
  return p;
}

template <class T, class Robot, Limbs kSharing>
class LiveParameters {
 public:
  using Layout = ParameterLayout<Robot, kSharing>;
  using Parameters = Vector<T, Layout::kColumns>;

  explicit LiveParameters(const Parameters& p) : p_(p), empty_(p.template segment<kInertialParameters>(kCarrier)) {}

  [[nodiscard]] const Parameters& operator()() const { return p_; }

  /// What the tool carries beside the model's own bodies: it takes the place of what was set before, and mass 0 sets it
  /// down. The frame is that of the tool, of the plate where there is no tool, and of the moving part of an axis.
  /// \param mass      at least 0 [kg]
  /// \param position  of the payload's centre of mass [m]
  /// \param inertia   about its centre of mass, along the frame's axes [kg m^2]
  /// \return out_of_range for a number that is not finite, a mass below 0, or an inertia that no body of this mass has;
  ///         then all stays as it was
  Status set_payload(const T& mass, const Vector3<T>& position, const Matrix3<T>& inertia = Matrix3<T>::Zero()) {
    const InertialVector<T> more = body_at(mass, position, inertia);
    if (!(mass >= T(0)) || !more.allFinite() || !may_be_inertia(mass, inertia)) return Status::out_of_range;
    p_.template segment<kInertialParameters>(kCarrier) = empty_ + more;
    return Status::ok;
  }

  /// Friction of one joint of the model.
  /// \param joint    drive from 0, then the inner joint
  /// \param viscous  at least 0 [N m s/rad | N s/m]
  /// \param coulomb  at least 0 [N m | N]
  /// \return out_of_range for another joint, or a number that is not finite or below 0; then all stays as it was
  Status set_friction(int joint, const T& viscous, const T& coulomb) {
    const bool numbers = viscous >= T(0) && coulomb >= T(0) && Vector<T, 2>(viscous, coulomb).allFinite();
    if (joint < 0 || joint >= Layout::kFrictionJoints || !numbers) return Status::out_of_range;
    p_(Layout::viscous(joint)) = viscous;
    p_(Layout::coulomb(joint)) = coulomb;
    return Status::ok;
  }

 private:
  static constexpr Body kCarrierBody =
      kHasInnerJoint<Robot> ? Body::tool : (kHasPlate<Robot> ? Body::platform : Body::upper_arm);
  static constexpr int kCarrier = kInertialParameters * Layout::body(kCarrierBody, 0);

  /// Has a body of this mass such moments? Each is at most the sum of the two others, and without mass there are none.
  static bool may_be_inertia(const T& mass, const Matrix3<T>& inertia) {
    const Vector3<T> moment = inertia.diagonal();
    const T sum = moment.sum();
    return moment.minCoeff() >= T(0) && T(2) * moment.maxCoeff() <= sum * T(1.001) && (mass > T(0) || sum == T(0));
  }

  Parameters p_;
  InertialVector<T> empty_;  ///< of the body that carries, without a payload
};

}  // namespace deltadyn
