#pragma once

/// \file
/// The plant's equations of motion with joints that slide or stick, at one state; time is moved on by plant.cpp.

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "deltadyn/effects/side_load.hpp"
#include "deltadyn/simulation/plant.hpp"
#include "deltadyn/simulation/stick_slip.hpp"

#include "plant_parts.hpp"

namespace deltadyn::detail {

constexpr int kMaxCoordinates = 2 * kMaxDrives;     // arms and the motors of soft drives
constexpr int kMaxState = 2 * kMaxCoordinates + 2;  // + work, losses

using State = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxState, 1>;
using Coordinates = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxCoordinates, 1>;
using CoordinateMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxCoordinates, kMaxCoordinates>;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxJoints, kMaxCoordinates>;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxCoordinates, kMaxJoints>;
using JointMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxJoints, kMaxJoints>;

constexpr double kBeyondAnyForce = 1e30;  // [N m | N]

/// Smallest u with A u = b. Joints whose rates depend on one another (all limbs and the telescope) make A singular.
inline JointVector least_forces(const JointMatrix& A, const JointVector& b) {
  constexpr double kRankThreshold = 1e-9;
  if (A.rows() == 1) return b / A(0, 0);
  Eigen::CompleteOrthogonalDecomposition<JointMatrix> decomposition(A.rows(), A.cols());
  decomposition.setThreshold(kRankThreshold);
  decomposition.compute(A);
  return decomposition.solve(b);
}

struct JointDynamics {
  JointDynamics(const RobotDescription& description, const std::vector<std::string>& names, const Eigen::VectorXd& p,
                const std::vector<Effect>& effects, const PlantOptions& given)
      : options(given), parts(build_plant(description, names, p, effects)) {
    n = parts.mechanism->drives();
    joints = parts.mechanism->joints();
    soft = static_cast<int>(parts.soft.size());
    coordinate_of_drive.resize(at(n));
    for (int j = 0; j < n; ++j) coordinate_of_drive[at(j)] = j;
    for (int e = 0; e < soft; ++e) coordinate_of_drive[at(parts.soft[at(e)].drive)] = n + e;
    direction.assign(at(joints), 0);
    turned.resize(at(joints));
    held_until.assign(at(joints), -1.0);
    tau_start = tau_end = DriveVector::Zero(n);
  }

  static std::size_t at(int k) { return static_cast<std::size_t>(k); }
  [[nodiscard]] int coordinates() const { return n + soft; }
  [[nodiscard]] int size() const { return 2 * coordinates() + 2; }

  // --- torque of the drives -------------------------------------------------------------------

  [[nodiscard]] double torque_at(int drive, double time) const {
    if (options.current_lag_s <= 0) return tau_end(drive);
    return tau_end(drive) +
           (tau_start(drive) - tau_end(drive)) * std::exp(-(time - command_time) / options.current_lag_s);
  }

  // --- the equations of motion at one state -----------------------------------------------------

  struct Terms {
    MechanismTerms robot;
    CoordinateMatrix M;
    Coordinates force;  ///< all that does not come through the joints with friction
    Rows J;
    Eigen::LLT<CoordinateMatrix> cholesky;
    double other_losses = 0;  ///< power of springs' dampers, drag and hose [W]
  };

  /// Forces of effects do not depend on the plate's acceleration; those that do change the machine.
  [[nodiscard]] Eigen::Vector3d force_on_plate(const Effect& effect, const MechanismTerms& robot) const {
    const PlateInput<double> in{.position = robot.r, .velocity = robot.v, .gravity = parts.gravity};
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    visit_effect(effect.id, [&](auto type) {
      using E = decltype(type);
      if constexpr (kIs<E, PlateForce>) {
        const auto forces = E::columns(in, shape_of(effect));
        for (std::size_t c = 0; c < forces.size(); ++c)
          sum += effect.amplitude(static_cast<Eigen::Index>(c)) * forces[c];
      }
    });
    return sum;
  }

  Status terms_at(const State& state, Terms& terms) const {
    const DriveVector q = state.head(n), qd = state.segment(coordinates(), n);
    if (const Status status = parts.mechanism->evaluate(q, qd, terms.robot); status != Status::ok) return status;
    const int c = coordinates();
    terms.M.setZero(c, c);
    terms.M.topLeftCorner(n, n) = terms.robot.M;
    terms.force.setZero(c);
    terms.force.head(n) = -terms.robot.bias;
    terms.J.setZero(joints, c);
    terms.J.leftCols(n) = terms.robot.J;
    terms.other_losses = 0;
    for (const Effect& effect : parts.plate_forces) {
      const Eigen::Vector3d force = force_on_plate(effect, terms.robot);
      terms.force.head(n) -= terms.robot.J_r.transpose() * force;
      terms.other_losses += force.dot(terms.robot.v);
    }
    for (int e = 0; e < soft; ++e) {
      const SoftDrive& spring = parts.soft[at(e)];
      const int arm = spring.drive, motor = n + e;
      terms.M(arm, arm) -= spring.motor_inertia;
      terms.M(motor, motor) = spring.motor_inertia;
      const double lead = state(motor) - state(arm), lead_rate = state(c + motor) - state(c + arm);
      const double torque = spring.torque(lead, lead_rate);
      terms.force(arm) += torque;
      terms.force(motor) -= torque;
      terms.other_losses += torque * lead_rate - spring.torque(lead, 0) * lead_rate;
      // The drive's friction sits on the motor.
      terms.J(arm, arm) = 0;
      terms.J(arm, motor) = 1;
      terms.robot.rate(arm) = state(c + motor);
      terms.robot.position(arm) = state(motor);
    }
    terms.cholesky.compute(terms.M);
    return terms.cholesky.info() == Eigen::Success ? Status::ok : Status::out_of_range;
  }

  [[nodiscard]] JointMotion motion_of(int j, double time, const Terms& terms, int sense, double side_load) const {
    const double position = terms.robot.position(j);
    return {.rate = terms.robot.rate(j),
            .direction = sense,
            .position = position,
            .time = time,
            .side_load = side_load,
            .memory = parts.laws[at(j)].has_memory() ? memory_at(j, position) : LawMemories{}};
  }

  /// Memories need no state of their own: since the last reversal they are functions of the position alone.
  [[nodiscard]] LawMemories memory_at(int j, double position) const {
    const Turn& since = turned[at(j)];
    return parts.laws[at(j)].moved(since.memory, position - since.position);
  }

  [[nodiscard]] double torque_of_joint(int j, double time) const { return j < n ? torque_at(j, time) : 0.0; }
  /// Direction in which a joint without dry friction resists.
  [[nodiscard]] int sense_of(int j, const Terms& terms) const {
    if (parts.laws[at(j)].minds_reversals()) return direction[at(j)];
    return terms.robot.rate(j) < 0 ? -1 : 1;
  }
  [[nodiscard]] bool stuck(int j) const { return parts.laws[at(j)].minds_reversals() && direction[at(j)] == 0; }

  struct Solution {
    Coordinates acceleration;
    JointVector transmitted;  ///< of each joint [N m | N]
  };

  /// Accelerations with the joints in `held` kept at rest. `side_load` is that of the telescope.
  void solve(double time, const Terms& terms, double side_load, Solution& out) const {
    Coordinates force = terms.force;
    out.transmitted.setZero(joints);
    int held = 0;
    std::array<int, kMaxJoints> rows{};
    for (int j = 0; j < joints; ++j) {
      if (stuck(j)) {
        rows[at(held++)] = j;
        continue;
      }
      out.transmitted(j) = parts.laws[at(j)].transmitted(torque_of_joint(j, time),
                                                         motion_of(j, time, terms, sense_of(j, terms), side_load));
      force += terms.J.row(j).transpose() * out.transmitted(j);
    }
    out.acceleration = terms.cholesky.solve(force);
    if (held == 0) return;
    Rows J(held, coordinates());
    JointVector bias(held);
    for (int k = 0; k < held; ++k) {
      J.row(k) = terms.J.row(rows[at(k)]);
      bias(k) = terms.robot.bias_rate(rows[at(k)]);
    }
    const Columns MinvJ = terms.cholesky.solve(J.transpose());
    const JointVector u = least_forces(J * MinvJ, -(J * out.acceleration + bias));
    out.acceleration += MinvJ * u;
    for (int k = 0; k < held; ++k) {
      out.transmitted(rows[at(k)]) = u(k);
      if (rows[at(k)] < n) out.acceleration(coordinate_of_drive[at(rows[at(k)])]) = 0;
    }
  }

  /// The side load of the telescope depends on the acceleration, which it changes a little: a few rounds settle it.
  double solve_with_side_load(double time, const Terms& terms, Solution& out) const {
    const int bar = parts.mechanism->inner_joint();
    if (bar < 0 || !parts.laws[at(bar)].has_side_load()) {
      solve(time, terms, 0, out);
      return 0;
    }
    double load = 0;
    constexpr int kRounds = 50;
    for (int round = 0; round < kRounds; ++round) {
      solve(time, terms, load, out);
      const Eigen::Vector3d a = terms.robot.a_bias + terms.robot.J_r * out.acceleration.head(n);
      const double next = deltadyn::side_load<double>(terms.robot.bar, a, parts.gravity);
      const bool settled = std::abs(next - load) <= 1e-13 * (1 + next);
      load = next;
      if (settled) break;
    }
    return load;
  }

  Status derivative(double time, const State& state, State& rate) {
    if (const Status status = terms_at(state, scratch); status != Status::ok) return status;
    solve_with_side_load(time, scratch, solution);
    const int c = coordinates();
    rate.resize(size());
    rate.head(c) = state.segment(c, c);
    rate.segment(c, c) = solution.acceleration;
    double power = 0, loss = scratch.other_losses;
    for (int j = 0; j < joints; ++j) {
      const double tau = torque_of_joint(j, time), v = scratch.robot.rate(j);
      power += tau * v;
      loss += (stuck(j) ? tau : tau - solution.transmitted(j)) * v;  // of a stuck joint v is zero but for rounding
    }
    rate(2 * c) = power;
    rate(2 * c + 1) = loss;
    return Status::ok;
  }

  // --- rest ---------------------------------------------------------------------------------------

  /// What a joint at rest can pass on: between sliding up and sliding down.
  void bounds(int j, double time, const Terms& terms, double side_load, double& low, double& high) const {
    if (time < held_until[at(j)]) {
      low = -kBeyondAnyForce;
      high = kBeyondAnyForce;
      return;
    }
    const double tau = torque_of_joint(j, time);
    JointMotion motion = motion_of(j, time, terms, 1, side_load);
    motion.rate = 0;
    low = parts.laws[at(j)].transmitted(tau, motion);
    motion.direction = -1;
    high = parts.laws[at(j)].transmitted(tau, motion);
    if (low > high) low = high = 0.5 * (low + high);
  }

  /// Decides on all joints at rest together; true if any of them starts to slide. Directions are set only if `act`.
  bool release(double time, Terms& terms, bool act) {
    Solution free;
    const double side_load = solve_with_side_load(time, terms, free);
    const std::vector<int> rest = joints_at_rest();
    if (rest.empty()) return false;
    // Accelerations with nothing passed on by the joints at rest.
    Coordinates force = terms.force;
    for (int j = 0; j < joints; ++j) {
      if (!stuck(j)) force += terms.J.row(j).transpose() * free.transmitted(j);
    }
    const Coordinates a0 = terms.cholesky.solve(force);
    const auto count = static_cast<Eigen::Index>(rest.size());
    const Rows J = terms.J(rest, Eigen::all);
    JointVector b(count), low(count), high(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const int j = rest[static_cast<std::size_t>(k)];
      b(k) = terms.J.row(j).dot(a0) + terms.robot.bias_rate(j);
      bounds(j, time, terms, side_load, low(k), high(k));
    }
    const JointMatrix A = J * terms.cholesky.solve(J.transpose());
    const StickSlip result = solve_stick_slip(A, b, low, high);
    const bool any = (result.direction.array() != 0).any();
    if (!act) return any;
    for (Eigen::Index k = 0; k < count; ++k) {
      const int j = rest[static_cast<std::size_t>(k)];
      if (result.direction(k) == 0) continue;
      direction[at(j)] = result.direction(k);
      ++counts.breakaways;
    }
    return any;
  }

  /// True if friction cannot hold all joints that are stuck.
  bool breaks_loose(double time, const State& state) {
    if (!any_stuck()) return false;
    if (terms_at(state, scratch) != Status::ok) return false;
    const double side_load = solve_with_side_load(time, scratch, solution);
    for (int j = 0; j < joints; ++j) {
      if (!stuck(j)) continue;
      double low = 0, high = 0;
      bounds(j, time, scratch, side_load, low, high);
      const double slack = 1e-9 * (high - low) + 1e-12;
      // The shares of joints that hold one another are not unique: ask for all of them together before believing it.
      if (solution.transmitted(j) < low - slack || solution.transmitted(j) > high + slack) {
        return release(time, scratch, false);
      }
    }
    return false;
  }

  /// Rates of joints at rest set to exactly zero; true if that changed anything but drives that rest already.
  bool hold_still(State& state) {
    bool others = false;
    const int c = coordinates();
    for (int j = 0; j < joints; ++j) {
      if (!stuck(j)) continue;
      if (j < n)
        state(c + coordinate_of_drive[at(j)]) = 0;
      else
        others = true;
    }
    if (!others || terms_at(state, scratch) != Status::ok) return false;
    // Passive joints: the smallest change in the metric of M, as an impulse would do it.
    const Rows J = scratch.J(joints_at_rest(), Eigen::all);
    const Columns MinvJ = scratch.cholesky.solve(J.transpose());
    state.segment(c, c) -= MinvJ * least_forces(J * MinvJ, J * state.segment(c, c));
    for (int j = 0; j < n; ++j) {
      if (stuck(j)) state(c + coordinate_of_drive[at(j)]) = 0;
    }
    return true;
  }

  /// Remembers where the joint turned round.
  void note_turn(int j, const Terms& terms) {
    if (!parts.laws[at(j)].has_memory()) return;
    const double position = terms.robot.position(j);
    turned[at(j)] = {memory_at(j, position), position};
  }

  [[nodiscard]] std::vector<int> joints_at_rest() const {
    std::vector<int> rest;
    for (int j = 0; j < joints; ++j) {
      if (stuck(j)) rest.push_back(j);
    }
    return rest;
  }

  [[nodiscard]] bool any_stuck() const {
    for (int j = 0; j < joints; ++j) {
      if (stuck(j)) return true;
    }
    return false;
  }

  struct Turn {
    LawMemories memory = {};
    double position = 0;
  };

  PlantOptions options;
  PlantParts parts;
  int n = 0, joints = 0, soft = 0;
  std::vector<int> coordinate_of_drive;
  DriveVector tau_start, tau_end;
  double command_time = 0;
  std::vector<int> direction;  ///< +1, -1, 0 stuck; means nothing for joints that do not mind reversals
  std::vector<Turn> turned;
  std::vector<double> held_until;  ///< times before which a joint does not break loose
  PlantCounts counts;
  Terms scratch;
  Solution solution;
};

}  // namespace deltadyn::detail
