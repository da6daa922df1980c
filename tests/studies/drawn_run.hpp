#pragma once

/// \file
/// One log of a drawn machine: its motion under a controller, integrated, and recorded.

#include "deltadyn/signal/log.hpp"

#include "studies/drawn_plant.hpp"

namespace deltadyn::blind {

class DrawnRun {
 public:
  DrawnRun(const DrawnCase& drawn, int log)
      : case_(drawn),
        log_(log),
        n_(drawn.machine.robot.drives()),
        model_(make_robot(drawn.machine.robot, drawn.machine.layout)),
        built_(build_machine(drawn.machine, drawn.hidden, log, true)) {
    for (const Hidden& one : drawn.hidden) {
      memory_ += one.memory_size;
      lag_ = std::max(lag_, one.motor_lag_s);
    }
    for (int j = 0; j < n_; ++j) {
      const auto at = static_cast<std::size_t>(j);
      bristle_.push_back(dirty() ? BristleWay(drawn.machine.dirt.bristles[at], 0.0) : BristleWay());
    }
  }

  /// Positions and torque as the machine has them, before sensors. False: the plant left its workspace.
  [[nodiscard]] bool record(Log& log) {
    if (!begin()) return false;
    const double every = std::min(5e-4, 1 / case_.rate_hz);  // of the controller
    const int per_sample = static_cast<int>(std::lround(1 / case_.rate_hz / every));
    const int lead = static_cast<int>(std::lround(0.5 / every));  // half a second to settle
    const int samples = static_cast<int>(std::lround(case_.duration_s * case_.rate_hz));
    log.t_s = Eigen::VectorXd::LinSpaced(samples, 0, (samples - 1) / case_.rate_hz);
    log.q.resize(samples, n_);
    log.tau.resize(samples, n_);
    const double pass = case_.machine.dirt.current_filter_s;
    Eigen::VectorXd current = command_, before = command_;
    for (int k = -lead; k < samples * per_sample; ++k) {
      if (!control(k * every)) return false;
      if (k == -lead) current = before = command_;
      if (k >= 0 && k % per_sample == 0) {
        log.q.row(k / per_sample) = measured().head(n_).transpose();
        // The command holds over a period: it belongs to the middle of it.
        log.tau.row(k / per_sample) = (pass > 0 ? current : Eigen::VectorXd(0.5 * (command_ + before))).transpose();
      }
      before = command_;
      if (!advance(k * every, every)) return false;
      if (pass > 0) current += (1 - std::exp(-every / pass)) * (command_ - current);
    }
    return log.q.allFinite() && log.tau.allFinite();
  }

 private:
  using Vector = Eigen::VectorXd;

  [[nodiscard]] bool dirty() const { return case_.machine.dirt.any(); }
  [[nodiscard]] Eigen::Index at_spring() const { return 2 * n_ + memory_; }

  [[nodiscard]] bool begin() {
    Vector q(n_), qd(n_), qdd(n_), feed(n_);
    constexpr double kStart = -0.5;
    if (model_->to_drives(case_.paths[static_cast<std::size_t>(log_)](kStart), q, qd, qdd) != Status::ok) return false;
    if (model_->inverse_dynamics(q, qd, qdd, case_.machine.parameters, feed) != Status::ok) return false;
    Eigen::MatrixXd M(n_, n_);
    if (model_->mass_matrix(q, case_.machine.parameters, M) != Status::ok) return false;
    inertia_ = M.diagonal();
    const Spring* soft = case_.spring();
    spring_ = spring_numbers(soft, soft != nullptr ? inertia_(soft->drive) : 0);
    for (int k = 0; k < built_.robot->parameters() && spring_.there(); ++k) {
      const ParameterId& id = built_.robot->parameter_ids()[static_cast<std::size_t>(k)];
      if (id.kind == ParameterKind::rotor_inertia && id.number == spring_.drive + 1) built_.p(k) -= spring_.rotor;
    }
    x_.setZero(at_spring() + (spring_.there() ? 2 : 0) + (lag_ > 0 ? n_ : 0));
    x_.head(n_) = q;
    x_.segment(n_, n_) = qd;
    if (spring_.there()) {
      x_(at_spring()) = q(spring_.drive) + feed(spring_.drive) / spring_.stiffness;
      x_(at_spring() + 1) = qd(spring_.drive);
    }
    if (lag_ > 0) x_.tail(n_) = feed;
    command_ = feed;
    return true;
  }

  [[nodiscard]] Vector measured() const {
    Vector both = x_.head(2 * n_);
    if (spring_.there() && spring_.encoder_on_motor) {
      both(spring_.drive) = x_(at_spring());
      both(n_ + spring_.drive) = x_(at_spring() + 1);
    }
    return both;
  }

  [[nodiscard]] bool control(double t) {
    Vector q(n_), qd(n_), qdd(n_), feed(n_);
    if (model_->to_drives(case_.paths[static_cast<std::size_t>(log_)](t), q, qd, qdd) != Status::ok) return false;
    if (model_->inverse_dynamics(q, qd, qdd, case_.machine.parameters, feed) != Status::ok) return false;
    // Against a spring that it does not see, a controller must be soft.
    const double hz = spring_.there() && !spring_.encoder_on_motor ? std::min(9.0, spring_.resonance_hz / 20) : 9.0;
    const double w = 2 * kPi * hz;
    const Vector seen = measured();
    command_ = feed + inertia_.cwiseProduct(w * w * (q - seen.head(n_)) + 1.4 * w * (qd - seen.tail(n_)));
    return true;
  }

  /// Steps that hold the sharpest friction stable.
  [[nodiscard]] int steps(double every) const {
    double stiffest = 0;
    for (int j = 0; j < n_ && !dirty(); ++j) {
      const DriveScale& s = case_.machine.scale[static_cast<std::size_t>(j)];
      const double carried = spring_.drive == j ? spring_.rotor : inertia_(j);
      stiffest = std::max(stiffest, s.friction / s.sign_width() / carried);
    }
    return std::clamp(static_cast<int>(std::ceil(stiffest * every / 1.2)), 1, 8);
  }

  [[nodiscard]] bool advance(double t, double every) {
    const int count = steps(every);
    const double h = every / count;
    Vector k1(x_.size()), k2 = k1, k3 = k1, k4 = k1;
    for (int s = 0; s < count; ++s) {
      const double now = t + s * h;
      start_ = turning(x_);
      if (!derivative(now, x_, k1) || !derivative(now + h / 2, x_ + h / 2 * k1, k2) ||
          !derivative(now + h / 2, x_ + h / 2 * k2, k3) || !derivative(now + h, x_ + h * k3, k4))
        return false;
      x_ += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      const Vector way = turning(x_) - start_;
      for (int j = 0; j < n_ && dirty(); ++j) bristle_[static_cast<std::size_t>(j)].move(way(j));
    }
    return x_.allFinite();
  }

  /// Positions, or rates, of what carries the drives' friction.
  [[nodiscard]] Vector turning(const Vector& x, Eigen::Index first = 0) const {
    Vector out = x.segment(first, n_);
    if (spring_.there()) out(spring_.drive) = x(at_spring() + (first > 0 ? 1 : 0));
    return out;
  }

  /// The drives' own friction, and cogging.
  void own_load(const Vector& x, Vector& load) const {
    const Vector place = turning(x), rate = turning(x, n_);
    for (int j = 0; j < n_; ++j) {
      const auto at = static_cast<std::size_t>(j);
      const DriveScale& scale = case_.machine.scale[at];
      const double share =
          dirty() ? bristle_[at].torque(place(j) - start_(j), rate(j)) : std::tanh(rate(j) / scale.sign_width());
      load(j) = built_.viscous[at] * rate(j) + built_.coulomb[at] * share;
    }
  }

  void add_cogging(const Vector& x, Vector& load) const {
    const Vector place = turning(x);
    for (int j = 0; j < n_ && dirty(); ++j) {
      const Cogging& c = case_.machine.dirt.cogging[static_cast<std::size_t>(j)];
      load(j) += c.amplitude * std::sin(c.n * place(j) + c.phase);
    }
  }

  [[nodiscard]] bool plate_state(Moment& now, Vector& load) const {
    if (!case_.machine.plate()) return true;
    Eigen::MatrixXd J(n_, n_);
    Vector z(n_);
    if (built_.robot->jacobian(now.q, J) != Status::ok || built_.robot->forward_kinematics(now.q, z) != Status::ok)
      return false;
    now.J = J;
    now.r = z.head<3>();
    now.v = (J * now.qd).head<3>();
    if (const auto& bar = case_.machine.robot.telescope) {
      const Eigen::Vector3d along = (now.r + bar->p_BV - bar->p_WU).normalized();
      const double rate = along.dot(now.v);
      load += (built_.viscous.back() * rate + built_.coulomb.back() * std::tanh(rate / 0.005)) *
              (J.topRows<3>().transpose() * along);
    }
    if (const auto& plate = case_.machine.robot.plate) {
      const double rate = (J * now.qd)(3) / plate->ratio;
      load += (built_.viscous.back() * rate + built_.coulomb.back() * std::tanh(rate / 0.02)) / plate->ratio *
              J.row(3).transpose();
    }
    return true;
  }

  [[nodiscard]] bool derivative(double t, const Vector& x, Vector& xd) const {
    Moment now;
    now.t = t;
    now.log = log_;
    now.q = x.head(n_);
    now.qd = x.segment(n_, n_);
    now.motor = lag_ > 0 ? Vector(x.tail(n_)) : command_;
    Vector load = Vector::Zero(n_);
    own_load(x, load);
    now.transmitted = now.motor - load;  // a gear passes on all but its own friction
    add_cogging(x, load);
    if (!plate_state(now, load)) return false;
    int at = 2 * n_;
    for (const Hidden& one : case_.hidden) {
      if (!one.resist) continue;
      Vector state_d = Vector::Zero(one.memory_size);
      one.resist(now, x.segment(at, one.memory_size), state_d, load);
      xd.segment(at, one.memory_size) = state_d;
      at += one.memory_size;
    }
    Vector torque = now.motor - load, acceleration(n_);
    if (spring_.there()) {
      const int j = spring_.drive;
      const double passed =
          spring_.stiffness * (x(at_spring()) - now.q(j)) + spring_.damping * (x(at_spring() + 1) - now.qd(j));
      xd(at_spring()) = x(at_spring() + 1);
      xd(at_spring() + 1) = (torque(j) - passed) / spring_.rotor;
      torque(j) = passed;
    }
    if (built_.robot->forward_dynamics(now.q, now.qd, torque, built_.p, acceleration) != Status::ok) return false;
    xd.head(n_) = now.qd;
    xd.segment(n_, n_) = acceleration;
    if (lag_ > 0) xd.tail(n_) = (command_ - now.motor) / lag_;
    return true;
  }

  const DrawnCase& case_;
  int log_, n_;
  Eigen::Index memory_ = 0;
  double lag_ = 0;
  std::unique_ptr<Robot> model_;
  BuiltMachine built_;
  SpringNumbers spring_;
  Vector x_, command_, inertia_, start_;
  std::vector<BristleWay> bristle_;
};

}  // namespace deltadyn::blind
