#include "plausibility.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/runtime/statistics.hpp"

#include "readings.hpp"

namespace deltadyn::gate {

namespace {

using Eigen::Index;

// |ln ratio| beyond kFault + kFaultTrust x (relative deviation of the prior) is no machine of this prior: with simple
// shapes (50 %) a factor of 3.3, with parts weighed to 2 % a factor of 1.27; a prior that is 30 % off raises nothing.
constexpr double kFault = 0.2, kFaultTrust = 2.0;
constexpr double kWarning = 0.12, kWarningTrust = 1.3;
constexpr double kCertain = 5.0;       // standard deviations of the data for a sign
constexpr double kKnown = 0.3;         // relative deviation of the data above which a ratio says nothing
constexpr double kBeyondRotors = 100;  // times the prior's inertia
constexpr double kWeighed = 0.15;      // relative deviation of a prior whose parts were weighed
// Gravity that exceeds the inertia's ratio by more than 1/this is no matter of the torque's scale
constexpr double kSpread = 0.5;
constexpr double kSoundInertia = 0.5;  // of the prior's, from which the torque's unit is right
// Of a sound weight, below which gravity is neither way up, but carried; and how well that must be known
constexpr double kCarried = 0.3, kCarriedKnown = 0.1;
// Times the effort of the robot file: drives reach three times their rated torque for moments
constexpr double kFaultEffort = 5.0;
constexpr double kWarnEffort = 1.5;
constexpr double kFarTooFast = 10.0;   // times the velocity limit
constexpr double kFarBeyond = 3.0;     // times the position limits
constexpr double kBeyondPlate = 1.03;  // times the plate's range: encoders and zero positions are a little off

double beyond(double ratio, double prior_std, double base, double trust) {
  return std::abs(std::log(std::max(ratio, 1e-12))) - base - trust * prior_std;
}

/// Units that make a factor of `ratio`, in words.
std::string units_of(const RobotDescription& robot, double ratio, double relative_std) {
  std::string words;
  const auto near = [&](double factor) {
    return factor > 0 && std::abs(std::log(ratio / factor)) < std::max(0.03, 2 * relative_std);
  };
  const bool turns = robot.drive_kind == DriveKind::revolute;
  if (near(1000)) words = turns ? "mN m?" : "mN?";
  if (near(0.001)) words = turns ? "kN m?" : "kN?";
  const double effort = robot.limits.front().effort;
  if (words.empty() && std::isfinite(effort) && effort > 0 && effort < 1e9) {
    if (near(1000 / effort)) words = fmt::format("per mille of the effort of {:g} in the robot file?", effort);
    if (near(100 / effort)) words = fmt::format("per cent of the effort of {:g} in the robot file?", effort);
    if (near(1 / effort)) words = fmt::format("a share of the effort of {:g} in the robot file?", effort);
  }
  return words.empty() ? "unit, torque constant or gear ratio?" : words + " Else torque constant or gear ratio";
}

LogFinding scale_finding(const RobotDescription& robot, const Ratio& ratio, double prior_std, bool fault,
                         const std::string& who, int drive) {
  return {.level = fault ? FindingLevel::fault : FindingLevel::warning,
          .key = drive >= 0 ? "torque_scale" : "scale",
          .drive = drive,
          .value = ratio.value,
          .std = ratio.std,
          .text = fmt::format("torque is {:.3g} +- {:.2g} times what the masses of the prior need, {}: {}", ratio.value,
                              ratio.std, who,
                              units_of(robot, ratio.value, std::hypot(ratio.data_std / ratio.value, prior_std))),
          .mend =
              "give the torque in N m at the joint (N for a carriage): delta-log import LOG --torque-unit permille "
              "--rated-torque .. (or --torque-unit A, a gear ratio) makes such a log; or, if it is right, give a "
              "--prior with the weighed masses"};
}

/// Inertia that comes out negative: the torque, or the position, has the wrong sign.
bool add_sign_findings(const RobotDescription& robot, const TorqueScale& scale, std::vector<LogFinding>& out) {
  std::vector<int> negative;
  for (std::size_t j = 0; j < scale.inertia.size(); ++j) {
    const Ratio& r = scale.inertia[j];
    if (r.known && r.value < -kCertain * r.data_std && r.value < -0.02) negative.push_back(static_cast<int>(j));
  }
  if (negative.empty()) return false;
  const bool all_limbs = negative.size() >= robot.limbs.size() && negative.front() == 0;
  const Ratio& first = scale.inertia[static_cast<std::size_t>(negative.front())];
  out.push_back(
      {.level = FindingLevel::fault,
       .key = "torque_sign",
       .drive = negative.size() == 1 ? negative.front() : -1,
       .value = first.value,
       .std = first.data_std,
       .text = fmt::format(
           "torque of {} has the wrong sign{}: the inertia comes out at {:.3g} +- {:.2g} times that of the prior",
           drives_in_words(negative, robot.drives()), all_limbs ? "" : " (or its position has)", first.value,
           first.data_std),
       .mend = "turn the sign of the torque (delta-log import: sign = -1 in the map)"});
  return true;
}

std::string all_or_limbs(const RobotDescription& robot, bool yaw_alike) {
  const int limbs = static_cast<int>(robot.limbs.size());
  if (robot.drives() == 1) return "drive 1";
  if (robot.drives() == limbs || yaw_alike) return "on all drives alike";
  return fmt::format("on drives 1 to {} alike", limbs);
}

/// Rate of a drive that only a twentieth of the steps exceed [rad/s | m/s].
double usual_rate(const Log& log, int drive) {
  const Index stride = std::max<Index>(1, log.samples() / 5000);
  std::vector<double> rates;
  for (Index k = 1; k < log.samples(); k += stride)
    rates.push_back(std::abs(log.q(k, drive) - log.q(k - 1, drive)) / std::max(log.t_s(k) - log.t_s(k - 1), 1e-12));
  return quantile(std::move(rates), 0.95);
}

/// A rate that no drive of this limit has: positions or time in another unit.
void add_rate_finding(const RobotDescription& robot, const std::vector<Log>& logs, int drive,
                      std::vector<LogFinding>& out) {
  const double limit = robot.limits[static_cast<std::size_t>(drive)].velocity;
  if (!(limit > 0 && limit < 1e9)) return;
  for (const Log& log : logs) {
    const double rate = usual_rate(log, drive);
    if (rate < kFarTooFast * limit) continue;
    out.push_back({.level = FindingLevel::fault,
                   .key = "position_rate",
                   .file = log.file,
                   .drive = drive,
                   .value = rate,
                   .unit = robot.kind_of_drive(drive) == DriveKind::revolute ? "rad/s" : "m/s",
                   .text = fmt::format("a velocity of {:.4g} is far beyond the limit of {:.4g} of drive {} (SI): "
                                       "positions or time have another unit",
                                       rate, limit, drive + 1),
                   .mend = "give positions in rad or m, or name the column _deg; give the time in seconds"});
    return;
  }
}

/// Springs, a hose or a counterweight hold what gravity pulls. Reflected rotors make the inertia large, not the weight.
bool is_carried(const Ratio& gravity, double inertia) {
  const double sound = std::min(1.0, inertia);
  return inertia > kSoundInertia && gravity.known && gravity.data_std < kCarriedKnown * sound &&
         std::abs(gravity.value) < kCarried * sound;
}

}  // namespace

std::vector<LogFinding> scale_findings(const RobotDescription& robot, const TorqueScale& scale) {
  std::vector<LogFinding> out;
  if (add_sign_findings(robot, scale, out)) return out;
  const std::size_t limbs = robot.limbs.size();
  const Ratio& g = scale.gravity;
  const bool weight_known = g.known && g.data_std < kKnown * std::abs(g.value);
  double inertia = 0, inertia_std = 0;
  int count = 0;
  for (std::size_t j = 0; j < std::min(limbs, scale.inertia.size()); ++j) {
    if (!scale.inertia[j].known || scale.inertia[j].data_std > kKnown * std::abs(scale.inertia[j].value)) continue;
    inertia += scale.inertia[j].value;
    inertia_std += scale.inertia[j].data_std;
    ++count;
  }
  if (count > 0) inertia /= count, inertia_std /= count;
  const bool carried = count > 0 && is_carried(g, inertia);
  const auto of_gravity = [&](FindingLevel level, const char* key, const char* words, const char* mend) -> LogFinding {
    return {.level = level,
            .key = key,
            .value = g.value,
            .std = g.data_std,
            .text = fmt::format("{} {:.3g} +- {:.2g} times those of the prior, the inertia {:.3g} times", words,
                                g.value, g.data_std, inertia),
            .mend = mend};
  };
  if (carried) {
    out.push_back(of_gravity(FindingLevel::warning, "gravity_carried", "gravity's torques are",
                             "if springs, a hose or a counterweight carry the arms, delta-diagnose names them; else "
                             "check how the base hangs: gravity in the robot file"));
  } else if (weight_known && g.value < 0 && count > 0 && inertia > 0) {
    return {of_gravity(FindingLevel::fault, "gravity_direction", "gravity acts the other way: its torques are",
                       "check how the base hangs: gravity in the robot file, and the direction of positive positions")};
  }
  Ratio ratio = g;
  bool certain = weight_known;
  if ((!weight_known || carried) && count > 0) {
    ratio.value = inertia;
    ratio.data_std = inertia_std;
    ratio.std = std::hypot(inertia_std, scale.prior_std * inertia);
    ratio.known = true;
    certain = inertia < 1;  // reflected rotor inertia may make it large, nothing makes it small
  }
  if (!ratio.known || ratio.value <= 0 || (!weight_known && count == 0)) return out;
  // A weight too large for the inertia, or springs that carry it, is another matter than the torque's scale.
  if (weight_known && count > 0 && inertia < kSpread * g.value) certain = false;
  if (weight_known && count > 0 && g.value < 1 && inertia > kSoundInertia) certain = false;
  const double far = beyond(ratio.value, scale.prior_std, kFault, kFaultTrust);
  const double doubtful = beyond(ratio.value, scale.prior_std, kWarning, kWarningTrust);
  const bool yaw_alike = scale.inertia.size() > limbs && scale.inertia.back().known &&
                         std::abs(std::log(std::max(1e-12, scale.inertia.back().value / ratio.value))) < 0.7;
  if (doubtful > 0 && !carried)
    out.push_back(scale_finding(robot, ratio, scale.prior_std, certain && far > 0, all_or_limbs(robot, yaw_alike), -1));
  if (scale.inertia.size() <= limbs || yaw_alike) return out;
  const Ratio& yaw = scale.inertia.back();
  if (!yaw.known || yaw.value <= 0 || yaw.data_std > kKnown * yaw.value) return out;
  const double yaw_prior = std::sqrt(std::max(0.0, yaw.std * yaw.std - yaw.data_std * yaw.data_std)) / yaw.value;
  const double yaw_far = beyond(yaw.value, yaw_prior, kFault, kFaultTrust);
  const bool small = yaw.value < 1;
  // Rotor inertia makes it large as a rule: only beside weighed parts, or beyond what rotors do, is that worth a word.
  if (yaw_far > 0 && (small || yaw_prior < kWeighed || yaw.value > kBeyondRotors)) {
    LogFinding f =
        scale_finding(robot, yaw, yaw_prior, small, fmt::format("on drive {}", limbs + 1), static_cast<int>(limbs));
    f.text = fmt::format("the inertia about drive {} is {:.3g} +- {:.2g} times that of the prior: {}", limbs + 1,
                         yaw.value, yaw.std,
                         small ? "position in degrees, or unit of the torque?"
                               : "rotor inertia of a geared motor (--rotor-inertia), or unit of the torque?");
    out.push_back(std::move(f));
  }
  return out;
}

std::vector<LogFinding> limit_findings(const RobotDescription& robot, const std::vector<Log>& logs, bool moving) {
  std::vector<LogFinding> out;
  for (int j = 0; j < robot.drives(); ++j) {
    const DriveLimits& limit = robot.limits[static_cast<std::size_t>(j)];
    double torque = 0, position = 0;
    for (const Log& log : logs) {
      if (log.tau.cols() > j) torque = std::max(torque, log.tau.col(j).cwiseAbs().maxCoeff());
      position = std::max(position, log.q.col(j).cwiseAbs().maxCoeff());
    }
    const bool turns = robot.kind_of_drive(j) == DriveKind::revolute;
    if (limit.effort > 0 && limit.effort < 1e9 && torque > kWarnEffort * limit.effort) {
      out.push_back(
          {.level = torque > kFaultEffort * limit.effort ? FindingLevel::fault : FindingLevel::warning,
           .key = "effort",
           .drive = j,
           .value = torque / limit.effort,
           .text = fmt::format("torque of drive {} reaches {:.4g} {}, {:.3g} times the effort in the robot file: unit?",
                               j + 1, torque, turns ? "N m" : "N", torque / limit.effort),
           .mend = "give the torque in N m at the joint (N for a carriage), or mend the effort in the robot file"});
    }
    if (moving) add_rate_finding(robot, logs, j, out);
    const double farthest = std::max(std::abs(limit.lower), std::abs(limit.upper));
    if (farthest > 0 && farthest < 1e9 && position > kFarBeyond * farthest) {
      out.push_back({.level = FindingLevel::fault,
                     .key = "position_range",
                     .drive = j,
                     .value = position,
                     .unit = turns ? "rad" : "m",
                     .text = fmt::format("position of drive {} reaches {:.4g} {}, the robot file allows {:.3g}: {}?",
                                         j + 1, position, turns ? "rad" : "m", farthest,
                                         turns ? "degrees, or the motor's side of a gear" : "millimetres"),
                     .mend = turns ? "name the column with its unit (q1_deg ...), or divide by the gear ratio"
                                   : "convert the column to m"});
    }
  }
  return out;
}

std::vector<LogFinding> plate_findings(const Robot& robot, const std::vector<Log>& logs) {
  const double range = robot.description().plate_yaw_range();
  if (!(range > 0)) return {};
  double farthest = 0;
  std::string file;
  Eigen::VectorXd z(robot.drives());
  for (const Log& log : logs) {
    const Index stride = std::max<Index>(1, log.samples() / 5000);
    PathPose path;
    for (Index k = 0; k < log.samples(); k += stride) {
      if (robot.forward_kinematics(log.q.row(k).transpose(), z, &path) != Status::ok || std::abs(z(3)) <= farthest)
        continue;
      farthest = std::abs(z(3));
      file = log.file;
    }
  }
  if (farthest <= kBeyondPlate * range) return {};
  return {{.level = FindingLevel::warning,
           .key = "plate_range",
           .file = file,
           .value = farthest,
           .unit = "rad",
           .text = fmt::format("the tool turns to {:.4g} rad, but its plate allows {:.4g} rad to either side", farthest,
                               range),
           .mend = "check the zero positions and the order of the drives; or mend range_rad of <plate> in the robot "
                   "file"}};
}

}  // namespace deltadyn::gate
