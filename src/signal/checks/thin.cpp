/// \file
/// A log with stale channels carries no more than the slowest of them: it is brought to that rate, in phase with it.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/signal/fir_decimator.hpp"

#include "checks.hpp"

namespace deltadyn::checks {

/// The rows in which the slowest channel was measured anew: offset of the first one. To be found before gaps are
/// filled.
Index fresh_phase(const CheckRoom& room) {
  const int factor = room.thinning;
  const Log& log = room.log;
  std::vector<Index> fresh(static_cast<std::size_t>(factor), 0);
  for (Index d = 0; d < log.drives(); ++d) {
    const bool positions = room.stale_positions[static_cast<std::size_t>(d)] == factor;
    const bool torques = room.stale_torques[static_cast<std::size_t>(d)] == factor;
    if (!positions && !torques) continue;
    const auto& block = positions ? log.q : log.tau;
    for (Index i = 0; i < log.samples(); ++i) {
      if (std::isfinite(block(i, d))) ++fresh[static_cast<std::size_t>(i % factor)];
    }
    break;
  }
  return std::ranges::max_element(fresh) - fresh.begin();
}

void thin_to_fresh_rows(CheckRoom& room) {
  const int factor = room.thinning;
  if (factor == 1) return;
  Log& log = room.log;
  const double rate_hz = 1.0 / room.grid.step_s;
  // As wide as the new rate allows; it leaves the lower half of the band as it is.
  const FirDecimator low_pass(rate_hz, 0.5 * rate_hz / factor, factor);
  const Index phase = room.fresh_row;
  const Index half = low_pass.half_width();
  std::vector<Index> rows;
  for (Index i = phase; i < log.samples(); i += factor) {
    if (i >= half && i + half < log.samples()) rows.push_back(i);
  }
  if (static_cast<Index>(rows.size()) < kFewestSamples) {
    throw UnusablePart(
        fmt::format("a channel changes only every {} rows, which leaves {} samples", factor, rows.size()), log.file,
        "record at the rate at which the drives answer, for longer");
  }
  Log thin = rows_of(log, rows);
  // Channels that are fresh in every row keep what the rows between say, in phase.
  for (const auto& [from, to, stale] :
       {std::tuple{&log.q, &thin.q, &room.stale_positions}, {&log.tau, &thin.tau, &room.stale_torques}}) {
    if (from->size() == 0) continue;
    for (Index d = 0; d < from->cols(); ++d) {
      if ((*stale)[static_cast<std::size_t>(d)] > 1) continue;
      Eigen::MatrixXd out(static_cast<Index>(rows.size()), 1);
      low_pass.apply(from->col(d).segment(rows.front() - half, rows.back() - rows.front() + 2 * half + 1), out);
      to->col(d) = out;
    }
  }
  // A spoilt sample spoils the rows that average over it.
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (log.any_left_out(rows[k] - half, 2 * half + 1)) thin.filled[k] = Log::kLeftOut;
    if (log.torque_out.size() > 0) {
      thin.torque_out.row(static_cast<Index>(k)) =
          log.torque_out.middleRows(rows[k] - half, 2 * half + 1).colwise().any();
    }
  }
  log = std::move(thin);
  room.grid.start_s = log.t_s(0);
  room.grid.step_s *= factor;
}

}  // namespace deltadyn::checks
