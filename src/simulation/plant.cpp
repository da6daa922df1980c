#include "deltadyn/simulation/plant.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/simulation/dormand_prince.hpp"

#include "plant_dynamics.hpp"

namespace deltadyn {
namespace {

using detail::State;

constexpr double kShortestStep = 1e-13;  // [s]
constexpr double kLongestStep = 2e-3;    // [s]
constexpr int kMostStalls = 20;          // events within a nanosecond of one another
constexpr double kHoldUndecided = 1e-4;  // [s]

}  // namespace

struct Plant::Impl : detail::JointDynamics {
  Impl(const RobotDescription& description, const std::vector<std::string>& names, const Eigen::VectorXd& p,
       const std::vector<Effect>& effects, const PlantOptions& given)
      : JointDynamics(description, names, p, effects, given) {
    x.setZero(size());
  }

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
    const auto system = [this](double t, const State& state, State& rate) {
      return derivative(t, state, rate) == Status::ok;
    };
    return dormand_prince_step(system, now, h, x, rate_now, next, rate_next, error);
  }

  [[nodiscard]] double relative(const State& error, const State& next) const {
    double worst = 0;
    for (int k = 0; k < 2 * coordinates(); ++k) {
      const double scale = options.tolerance * std::max({1.0, std::abs(x(k)), std::abs(next(k))});
      worst = std::max(worst, std::abs(error(k)) / scale);
    }
    return worst;
  }

  [[noreturn]] void lost(const char* how) const {
    throw Error(
        fmt::format("at {:.4f} s the robot {}", now, how), "simulation",
        "check that trajectory, parameters and robot file belong together; a lower --bandwidth-hz steadies a loop that "
        "is unstable",
        ExitCode::no_convergence);
  }

  /// First instant in (0, h] at which a sliding joint reverses or a stuck one breaks loose; x, the time and the rates
  /// move there.
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
      if (direction[at(j)] != 0) note_turn(j, scratch);
      direction[at(j)] = 0;
      held_until[at(j)] = now + kHoldUndecided;
    }
    settle(false);
  }

  void accept(double h, const State& next) {
    if (any_stuck()) counts.stuck_s += h;
    x = next;
    now += h;
    ++counts.steps;
  }
  /// Joints at the end of their sliding are at rest; then all at rest are decided on together.
  void settle(bool arrivals) {
    if (terms_at(x, scratch) != Status::ok) lost("is in a pose that cannot be");
    if (arrivals) {
      for (int j = 0; j < joints; ++j) {
        if (!parts.laws[at(j)].minds_reversals() || direction[at(j)] == 0) continue;
        if (direction[at(j)] * scratch.robot.rate(j) <= 0) {
          note_turn(j, scratch);
          direction[at(j)] = 0;
          ++counts.reversals;
        }
      }
    }
    hold_still(x);
    if (terms_at(x, scratch) != Status::ok) lost("is in a pose that cannot be");
    release(now, scratch, true);
    if (derivative(now, x, rate_now) != Status::ok) lost("is in a pose that cannot be");
  }

  void advance(double seconds) {
    const double end = now + seconds;
    State next, rate_next, error;
    int stalled = 0;
    while (end - now > kShortestStep) {
      double h = std::min({end - now, kLongestStep, step_size});
      if (end - now - h < 1e-9) h = end - now;
      const bool done = step(h, next, rate_next, error);
      const double size = done ? relative(error, next) : 1e6;
      if (!(size <= 1)) {
        step_size = h * std::clamp(0.9 * std::pow(size, -0.2), 0.1, 0.9);
        if (step_size < kShortestStep)
          lost(done ? "cannot be integrated on" : "leaves its reach or meets a singular pose");
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

  /// Of the coordinates that begin at `first`, those of the drives on the side where their encoders sit.
  [[nodiscard]] DriveVector at_encoders(const State& all, int first) const {
    DriveVector drives = all.segment(first, n);
    for (int e = 0; e < soft; ++e) {
      if (parts.soft[at(e)].encoder_on_motor) drives(parts.soft[at(e)].drive) = all(first + n + e);
    }
    return drives;
  }

  State x, rate_now;
  double now = 0, step_size = 1e-3;
  bool inverse_begun = false;
  std::vector<Turn> inverse_memory;  ///< at the sample before
};

Plant::Plant(const RobotDescription& description, const std::vector<std::string>& names, const Eigen::VectorXd& p,
             const std::vector<Effect>& effects, const PlantOptions& options)
    : impl_(std::make_unique<Impl>(description, names, p, effects, options)) {
  if (!(options.tolerance > 0 && options.tolerance <= 1e-3) || !(options.current_lag_s >= 0)) {
    throw Error("options of the simulation are out of range", "",
                "give a tolerance between 0 and 1e-3 and times that are not negative", ExitCode::usage);
  }
}
Plant::~Plant() = default;
Plant::Plant(Plant&&) noexcept = default;

void Plant::start(const DriveVector& q, const DriveVector& qd) {
  Impl& m = *impl_;
  const int c = m.coordinates();
  MechanismTerms terms;
  if (q.size() != m.n || qd.size() != m.n || m.parts.mechanism->evaluate(q, qd, terms) != Status::ok) {
    throw Error("the simulation cannot start where the motion starts: the pose is out of reach or singular",
                "simulation", "check that the trajectory belongs to this robot");
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
    if (m.soft > 0) {
      throw Error(fmt::format("too little inertia is left behind the spring or play of drive {}",
                              m.parts.soft.front().drive + 1),
                  "simulation", "give play a larger share of the load (0.3 or more)", ExitCode::usage);
    }
    throw Error("the mass matrix of the plant is not positive definite", "simulation",
                "the parameters are not physically consistent; look at masses and inertias");
  }
  for (int j = 0; j < m.joints; ++j) {
    const double rate = all.robot.rate(j);
    const int sense = rate > 1e-12 ? 1 : (rate < -1e-12 ? -1 : 0);
    m.direction[Impl::at(j)] = sense;
    m.turned[Impl::at(j)] = {m.parts.laws[Impl::at(j)].start(sense), all.robot.position(j)};
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
  return impl_->at_encoders(impl_->x, 0);
}
DriveVector Plant::qd() const {
  return impl_->at_encoders(impl_->x, impl_->coordinates());
}
DriveVector Plant::qdd() const {
  return impl_->at_encoders(impl_->rate_now, impl_->coordinates());
}

DriveVector Plant::torque() const {
  DriveVector tau(impl_->n);
  for (int j = 0; j < impl_->n; ++j) tau(j) = impl_->torque_at(j, impl_->now);
  return tau;
}

std::vector<int> Plant::directions() const {
  return impl_->direction;
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
  const detail::Coordinates yd = m.x.segment(m.coordinates(), m.coordinates());
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
    throw Error(
        fmt::format(
            "drive {} has a spring or play: the motor's motion then needs derivatives of the arm's motion that a "
            "trajectory does not have, or has jumps",
            m.parts.soft.front().drive + 1),
        "--inverse", "simulate in closed loop, without --inverse", ExitCode::usage);
  }
  State state = State::Zero(m.size());
  state.head(m.n) = q;
  state.segment(m.coordinates(), m.n) = qd;
  Impl::Terms terms;
  if (m.terms_at(state, terms) != Status::ok) {
    throw Error(fmt::format("at {:.4f} s the motion is out of reach or in a singular pose", time), "simulation",
                "check that the trajectory belongs to this robot");
  }
  const int bar = m.parts.mechanism->inner_joint();
  const auto sense = [&terms](int j) { return terms.robot.rate(j) > 0 ? 1 : (terms.robot.rate(j) < 0 ? -1 : 0); };
  m.inverse_memory.resize(Impl::at(m.joints));
  for (int j = 0; j < m.joints; ++j) {
    const FrictionLaw& law = m.parts.laws[Impl::at(j)];
    auto& before = m.inverse_memory[Impl::at(j)];
    const double position = terms.robot.position(j);
    before = {m.inverse_begun ? law.moved(before.memory, position - before.position) : law.start(sense(j)), position};
  }
  m.inverse_begun = true;
  const Eigen::Vector3d a = terms.robot.a_bias + terms.robot.J_r * qdd;
  const double across = bar >= 0 ? side_load<double>(terms.robot.bar, a, m.parts.gravity) : 0.0;
  DriveVector load = terms.robot.M * qdd - terms.force.head(m.n);
  std::vector<JointMotion> motions;
  for (int j = 0; j < m.joints; ++j) {
    motions.push_back({.rate = terms.robot.rate(j),
                       .direction = sense(j),
                       .position = terms.robot.position(j),
                       .time = time,
                       .side_load = across,
                       .memory = m.inverse_memory[Impl::at(j)].memory});
    if (j >= m.n) load += terms.robot.J.row(j).transpose() * m.parts.laws[Impl::at(j)].required(0, motions.back());
  }
  DriveVector tau(m.n);
  for (int j = 0; j < m.n; ++j) tau(j) = m.parts.laws[Impl::at(j)].required(load(j), motions[Impl::at(j)]);
  return tau;
}

}  // namespace deltadyn
