#pragma once

/// \file
/// Effects of the catalogue as regressor columns over a log: the formulas of effects/ at every sample, then the same
/// low pass and decimation as torque and regressor.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "deltadyn/identification/log_processing.hpp"
#include "deltadyn/runtime/effect_catalogue.hpp"
#include "deltadyn/runtime/effect_states.hpp"

namespace deltadyn {

/// What effects are computed from, at each of the N samples of a prepared log; n drives.
struct EffectSignals {
  Eigen::VectorXd t_s;
  Eigen::MatrixXd q, qd, qdd;     ///< N x n
  Eigen::MatrixXd torque;         ///< N x n, of the model with all its friction [N m | N]
  Eigen::MatrixXd load;           ///< N x n, of the model without the drives' own friction
  Eigen::MatrixXd load_dd, snap;  ///< second time derivatives of load and qdd
  std::vector<Eigen::MatrixXd> load_lag,
      inertia_lag;           ///< N x n for each drive: change of all torques, without friction, for a lag of
                             ///< this drive by its load, and by its inertia times qdd
  Eigen::MatrixXd coupling;  ///< N x n^2: the mass matrix, column by column
  Eigen::VectorXd inertia;   ///< n, of each drive with the others held, in the middle of the workspace
  Eigen::MatrixXd position, velocity, acceleration;  ///< N x 3, of the plate
  Eigen::MatrixXd J;                                 ///< N x 3n: d position / d q1, d position / d q2, ...
  Eigen::VectorXd inner_rate;                        ///< N, of the inner joint
  Eigen::MatrixXd J_inner;                           ///< N x n
  Eigen::MatrixXd bar;                               ///< N x 3
  Eigen::MatrixXd passive_rate;                      ///< N x m, of the different passive joints
  Eigen::MatrixXd J_passive;                         ///< N x m n: d rate 1 / d qd, d rate 2 / d qd, ...
  /// N x n each: torque per unit of each MachineDifference; empty if not asked for
  std::vector<Eigen::MatrixXd> changed;
  double sample_time_s = 0;
};

/// Values of one column at the samples: N x 1 if it acts on one drive alone, else N x n.
struct EffectColumn {
  int drive = -1;  ///< -1: all
  Eigen::MatrixXd values;
};

/// A change of the machine by one amplitude of an effect, seen by a central difference.
struct MachineDifference {
  EffectId id;
  int joint;
  Shape<double> shape;
  std::size_t amplitude;
  double step;
  struct Side {
    std::unique_ptr<Robot> robot;
    Eigen::VectorXd home_offset;
  };
  Side plus, minus;
};

/// Do effects change the machine, so that their columns take differences of whole models?
[[nodiscard]] bool needs_differences(const std::vector<Effect>& effects);

/// Computes signals and columns for one robot. Safe to use from several threads.
class EffectModel {
 public:
  explicit EffectModel(const Robot& robot);
  ~EffectModel();
  EffectModel(const EffectModel&) = delete;
  EffectModel& operator=(const EffectModel&) = delete;

  /// \param p                 parameters in the robot's layout, for the effects that need the model's torque
  /// \param with_differences  of changed machines, too (these need the model some twenty times a sample)
  /// \param near              of nearly the same motion (encoder noise apart): spares the derivatives along the lags of
  ///                          elastic joints
  /// Throws deltadyn::Error for poses that the robot cannot have.
  [[nodiscard]] EffectSignals signals(const PreparedLog& log, const Eigen::VectorXd& p, bool with_differences = true,
                                      const EffectSignals* near = nullptr) const;

  /// One column an amplitude of the effect.
  /// \param shape       one value a shape parameter
  /// \param log_number  of this log among those of the identification, from 1, for effects of one log only
  [[nodiscard]] std::vector<EffectColumn> columns(const EffectSignals& signals, EffectId id, int joint,
                                                  const Eigen::VectorXd& shape, int log_number) const;

  [[nodiscard]] const Robot& robot() const { return robot_; }

 private:
  void add_differences(const PreparedLog& log, const Eigen::VectorXd& p, EffectSignals& out) const;
  void add_lags(const Eigen::VectorXd& p, const EffectSignals* near, EffectSignals& out) const;

  const Robot& robot_;
  std::unique_ptr<EffectStates> states_;
  std::vector<int> own_friction_;  ///< columns of p that load leaves out
  std::vector<int> friction_;      ///< columns of p of all friction
  std::vector<MachineDifference> differences_;
};

/// Low pass and decimation as read_rows does: rows of the log x columns of `values`.
[[nodiscard]] Eigen::MatrixXd low_passed_rows(const PreparedLog& log, const Eigen::Ref<const Eigen::MatrixXd>& values);

/// All columns of all effects in the rows of a log, with their fixed shapes: for each drive rows x (sum of amplitudes).
[[nodiscard]] std::vector<Eigen::MatrixXd> effect_rows(const EffectModel& model, const PreparedLog& log,
                                                       const Eigen::VectorXd& p, const std::vector<Effect>& effects,
                                                       int log_number);

/// Number of amplitudes of all effects together.
[[nodiscard]] Eigen::Index amplitude_count(const std::vector<Effect>& effects);
/// The amplitudes one after the other, and back.
[[nodiscard]] Eigen::VectorXd amplitudes_of(const std::vector<Effect>& effects);
void set_amplitudes(const Eigen::VectorXd& amplitudes, const Eigen::VectorXd& std, std::vector<Effect>& effects);

}  // namespace deltadyn
