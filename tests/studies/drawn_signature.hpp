#pragma once

/// \file
/// How much of an effect, and of the dirt, no parameters of the user's model can hold: what a diagnosis has to go by.
///
/// On the reference motion of the two training logs, each drive's torque beside the rigid model is made for the hidden
/// effects and for the dirt, and fitted by the model's own columns; the strength is what an effect leaves over what the
/// dirt leaves (clean machines: over the noise), in the drive where that is largest. Of the dirt, the bristles do not
/// count: their build-up is large, but near reversals only, where delta-identify finds it.

#include <Eigen/QR>
#include <cmath>
#include <vector>

#include "studies/drawn_run.hpp"

namespace deltadyn::blind {

/// The reference motion of one log at 1 kHz, with the torque of the user's model.
struct ReferenceLog {
  static constexpr double kStep = 1e-3;
  Eigen::MatrixXd q, qd, qdd;    ///< N x drives
  Eigen::MatrixXd rigid, whole;  ///< torque without and with the drives' friction
  std::vector<Eigen::MatrixXd> J;
  std::vector<Eigen::Vector3d> r;
};

class Signature {
 public:
  explicit Signature(const DrawnCase& drawn)
      : case_(drawn), n_(drawn.machine.robot.drives()), model_(make_robot(drawn.machine.robot, drawn.machine.layout)) {
    for (int l = 0; l < 2; ++l) good_ = good_ && follow(l);
    if (good_) make_columns();
  }

  /// rms of what is left of the effects' torque, one a drive; zero if the path cannot be followed.
  [[nodiscard]] Eigen::VectorXd effects(const std::vector<Hidden>& hidden) const {
    return left_of([&](int log) { return of_effects(hidden, log); });
  }
  /// The same of the dirt but for the bristles: they act near reversals only, where delta-identify finds them.
  [[nodiscard]] Eigen::VectorXd dirt() const {
    return left_of([&](int log) { return of_dirt(log); });
  }
  /// Largest torque of each drive.
  [[nodiscard]] Eigen::VectorXd largest() const {
    return good_ ? Eigen::VectorXd(logs_[0].whole.cwiseAbs().colwise().maxCoeff().transpose())
                 : Eigen::VectorXd::Zero(n_);
  }

 private:
  static constexpr int kStride = 10;

  bool follow(int l) {
    ReferenceLog log;
    const auto rows = static_cast<Eigen::Index>(case_.duration_s / ReferenceLog::kStep);
    for (Eigen::MatrixXd* m : {&log.q, &log.qd, &log.qdd, &log.rigid, &log.whole}) m->resize(rows, n_);
    Eigen::VectorXd q(n_), qd(n_), qdd(n_), tau(n_), z(n_);
    Eigen::VectorXd frictionless = case_.machine.parameters;
    for (int k = 0; k < model_->parameters(); ++k) {
      const ParameterId& id = model_->parameter_ids()[static_cast<std::size_t>(k)];
      if (id.is_friction() && id.number > 0) frictionless(k) = 0;
    }
    for (Eigen::Index k = 0; k < rows; ++k) {
      const double t = static_cast<double>(k) * ReferenceLog::kStep;
      if (model_->to_drives(case_.paths[static_cast<std::size_t>(l)](t), q, qd, qdd) != Status::ok) return false;
      log.q.row(k) = q.transpose();
      log.qd.row(k) = qd.transpose();
      log.qdd.row(k) = qdd.transpose();
      if (model_->inverse_dynamics(q, qd, qdd, frictionless, tau) != Status::ok) return false;
      log.rigid.row(k) = tau.transpose();
      if (model_->inverse_dynamics(q, qd, qdd, case_.machine.parameters, tau) != Status::ok) return false;
      log.whole.row(k) = tau.transpose();
      if (!case_.machine.plate()) continue;
      Eigen::MatrixXd J(n_, n_);
      if (model_->jacobian(q, J) != Status::ok || model_->forward_kinematics(q, z) != Status::ok) return false;
      log.J.push_back(J);
      log.r.push_back(z.head<3>());
    }
    logs_.push_back(std::move(log));
    return true;
  }

  void make_columns() {
    Eigen::MatrixXd Y(n_, model_->parameters());
    std::vector<Eigen::MatrixXd> blocks;
    for (const ReferenceLog& log : logs_) {
      for (Eigen::Index k = 0; k < log.q.rows(); k += kStride) {
        if (model_->regressor(log.q.row(k).transpose(), log.qd.row(k).transpose(), log.qdd.row(k).transpose(), Y) !=
            Status::ok)
          Y.setZero();
        blocks.push_back(Y);
      }
    }
    Eigen::MatrixXd all(static_cast<Eigen::Index>(blocks.size()) * n_, model_->parameters());
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      for (int j = 0; j < n_; ++j) {
        all.row(static_cast<Eigen::Index>(k) * n_ + j) = blocks[k].row(j) / weight(j);
      }
    }
    for (Eigen::Index c = 0; c < all.cols(); ++c) all.col(c) /= std::max(1e-12, all.col(c).norm());
    columns_ = all;
    solver_.setThreshold(1e-8);
    solver_.compute(columns_);
  }

  [[nodiscard]] double weight(int j) const { return case_.machine.scale[static_cast<std::size_t>(j)].torque; }

  template <class Torque>
  [[nodiscard]] Eigen::VectorXd left_of(Torque torque) const {
    Eigen::VectorXd rms = Eigen::VectorXd::Zero(n_);
    if (!good_) return rms;
    Eigen::VectorXd all(columns_.rows());
    Eigen::Index at = 0;
    for (int l = 0; l < 2; ++l) {
      const Eigen::MatrixXd tau = torque(l);
      for (Eigen::Index k = 0; k < tau.rows(); k += kStride) {
        for (int j = 0; j < n_; ++j) all(at++) = tau(k, j) / weight(j);
      }
    }
    const Eigen::VectorXd left = all - columns_ * solver_.solve(all);
    for (Eigen::Index k = 0; k < left.size(); ++k) rms(k % n_) += left(k) * left(k);
    for (int j = 0; j < n_; ++j) {
      rms(j) = weight(j) * std::sqrt(rms(j) * n_ / static_cast<double>(left.size()));
    }
    return rms;
  }

  /// Torque of another machine on the same motion, less that of the model without the drives' friction.
  [[nodiscard]] Eigen::MatrixXd of_machine(const BuiltMachine& built, const ReferenceLog& log) const {
    Eigen::MatrixXd out(log.q.rows(), n_);
    Eigen::VectorXd tau(n_);
    for (Eigen::Index k = 0; k < log.q.rows(); ++k) {
      if (built.robot->inverse_dynamics(log.q.row(k).transpose(), log.qd.row(k).transpose(), log.qdd.row(k).transpose(),
                                        built.p, tau) != Status::ok)
        tau = log.rigid.row(k).transpose();
      out.row(k) = tau.transpose();
    }
    return out;
  }

  static Eigen::MatrixXd rate_of(const Eigen::MatrixXd& x) {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(x.rows(), x.cols());
    const Eigen::Index inner = x.rows() - 2;
    out.middleRows(1, inner) = (x.bottomRows(inner) - x.topRows(inner)) / (2 * ReferenceLog::kStep);
    return out;
  }

  [[nodiscard]] Eigen::MatrixXd of_effects(const std::vector<Hidden>& hidden, int l) const {
    const ReferenceLog& log = logs_[static_cast<std::size_t>(l)];
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(log.q.rows(), n_);
    for (const Hidden& one : hidden) {
      if (one.robot || one.parameters) {
        sum += of_machine(build_machine(case_.machine, {one}, l, false), log) -
               of_machine(build_machine(case_.machine, {}, l, false), log);
      }
      if (one.motor_lag_s > 0) sum += one.motor_lag_s * rate_of(log.rigid);
      if (one.spring) {
        const double w = 2 * kPi * one.spring->resonance_hz;
        sum.col(one.spring->drive) -= rate_of(rate_of(log.rigid)).col(one.spring->drive) / (w * w);
      }
      if (one.resist) sum += of_resistance(one, l, log);
      if (one.record) sum += of_record(one, l, log);
    }
    return sum;
  }

  [[nodiscard]] Eigen::MatrixXd of_resistance(const Hidden& one, int l, const ReferenceLog& log) const {
    Eigen::MatrixXd out(log.q.rows(), n_);
    Eigen::VectorXd memory = Eigen::VectorXd::Zero(one.memory_size), rate = memory, load(n_);
    Moment now;
    now.log = l;
    for (Eigen::Index k = 0; k < log.q.rows(); ++k) {
      now.t = static_cast<double>(k) * ReferenceLog::kStep;
      now.q = log.q.row(k).transpose();
      now.qd = log.qd.row(k).transpose();
      now.motor = log.whole.row(k).transpose();
      now.transmitted = log.rigid.row(k).transpose();
      if (case_.machine.plate()) {
        now.J = log.J[static_cast<std::size_t>(k)];
        now.r = log.r[static_cast<std::size_t>(k)];
        now.v = (now.J * now.qd).head<3>();
      }
      load.setZero();
      one.resist(now, memory, rate, load);
      memory += ReferenceLog::kStep * rate;
      out.row(k) = load.transpose();
    }
    return out;
  }

  /// What is recorded in place of torque and position, as torque.
  [[nodiscard]] Eigen::MatrixXd of_record(const Hidden& one, int l, const ReferenceLog& log) const {
    Eigen::MatrixXd tau = log.rigid, q = log.q;  // jumps of friction are no evidence: those rows are hardly used
    one.record(l, tau, q, ReferenceLog::kStep);
    Eigen::MatrixXd out = tau - log.rigid;
    if (q == log.q) return out;
    ReferenceLog shifted = log;
    shifted.q = q;
    const BuiltMachine built = build_machine(case_.machine, {}, l, false);
    return out + of_machine(built, log) - of_machine(built, shifted);
  }

  [[nodiscard]] Eigen::MatrixXd of_dirt(int l) const {
    const ReferenceLog& log = logs_[static_cast<std::size_t>(l)];
    const Dirt& dirt = case_.machine.dirt;
    if (!dirt.any()) return Eigen::MatrixXd::Zero(log.q.rows(), n_);
    Eigen::MatrixXd sum = of_machine(build_machine(case_.machine, {}, l, true), log) -
                          of_machine(build_machine(case_.machine, {}, l, false), log) -
                          dirt.current_filter_s * rate_of(log.rigid);
    for (int j = 0; j < n_; ++j) {
      const Cogging& c = dirt.cogging[static_cast<std::size_t>(j)];
      for (Eigen::Index k = 0; k < log.q.rows(); ++k) sum(k, j) += c.amplitude * std::sin(c.n * log.q(k, j) + c.phase);
    }
    return sum;
  }

  const DrawnCase& case_;
  int n_;
  std::unique_ptr<Robot> model_;
  bool good_ = true;
  std::vector<ReferenceLog> logs_;
  Eigen::MatrixXd columns_;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver_;
};

}  // namespace deltadyn::blind
