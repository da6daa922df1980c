#include "deltadyn/simulation/plant.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/effects/aerodynamic_drag.hpp"
#include "deltadyn/effects/hose_force.hpp"
#include "deltadyn/effects/hysteresis.hpp"
#include "deltadyn/effects/presliding.hpp"
#include "deltadyn/effects/telescope_side_load.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/simulation/dormand_prince.hpp"
#include "deltadyn/simulation/stick_slip.hpp"

#include "plant_parts.hpp"

namespace deltadyn {
namespace {

constexpr int kMaxCoordinates = 2 * kMaxDrives;                      // arms and the motors of soft drives
constexpr int kMaxState = 2 * kMaxCoordinates + kMaxDrives + 1 + 2;  // + hysteresis of drives and telescope + work, losses

using State = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxState, 1>;
using Coordinates = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxCoordinates, 1>;
using CoordinateMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxCoordinates, kMaxCoordinates>;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxJoints, kMaxCoordinates>;
using JointMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxJoints, kMaxJoints>;

constexpr double kShortestStep = 1e-13;   // [s]
constexpr double kBeyondAnyForce = 1e30;  // [N m | N]
constexpr int kMostStalls = 20;           // events within a nanosecond of one another
constexpr double kHoldUndecided = 1e-4;   // [s]

/// Smallest u with A u = b. Joints whose rates depend on one another (all limbs and the telescope) make A singular.
JointVector least_forces(const JointMatrix& A, const JointVector& b) {
  constexpr double kRankThreshold = 1e-9;
  if (A.rows() == 1) return b / A(0, 0);
  Eigen::CompleteOrthogonalDecomposition<JointMatrix> decomposition(A.rows(), A.cols());
  decomposition.setThreshold(kRankThreshold);
  decomposition.compute(A);
  return decomposition.solve(b);
}

}  // namespace

struct Plant::Impl {
  Impl(const RobotDescription& description, const std::vector<std::string>& names, const Eigen::VectorXd& p,
       const std::vector<Effect>& effects, const PlantOptions& given)
      : options(given), parts(detail::build_plant(description, names, p, effects)) {
    n = parts.mechanism->drives();
    joints = parts.mechanism->joints();
    soft = static_cast<int>(parts.soft.size());
    for (int j = 0; j < joints; ++j) {
      const FrictionLaw& law = parts.laws[at(j)];
      if (law.has_loop()) loop_joints.push_back(j);
    }
    coordinate_of_drive.resize(at(n));
    for (int j = 0; j < n; ++j) coordinate_of_drive[at(j)] = j;
    for (int e = 0; e < soft; ++e) coordinate_of_drive[at(parts.soft[at(e)].drive)] = n + e;
    x.setZero(size());
    direction.assign(at(joints), 0);
    bristle.resize(at(joints));
    held_until.assign(at(joints), -1.0);
    tau_start = tau_end = DriveVector::Zero(n);
  }

  static std::size_t at(int k) { return static_cast<std::size_t>(k); }
  [[nodiscard]] int coordinates() const { return n + soft; }
  [[nodiscard]] int loops() const { return static_cast<int>(loop_joints.size()); }
  [[nodiscard]] int size() const { return 2 * coordinates() + loops() + 2; }

  // --- torque of the drives -------------------------------------------------------------------

  [[nodiscard]] double torque_at(int drive, double time) const {
    if (options.current_lag_s <= 0) return tau_end(drive);
    return tau_end(drive) + (tau_start(drive) - tau_end(drive)) * std::exp(-(time - command_time) / options.current_lag_s);
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
    if (parts.drag > 0) {
      const Eigen::Vector3d drag = parts.drag * aerodynamic_drag<double>(terms.robot.v);
      terms.force.head(n) -= terms.robot.J_r.transpose() * drag;
      terms.other_losses += drag.dot(terms.robot.v);
    }
    if (parts.hose) {
      const Eigen::Vector3d hose =
          parts.hose_force + parts.hose_stiffness.cwiseProduct(hose_stretch<double>(terms.robot.r, parts.hose_reference));
      terms.force.head(n) -= terms.robot.J_r.transpose() * hose;
      terms.other_losses += hose.dot(terms.robot.v);
    }
    for (int e = 0; e < soft; ++e) {
      const detail::SoftDrive& spring = parts.soft[at(e)];
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

  [[nodiscard]] JointMotion motion_of(int j, double time, const State& state, const Terms& terms, int sense,
                                      double side_load) const {
    JointMotion motion;
    motion.rate = terms.robot.rate(j);
    motion.direction = sense;
    motion.position = terms.robot.position(j);
    motion.time = time;
    motion.side_load = side_load;
    if (parts.laws[at(j)].bristle_displacement() > 0) motion.bristle = bristle_state(j, motion.position);
    for (int k = 0; k < loops(); ++k) {
      if (loop_joints[at(k)] == j) motion.loop = state(2 * coordinates() + k);
    }
    return motion;
  }

  /// Presliding needs no state of its own: since the last reversal it is a function of the position alone.
  [[nodiscard]] double bristle_state(int j, double position) const {
    const Bristle& since = bristle[at(j)];
    Presliding<double> law(parts.laws[at(j)].bristle_displacement(), since.state);
    return law.move(position - since.position);
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
  void solve(double time, const State& state, const Terms& terms, double side_load, Solution& out) const {
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
                                                         motion_of(j, time, state, terms, sense_of(j, terms), side_load));
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
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxCoordinates, kMaxJoints> MinvJ =
        terms.cholesky.solve(J.transpose());
    const JointVector u = least_forces(J * MinvJ, -(J * out.acceleration + bias));
    out.acceleration += MinvJ * u;
    for (int k = 0; k < held; ++k) {
      out.transmitted(rows[at(k)]) = u(k);
      if (rows[at(k)] < n) out.acceleration(coordinate_of_drive[at(rows[at(k)])]) = 0;
    }
  }

  /// The side load of the telescope depends on the acceleration, which it changes a little: a few rounds settle it.
  double solve_with_side_load(double time, const State& state, const Terms& terms, Solution& out) const {
    const int bar = parts.mechanism->telescope_joint();
    if (bar < 0 || !parts.laws[at(bar)].has_side_load()) {
      solve(time, state, terms, 0, out);
      return 0;
    }
    double load = 0;
    constexpr int kRounds = 50;
    for (int round = 0; round < kRounds; ++round) {
      solve(time, state, terms, load, out);
      const Eigen::Vector3d a = terms.robot.a_bias + terms.robot.J_r * out.acceleration.head(n);
      const double next = telescope_side_load<double>(1.0, terms.robot.bar, a, parts.gravity);
      const bool settled = std::abs(next - load) <= 1e-13 * (1 + next);
      load = next;
      if (settled) break;
    }
    return load;
  }

  Status derivative(double time, const State& state, State& rate) {
    ++counts.evaluations;
    if (const Status status = terms_at(state, scratch); status != Status::ok) return status;
    solve_with_side_load(time, state, scratch, solution);
    const int c = coordinates();
    rate.resize(size());
    rate.head(c) = state.segment(c, c);
    rate.segment(c, c) = solution.acceleration;
    for (int k = 0; k < loops(); ++k) {
      const int j = loop_joints[at(k)];
      rate(2 * c + k) = parts.laws[at(j)].loop_rate(scratch.robot.rate(j), state(2 * c + k));
    }
    double power = 0, loss = scratch.other_losses;
    for (int j = 0; j < joints; ++j) {
      const double tau = torque_of_joint(j, time), v = scratch.robot.rate(j);
      power += tau * v;
      if (!stuck(j))
        loss += (tau - solution.transmitted(j)) * v;
      else
        loss += tau * v;  // v is zero but for rounding
    }
    rate(2 * c + loops()) = power;
    rate(2 * c + loops() + 1) = loss;
    return Status::ok;
  }

  // --- rest ---------------------------------------------------------------------------------------

  /// What a joint at rest can pass on: between sliding up and sliding down.
  void bounds(int j, double time, const State& state, const Terms& terms, double side_load, double& low, double& high) const {
    if (time < held_until[at(j)]) {
      low = -kBeyondAnyForce;
      high = kBeyondAnyForce;
      return;
    }
    const double tau = torque_of_joint(j, time);
    JointMotion motion = motion_of(j, time, state, terms, 1, side_load);
    motion.rate = 0;
    low = parts.laws[at(j)].transmitted(tau, motion);
    motion.direction = -1;
    high = parts.laws[at(j)].transmitted(tau, motion);
    if (low > high) low = high = 0.5 * (low + high);
  }

  /// Decides on all joints at rest together; true if any of them starts to slide. Directions are set only if `act`.
  bool release(double time, const State& state, Terms& terms, bool act) {
    Solution free;
    const double side_load = solve_with_side_load(time, state, terms, free);
    std::vector<int> rest;
    for (int j = 0; j < joints; ++j) {
      if (stuck(j)) rest.push_back(j);
    }
    if (rest.empty()) return false;
    // Accelerations with nothing passed on by the joints at rest.
    Coordinates force = terms.force;
    for (int j = 0; j < joints; ++j) {
      if (!stuck(j)) force += terms.J.row(j).transpose() * free.transmitted(j);
    }
    const Coordinates a0 = terms.cholesky.solve(force);
    const auto count = static_cast<Eigen::Index>(rest.size());
    Rows J(count, coordinates());
    JointVector b(count), low(count), high(count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const int j = rest[static_cast<std::size_t>(k)];
      J.row(k) = terms.J.row(j);
      b(k) = terms.J.row(j).dot(a0) + terms.robot.bias_rate(j);
      bounds(j, time, state, terms, side_load, low(k), high(k));
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
    const double side_load = solve_with_side_load(time, state, scratch, solution);
    for (int j = 0; j < joints; ++j) {
      if (!stuck(j)) continue;
      double low = 0, high = 0;
      bounds(j, time, state, scratch, side_load, low, high);
      const double slack = 1e-9 * (high - low) + 1e-12;
      // The shares of joints that hold one another are not unique: ask for all of them together before believing it.
      if (solution.transmitted(j) < low - slack || solution.transmitted(j) > high + slack) {
        return release(time, state, scratch, false);
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
    std::vector<int> rest;
    for (int j = 0; j < joints; ++j) {
      if (stuck(j)) rest.push_back(j);
    }
    const auto count = static_cast<Eigen::Index>(rest.size());
    Rows J(count, c);
    for (Eigen::Index k = 0; k < count; ++k) J.row(k) = scratch.J.row(rest[static_cast<std::size_t>(k)]);
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxCoordinates, kMaxJoints> MinvJ =
        scratch.cholesky.solve(J.transpose());
    state.segment(c, c) -= MinvJ * least_forces(J * MinvJ, J * state.segment(c, c));
    for (int j = 0; j < n; ++j) {
      if (stuck(j)) state(c + coordinate_of_drive[at(j)]) = 0;
    }
    return true;
  }

  /// Remembers where presliding turned round.
  void note_bristle(int j, const Terms& terms) {
    if (parts.laws[at(j)].bristle_displacement() <= 0) return;
    const double position = terms.robot.position(j);
    bristle[at(j)] = {bristle_state(j, position), position};
  }

  // --- time ---------------------------------------------------------------------------------------

  /// How far the slowest sliding joint is from reversing, negative beyond; only joints that mind.
  double least_rate(const State& state, int* which = nullptr) {
    double least = 1e300;
    if (terms_at(state, scratch) != Status::ok) return least;
    for (int j = 0; j < joints; ++j) {
      if (!parts.laws[at(j)].minds_reversals() || direction[at(j)] == 0) continue;
      const double rate = direction[at(j)] * scratch.robot.rate(j);
      if (rate < least) {
        least = rate;
        if (which != nullptr) *which = j;
      }
    }
    return least;
  }

  bool step(double h, State& next, State& rate_next, State& error) {
    const auto system = [this](double t, const State& state, State& rate) { return derivative(t, state, rate) == Status::ok; };
    return dormand_prince_step(system, now, h, x, rate_now, next, rate_next, error);
  }

  [[nodiscard]] double relative(const State& error, const State& next) const {
    double worst = 0;
    for (int k = 0; k < 2 * coordinates() + loops(); ++k) {
      const double scale = options.tolerance * std::max({1.0, std::abs(x(k)), std::abs(next(k))});
      worst = std::max(worst, std::abs(error(k)) / scale);
    }
    return worst;
  }

  [[noreturn]] void lost(const char* how) const {
    throw Error(fmt::format("at {:.4f} s the robot {}", now, how), "simulation",
                "check that trajectory, parameters and robot file belong together, and the gains of the controller",
                ExitCode::no_convergence);
  }

  /// First instant in (0, h] at which a sliding joint reverses or a stuck one breaks loose; x, the time and the rates move there.
  void go_to_event(double h) {
    State next, rate_next, error;
    double low = 0, high = h;
    const double start = least_rate(x);
    // Reversal by the rate, which is continuous: false position with the Illinois rule.
    if (!step(h, next, rate_next, error)) lost("cannot be moved on");
    double f_low = std::max(start, 0.0), f_high = least_rate(next);
    if (f_high < 0) {
      int side = 0;
      for (int round = 0; round < 80 && high - low > 1e-15 && f_high < -1e-13; ++round) {
        double middle = f_low > 0 ? low + (high - low) * f_low / (f_low - f_high) : 0.5 * (low + high);
        middle = std::clamp(middle, low + 0.01 * (high - low), high - 1e-3 * (high - low));
        if (!step(middle, next, rate_next, error)) lost("cannot be moved on");
        const double f = least_rate(next);
        if (f < 0) {
          if (side == -1) f_low *= 0.5;
          high = middle;
          f_high = f;
          side = -1;
        } else {
          if (side == 1) f_high *= 0.5;
          low = middle;
          f_low = f;
          side = 1;
        }
        if (low == 0 && high < 1e-10) break;
      }
      if (!step(high, next, rate_next, error)) lost("cannot be moved on");
    }
    // A joint that breaks loose before that comes first. It starts with no acceleration, so bisection is exact enough.
    if (breaks_loose(now + high, next)) {
      double calm = 0, loose = high;
      while (loose - calm > 1e-3 * h && loose > 1e-9) {
        const double middle = 0.5 * (calm + loose);
        if (!step(middle, next, rate_next, error)) lost("cannot be moved on");
        (breaks_loose(now + middle, next) ? loose : calm) = middle;
      }
      high = loose;
      if (!step(high, next, rate_next, error)) lost("cannot be moved on");
    }
    accept(high, next);
    settle(true);
  }

  /// Joints that turn within rounding of rest count as stuck for a moment, whatever they carry.
  void hold_undecided() {
    if (terms_at(x, scratch) != Status::ok) lost("is in a pose that cannot be");
    for (int j = 0; j < joints; ++j) {
      if (!parts.laws[at(j)].minds_reversals() || std::abs(scratch.robot.rate(j)) > 1e-9) continue;
      if (direction[at(j)] != 0) note_bristle(j, scratch);
      direction[at(j)] = 0;
      held_until[at(j)] = now + kHoldUndecided;
      ++counts.undecided;
    }
    settle(false);
  }

  void accept(double h, const State& next) {
    if (any_stuck()) counts.stuck_s += h;
    x = next;
    now += h;
    ++counts.steps;
  }
  [[nodiscard]] bool any_stuck() const {
    for (int j = 0; j < joints; ++j) {
      if (stuck(j)) return true;
    }
    return false;
  }

  /// Joints at the end of their sliding are at rest; then all at rest are decided on together.
  void settle(bool arrivals) {
    if (terms_at(x, scratch) != Status::ok) lost("is in a pose that cannot be");
    if (arrivals) {
      for (int j = 0; j < joints; ++j) {
        if (!parts.laws[at(j)].minds_reversals() || direction[at(j)] == 0) continue;
        if (direction[at(j)] * scratch.robot.rate(j) <= 0) {
          note_bristle(j, scratch);
          direction[at(j)] = 0;
          ++counts.reversals;
        }
      }
    }
    hold_still(x);
    if (terms_at(x, scratch) != Status::ok) lost("is in a pose that cannot be");
    release(now, x, scratch, true);
    if (derivative(now, x, rate_now) != Status::ok) lost("is in a pose that cannot be");
  }

  void advance(double seconds) {
    const double end = now + seconds;
    State next, rate_next, error;
    int stalled = 0;
    while (end - now > kShortestStep) {
      double h = std::min({end - now, options.largest_step_s, step_size});
      if (end - now - h < 1e-9) h = end - now;
      const bool done = step(h, next, rate_next, error);
      const double size = done ? relative(error, next) : 1e6;
      if (!(size <= 1)) {
        ++counts.rejected_steps;
        step_size = h * std::clamp(0.9 * std::pow(size, -0.2), 0.1, 0.9);
        if (step_size < kShortestStep) lost(done ? "cannot be integrated on" : "leaves its reach or meets a singular pose");
        continue;
      }
      const double grown = h * std::clamp(0.9 * std::pow(std::max(size, 1e-8), -0.2), 0.2, 5.0);
      if (least_rate(next) < 0 || breaks_loose(now + h, next)) {
        const double before = now;
        go_to_event(h);
        // Rounding may leave a joint undecided between sticking and sliding, over and over: hold it for a moment.
        stalled = now - before < 1e-9 ? stalled + 1 : 0;
        if (stalled > kMostStalls) {
          hold_undecided();
          stalled = 0;
        }
        continue;
      }
      accept(h, next);
      rate_now = rate_next;
      if (hold_still(x) && derivative(now, x, rate_now) != Status::ok) lost("is in a pose that cannot be");
      step_size = std::max(grown, h < step_size ? step_size : grown);
      stalled = 0;
    }
    now = end;
  }

  struct Bristle {
    double state = 0, position = 0;
  };

  PlantOptions options;
  detail::PlantParts parts;
  int n = 0, joints = 0, soft = 0;
  std::vector<int> loop_joints, coordinate_of_drive;
  State x, rate_now;
  double now = 0, step_size = 1e-3;
  DriveVector tau_start, tau_end;
  double command_time = 0;
  std::vector<int> direction;  ///< +1, -1, 0 stuck; means nothing for joints that do not mind reversals
  std::vector<Bristle> bristle;
  std::vector<double> held_until;  ///< times before which a joint does not break loose
  PlantCounts counts;
  Terms scratch;
  Solution solution;
  bool inverse_begun = false;
  JointVector inverse_position;  ///< of the sample before, for effects with memory
  std::vector<Presliding<double>> inverse_bristle;
  std::vector<Hysteresis<double>> inverse_loop;
};

Plant::Plant(const RobotDescription& description, const std::vector<std::string>& names, const Eigen::VectorXd& p,
             const std::vector<Effect>& effects, const PlantOptions& options)
    : impl_(std::make_unique<Impl>(description, names, p, effects, options)) {
  if (!(options.tolerance > 0 && options.tolerance <= 1e-3) || !(options.largest_step_s > 0) || !(options.current_lag_s >= 0)) {
    throw Error("options of the simulation are out of range", "",
                "give a tolerance between 0 and 1e-3 and times that are not negative", ExitCode::usage);
  }
}
Plant::~Plant() = default;
Plant::Plant(Plant&&) noexcept = default;

bool Plant::takes(EffectId id) {
  return detail::plant_takes(id);
}

void Plant::start(const DriveVector& q, const DriveVector& qd) {
  Impl& m = *impl_;
  const int c = m.coordinates();
  MechanismTerms terms;
  if (q.size() != m.n || qd.size() != m.n || m.parts.mechanism->evaluate(q, qd, terms) != Status::ok) {
    throw Error("the simulation cannot start where the motion starts: the pose is out of reach or singular", "simulation",
                "check that the trajectory belongs to this robot");
  }
  m.now = m.command_time = 0;
  m.counts = {};
  std::fill(m.held_until.begin(), m.held_until.end(), -1.0);
  m.x.setZero(m.size());
  m.x.head(m.n) = q;
  m.x.segment(c, m.n) = qd;
  for (int e = 0; e < m.soft; ++e) {
    // A spring that already carries the weight does not ring.
    const detail::SoftDrive& spring = m.parts.soft[Impl::at(e)];
    const double load = terms.bias(spring.drive);
    const double lead = load / spring.stiffness + (load > 0 ? 0.5 : -0.5) * spring.gap;
    m.x(m.n + e) = q(spring.drive);
    if (spring.encoder_on_motor)
      m.x(spring.drive) -= lead;
    else
      m.x(m.n + e) += lead;
    m.x(c + m.n + e) = qd(spring.drive);
  }
  Impl::Terms all;
  if (m.terms_at(m.x, all) != Status::ok) {
    throw Error("the mass matrix of the plant is not positive definite", "simulation",
                "the parameters are not physically consistent; look at masses and inertias");
  }
  for (int j = 0; j < m.joints; ++j) {
    const double rate = all.robot.rate(j);
    const int sense = rate > 1e-12 ? 1 : (rate < -1e-12 ? -1 : 0);
    m.direction[Impl::at(j)] = sense;
    m.bristle[Impl::at(j)] = {static_cast<double>(sense), all.robot.position(j)};
  }
  m.tau_start.setZero(m.n);
  m.tau_end.setZero(m.n);
  m.step_size = 1e-3;
  m.inverse_begun = false;
  m.settle(false);
}

void Plant::command(const DriveVector& tau) {
  Impl& m = *impl_;
  if (m.options.current_lag_s > 0 && (m.now > 0 || m.command_time > 0))
    m.tau_start = torque();
  else
    m.tau_start = tau;
  m.tau_end = tau;
  m.command_time = m.now;
  m.settle(false);
}

void Plant::advance(double seconds) {
  impl_->advance(seconds);
}

double Plant::time() const {
  return impl_->now;
}

DriveVector Plant::q() const {
  const Impl& m = *impl_;
  DriveVector q = m.x.head(m.n);
  for (int e = 0; e < m.soft; ++e) {
    if (m.parts.soft[Impl::at(e)].encoder_on_motor) q(m.parts.soft[Impl::at(e)].drive) = m.x(m.n + e);
  }
  return q;
}

DriveVector Plant::qd() const {
  const Impl& m = *impl_;
  DriveVector qd = m.x.segment(m.coordinates(), m.n);
  for (int e = 0; e < m.soft; ++e) {
    if (m.parts.soft[Impl::at(e)].encoder_on_motor) qd(m.parts.soft[Impl::at(e)].drive) = m.x(m.coordinates() + m.n + e);
  }
  return qd;
}

DriveVector Plant::qdd() const {
  const Impl& m = *impl_;
  DriveVector qdd = m.rate_now.segment(m.coordinates(), m.n);
  for (int e = 0; e < m.soft; ++e) {
    if (m.parts.soft[Impl::at(e)].encoder_on_motor) {
      qdd(m.parts.soft[Impl::at(e)].drive) = m.rate_now(m.coordinates() + m.n + e);
    }
  }
  return qdd;
}

DriveVector Plant::torque() const {
  DriveVector tau(impl_->n);
  for (int j = 0; j < impl_->n; ++j) tau(j) = impl_->torque_at(j, impl_->now);
  return tau;
}

std::vector<int> Plant::directions() const {
  const Impl& m = *impl_;
  std::vector<int> all;
  for (int j = 0; j < m.joints; ++j) all.push_back(m.direction[Impl::at(j)]);
  return all;
}

const PlantCounts& Plant::counts() const {
  return impl_->counts;
}
double Plant::work() const {
  return impl_->x(impl_->size() - 2);
}
double Plant::losses() const {
  return impl_->x(impl_->size() - 1);
}

double Plant::energy() const {
  const Impl& m = *impl_;
  Impl::Terms terms;
  double energy = 0;
  if (m.terms_at(m.x, terms) != Status::ok) return std::nan("");
  if (m.parts.mechanism->potential_energy(m.x.head(m.n), energy) != Status::ok) return std::nan("");
  const Coordinates yd = m.x.segment(m.coordinates(), m.coordinates());
  energy += 0.5 * yd.dot(terms.M * yd);
  for (int e = 0; e < m.soft; ++e) {
    const detail::SoftDrive& spring = m.parts.soft[Impl::at(e)];
    energy += spring.energy(m.x(m.n + e) - m.x(spring.drive));
  }
  return energy;
}

DriveVector Plant::inverse(double time, const DriveVector& q, const DriveVector& qd, const DriveVector& qdd) {
  Impl& m = *impl_;
  if (m.soft > 0) {
    throw Error("a spring or play in a drive has no torque that a given motion takes", "simulation",
                "simulate in closed loop, without --inverse", ExitCode::usage);
  }
  State state = State::Zero(m.size());
  state.head(m.n) = q;
  state.segment(m.coordinates(), m.n) = qd;
  Impl::Terms terms;
  if (m.terms_at(state, terms) != Status::ok) {
    throw Error(fmt::format("at {:.4f} s the motion is out of reach or in a singular pose", time), "simulation",
                "check that the trajectory belongs to this robot");
  }
  const int bar = m.parts.mechanism->telescope_joint();
  if (!m.inverse_begun) {
    m.inverse_begun = true;
    m.inverse_bristle.clear();
    m.inverse_loop.clear();
    for (int j = 0; j < m.joints; ++j) {
      const double displacement = m.parts.laws[Impl::at(j)].bristle_displacement();
      const double rate = terms.robot.rate(j);
      m.inverse_bristle.emplace_back(displacement > 0 ? displacement : 1.0, rate > 0 ? 1.0 : (rate < 0 ? -1.0 : 0.0));
      const auto shape = m.parts.laws[Impl::at(j)].loop_shape();
      m.inverse_loop.emplace_back(shape);
    }
  } else {
    for (int j = 0; j < m.joints; ++j) {
      const double step = terms.robot.position(j) - m.inverse_position(j);
      m.inverse_bristle[Impl::at(j)].move(step);
      m.inverse_loop[Impl::at(j)].move(step);
    }
  }
  m.inverse_position = terms.robot.position;
  const Eigen::Vector3d a = terms.robot.a_bias + terms.robot.J_r * qdd;
  const double side_load = bar >= 0 ? telescope_side_load<double>(1.0, terms.robot.bar, a, m.parts.gravity) : 0.0;
  DriveVector load = terms.robot.M * qdd - terms.force.head(m.n);
  std::vector<JointMotion> motions;
  for (int j = 0; j < m.joints; ++j) {
    JointMotion motion;
    motion.rate = terms.robot.rate(j);
    motion.direction = motion.rate > 0 ? 1 : (motion.rate < 0 ? -1 : 0);
    motion.position = terms.robot.position(j);
    motion.time = time;
    motion.side_load = side_load;
    motion.bristle = m.inverse_bristle[Impl::at(j)].state();
    motion.loop = m.inverse_loop[Impl::at(j)].state();
    if (j >= m.n) load += terms.robot.J.row(j).transpose() * m.parts.laws[Impl::at(j)].required(0, motion);
    motions.push_back(motion);
  }
  DriveVector tau(m.n);
  for (int j = 0; j < m.n; ++j) tau(j) = m.parts.laws[Impl::at(j)].required(load(j), motions[Impl::at(j)]);
  return tau;
}

}  // namespace deltadyn
