#pragma once

/// \file
/// Drive torques from Lagrange's equations d/dt dT/dqd - dT/dq + dV/dq, every derivative by dual numbers.

#include <array>
#include <vector>

#include "oracles/mechanism.hpp"

namespace oracles {

/// m mcx mcy mcz Ixx Iyy Izz Ixy Iyz Ixz, about the origin of the body frame.
using Ten = std::array<Real, 10>;

/// Everything that weighs or rubs, in the order of poses().
struct Load {
  std::vector<Ten> bodies;
  Numbers viscous, coulomb;  ///< drives, then the bar's slide or the joints of a plate that turns, by theta
  Numbers rotor_inertia, offset;
};

template <class S>
struct State {
  std::vector<S> q, qd;
};

/// Second moments of mass, the integral of (x y z 1)^T (x y z 1) dm.
inline Eigen::Matrix<Real, 4, 4> mass_moments(const Ten& t) {
  const Real half_trace = (t[4] + t[5] + t[6]) / 2;
  Eigen::Matrix<Real, 4, 4> P;
  P << half_trace - t[4], -t[7], -t[9], t[1],  //
      -t[7], half_trace - t[5], -t[8], t[2],   //
      -t[9], -t[8], half_trace - t[6], t[3],   //
      t[1], t[2], t[3], t[0];
  return P;
}

/// Half the integral of |velocity|^2 dm: tr(Xd P Xd^T) / 2 with X = (R p).
template <class S>
S kinetic_energy(const Mechanism& m, const Load& load, const State<S>& state, const Numbers& guess) {
  std::vector<Dual<S>> q;
  for (std::size_t i = 0; i < state.q.size(); ++i) q.push_back(Dual<S>(state.q[i], state.qd[i]));
  const auto bodies = poses(m, q, guess);
  S energy(0);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto P = mass_moments(load.bodies[b]);
    for (int row = 0; row < 3; ++row) {
      S rate[4];
      for (int k = 0; k < 3; ++k) rate[k] = bodies[b].R(row, k).slope;
      rate[3] = bodies[b].p(row).slope;
      for (int j = 0; j < 4; ++j) {
        for (int k = 0; k < 4; ++k) energy += S(P(j, k) / 2) * rate[j] * rate[k];
      }
    }
  }
  for (std::size_t i = 0; i < state.qd.size(); ++i) energy += S(load.rotor_inertia[i] / 2) * state.qd[i] * state.qd[i];
  return energy;
}

/// Minus the integral of gravity times place over dm.
template <class S>
S potential_energy(const Mechanism& m, const Load& load, const std::vector<S>& q, const Numbers& guess) {
  const auto bodies = poses(m, q, guess);
  S energy(0);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Ten& t = load.bodies[b];
    const Vec3<S> moment = bodies[b].R * lift<S>(Vec3<Real>(t[1], t[2], t[3]));
    for (int k = 0; k < 3; ++k) energy -= S(m.gravity(k)) * (S(t[0]) * bodies[b].p(k) + moment(k));
  }
  return energy;
}

/// Coordinate of the joint with friction that is no drive.
template <class S>
S inner_coordinate(const Mechanism& m, const std::vector<S>& y) {
  return m.has_bar ? bar_length(m, y) : theta(m, y);
}

/// Rates of the joints with friction, and their derivatives by the drive rates (row: joint, column: drive).
struct Rubbing {
  Numbers rate;
  std::vector<Numbers> gain;
};
inline Rubbing rubbing(const Mechanism& m, const Numbers& q, const Numbers& qd, const Numbers& guess) {
  const std::size_t n = m.drives();
  Rubbing result{qd, std::vector<Numbers>(n, Numbers(n, 0))};
  for (std::size_t i = 0; i < n; ++i) result.gain[i][i] = 1;
  if (!m.has_bar && !m.turning_plate) return result;
  Numbers gain(n);
  Real rate = 0;
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<Dual<Real>> seeded(n);
    for (std::size_t k = 0; k < n; ++k) seeded[k] = Dual<Real>(q[k], k == i ? 1.0L : 0.0L);
    gain[i] = inner_coordinate(m, plate(m, seeded, guess)).slope;
    rate += gain[i] * qd[i];
  }
  result.rate.push_back(rate);
  result.gain.push_back(gain);
  return result;
}

/// Friction torques: force of each rubbing joint times its gain (principle of virtual power).
inline Numbers friction_torque(const Mechanism& m, const Load& load, const Numbers& q, const Numbers& qd,
                               const Numbers& guess) {
  const Rubbing joints = rubbing(m, q, qd, guess);
  Numbers torque(m.drives(), 0);
  for (std::size_t j = 0; j < joints.rate.size(); ++j) {
    const Real v = joints.rate[j];
    const Real force = load.viscous[j] * v + load.coulomb[j] * static_cast<Real>((v > 0) - (v < 0));
    for (std::size_t i = 0; i < torque.size(); ++i) torque[i] += force * joints.gain[j][i];
  }
  return torque;
}

/// Power that friction turns to heat.
inline Real friction_power(const Mechanism& m, const Load& load, const Numbers& q, const Numbers& qd,
                           const Numbers& guess) {
  const Numbers torque = friction_torque(m, load, q, qd, guess);
  Real power = 0;
  for (std::size_t i = 0; i < torque.size(); ++i) power += torque[i] * qd[i];
  return power;
}

/// Gradient of the potential energy by q.
inline Numbers gravity_torque(const Mechanism& m, const Load& load, const Numbers& q, const Numbers& guess) {
  Numbers gradient;
  for (std::size_t i = 0; i < q.size(); ++i) {
    std::vector<Dual<Real>> seeded;
    for (std::size_t k = 0; k < q.size(); ++k) seeded.push_back(Dual<Real>(q[k], k == i ? 1.0L : 0.0L));
    gradient.push_back(potential_energy(m, load, seeded, guess).slope);
  }
  return gradient;
}

/// Second derivative of the kinetic energy by two drive rates: entry (i, j) of the mass matrix.
inline Real mass_matrix_entry(const Mechanism& m, const Load& load, const Numbers& q, std::size_t i, std::size_t j,
                              const Numbers& guess) {
  using Second = Dual<Dual<Real>>;
  State<Second> state;
  for (std::size_t k = 0; k < q.size(); ++k) {
    state.q.push_back(Second(q[k]));
    state.qd.push_back(Second(Dual<Real>(0, k == i ? 1.0L : 0.0L), Dual<Real>(k == j ? 1.0L : 0.0L, 0)));
  }
  return kinetic_energy(m, load, state, guess).slope.slope;
}

/// Drive torques of a motion.
inline Numbers drive_torque(const Mechanism& m, const Load& load, const Numbers& q, const Numbers& qd,
                            const Numbers& qdd, const Numbers& guess) {
  const std::size_t n = m.drives();
  Numbers torque = friction_torque(m, load, q, qd, guess);
  const Numbers gravity = gravity_torque(m, load, q, guess);
  for (std::size_t i = 0; i < n; ++i) {
    // d/dt dT/dqd_i: outer slope by time along (qd, qdd), inner slope by qd_i.
    using Second = Dual<Dual<Real>>;
    State<Second> moving;
    State<Dual<Real>> shifted;
    for (std::size_t k = 0; k < n; ++k) {
      const Real seed = k == i ? 1 : 0;
      moving.q.push_back(Second(Dual<Real>(q[k]), Dual<Real>(qd[k])));
      moving.qd.push_back(Second(Dual<Real>(qd[k], seed), Dual<Real>(qdd[k])));
      shifted.q.push_back(Dual<Real>(q[k], seed));
      shifted.qd.push_back(Dual<Real>(qd[k]));
    }
    const Real momentum_rate = kinetic_energy(m, load, moving, guess).slope.slope;
    const Real slope = kinetic_energy(m, load, shifted, guess).slope;
    torque[i] += momentum_rate - slope + gravity[i] + load.offset[i];
  }
  return torque;
}

}  // namespace oracles
