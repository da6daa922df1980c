#include "deltadyn/effects/all.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "deltadyn/core/dual.hpp"
#include "deltadyn/core/sign.hpp"
#include "deltadyn/identification/effect_columns.hpp"
#include "deltadyn/io/effect_file.hpp"
#include "deltadyn/runtime/changed_machine.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/simulation/plant.hpp"
#include "deltadyn/simulation/sensors.hpp"

#include "../../tools/simulate/effect_flag.hpp"
#include "identification/synthetic_log.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A smooth motion of one drive, for robots that have no plate to draw a motion for.
Log motion_of_axis(const Robot& robot, const VectorXd& p) {
  constexpr Index kSamples = 2000;
  Log log;
  log.t_s = VectorXd::LinSpaced(kSamples, 0, 1.999);
  log.q = log.qd = log.qdd = log.tau = MatrixXd::Zero(kSamples, 1);
  for (Index k = 0; k < kSamples; ++k) {
    for (const double w : {3.1, 7.3, 11.9}) {
      log.q(k, 0) += std::sin(w * log.t_s(k) + w) / w;
      log.qd(k, 0) += std::cos(w * log.t_s(k) + w);
      log.qdd(k, 0) -= w * std::sin(w * log.t_s(k) + w);
    }
    VectorXd tau(1);
    EXPECT_EQ(robot.inverse_dynamics(log.q.row(k), log.qd.row(k), log.qdd.row(k), p, tau), Status::ok);
    log.tau.row(k) = tau;
  }
  return log;
}

/// One robot type with a log that is exact in all derivatives.
class EveryEffect : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const std::string type = GetParam();
    const bool axis = type.find("axis") != std::string::npos;
    robot_ =
        make_robot(axis ? testing_support::axis_description(type == "axis" ? DriveKind::revolute : DriveKind::prismatic)
                        : testing_support::description_of(type));
    p_ = testing_support::delta_truth(*robot_);
    testing_support::SyntheticOptions options;
    options.duration_s = 2;
    const Log log = axis ? motion_of_axis(*robot_, p_) : testing_support::synthetic_log(*robot_, p_, options);
    ProcessingOptions processing;
    processing.filter = false;
    log_ = prepare_log(*robot_, log, processing);
    model_ = std::make_unique<EffectModel>(*robot_);
    signals_ = model_->signals(log_, p_);
  }

  /// Calls what(effect) for each effect of the list, at each place of the robot and for each choice that its shapes
  /// have.
  template <class What>
  void for_each(const What& what) const {
    for (const EffectKind& kind : effect_catalogue()) {
      for (const int joint : effect_joints(kind.id, robot_->description())) {
        Effect effect;
        effect.id = kind.id;
        effect.joint = joint;
        effect.shape.resize(static_cast<Index>(kind.shapes.size()));
        effect.amplitude.resize(static_cast<Index>(kind.amplitudes.size()));
        std::vector<Effect> all = {effect};
        for (std::size_t k = 0; k < kind.shapes.size(); ++k) {
          std::vector<Effect> next;
          for (Effect one : all) {
            for (const double value : shapes_of(kind.shapes[k], std::max(joint, 0))) {
              one.shape(static_cast<Index>(k)) = value;
              next.push_back(one);
            }
          }
          all = next;
        }
        for (Effect& one : all) {
          for (std::size_t k = 0; k < kind.amplitudes.size(); ++k)
            one.amplitude(static_cast<Index>(k)) = kind.tied ? one.shape(0) : size_of(kind.amplitudes[k], joint);
          SCOPED_TRACE(fmt::format("{} at {} ({})", kind.name, effect_joint_name(kind.id, joint),
                                   effect_shape_text(one, robot_->description())));
          what(one);
        }
      }
    }
  }

  /// A value inside the range of a shape parameter for this motion; all of its choices.
  [[nodiscard]] std::vector<double> shapes_of(const ShapeTraits& shape, int joint) const {
    const std::vector<double> start = start_values(shape);
    const double middle = start.empty() ? 1.0 : start[start.size() / 2];
    const auto q = signals_.q.col(joint).array();
    const double range = q.maxCoeff() - q.minCoeff();
    switch (shape.scale) {
      case ShapeScale::choice: return start;
      case ShapeScale::absolute: return start.size() <= 4 ? start : std::vector<double>{middle};
      case ShapeScale::largest_rate: return {middle * signals_.qd.col(joint).cwiseAbs().maxCoeff()};
      case ShapeScale::largest_torque: return {middle * signals_.torque.col(joint).cwiseAbs().maxCoeff()};
      case ShapeScale::displacement: return {middle * range};
      case ShapeScale::range: return {middle * range};
      case ShapeScale::place: return {0.5 * (q.maxCoeff() + q.minCoeff()) + 0.3 * range};
      case ShapeScale::waves: return {3 * 2 * std::numbers::pi / range};
      case ShapeScale::logs: return {1};
    }
    return {};
  }

  /// A size that a machine may have: friction below Coulomb's, changes of the machine small.
  [[nodiscard]] double size_of(const AmplitudeTraits& amplitude, int joint) const {
    const std::string unit(amplitude.unit);
    if (unit == "{F}") return 0.2 * coulomb_of(fmt::format("drive{}", std::max(joint, 0) + 1));
    if (unit == "rad" || unit == "SI") return 1e-5;
    if (unit == "{F}*s/{x}" || unit.empty()) return 0.01;
    if (unit == "{F}*s^2/{x}" || unit == "kg*m^2" || unit == "kg*m") return 0.003;
    return unit == "s^2" ? 1e-6 : 0.3;
  }
  [[nodiscard]] double coulomb_of(const std::string& joint) const {
    const auto& names = robot_->parameter_names();
    const auto found = std::find(names.begin(), names.end(), joint + ".coulomb");
    return p_(found - names.begin());
  }

  /// Torque of the column model, samples x drives.
  [[nodiscard]] MatrixXd fitted(const Effect& effect, bool per_amplitude, Index amplitude = 0) const {
    MatrixXd sum = MatrixXd::Zero(log_.q.rows(), log_.q.cols());
    const auto columns = model_->columns(signals_, effect.id, effect.joint, effect.shape, 1);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const double size =
          per_amplitude ? (static_cast<Index>(c) == amplitude ? 1.0 : 0.0) : effect.amplitude(static_cast<Index>(c));
      if (columns[c].drive < 0) {
        sum += size * columns[c].values;
      } else {
        sum.col(columns[c].drive) += size * columns[c].values;
      }
    }
    return sum;
  }

  /// Torque that the virtual robot needs for the motion.
  [[nodiscard]] MatrixXd needed(const std::vector<Effect>& effects) const {
    Plant plant(robot_->description(), robot_->parameter_names(), p_, effects);
    MatrixXd torque(log_.q.rows(), log_.q.cols());
    for (Index k = 0; k < torque.rows(); ++k)
      torque.row(k) = plant.inverse(log_.t_s(k), log_.q.row(k).transpose(), log_.qd.row(k).transpose(),
                                    log_.qdd.row(k).transpose());
    return torque;
  }

  /// What the effect adds to the torque: to that which the virtual robot needs, or to the record of the rigid robot's.
  [[nodiscard]] MatrixXd made_by(const Effect& effect) const {
    if (is_log_effect(effect.id)) return recorded_torque(log_.t_s, signals_.torque, {effect}, {}, 1) - signals_.torque;
    return needed({effect}) - needed({});
  }

  std::unique_ptr<Robot> robot_;
  VectorXd p_;
  PreparedLog log_;
  std::unique_ptr<EffectModel> model_;
  EffectSignals signals_;
};

/// A spring or play: its own motion has to be integrated (tests/identification/effect_columns_test.cpp, acceptance
/// tests).
bool softens(const Effect& effect, const RobotDescription& robot) {
  ChangedMachine machine(robot);
  visit_effect(effect.id, [&](auto type) {
    using E = decltype(type);
    if constexpr (HasChange<E, ChangedMachine>::value)
      E::change(machine, effect.joint, amplitudes_of(effect), shape_of(effect));
  });
  return !machine.springs.empty();
}

bool by_differences(EffectId id) {
  bool by = false;
  visit_effect(id, [&by](auto effect) { by = kIs<decltype(effect), MachineChange>; });
  return by;
}

TEST_P(EveryEffect, ItsColumnIsTheDifferenceThatTheVirtualRobotMakes) {
  int compared = 0;
  for_each([&](const Effect& effect) {
    if (softens(effect, robot_->description())) return;
    const MatrixXd difference = made_by(effect);
    // A change of the machine is seen to first order: what is left is of second order in an amplitude of 1e-5.
    const double bound = by_differences(effect.id) ? 1e-3 : 1e-8;
    if (effect_kind(effect.id).effect_class == EffectClass::phase) {
      // A skew is fitted along straight lines between the samples, which differ where Coulomb's friction jumps.
      const MatrixXd error = (fitted(effect, false) - difference).cwiseAbs();
      EXPECT_LT((error.array() > 1e-2 * difference.cwiseAbs().maxCoeff()).count(), error.size() / 10);
      return;
    }
    const double size = difference.cwiseAbs().maxCoeff();
    EXPECT_GT(size, 1e-9);
    EXPECT_LT((fitted(effect, false) - difference).cwiseAbs().maxCoeff(), bound * size + 1e-10);
    ++compared;
  });
  EXPECT_GE(compared, 20);
}

TEST_P(EveryEffect, ItsAmplitudesComeBackBesideTheBaseParameters) {
  const Index n = log_.q.cols(), every = 10, rows = (log_.q.rows() + every - 1) / every;
  MatrixXd Y(rows * n, robot_->parameters());
  for (Index k = 0; k < rows; ++k) {
    MatrixXd one(n, robot_->parameters());
    const Index at = every * k;
    ASSERT_EQ(robot_->regressor(log_.q.row(at), log_.qd.row(at), log_.qdd.row(at), one), Status::ok);
    Y.middleRows(n * k, n) = one;
  }
  const auto stacked = [&](const MatrixXd& torque) {
    VectorXd all(rows * n);
    for (Index k = 0; k < rows; ++k) all.segment(n * k, n) = torque.row(every * k).transpose();
    return all;
  };
  const Eigen::CompleteOrthogonalDecomposition<MatrixXd> base(Y);
  const auto orthogonal = [&](const VectorXd& x) { return VectorXd(x - Y * base.solve(x)); };
  for_each([&](const Effect& effect) {
    if (softens(effect, robot_->description())) return;
    // The column of a changed machine is the first term of a series. A skew of a jump of Coulomb's friction says
    // nothing below a sample (see the test above): of the phase only the fit's own torque comes back.
    const bool phase = effect_kind(effect.id).effect_class == EffectClass::phase;
    const double bound = by_differences(effect.id) ? 1e-3 : 1e-5;
    const MatrixXd torque = phase ? fitted(effect, false) : made_by(effect);
    const Index amplitudes = effect.amplitude.size();
    MatrixXd C(rows * n, amplitudes);
    for (Index c = 0; c < amplitudes; ++c) C.col(c) = orthogonal(stacked(fitted(effect, true, c)));
    const VectorXd found = C.completeOrthogonalDecomposition().solve(orthogonal(stacked(torque)));
    for (Index c = 0; c < amplitudes; ++c) {
      // What the base parameters absorb cannot come back (f0 along z, one inertia of an axis).
      MatrixXd others = C;
      others.col(c).setZero();
      const VectorXd alone = C.col(c) - others * others.completeOrthogonalDecomposition().solve(VectorXd(C.col(c)));
      if (alone.norm() < 1e-6 * (1 + stacked(fitted(effect, true, c)).norm())) continue;
      const double size = effect.amplitude(c);
      EXPECT_NEAR(found(c), size, bound * std::abs(size) + 1e-12);
    }
  });
}

std::string flag_of(const Effect& effect) {
  std::string flag = fmt::format("{}@{}:", effect_kind(effect.id).name, effect_joint_name(effect.id, effect.joint));
  for (const tools::EffectKey& key : tools::effect_keys(effect_kind(effect.id)))
    flag += fmt::format("{}={},", key.name, (key.amplitude ? effect.amplitude : effect.shape)(key.index));
  flag.pop_back();
  return flag;
}

TEST_P(EveryEffect, FilesAndFlagsMakeTheRoundTrip) {
  const std::string path =
      (std::filesystem::temp_directory_path() / fmt::format("effects_{}.csv", GetParam())).string();
  const RobotDescription& robot = robot_->description();
  for_each([&](const Effect& effect) {
    write_effects(path, {effect}, robot);
    for (const Effect& back : {read_effects(path, robot).at(0), tools::parse_effect(flag_of(effect), robot)}) {
      EXPECT_EQ(back.id, effect.id);
      EXPECT_EQ(back.joint, effect.joint);
      EXPECT_EQ(back.amplitude, effect.amplitude);
      EXPECT_EQ(back.shape, effect.shape);
    }
  });
  std::filesystem::remove(path);
}

/// Numbers just outside a range, on either side where it has an end.
std::vector<double> outside(const Range& range) {
  std::vector<double> numbers;
  if (std::isfinite(range.lowest)) numbers.push_back(range.open ? range.lowest : range.lowest - 1e-3);
  if (std::isfinite(range.highest)) numbers.push_back(range.highest * 1.01);
  return numbers;
}

TEST_P(EveryEffect, ANumberOutOfRangeIsRefusedByFilesFlagsAndTheVirtualRobot) {
  const std::string path = (std::filesystem::temp_directory_path() / fmt::format("wrong_{}.csv", GetParam())).string();
  const RobotDescription& robot = robot_->description();
  const auto expect_refused = [&](const Effect& wrong) {
    write_effects(path, {wrong}, robot);
    EXPECT_THROW((void)read_effects(path, robot), Error);
    EXPECT_THROW((void)tools::parse_effect(flag_of(wrong), robot), Error);
    EXPECT_THROW(Plant(robot, robot_->parameter_names(), p_, {wrong}), Error);
  };
  for_each([&](const Effect& effect) {
    const EffectKind& kind = effect_kind(effect.id);
    for (std::size_t k = 0; k < kind.amplitudes.size(); ++k) {
      for (const double number : outside(kind.amplitudes[k].range())) {
        Effect wrong = effect;
        wrong.amplitude(static_cast<Index>(k)) = number;
        expect_refused(wrong);
      }
    }
    for (std::size_t k = kind.tied ? 1 : 0; k < kind.shapes.size(); ++k) {
      for (const double number : outside(kind.shapes[k].range)) {
        Effect wrong = effect;
        wrong.shape(static_cast<Index>(k)) = number;
        expect_refused(wrong);
      }
    }
  });
  std::filesystem::remove(path);
}

INSTANTIATE_TEST_SUITE_P(Robots, EveryEffect,
                         testing::Values("delta3", "delta4", "linear-delta3", "h4", "i4", "par4", "axis",
                                         "linear-axis"),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           std::erase(name, '-');
                           return name;
                         });

/// The slope of a law by one of its inputs, by dual numbers and by a central difference.
template <class E>
void check_slope(std::mt19937_64& random) {
  using D = Dual<double, 1>;
  std::uniform_real_distribution<double> uniform(0.2, 1.0);
  const auto side = [&] { return (random() & 1U) != 0 ? 1.0 : -1.0; };
  Shape<double> shape{};
  constexpr EffectTraits traits = E::traits();
  for (std::size_t k = 0; k < traits.shapes.size(); ++k) {
    const std::vector<double> start = start_values(traits.shapes[k]);
    shape[k] = start.empty() ? 2.0 : start[start.size() / 2];
  }
  Shape<D> dual_shape;
  for (std::size_t k = 0; k < shape.size(); ++k) dual_shape[k] = D(shape[k]);
  const double at[5] = {side() * uniform(random), side() * uniform(random), uniform(random), side() * uniform(random),
                        uniform(random)};
  const auto input = [&](auto scalar, int moved, const auto& by) {
    using T = decltype(scalar);
    T value[5];
    for (int k = 0; k < 5; ++k) value[k] = k == moved ? T(at[k]) + by : T(at[k]);
    JointInput<T> in;
    in.position = value[0];
    in.rate = value[1];
    in.sign = sign_of(value[1]);
    in.time = value[2];
    in.load = value[3];
    in.acceleration = value[4];
    in.side_load = in.gravity_x = T(2);
    in.gravity_z = T(-9);
    return in;
  };
  const auto columns = [](const auto& in, const auto& its_shape) {
    using T = std::decay_t<decltype(in.rate)>;
    if constexpr (kIs<E, JointMemory>) {
      const T state = E::moved(E::start(T(1), its_shape), T(-0.004) + in.position * T(1e-6), in, its_shape);
      return E::columns(state, in, its_shape);
    } else {
      return E::columns(in, its_shape);
    }
  };
  D unit(0.0);
  unit.slope(0) = 1;
  for (int moved = 0; moved < 5; ++moved) {
    constexpr double kStep = 1e-6;
    const auto slope = columns(input(D(), moved, unit), dual_shape);
    const auto up = columns(input(0.0, moved, kStep), shape), down = columns(input(0.0, moved, -kStep), shape);
    for (std::size_t c = 0; c < up.size(); ++c)
      EXPECT_NEAR(slope[c].slope(0), (up[c] - down[c]) / (2 * kStep), 1e-6 * (1 + std::abs(slope[c].slope(0))))
          << traits.name;
  }
}

/// The same for a force on the plate, by the nine numbers of its motion.
template <class E>
void check_slope_of_force(std::mt19937_64& random) {
  using D = Dual<double, 1>;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  double at[9];
  for (double& number : at) number = uniform(random);
  const auto forces = [&](auto scalar, int moved, const auto& by) {
    using T = decltype(scalar);
    T value[9];
    for (int k = 0; k < 9; ++k) value[k] = k == moved ? T(at[k]) + by : T(at[k]);
    PlateInput<T> in;
    in.position = {value[0], value[1], value[2]};
    in.velocity = {value[3], value[4], value[5]};
    in.acceleration = {value[6], value[7], value[8]};
    in.gravity = {T(0), T(0), T(-9.81)};
    return E::columns(in, Shape<T>{});
  };
  D unit(0.0);
  unit.slope(0) = 1;
  for (int moved = 0; moved < 9; ++moved) {
    constexpr double kStep = 1e-6;
    const auto slope = forces(D(), moved, unit);
    const auto up = forces(0.0, moved, kStep), down = forces(0.0, moved, -kStep);
    for (std::size_t c = 0; c < up.size(); ++c) {
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(slope[c](axis).slope(0), (up[c](axis) - down[c](axis)) / (2 * kStep), 1e-7) << E::traits().name;
    }
  }
}

template <class... Effects>
void check_slopes(EffectList<Effects...>) {
  std::mt19937_64 random(7);
  const auto check = [&](auto effect) {
    using E = decltype(effect);
    if constexpr (kIs<E, JointLaw> || kIs<E, JointMemory>) {
      for (int trial = 0; trial < 20; ++trial) check_slope<E>(random);
    } else if constexpr (kIs<E, PlateForce>) {
      for (int trial = 0; trial < 20; ++trial) check_slope_of_force<E>(random);
    }
  };
  (check(Effects()), ...);
}

TEST(AllEffects, DerivativesOfTheLawsAgreeWithTheirDifferences) {
  check_slopes(AllEffects());
}

TEST(AllEffects, StartValuesAndTheirSearchStayInTheRangeOfTheShape) {
  for (const EffectKind& kind : effect_catalogue()) {
    for (const ShapeTraits& shape : kind.shapes) {
      for (const double start : start_values(shape)) {
        const ShapeSearch& search = shape.search;
        for (const double by : {search.low, search.high}) {
          double end = start;
          if (search.kind == ShapeSearch::by_factor) end *= by;
          if (search.kind == ShapeSearch::by_difference) end = std::max(start + by, search.least);
          EXPECT_TRUE(shape.range.holds(end)) << kind.name << ' ' << shape.name << ' ' << end;
        }
      }
    }
  }
}

TEST(AllEffects, NamesAndAliasesAreTheirOwnAndSpecialCasesExist) {
  std::vector<std::string_view> names;
  for (const EffectKind& kind : effect_catalogue()) {
    names.push_back(kind.name);
    if (!kind.alias.empty()) names.push_back(kind.alias);
    for (const std::string_view name : kind.special_cases) EXPECT_NE(find_effect_kind(name), nullptr) << kind.name;
    EXPECT_FALSE(kind.meaning.empty() || kind.shows.empty() || kind.remedy.empty()) << kind.name;
    EXPECT_FALSE(kind.amplitudes.empty()) << kind.name;
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

}  // namespace
}  // namespace deltadyn
