#pragma once

/// \file
/// Reference motions of the drawn robots: random Fourier paths, and pick and place.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "deltadyn/runtime/workspace.hpp"

#include "studies/drawn_machine.hpp"

namespace deltadyn::blind {

using Path = std::function<TaskState(double t)>;

/// What the three logs hold.
enum class MotionKind {
  fourier,  ///< random Fourier paths
  pick,     ///< pick and place in all logs
  mixed     ///< Fourier paths to train on, pick and place held out
};

inline const char* motion_name(MotionKind kind) {
  return kind == MotionKind::fourier ? "fourier" : kind == MotionKind::pick ? "pick" : "mixed";
}

/// Room of each task coordinate to either side of home [m | rad].
inline Eigen::VectorXd room_of(const Machine& m, double share) {
  const int n = m.robot.drives();
  Eigen::VectorXd room(n);
  if (!m.plate()) {
    room(0) = m.turns(0) ? 1.0 : 0.25;
    return share * room;
  }
  const bool carriages = m.robot.drive_kind == DriveKind::prismatic;
  for (int i = 0; i < n; ++i) {
    const double yaw = m.robot.plate ? 0.4 * share * m.robot.plate_yaw_range() : 5.0;
    room(i) = i == 3 ? yaw : m.length * (carriages ? (i < 2 ? 0.20 : 0.14) : (i < 2 ? 0.30 : 0.17));
  }
  room.head(3) *= share;  // a tool turns as far as it likes
  return room;
}

struct PathOptions {
  double share = 1;  ///< of the room
  double base_hz = 0.3;
  double size = 1;     ///< of the Fourier path
  int harmonics = 5;   ///< 0.1 to 0.3 Hz: more shake a spring
  double cycle_s = 0;  ///< of pick and place; 0: a Fourier path
  std::uint64_t seed = 1;
};

inline Path fourier_path(const Machine& m, const PathOptions& o) {
  Random random(o.seed);
  const int n = m.robot.drives();
  const Eigen::VectorXd room = room_of(m, o.share);
  Eigen::MatrixXd a(n, 2 * o.harmonics);
  for (int k = 0; k < a.size(); ++k) a(k) = between(random, -1, 1);
  const double home = m.home_z;
  return [=](double t) {
    TaskState s;
    s.z = s.zd = s.zdd = Eigen::VectorXd::Zero(n);
    for (int h = 1; h <= o.harmonics; ++h) {
      const double w = 2 * kPi * o.base_hz * h, c = 0.6 * o.size / std::sqrt(h);
      const Eigen::VectorXd A = c * room.cwiseProduct(a.col(2 * h - 2)), B = c * room.cwiseProduct(a.col(2 * h - 1));
      s.z += A * std::sin(w * t) + B * (std::cos(w * t) - 1);
      s.zd += w * (A * std::cos(w * t) - B * std::sin(w * t));
      s.zdd -= w * w * (A * std::sin(w * t) + B * std::cos(w * t));
    }
    if (n > 2) s.z(2) += home;
    return s;
  };
}

/// Smooth step from 0 to 1 over [begin, end] with its two derivatives; jerk is steady, too.
inline Eigen::Vector3d smooth_step(double t, double begin, double end) {
  const double T = end - begin, u = std::clamp((t - begin) / T, 0.0, 1.0), u2 = u * u, u3 = u2 * u;
  return {u2 * u2 * (35 + u * (-84 + u * (70 - 20 * u))), 140 * u3 * std::pow(1 - u, 3) / T,
          420 * u2 * (1 - u) * (1 - u) * (1 - 2 * u) / (T * T)};
}

/// Lift, carry over, lower, wait a moment; then to the next place.
inline Path pick_path(const Machine& m, const PathOptions& o) {
  Random random(o.seed);
  const int n = m.robot.drives();
  const Eigen::VectorXd room = room_of(m, o.share);
  std::vector<Eigen::VectorXd> places;
  std::vector<double> wait;
  for (int k = 0; k < 200; ++k) {
    Eigen::VectorXd place(n);
    for (int i = 0; i < n; ++i) place(i) = room(i) * (i == 3 && !m.robot.plate ? 0.25 : 1.0) * between(random, -1, 1);
    if (n > 2) place(2) = room(2) * between(random, -1.0, -0.3);
    places.push_back(place);
    wait.push_back(o.cycle_s * between(random, 0.05, 0.3));
  }
  const double home = m.home_z, T = o.cycle_s, lift = n > 2 ? 1.3 * room(2) : 0;
  return [=](double t) {
    const double since = t + 2;  // a path before the record begins, too
    std::size_t k = 0;
    double begin = 0;
    while (k + 2 < places.size() && begin + T + wait[k] <= since) begin += T + wait[k++];
    const double at = since - begin;
    const Eigen::VectorXd way = places[k + 1] - places[k];
    const Eigen::Vector3d over = n > 2 ? smooth_step(at, 0.15 * T, 0.85 * T) : smooth_step(at, 0, T);
    TaskState s;
    s.z = places[k] + over(0) * way;
    s.zd = over(1) * way;
    s.zdd = over(2) * way;
    if (n > 2) {
      const Eigen::Vector3d high = lift * (smooth_step(at, 0, 0.45 * T) - smooth_step(at, 0.55 * T, T));
      s.z(2) += home + high(0);
      s.zd(2) += high(1);
      s.zdd(2) += high(2);
    }
    return s;
  };
}

inline Path path_of(const Machine& m, const PathOptions& o) {
  return o.cycle_s > 0 ? pick_path(m, o) : fourier_path(m, o);
}

/// Is the path in reach of the drawn and of the built robot, far from singular poses and from where drives end?
inline bool in_reach(const Machine& m, const Path& path, double duration_s) {
  const auto robot = make_robot(m.robot, m.layout);
  const int n = m.robot.drives();
  Eigen::VectorXd q(n), qd(n), qdd(n);
  Eigen::MatrixXd J(n, n);
  for (double t = -1; t < duration_s + 0.1; t += 0.02) {
    if (robot->to_drives(path(t), q, qd, qdd) != Status::ok) return false;
    if (!m.plate()) continue;
    for (int j = 0; j < m.limbs(); ++j) {
      if (m.turns(j) && (q(j) < -0.8 || q(j) > 1.4)) return false;
    }
    if (robot->jacobian(q, J) != Status::ok) return false;
    if (plate_condition(m.robot, J) > (m.robot.plate ? 9 : 5)) return false;
  }
  return true;
}

/// Speed, range, torque and inertia of every drive on a path.
inline void measure_scales(Machine& m, const Path& path, double duration_s) {
  const auto robot = make_robot(m.robot, m.layout);
  const int n = m.robot.drives();
  Eigen::VectorXd q(n), qd(n), qdd(n), tau(n), low = Eigen::VectorXd::Constant(n, 1e9), high = -low;
  Eigen::VectorXd square = Eigen::VectorXd::Zero(n), speed = square;
  Eigen::MatrixXd M(n, n);
  int count = 0;
  for (double t = 0; t < duration_s; t += 0.01, ++count) {
    if (robot->to_drives(path(t), q, qd, qdd) != Status::ok) return;
    if (robot->inverse_dynamics(q, qd, qdd, m.parameters, tau) != Status::ok) return;
    if (count == 0 && robot->mass_matrix(q, m.parameters, M) != Status::ok) return;
    low = low.cwiseMin(q);
    high = high.cwiseMax(q);
    speed = speed.cwiseMax(qd.cwiseAbs());
    square += tau.cwiseAbs2();
  }
  m.scale.clear();
  for (int j = 0; j < n; ++j) {
    m.scale.push_back({speed(j), high(j) - low(j), std::sqrt(square(j) / count), 0, M(j, j)});
  }
}

}  // namespace deltadyn::blind
