/// \file
/// Single wrong samples are replaced; a position that jumps and stays is refused.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/runtime/statistics.hpp"

#include "checks.hpp"
#include "sample_stretches.hpp"

namespace deltadyn::checks {
namespace {

constexpr double kOutlier = 30.0;     // times farther from the cubic through its neighbours than usual
constexpr double kRounding = 1e-9;    // of the value: what the digits of a file leave of a constant
constexpr Index kWindow = 25;         // samples on either side that tell what is usual here
constexpr double kManySpikes = 0.01;  // of the samples: then the recording itself is in doubt
constexpr Index kLongestSpike = 5;    // samples; longer is an event of its own

/// Distance of a sample from the cubic through its four neighbours.
double surprise(const Eigen::Ref<const Eigen::VectorXd>& v, Index i) {
  return v(i) - (4.0 * (v(i - 1) + v(i + 1)) - (v(i - 2) + v(i + 2))) / 6.0;
}

/// The line across [begin, end) from the samples around it.
double bridge(const Eigen::Ref<const Eigen::VectorXd>& v, Index begin, Index end, Index i) {
  const double share = static_cast<double>(i - begin + 1) / static_cast<double>(end - begin + 1);
  return (1.0 - share) * v(begin - 1) + share * v(end);
}

/// Looks through one channel.
class SpikeSearch {
 public:
  SpikeSearch(CheckRoom& room, const Channel& channel)
      : room_(room), channel_(channel), values_(channel.values()), largest_(values_.cwiseAbs().maxCoeff()) {
    const Index n = values_.size();
    size_.setZero(n);
    for (Index i = 2; i + 2 < n; ++i) size_(i) = std::abs(surprise(values_, i));
    std::vector<double> moving;
    for (const auto& [begin, end] : sample_stretches(n, 512)) {
      for (Index i = begin; i < end; ++i) {
        if (size_(i) > kRounding * largest_) moving.push_back(size_(i));
      }
    }
    usual_ = lower_median(std::move(moving));
  }

  void run() {
    const Index n = values_.size();
    const double floor = std::max(kOutlier * usual_, 1e-12 * largest_);
    for (Index i = 2; i + 2 < n; ++i) {
      if (size_(i) <= floor || !is_peak(i)) continue;
      const double nearby = largest_nearby(i, 3);
      if (size_(i) > kOutlier * nearby / 5.0) {
        if (replaced_leaves_little(i, nearby)) {
          replace(i, i + 1);
          continue;
        }
        if (channel_.position && is_jump(i)) refuse_jump(i);
      }
      // A spike of several samples surprises at both of its ends.
      if (const Index end = end_of_long_spike(i); end > i) replace(i, end);
    }
  }
  [[nodiscard]] const Tally& spikes() const { return spikes_; }
  [[nodiscard]] double first_value() const { return first_value_; }

 private:
  [[nodiscard]] bool is_peak(Index i) const { return size_.segment(i - 2, 5).maxCoeff() <= size_(i); }

  /// Largest surprise around sample i, without those within `apart`, which what is at i causes itself.
  [[nodiscard]] double largest_nearby(Index i, Index apart) const {
    double largest = 0;
    for (Index k = std::max<Index>(2, i - kWindow); k <= std::min(values_.size() - 3, i + kWindow); ++k) {
      if (std::abs(k - i) > apart) largest = std::max(largest, size_(k));
    }
    return largest;
  }

  /// A step or a kink also surprises, but stays when the sample is replaced.
  [[nodiscard]] bool replaced_leaves_little(Index i, double nearby) const {
    const Index first = std::max<Index>(0, i - 4);
    Eigen::VectorXd mended = values_.segment(first, std::min<Index>(9, values_.size() - first));
    const Index centre = i - first;
    mended(centre) -= surprise(mended, centre);
    double left = 0;
    for (Index k = std::max<Index>(2, centre - 2); k <= std::min(mended.size() - 3, centre + 2); ++k) {
      left = std::max(left, std::abs(surprise(mended, k)));
    }
    return left < 0.1 * size_(i) + nearby;
  }

  /// End of a spike of several samples around i: all of them far from the line across, which itself is smooth; i if
  /// there is none.
  Index end_of_long_spike(Index& i) const {
    const Index n = values_.size();
    for (Index length = 2; length <= kLongestSpike; ++length) {
      for (Index begin = std::max<Index>(3, i - length); begin <= i + 1 && begin + length + 3 < n; ++begin) {
        const Index end = begin + length;
        // What the line across would miss anyway: the largest change over so many samples nearby.
        double around = usual_;
        for (Index k = std::max<Index>(0, begin - kWindow); k + length < std::min(n, end + kWindow); ++k) {
          if (k + length < begin || k >= end) around = std::max(around, std::abs(values_(k + length) - values_(k)));
        }
        if (std::abs(values_(end) - values_(begin - 1)) > 2.0 * around) continue;
        double least = 1e300;
        for (Index k = begin; k < end; ++k)
          least = std::min(least, std::abs(values_(k) - bridge(values_, begin, end, k)));
        if (least < 8.0 * around || least < kOutlier * usual_) continue;
        i = begin;
        return end;
      }
    }
    return i;
  }

  /// A kink (a hard stop) surprises too, but its steps are no larger than those around it.
  [[nodiscard]] bool is_jump(Index i) const {
    const auto step = [&](Index k) { return std::abs(values_(k + 1) - values_(k)); };
    double around = 0;
    for (Index k = std::max<Index>(0, i - kWindow); k < std::min(values_.size() - 1, i + kWindow); ++k) {
      if (std::abs(k - i) > 3) around = std::max(around, step(k));
    }
    return std::max(step(i - 1), step(i)) > 4.0 * around;
  }

  [[noreturn]] void refuse_jump(Index i) const {
    check_stuck(room_);  // an encoder that reads again jumps too, and then the cause is worth more than the jump
    throw Error(fmt::format("the position jumps, from {:.9g} to {:.9g}", values_(i - 1), values_(i + 1)),
                room_.where(i, channel_.name),
                "unwrap the angle if it was wrapped; else look for lost encoder counts and cut the log here");
  }

  void replace(Index begin, Index end) {
    if (spikes_.count == 0) first_value_ = values_(begin);
    spikes_.add(begin, end - begin);
    auto column = channel_.block->col(channel_.drive);
    if (channel_.position && end - begin == 1) {
      column(begin) -= surprise(values_, begin);
    } else {
      for (Index k = begin; k < end; ++k) column(k) = bridge(values_, begin, end, k);
    }
    values_.segment(begin, end - begin) = column.segment(begin, end - begin);
    for (Index k = std::max<Index>(2, begin - 2); k <= std::min(values_.size() - 3, end + 1); ++k)
      size_(k) = std::abs(surprise(values_, k));
    for (Index k = begin; k < end; ++k) room_.mark_filled(k, end - begin == 1 ? Log::kBridged : Log::kLeftOut);
  }

  CheckRoom& room_;
  const Channel& channel_;
  Eigen::VectorXd values_;
  double largest_;
  double usual_ = 0;
  double first_value_ = 0;
  Eigen::VectorXd size_;
  Tally spikes_;
};

}  // namespace

void repair_spikes(CheckRoom& room) {
  if (room.log.samples() < 12) return;
  struct Found {
    const Channel* channel;
    Tally spikes;
    double value;
  };
  const std::vector<Channel> channels = room.channels();
  std::vector<Found> all;
  Index count = 0;
  for (const Channel& channel : channels) {
    if (channel.block != &room.log.q && channel.block != &room.log.tau) continue;
    SpikeSearch search(room, channel);
    search.run();
    if (search.spikes().count > 0) all.push_back({&channel, search.spikes(), search.first_value()});
    count += search.spikes().count;
  }
  const bool many = static_cast<double>(count) > kManySpikes * static_cast<double>(room.log.samples());
  for (const Found& one : all) {
    const std::string more = all.size() > 1
                                 ? fmt::format(", the first of {} such samples in {} columns", count, all.size())
                             : count > 1 ? fmt::format(", the first of {} such samples", count)
                                         : " of one sample";
    room.tell({.level = many ? FindingLevel::warning : FindingLevel::mended,
               .key = one.channel->position ? "spikes" : "torque_spikes",
               .drive = static_cast<int>(one.channel->drive),
               .value = static_cast<double>(one.spikes.count),
               .unit = "rows",
               .text = fmt::format("{}: the value {:.9g} is a spike{}, replaced",
                                   room.where(one.spikes.first, one.channel->name), one.value, more),
               .mend = many ? "look for a loose cable or a recorder that mixes up its channels" : ""},
              &one == &all.front());
  }
}

}  // namespace deltadyn::checks
