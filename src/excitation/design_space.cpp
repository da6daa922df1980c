#include "deltadyn/excitation/design_space.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <random>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/random.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kTriesPerState = 400;  // before the limits count as leaving nothing
constexpr int kTriesPerPlace = 100000;
constexpr int kFewest = 50;         // states that a design can start from
constexpr int kEarlyTries = 20000;  // after which fewer than that are a hopeless case,
constexpr int kFewOfEarly = 1000;   // and fewer than these a reason to look at slower states

class StateDraw {
 public:
  StateDraw(const Robot& robot, const MotionLimits& limits, std::uint64_t seed)
      : robot_(robot), limits_(limits), random_(seed), n_(robot.drives()), z_(n_), q_(n_), qd_(n_), qdd_(n_) {}

  /// From now on all rates of a state are made smaller by a factor of its own, velocities less than accelerations.
  void slow_down() { slow_ = true; }

  /// False if the pose is out of reach. Throws if the workspace seems to hold no pose that the limits allow.
  bool next(VectorXd& x) {
    VectorXd zd(n_), zdd(n_);
    int tries = 0;
    do {
      if (++tries > kTriesPerPlace) {
        throw Error(
            fmt::format("of {} random places in the ranges of the task coordinates none lies in the workspace ({})",
                        kTriesPerPlace, limits_.region->text()),
            "limits", "widen these ranges or move the workspace into them", ExitCode::bad_input);
      }
      draw_state(zd, zdd);
    } while (has_plate() && !limits_.region->contains(z_.head<3>()));
    if (robot_.inverse_kinematics(z_, q_) != Status::ok) return false;
    TaskState task;
    if (robot_.to_task(q_, qd_, qdd_, task) != Status::ok) return false;
    x.resize(3 * n_);
    for (int i = 0; i < n_; ++i) {
      x(i) = z_(i);
      x(n_ + i) = std::isfinite(limits_.zd(i)) ? zd(i) : task.zd(i);
      x(2 * n_ + i) = std::isfinite(limits_.zdd(i)) ? zdd(i) : task.zdd(i);
    }
    if (slow_) {
      const double share = uniform(0, 1);
      x.segment(n_, n_) *= share;
      x.tail(n_) *= share * share;
    }
    return true;
  }

 private:
  [[nodiscard]] bool has_plate() const { return !robot_.description().parts.empty(); }
  void draw_state(VectorXd& zd, VectorXd& zdd) {
    for (int i = 0; i < n_; ++i) {
      double lower = limits_.z_lower(i), upper = limits_.z_upper(i);
      if (has_plate() && i < 3) {
        lower = std::max(lower, limits_.region->lower()(i));
        upper = std::min(upper, limits_.region->upper()(i));
      } else if (!robot_.description().plate) {  // else the yaw is no drive's
        lower = std::max(lower, limits_.q_lower(i));
        upper = std::min(upper, limits_.q_upper(i));
      }
      z_(i) = uniform(lower, upper);
    }
    for (int i = 0; i < n_; ++i) {
      qd_(i) = draw(limits_.qd(i));
      qdd_(i) = draw(limits_.qdd(i));
    }
    for (int i = 0; i < n_; ++i) {
      zd(i) = draw(limits_.zd(i));
      zdd(i) = draw(limits_.zdd(i));
    }
  }
  double uniform(double lower, double upper) { return lower + (upper - lower) * unit_of_53_bits(random_); }
  double draw(double limit) {
    const double share = uniform(-1, 1);
    return std::isfinite(limit) ? share * limit : 0.0;
  }

  const Robot& robot_;
  const MotionLimits& limits_;
  std::mt19937_64 random_;
  int n_;
  bool slow_ = false;
  VectorXd z_, q_, qd_, qdd_;
};

}  // namespace

AdmissibleStates admissible_states(const Robot& robot, const TaskRegressor& regressor, const MotionLimits& limits,
                                   int count, std::uint64_t seed) {
  limits.validate(robot.description());
  const std::vector<Limit> list = limits.list(robot.description());
  const int n = robot.drives();
  AdmissibleStates states;
  states.x.resize(3 * n, count);
  StateDraw draw(robot, limits, seed);
  LimitedState state;
  state.drives.resize(3 * n);
  Eigen::MatrixXd Y(n, robot.parameters());
  std::vector<int> broken(list.size(), 0);
  int found = 0, unreachable = 0;
  LimitedState rest;
  rest.drives.resize(3 * n);
  double best_room = -std::numeric_limits<double>::infinity();
  // Torque to hold a pose and to begin to move in any direction: Coulomb friction comes with the slightest rate.
  const auto load_at_rest = [&](const VectorXd& z) {
    constexpr double kSlight = 1e-9;
    double load = 0;
    for (unsigned directions = 0; directions < (1U << static_cast<unsigned>(n)); ++directions) {
      rest.x = VectorXd::Zero(3 * n);
      rest.x.head(n) = z;
      for (int i = 0; i < n; ++i)
        rest.x(n + i) = (directions >> static_cast<unsigned>(i)) % 2 == 0 ? kSlight : -kSlight;
      if (regressor.evaluate(rest.x, VectorXd(), Y, rest.drives) != Status::ok)
        return std::numeric_limits<double>::infinity();
      rest.tau = Y * limits.parameters;
      for (const Limit& limit : list)
        if (limit.quantity == LimitedQuantity::tau)
          load = std::max(load, limit_load(limit, usage_of(limit, limited_value(limit, limits, rest))));
      if (1 - load <= best_room) break;
    }
    return load;
  };
  while (found < count && states.drawn < kTriesPerState * count) {
    if (states.drawn == kEarlyTries && found < kFewOfEarly) {
      if (best_room > 0) {
        draw.slow_down();  // a pose holds itself, so that slow motions are allowed
      } else if (found < kFewest) {
        break;
      }
    }
    ++states.drawn;
    if (!draw.next(state.x) || regressor.evaluate(state.x, VectorXd(), Y, state.drives) != Status::ok) {
      ++unreachable;
      continue;
    }
    if (limits.parameters.size() > 0) state.tau = Y * limits.parameters;
    bool allowed = true, pose_allowed = true;
    double pose_load = 0;
    for (std::size_t k = 0; k < list.size(); ++k) {
      const double load = limit_load(list[k], usage_of(list[k], limited_value(list[k], limits, state)));
      const bool of_pose = list[k].quantity == LimitedQuantity::region || list[k].quantity == LimitedQuantity::z ||
                           list[k].quantity == LimitedQuantity::q;
      if (of_pose) pose_load = std::max(pose_load, load);
      if (load <= 1) continue;
      ++broken[k];
      allowed = false;
      pose_allowed = pose_allowed && !of_pose;
    }
    if (allowed) states.x.col(found++) = state.x;
    if (!pose_allowed) continue;
    // At rest nothing but gravity loads the drives. A motion shrinks towards the centre, which should hold itself.
    if (1 - pose_load > best_room && limits.parameters.size() > 0)
      pose_load = std::max(pose_load, load_at_rest(state.x.head(n)));
    if (1 - pose_load > best_room) {
      best_room = 1 - pose_load;
      states.centre = state.x.head(n);
    }
  }
  if (found < std::min(count, kFewest)) {
    const double total = states.drawn;
    if (unreachable > 0.9 * total)
      throw Error(fmt::format("the robot reaches only {:.1f} % of the workspace ({})", 100 - 100 * unreachable / total,
                              limits.region ? limits.region->text() : "range of the drive"),
                  "workspace", "move the workspace into the reach of the robot (delta-model info shows it)",
                  ExitCode::bad_input);
    const auto worst = static_cast<std::size_t>(std::ranges::max_element(broken) - broken.begin());
    throw Error(fmt::format("the limits leave no motion: of {} random states {} are allowed, and {} break the limit "
                            "'{}' ({:.6g} to {:.6g} {})",
                            states.drawn, found, broken[worst], list[worst].name, list[worst].lower, list[worst].upper,
                            list[worst].unit),
                "limits", "widen this limit or move the workspace", ExitCode::bad_input);
  }
  states.x.conservativeResize(Eigen::NoChange, found);
  return states;
}

Status DesignSpace::weighted_columns(const Eigen::Ref<const VectorXd>& x, Eigen::Ref<Eigen::MatrixXd> A) const {
  Eigen::MatrixXd Y(regressor->drives(), regressor->parameters());
  VectorXd drives(3 * regressor->drives());
  const Status status = regressor->evaluate(x, VectorXd(), Y, drives);
  if (status != Status::ok) return status;
  for (std::size_t k = 0; k < base_columns.size(); ++k) {
    const auto at = static_cast<Index>(k);
    A.col(at) = Y.col(base_columns[k]).cwiseQuotient(torque_scale) / column_scale(at);
  }
  return Status::ok;
}

double DesignSpace::log_det_of_scales() const {
  return 2 * column_scale.array().log().sum();
}

DesignSpace make_design_space(const Robot& robot, const MotionLimits& limits, const std::vector<int>& base_columns,
                              const VectorXd& torque_scale, int states, std::uint64_t seed) {
  const int n = robot.drives();
  if (torque_scale.size() != n || !(torque_scale.minCoeff() > 0) || !torque_scale.allFinite())
    throw Error("the torque scale needs one positive number a drive", "", fmt::format("give {} numbers", n),
                ExitCode::usage);
  if (base_columns.empty()) throw Error("no base parameters were given", "", "", ExitCode::usage);
  DesignSpace space;
  space.robot = &robot;
  space.regressor = make_task_regressor(robot);
  space.base_columns = base_columns;
  space.torque_scale = torque_scale;
  space.states = admissible_states(robot, *space.regressor, limits, states, seed);

  const Index count = space.states.x.cols();
  const auto spread = [&](Index first) -> VectorXd {
    const Eigen::MatrixXd block = space.states.x.middleRows(first, n);
    const VectorXd mean = block.rowwise().mean();
    const VectorXd variance = (block.colwise() - mean).rowwise().squaredNorm() / static_cast<double>(count);
    return (3 * variance).cwiseSqrt();  // half the width, if uniform
  };
  space.coordinate_scale = spread(0);
  space.rate_scale = spread(n);
  space.acceleration_scale = spread(2 * n);

  const auto p = static_cast<Index>(base_columns.size());
  space.column_scale = VectorXd::Ones(p);
  VectorXd squares = VectorXd::Zero(p);
  Eigen::MatrixXd A(n, p);
  for (Index k = 0; k < count; ++k) {
    if (space.weighted_columns(space.states.x.col(k), A) != Status::ok) continue;
    squares += A.colwise().squaredNorm().transpose();
  }
  space.column_scale = (squares / static_cast<double>(count)).cwiseSqrt().cwiseMax(1e-12);
  return space;
}

}  // namespace deltadyn
