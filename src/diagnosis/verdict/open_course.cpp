#include "open_course.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace deltadyn::detail {

namespace {

/// Largest rates of a drive: in the fastest and in the slowest training log, and in the hold-out log.
struct Speeds {
  double training = 0, slowest = std::numeric_limits<double>::infinity(), holdout = 0;
};

Speeds speeds_of(const SearchContext& context, Index drive) {
  Speeds out;
  for (const LogRows& log : context.logs) {
    const double largest = log.qd.col(drive).cwiseAbs().maxCoeff();
    out.training = std::max(out.training, largest);
    out.slowest = std::min(out.slowest, largest);
  }
  if (context.holdout != nullptr) out.holdout = context.holdout->qd.col(drive).cwiseAbs().maxCoeff();
  return out;
}

}  // namespace

std::optional<Remark> open_course(const SearchContext& context, const NamedEffect& one, double gap_shrink) {
  const DiagnosisPolicy& policy = context.policy();
  const EffectKind& kind = effect_kind(one.effect.id);
  const Course course = kind.course != nullptr ? kind.course(one.effect.shape.data()) : Course::not_by_rate;
  if (course == Course::not_by_rate) return std::nullopt;
  const Speeds speed = speeds_of(context, one.effect.joint);
  double wanted = context.robot.description().limits[static_cast<std::size_t>(one.effect.joint)].velocity;
  if (!std::isfinite(wanted)) wanted = speed.holdout;
  if (speed.training >= policy.slow_logs * wanted) return std::nullopt;
  const bool one_speed = speed.training < policy.other_speed * speed.slowest;
  const double unsure = one.effect.amplitude_std(0) / std::abs(one.effect.amplitude(0));
  Remark out{.kind = Remark::Kind::course_unsure,
             .who = one.at_joint(),
             .drive = one.effect.joint,
             .value = policy.slow_logs * wanted,
             .other = unsure};
  if (unsure > policy.unsure_course) return out;
  if (speed.holdout > policy.other_speed * speed.training && gap_shrink < policy.as_good) {
    out.kind = Remark::Kind::course_missed_beyond;
    out.other = gap_shrink;
    return out;
  }
  if (one_speed && course == Course::endless) {
    out.kind = Remark::Kind::course_is_a_power;
    return out;
  }
  if (one_speed && course == Course::ends_at_rate && speed.training < policy.course_ends * one.effect.shape(0)) {
    out.kind = Remark::Kind::course_ends_within;
    out.other = speed.training / one.effect.shape(0);
    return out;
  }
  return std::nullopt;
}

}  // namespace deltadyn::detail
