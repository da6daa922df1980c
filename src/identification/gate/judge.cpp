#include "judge.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <optional>

#include "deltadyn/runtime/in_parallel.hpp"
#include "deltadyn/runtime/statistics.hpp"

namespace deltadyn::gate {

namespace {

using Eigen::Index;

// Of the torque: friction of another law, load and noise leave less; wrong signs leave more
constexpr double kSoundResidual = 0.02;
constexpr double kSoundRatio = 1.2;  // all drives together over each drive by itself: one machine explains all torques
constexpr double kWins = 0.5;        // a fault explains away at least half of the residual ...
// ... or, where noise covers the rest, leaves nothing between all drives together and each alone
constexpr double kWinsNoisy = 0.8;
constexpr double kWinsOdd = 0.4;               // the same for a zero at any angle, which explains more by chance
constexpr double kBreaks = 1.1, kHeals = 1.1;  // that ratio, as given and for the winner
constexpr double kSoundWinner = 0.15;          // ... down to that of a fit that may have other, smaller faults
constexpr double kSoundOdd = 0.035;            // a zero or factor of any size fits another robot's log to some per cent
constexpr double kAlike = 1.1;                 // residuals within this ratio do not tell explanations apart
// Of an explanation's residual: springs or rotors on the drives explain the log better
constexpr double kOwnTorque = 0.9;
constexpr double kOutOfReach = 0.01;    // share of poses that a recording of this robot cannot have
constexpr Index kCoarsePoints = 120;    // for searches over a factor or a zero
constexpr int kBestStarts = 2;          // of a search, refined
constexpr double kWorthRefining = 2.0;  // times the smallest residual of all searches
constexpr double kNoOffset = 0.6;       // steps of a search for a zero
// A factor of one torque nearer to 1 is a matter for the fit and the diagnosis
constexpr double kScaleWorth = 0.25;
constexpr int kFewestRowsPerParameter = 2;

/// What can be said of one reading of the positions.
class Judge {
 public:
  Judge(const Robot& robot, const BaseParameters& base, const Points& points)
      : robot_(robot), base_(base), points_(points) {}

  Judgement run() {
    const int n = robot_.drives();
    Judgement out;
    if (points_.q.rows() * n < kFewestRowsPerParameter * base_.count())
      return out;  // too short to judge: sound until shown otherwise
    const Reading given = Reading::as_given(n);
    std::optional<Explanation> as_given = plain(given);
    if (as_given) out.as_given = *as_given;
    out.with_springs = with_springs_;
    out.as_given.unreachable = unreachable_;
    out.sound = as_given && unreachable_ <= kOutOfReach && as_given->residual < kSoundResidual &&
                as_given->residual < kSoundRatio * alone_ + 0.002;
    const double residual = as_given ? as_given->residual : 1.0;
    collect_discrete(given, nullptr);
    out.winners = winners(residual);
    if (out.sound || (!out.winners.empty() && out.winners.front().residual < kSoundResidual)) return out;
    collect_families(given, nullptr);
    out.winners = winners(residual);
    if (out.winners.empty()) {  // two faults at once: again from the best single one of the positions
      const std::optional<Explanation> first = best_of_positions();
      if (!first) return out;
      collect_discrete(first->reading, &*first);
      collect_families(first->reading, &*first);
      out.winners = winners(residual);
    }
    return out;
  }

 private:
  [[nodiscard]] bool enough(const Rows& rows) const {
    Index total = 0;
    for (const DriveRows& drive : rows.drives) {
      if (drive.count() < 10) return false;
      total += drive.count();
    }
    return total >= kFewestRowsPerParameter * (base_.count() + robot_.drives());
  }

  /// A reading with the torques as they are. Sets unreachable_ and alone_, the residual of each drive by itself.
  std::optional<Explanation> plain(const Reading& reading) {
    const Rows rows = rows_of_points(robot_, base_, points_, reading);
    unreachable_ = rows.unreachable;
    if (!enough(rows)) return std::nullopt;
    const std::vector<TorqueBlock> blocks = fold_torques(rows, points_.tau);
    Explanation out;
    out.reading = reading;
    out.assignment = own_columns();
    out.factor.setOnes(robot_.drives());
    out.residual = relative_residual(residual_form(blocks, out.assignment, out.factor), out.factor);
    out.unreachable = rows.unreachable;
    alone_ = root_mean_square(own_residuals(blocks));
    const auto residual_beside = [&](const Eigen::MatrixXd& own) {
      const Rows more = with_own_columns(rows, own);
      return relative_residual(residual_form(fold_torques(more, points_.tau), out.assignment, out.factor), out.factor);
    };
    with_springs_ = residual_beside(points_.q);
    with_rotors_ = residual_beside(points_.qdd);
    return out;
  }

  /// Each drive's torque in the column of its position.
  [[nodiscard]] std::vector<int> own_columns() const { return Reading::as_given(robot_.drives()).source; }

  /// The signs of the torques as the bits of a number.
  [[nodiscard]] Eigen::VectorXd signs_of(int set) const {
    return Eigen::VectorXd::NullaryExpr(robot_.drives(), [set](Index j) { return (set >> j & 1) != 0 ? -1.0 : 1.0; });
  }

  /// The rows with a torque beside the model that follows each drive's own position or acceleration: a spring or a
  /// rotor, which no fault of a record is.
  [[nodiscard]] Rows with_own_columns(Rows rows, const Eigen::MatrixXd& own) const {
    const auto n = static_cast<Index>(rows.drives.size());
    for (Index j = 0; j < n; ++j) {
      DriveRows& drive = rows.drives[static_cast<std::size_t>(j)];
      const Index before = drive.Y.cols();
      drive.Y.conservativeResize(Eigen::NoChange, before + n);
      drive.Y.rightCols(n).setZero();
      drive.Y.col(before + j) = drive.of_points(own.col(j));
    }
    return rows;
  }

  /// Adds every explanation over `start`, itself the reading of `before` or the log as given.
  void collect_discrete(const Reading& start, const Explanation* before) {
    PositionHypothesis as_is;
    as_is.reading = Reading::as_given(robot_.drives());
    add_torque_readings(as_is, start, before);
    for (const PositionHypothesis& h : position_hypotheses(robot_.description())) add_torque_readings(h, start, before);
  }
  /// A value of a family that a search over few points found.
  struct Start {
    double residual, value;
    const PositionFamily* family;
  };

  /// Factors and zeros: all families over few points first, the promising ones refined.
  void collect_families(const Reading& start, const Explanation* before) {
    const std::vector<PositionFamily> families = position_families(robot_.description());
    const Points few = thinned(kCoarsePoints);
    std::vector<Start> found;
    double least = std::numeric_limits<double>::infinity();
    for (const PositionFamily& family : families) {
      std::vector<double> residual(family.start.size());
      in_parallel(residual.size(),
                  [&](std::size_t k) { residual[k] = best_torques(family, start, family.start[k], few); });
      std::vector<Start> own;
      for (std::size_t k = 0; k < residual.size(); ++k) {
        if (std::isfinite(residual[k])) own.push_back({residual[k], family.start[k], &family});
      }
      std::ranges::sort(own, {}, &Start::residual);
      if (own.size() > kBestStarts) own.resize(kBestStarts);
      for (const Start& one : own) least = std::min(least, one.residual);
      found.insert(found.end(), own.begin(), own.end());
    }
    for (const Start& one : found) {
      if (one.residual > kWorthRefining * least) continue;
      const PositionFamily& family = *one.family;
      const double value = plausible(family, start, refine(family, start, one.value));
      const bool nothing = family.geometric ? std::abs(value - 1) < 0.1
                                            : (std::abs(value) < kNoOffset * family.step && family.sign.front() > 0);
      if (!nothing) add_torque_readings(member(family, robot_.description(), value, 0.01), start, before);
    }
  }

  [[nodiscard]] std::optional<Explanation> best_of_positions() const {
    std::optional<Explanation> best;
    for (const Explanation& e : all_) {
      if (e.torques_as_given() && (!best || e.residual < best->residual)) best = e;
    }
    return best;
  }

  /// One reading of the positions with the best order, signs and factors of the torques.
  void add_torque_readings(const PositionHypothesis& h, const Reading& start, const Explanation* before) {
    const Reading reading = compose(h.reading, start);
    const Rows rows = rows_of_points(robot_, base_, points_, reading);
    if (rows.unreachable > kOutOfReach || !enough(rows)) return;
    const std::vector<TorqueBlock> blocks = fold_torques(rows, points_.tau);
    Explanation e;
    if (before != nullptr) {
      e.words = before->words;
      e.key = before->key;
      e.mend = before->mend;
      e.changes = before->changes;
    }
    e.drive = before != nullptr ? before->drive : h.drive;
    e.reading = reading;
    e.alone = root_mean_square(own_residuals(blocks));
    e.changes += h.changes;
    e.odd = h.odd;
    if (!h.words.empty()) e.say(h.key, h.words, h.mend);
    e.assignment = h.drives_moved ? h.reading.source : own_columns();
    do {
      add_signs_and_factors(h, e, blocks);
      // Both columns in another order is the robot numbered in another way: no further hypothesis.
    } while (!h.drives_moved && h.key != "position_order" && std::ranges::next_permutation(e.assignment).found);
  }

  void add_signs_and_factors(const PositionHypothesis& h, Explanation e, const std::vector<TorqueBlock>& blocks) {
    const int n = robot_.drives();
    if (!h.drives_moved) tell_order(e);
    const Eigen::MatrixXd form = residual_form(blocks, e.assignment, Eigen::VectorXd::Ones(n));
    // The sign of all torques together is a matter of the masses; of two opposite patterns the one with fewer turned is
    // taken.
    for (int set = 0; set < (1 << (n - 1)); ++set) {
      e.factor = signs_of(set);
      if (2 * (e.factor.array() < 0).count() > n) e.factor = -e.factor;
      e.residual = relative_residual(form, e.factor);
      add(e, -1, {});
    }
    if (n == 1) return;
    // Another unit of one torque beside a wrong position is two faults, unless it is one drive's motor side.
    const bool motor_side = h.key == "position_scale" && h.drive >= 0;
    if (!h.words.empty() && !motor_side) return;
    for (int j = 0; j < n; ++j) {
      if (motor_side && j != h.drive) continue;
      const Factor factor = best_factor(blocks, e.assignment, j);
      if (std::abs(std::abs(factor.value) - 1) < kScaleWorth || std::abs(factor.value) < 5 * factor.std) continue;
      e.factor.setOnes();
      e.factor(j) = factor.value;
      const Eigen::MatrixXd again = residual_form(blocks, e.assignment, e.factor.cwiseAbs());
      e.residual = relative_residual(again, e.factor.cwiseSign());
      add(e, j, factor);
    }
  }

  /// \param scaled_drive  whose torque has another scale; -1: none
  void add(Explanation e, int scaled_drive, const Factor& scale) {
    tell_signs(scaled_drive, e);
    if (scaled_drive >= 0) tell_factor(scaled_drive, scale, e);
    if (!e.words.empty()) all_.push_back(std::move(e));
  }

  static void tell_order(Explanation& e) {
    const std::vector<int>& order = e.assignment;
    std::vector<int> moved;
    std::string columns;
    for (std::size_t j = 0; j < order.size(); ++j) {
      if (order[j] != static_cast<int>(j)) moved.push_back(static_cast<int>(j));
      columns += fmt::format("{}{}", columns.empty() ? "" : ", ", order[j] + 1);
    }
    if (moved.empty()) return;
    e.changes += static_cast<double>(moved.size()) - 0.1;  // one column moved back is less than one turned
    const std::string words =
        moved.size() == 2
            ? fmt::format("the torques of drives {} and {} are swapped against their positions", moved[0] + 1,
                          moved[1] + 1)
            : fmt::format(
                  "the torques are in another order than the positions: drives 1 to {} have the torque columns {}",
                  order.size(), columns);
    e.say("torque_order", words,
          "bring positions and torques of each drive together (delta-log import: source in the map)");
  }

  void tell_signs(int scaled_drive, Explanation& e) const {
    std::vector<int> turned;
    for (int j = 0; j < e.factor.size(); ++j) {
      if (e.factor(j) < 0 && j != scaled_drive) turned.push_back(j);
    }
    if (turned.empty()) return;
    e.changes += static_cast<double>(turned.size());
    if (e.drive < 0 && turned.size() == 1) e.drive = turned.front();
    e.say("torque_sign", fmt::format("the torque of {} has the wrong sign", drives_in_words(turned, robot_.drives())),
          "turn the sign of the torque column (delta-log import: sign = -1 in the map)");
  }

  static void tell_factor(int drive, const Factor& scale, Explanation& e) {
    const double factor = e.factor(drive);
    // The form's factor turns the column into the torque; what the user sees is its inverse.
    e.changes += factor < 0 ? 2.5 : 1.5;
    e.value = 1 / factor;
    e.std = scale.std / (factor * factor);
    e.drive = drive;
    e.say("torque_scale_drive",
          fmt::format("the torque of drive {} is {:.4g} +- {:.2g} times what the other drives need: unit, torque "
                      "constant or gear ratio?",
                      drive + 1, e.value, e.std),
          "give the torque of every drive in N m at the joint (N for a carriage)");
  }

  [[nodiscard]] double refine(const PositionFamily& family, const Reading& start, double value) const {
    double step = 4 * family.step;  // the coarse search may end some steps off
    const auto at = [&](double x) { return best_torques(family, start, x, points_); };
    double best = at(value);
    for (int pass = 0; pass < 16; ++pass) {
      step *= 0.5;
      for (const double sign : {-1.0, 1.0}) {
        const double there = family.geometric ? value * (1 + sign * step) : value + sign * step;
        const double residual = at(there);
        if (residual < best) {
          best = residual;
          value = there;
          break;
        }
      }
    }
    return value;
  }

  /// The unit, whole ratio or right angle next to a value, if it explains the log about as well.
  [[nodiscard]] double plausible(const PositionFamily& family, const Reading& start, double value) const {
    const double least = best_torques(family, start, value, points_);
    for (const double candidate : plausible_values(family, robot_.description(), value)) {
      if (best_torques(family, start, candidate, points_) < kAlike * least + 0.002) return candidate;
    }
    return value;
  }

  /// Smallest residual over the signs of the torques, for the motor side of one drive over its factor, too; not finite
  /// where the poses are out of reach.
  [[nodiscard]] double best_torques(const PositionFamily& family, const Reading& start, double value,
                                    const Points& points) const {
    const Reading reading = compose(member(family, robot_.description(), value, 0).reading, start);
    const Rows rows = rows_of_points(robot_, base_, points, reading);
    if (rows.unreachable > kOutOfReach || !enough(rows)) return std::numeric_limits<double>::infinity();
    const std::vector<TorqueBlock> blocks = fold_torques(rows, points.tau);
    const int n = robot_.drives();
    const std::vector<int> order = own_columns();
    const Eigen::MatrixXd form = residual_form(blocks, order, Eigen::VectorXd::Ones(n));
    double best = std::numeric_limits<double>::infinity();
    for (int set = 0; set < (1 << (n - 1)); ++set) best = std::min(best, relative_residual(form, signs_of(set)));
    if (!family.geometric || family.drives.size() != 1 || n == 1) return best;
    Eigen::VectorXd s = Eigen::VectorXd::Ones(n);
    s(family.drives.front()) = best_factor(blocks, order, family.drives.front()).value;
    if (s.cwiseAbs().minCoeff() < 1e-6) return best;
    return std::min(best, relative_residual(residual_form(blocks, order, s.cwiseAbs()), s.cwiseSign()));
  }

  [[nodiscard]] Points thinned(Index count) const {
    Points few;
    few.sigma_s = points_.sigma_s;
    const Index N = points_.q.rows(), step = std::max<Index>(1, N / count);
    for (Index k = 0; k < N; k += step) few.at.push_back(points_.at[static_cast<std::size_t>(k)]);
    const auto rows = Eigen::seqN(0, std::ssize(few.at), step);
    few.q = points_.q(rows, Eigen::all);
    few.qd = points_.qd(rows, Eigen::all);
    few.qdd = points_.qdd(rows, Eigen::all);
    few.tau = points_.tau(rows, Eigen::all);
    few.torque_out = points_.torque_out(rows, Eigen::all);
    return few;
  }

  /// Those that explain the log clearly better than as it is, the one with the fewest changes first.
  [[nodiscard]] std::vector<Explanation> winners(double as_given) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Explanation& e : all_) least = std::min(least, e.residual);
    std::vector<Explanation> out;
    if (least > kSoundWinner) return out;
    for (const Explanation& e : all_) {
      // A factor or a zero of any size follows the torque of a spring or rotor to some extent, too.
      if (is_search(e.key) && std::min(with_springs_, with_rotors_) < kOwnTorque * e.residual) continue;
      if (e.residual < kAlike * least + 0.0005 && (e.residual < kWins * as_given || heals(e, as_given)) &&
          (!e.odd || e.residual < kSoundOdd))
        out.push_back(e);
    }
    if (out.empty()) return out;
    std::ranges::sort(out, {}, [](const Explanation& e) { return std::pair(e.changes, e.residual); });
    // Searches end near one another: of the same words the best.
    std::vector<Explanation> distinct;
    for (const Explanation& e : out) {
      if (std::ranges::none_of(distinct, [&](const Explanation& d) {
            return d.words == e.words || (d.key == e.key && d.drive == e.drive && is_search(d.key));
          }))
        distinct.push_back(e);
    }
    const double fewest = distinct.front().changes;
    std::erase_if(distinct, [&](const Explanation& e) { return e.changes > fewest + 0.5; });
    return distinct;
  }

  /// Noise may cover most of a residual. What is left of a fault then is that all drives together fit worse than each
  /// one alone.
  [[nodiscard]] bool heals(const Explanation& e, double as_given) const {
    if (e.odd && e.key == "position_scale") return false;  // a wrong length of the robot file looks like that, too
    return e.torques_as_given() && as_given > kBreaks * alone_ &&
           e.residual < (e.odd ? kWinsOdd : kWinsNoisy) * as_given && e.residual < kHeals * e.alone;
  }

  static bool is_search(const std::string& key) { return key == "position_scale" || key == "position_zero"; }

  const Robot& robot_;
  const BaseParameters& base_;
  const Points& points_;
  double unreachable_ = 0, alone_ = 0;
  double with_springs_ = 1, with_rotors_ = 1;  ///< residual of the log as given with one on every drive
  std::vector<Explanation> all_;
};

}  // namespace

Judgement judge(const Robot& robot, const BaseParameters& base, const Points& points) {
  return Judge(robot, base, points).run();
}

}  // namespace deltadyn::gate
