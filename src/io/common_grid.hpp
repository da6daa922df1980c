#pragma once

/// \file
/// Channels of several sample rates on the time stamps of one of them, without phase error.

#include <Eigen/Core>

namespace deltadyn {

/// One channel with its own time stamps, strictly increasing.
struct SampledChannel {
  Eigen::VectorXd t_s, values;
};

struct ValueRange {
  double low, high;
  [[nodiscard]] double width() const { return high - low; }
};
/// Of the numbers that are there.
[[nodiscard]] ValueRange range_of(const Eigen::Ref<const Eigen::VectorXd>& values);

/// Median step of stamps [s].
[[nodiscard]] double usual_step_s(const Eigen::Ref<const Eigen::VectorXd>& t_s);

/// Rows that follow the first over the time from first to last stamp [Hz]; 0 if there is none.
[[nodiscard]] double mean_rate_hz(const Eigen::Ref<const Eigen::VectorXd>& t_s);

/// Values at the times of the grid. A faster channel first passes a zero-phase low pass at 0.4 of the grid's rate, so
/// that nothing folds into its band; then the cubic through the four samples around each time is taken, which shifts no
/// frequency in time. Where the channel has a gap of more than 2.5 of its steps, and outside of it, the value is NaN:
/// nothing is made up.
/// \param low_pass_hz  the edge of the low pass, 0 if none was needed
[[nodiscard]] Eigen::VectorXd onto_grid(const SampledChannel& series, const Eigen::Ref<const Eigen::VectorXd>& grid_s,
                                        double& low_pass_hz);

/// Sample indices of a channel whose slower recorder was filled up with repeats of the last value: of each `factor`
/// rows the one where new values appear.
[[nodiscard]] Eigen::Index first_of_repeats(const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Index factor);

/// Takes the jumps out of a number that begins again after `wrap`. Returns how many there were.
Eigen::Index unwrap(Eigen::Ref<Eigen::VectorXd> values, double wrap);

/// The period at which a position begins again, if its jumps all agree with one (2 pi, 360, a power of two, `counts`);
/// else 0.
/// \param counts  counts per turn, 0: not known
[[nodiscard]] double find_wrap(const Eigen::Ref<const Eigen::VectorXd>& values, double counts);

}  // namespace deltadyn
