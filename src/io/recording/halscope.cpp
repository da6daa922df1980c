#include <charconv>
#include <fmt/format.h>

#include "deltadyn/runtime/error.hpp"

#include "recognisers.hpp"

namespace deltadyn::forms {
namespace {

constexpr std::string_view kPeriod = "# Sampling period is ";

/// LinuxCNC's scope_files.c: the period, then names without a mark, then marked display settings, then rows.
long period_ns(const TextFile& file) {
  const std::string_view rest = std::string_view(file.text).substr(kPeriod.size());
  long ns = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), ns);
  if (error != std::errc() || ns <= 0) {
    throw Error("the sampling period of this halscope file is no positive number", file.path + ", line 1",
                "write '# Sampling period is N ns' into the first line");
  }
  return ns;
}

}  // namespace

std::optional<Recording> read_halscope(const TextFile& file) {
  if (!file.text.starts_with(kPeriod)) return std::nullopt;
  const double step_s = 1e-9 * static_cast<double>(period_ns(file));
  Recording recording = read_delimited(file);
  recording.form = fmt::format("LinuxCNC halscope, a sample every {:.6g} ms", 1e3 * step_s);
  Timeline& timeline = recording.timelines[0];
  timeline.name = "sampling period";
  timeline.unit = "ns";
  timeline.t_s = step_s * Eigen::VectorXd::LinSpaced(timeline.rows(), 0.0, static_cast<double>(timeline.rows() - 1));
  return recording;
}

}  // namespace deltadyn::forms
