#pragma once

/// \file
/// Position, motion and torque of any list of bodies and joints (joints.hpp), by least squares and the principle of
/// virtual power. It knows no limb, no plate and no robot.

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <stdexcept>
#include <string>

#include "oracles/joints.hpp"
#include "oracles/lagrange.hpp"  // for Load, which is data

namespace oracles::bodies {

using Column = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
using Block = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using Sparse = Eigen::SparseMatrix<Real>;

struct System {
  std::size_t bodies = 1;  ///< with the base
  int drives = 0;
  Equations equations;
  Reading inner;  ///< coordinate of the joint with friction that is no drive
  Real3 gravity;
  [[nodiscard]] Eigen::Index unknowns() const { return 6 * static_cast<Eigen::Index>(bodies - 1); }
  [[nodiscard]] Eigen::Index rows() const { return static_cast<Eigen::Index>(equations.size()); }
};

/// What is left of the equations at places of the bodies.
inline Column errors(const System& system, const Places& at, const Numbers& q) {
  Column out(system.rows());
  for (Eigen::Index row = 0; row < out.size(); ++row) {
    const Equation& equation = system.equations[static_cast<std::size_t>(row)];
    out(row) = equation.drive < 0 ? 0 : -q[static_cast<std::size_t>(equation.drive)];
    for (const auto& [times, reading] : equation.terms)
      out(row) += times * value(reading, at[reading.a], at[reading.b]);
  }
  return out;
}

/// Derivatives of the equations by the twists of all bodies.
inline Sparse jacobian(const System& system, const Places& at) {
  std::vector<Eigen::Triplet<Real>> entries;
  for (Eigen::Index row = 0; row < system.rows(); ++row) {
    for (const auto& [times, reading] : system.equations[static_cast<std::size_t>(row)].terms) {
      const Slopes by = slopes(reading, at);
      for (int k = 0; k < 6; ++k) {
        if (reading.a > 0)
          entries.emplace_back(static_cast<int>(row), 6 * static_cast<int>(reading.a - 1) + k, times * by.by_a(k));
        if (reading.b > 0)
          entries.emplace_back(static_cast<int>(row), 6 * static_cast<int>(reading.b - 1) + k, times * by.by_b(k));
      }
    }
  }
  Sparse J(system.rows(), system.unknowns());
  J.setFromTriplets(entries.begin(), entries.end());
  return J;
}

/// Solves J x = b where b lies in the range of J, which may have more rows than rank: redundant joints do no harm.
class LeastSquares {
 public:
  explicit LeastSquares(Sparse J) : J_(std::move(J)), solver_(Sparse(J_.transpose() * J_)) {}

  /// Throws std::runtime_error if the equations contradict each other or leave a body free.
  [[nodiscard]] Block solve(const Block& b) const {
    Block x = step(b);
    // The normal equations square the condition number; each refinement takes back what that costs.
    for (int refinement = 0; refinement < 2; ++refinement) x += step(b - J_ * x);
    const Real left = (J_ * x - b).cwiseAbs().maxCoeff();
    if (!(left < 1e-12L * (1 + b.cwiseAbs().maxCoeff()))) throw std::runtime_error("the joints contradict each other");
    return x;
  }
  /// One step of Gauss and Newton.
  [[nodiscard]] Block step(const Block& b) const {
    if (solver_.info() != Eigen::Success) throw std::runtime_error("a body is free to move");
    return solver_.solve(Block(J_.transpose() * b));
  }

 private:
  Sparse J_;
  Eigen::SimplicialLDLT<Sparse> solver_;
};

/// Moves a body by a finite twist.
inline void shift(Place<Real>& place, const Twist& by) {
  place.p += by.tail<3>();
  const Real angle = by.head<3>().norm();
  if (angle > 0) place.R = Eigen::AngleAxis<Real>(angle, by.head<3>() / angle).toRotationMatrix() * place.R;
}

/// Places of the bodies at drive coordinates q, by Gauss and Newton from a rough guess.
/// Throws std::runtime_error if it does not converge.
inline Places assemble(const System& system, const Numbers& q, Places at) {
  for (int iteration = 0; iteration < 40; ++iteration) {
    const LeastSquares squares(jacobian(system, at));
    const Column by = squares.step(-errors(system, at, q));
    // A step that would turn a body right round is of no use.
    const Real largest = by.cwiseAbs().maxCoeff(), shorter = std::min<Real>(1, 0.5L / largest);
    for (std::size_t body = 1; body < at.size(); ++body) {
      shift(at[body], shorter * by.segment<6>(6 * static_cast<Eigen::Index>(body - 1)));
    }
    if (largest < 1e-12L) {  // after which convergence, being quadratic, has gone as far as rounding lets it
      if (!(errors(system, at, q).cwiseAbs().maxCoeff() < 1e-15L)) break;
      return at;
    }
  }
  throw std::runtime_error("the bodies do not come together");
}

/// Bodies in motion.
struct Flight {
  Places at;
  Block gain;          ///< d twists / d drive rates
  Column twist, rate;  ///< of all bodies
  Numbers qd, qdd;     ///< of the drives
  [[nodiscard]] Twist twist_of(std::size_t body) const { return part(twist, body); }
  [[nodiscard]] Twist rate_of(std::size_t body) const { return part(rate, body); }

 private:
  static Twist part(const Column& all, std::size_t body) {
    return body == 0 ? Twist::Zero().eval() : Twist(all.segment<6>(6 * static_cast<Eigen::Index>(body - 1)));
  }
};

/// A reading in second order along time: value.value, value.slope and slope.slope.
inline Dual<Dual<Real>> value_in(const Flight& flight, const Reading& reading) {
  const auto place = [&](std::size_t k) { return in_flight(flight.at[k], flight.twist_of(k), flight.rate_of(k)); };
  return value(reading, place(reading.a), place(reading.b));
}

inline Flight fly(const System& system, const Places& at, const Numbers& qd, const Numbers& qdd) {
  const LeastSquares squares(jacobian(system, at));
  Block drives = Block::Zero(system.rows(), system.drives);
  for (Eigen::Index row = 0; row < system.rows(); ++row) {
    const int drive = system.equations[static_cast<std::size_t>(row)].drive;
    if (drive >= 0) drives(row, drive) = 1;
  }
  Flight flight{at, squares.solve(drives), {}, Column::Zero(system.unknowns()), qd, qdd};
  const Eigen::Map<const Column> first(qd.data(), system.drives), second(qdd.data(), system.drives);
  flight.twist = flight.gain * first;
  // What the equations' second derivatives are without accelerations, the accelerations must take back.
  Block wanted = drives * second;
  for (Eigen::Index row = 0; row < system.rows(); ++row) {
    for (const auto& [times, reading] : system.equations[static_cast<std::size_t>(row)].terms) {
      wanted(row, 0) -= times * value_in(flight, reading).slope.slope;
    }
  }
  flight.rate = squares.solve(wanted);
  return flight;
}

/// Inertia of a body about the origin of its frame, along the axes of the base.
struct Heavy {
  Real m;
  Real3 mc;
  Real33 I;
};
inline Heavy heavy(const Ten& t, const Real33& R) {
  Real33 I;
  I << t[4], t[7], t[9], t[7], t[5], t[8], t[9], t[8], t[6];
  return {t[0], R * Real3(t[1], t[2], t[3]), R * I * R.transpose()};
}

/// d momentum / d twist of a body, 6 x 6.
inline Eigen::Matrix<Real, 6, 6> twist_inertia(const Heavy& body) {
  Eigen::Matrix<Real, 6, 6> out;
  const Real33 S = cross_matrix(body.mc);
  out << body.I, S, -S, body.m * Real33::Identity();
  return out;
}

/// Mass matrix by the drive rates.
inline Block mass_matrix(const System& system, const Flight& flight, const Load& load) {
  Block M = Block::Zero(system.drives, system.drives);
  for (std::size_t body = 1; body < system.bodies; ++body) {
    const Block gain = flight.gain.middleRows<6>(6 * static_cast<Eigen::Index>(body - 1));
    M += gain.transpose() * twist_inertia(heavy(load.bodies[body - 1], flight.at[body].R)) * gain;
  }
  for (int i = 0; i < system.drives; ++i) M(i, i) += load.rotor_inertia[static_cast<std::size_t>(i)];
  return M;
}

/// Moment about the origin and force that a body's motion takes, gravity included (Newton, Euler).
inline Twist wrench(const Heavy& body, const Twist& twist, const Twist& rate, const Real3& gravity) {
  const Real3 w = twist.head<3>(), w_d = rate.head<3>(), a = rate.tail<3>() - gravity;
  Twist out;
  out << body.mc.cross(a) + body.I * w_d + w.cross(body.I * w),
      body.m * a + w_d.cross(body.mc) + w.cross(w.cross(body.mc));
  return out;
}

/// Drive torques of a motion: virtual power of all wrenches, of rotors and of what rubs.
inline Column drive_torque(const System& system, const Flight& flight, const Load& load) {
  const auto rubs = [&load](std::size_t joint, Real rate) {
    return load.viscous[joint] * rate + load.coulomb[joint] * static_cast<Real>((rate > 0) - (rate < 0));
  };
  Column torque = Column::Zero(system.drives);
  for (std::size_t body = 1; body < system.bodies; ++body) {
    torque += flight.gain.middleRows<6>(6 * static_cast<Eigen::Index>(body - 1)).transpose() *
              wrench(heavy(load.bodies[body - 1], flight.at[body].R), flight.twist_of(body), flight.rate_of(body),
                     system.gravity);
  }
  const Real rate = value_in(flight, system.inner).value.slope;
  const Slopes by = slopes(system.inner, flight.at);
  const auto take = [&](std::size_t body, const Twist& slope) {
    if (body == 0) return;
    const Real force = rubs(static_cast<std::size_t>(system.drives), rate);
    torque += force * flight.gain.middleRows<6>(6 * static_cast<Eigen::Index>(body - 1)).transpose() * slope;
  };
  take(system.inner.a, by.by_a);
  take(system.inner.b, by.by_b);
  for (std::size_t i = 0; i < static_cast<std::size_t>(system.drives); ++i) {
    torque(static_cast<Eigen::Index>(i)) +=
        rubs(i, flight.qd[i]) + load.rotor_inertia[i] * flight.qdd[i] + load.offset[i];
  }
  return torque;
}

}  // namespace oracles::bodies
