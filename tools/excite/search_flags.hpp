#pragma once

/// \file
/// How delta-excite searches: the series and its segments, what is made large, how long.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <vector>

#include "deltadyn/excitation/optimize.hpp"
#include "deltadyn/excitation/reversals.hpp"
#include "deltadyn/identification/log_processing.hpp"

#include "excite/list_flags.hpp"
#include "tool_support.hpp"

namespace deltadyn::tools {

class SearchFlags {
 public:
  static constexpr int kUsualStates = 6000;  ///< of --bound-states

  SearchFlags() { options_.speeds.clear(); }

  void add_to(CLI::App& app) {
    add_series(app);
    add_criterion(app);
    add_effort(app);
  }

  /// The options of the search as the flags have them. Throws Error(usage) that names the flag.
  /// \param articulated  the plate is: four drives that are coupled, and all feel the reversals of its joints
  [[nodiscard]] ExcitationOptions options(std::uint64_t seed, bool articulated) const {
    ExcitationOptions options = options_;
    options.seed = seed;
    options.harmonics = harmonics_.value_or(articulated ? kHarmonicsOfAPlate : options.harmonics);
    options.least_away = least_away_.value_or(articulated ? kAwayOfAPlate : kAway);
    options.criterion = criterion_of(criterion_);
    options.lowest_hz = frequency_.front();
    options.highest_hz = frequency_.back();
    options.speeds = speeds();
    options.time_limit_s = time_limit_s_;
    options.validate();
    if (segment_files_ && options.speeds.size() < 2)
      throw Error("--segment-files with one segment", "", "give --segments 2 --segment-speeds 0.3,1, or leave it out",
                  ExitCode::usage);
    set_reversals(options);
    require_duration(options);
    if (periodic_ && options.speeds.size() > 1)
      throw Error("--periodic holds one segment", "", "leave out --periodic or --segments", ExitCode::usage);
    return options;
  }

  /// OUTPUT_1.csv, OUTPUT_2.csv, .. beside the output, if they are asked for.
  [[nodiscard]] std::vector<std::string> segment_file_names(const std::string& output) const {
    std::vector<std::string> names;
    if (!segment_files_) return names;
    const std::filesystem::path path(output);
    const std::size_t count = std::max(static_cast<std::size_t>(std::max(segments_, 1)), options_.speeds.size());
    for (std::size_t k = 1; k <= count; ++k)
      names.push_back(
          (path.parent_path() / fmt::format("{}_{}{}", path.stem().string(), k, path.extension().string())).string());
    return names;
  }

  [[nodiscard]] const std::string& criterion() const { return criterion_; }
  [[nodiscard]] double cutoff_hz() const { return cutoff_hz_; }
  [[nodiscard]] double duration_s() const { return duration_s_; }
  [[nodiscard]] double time_limit_s() const { return time_limit_s_; }
  [[nodiscard]] bool periodic() const { return periodic_; }
  [[nodiscard]] int bound_states() const { return bound_states_; }

 private:
  // Of the robots in data/robots those with four limbs gain from 0.43 to 0.48 by three more harmonics, others little
  // beside the time that they take.
  static constexpr int kHarmonicsOfAPlate = 8;
  // At a cut-off of 30 Hz a third is then still left, from which on validation has no reservations. Reversals of an
  // articulated plate count for all four drives: the same share costs a motion more of what it shows.
  static constexpr double kAway = 0.45, kAwayOfAPlate = 0.4;

  void add_series(CLI::App& app) {
    app.option_defaults()->group("Motion");
    app.add_option("--base-frequency-hz", frequency_, "range lower,upper of the base frequency [Hz]")
        ->delimiter(',')
        ->expected(1, 2)
        ->capture_default_str();
    app.add_option("--harmonics", harmonics_,
                   fmt::format("harmonics of the Fourier series (8) [{}; {} for an articulated plate]",
                               options_.harmonics, kHarmonicsOfAPlate));
    app.add_option("--segments", segments_, "motions one after the other, each as good as possible beside the others")
        ->capture_default_str();
    add_list(app, "--segment-speeds", options_.speeds,
             "speed of each segment as a share of the velocity limits, e.g. 0.3,1 [1]");
    app.add_flag("--segment-files", segment_files_,
                 "each segment in a file of its own, too: OUTPUT_1.csv, OUTPUT_2.csv, ..");
    app.add_option("--duration-s", duration_s_, "of the periodic part of each segment, at least; whole periods [s]")
        ->capture_default_str();
    app.add_option("--rate-hz", options_.rate_hz, "sample rate of the controller [Hz]")->capture_default_str();
    app.add_flag("--periodic", periodic_, "only the periodic part, no run-in and run-out");
  }

  void add_criterion(CLI::App& app) {
    app.option_defaults()->group("What makes a motion good");
    app.add_option("--criterion", criterion_, "what is made large (9)")
        ->check(CLI::IsMember({"logdet", "cond", "det", "trace", "min-eigenvalue"}))
        ->capture_default_str();
    app.add_option("--velocity-weight", options_.velocity_weight,
                   "w of (9): weight of the drive velocities beside the criterion")
        ->capture_default_str();
    app.add_option("--away-from-reversals", least_away_,
                   fmt::format("least share of the time that every drive is away from velocity reversals; 0: no matter "
                               "[{}; {} for an articulated plate]",
                               kAway, kAwayOfAPlate));
    app.add_option("--cutoff-hz", cutoff_hz_,
                   "cut-off of the identification, which sets what it leaves out near a reversal [Hz]")
        ->capture_default_str();
  }

  void add_effort(CLI::App& app) {
    app.option_defaults()->group("Effort of the search");
    app.add_option("--starts", options_.starts, "starts of the search, 0: as many as the time allows")
        ->capture_default_str();
    app.add_option("--time-limit-s", time_limit_s_, "of the whole tool; the best motion until then is written [s]")
        ->capture_default_str();
    app.add_option("--bound-states", bound_states_, "admissible states for the upper bound of the efficiency")
        ->check(CLI::Range(500, 200000))
        ->capture_default_str();
  }

  [[nodiscard]] std::vector<double> speeds() const {
    std::vector<double> speeds = options_.speeds;
    if (speeds.empty()) speeds = {1.0};
    if (segments_ < 1) throw Error("--segments is below 1", "", "give 1 or more", ExitCode::usage);
    if (speeds.size() == 1) speeds.resize(static_cast<std::size_t>(segments_), speeds.front());
    if (segments_ > 1 && speeds.size() != static_cast<std::size_t>(segments_))
      throw Error(fmt::format("{} speeds for {} segments", speeds.size(), segments_), "--segment-speeds",
                  "give one speed a segment", ExitCode::usage);
    return speeds;
  }

  /// What an identification at this cut-off leaves out on either side of a reversal.
  void set_reversals(ExcitationOptions& options) const {
    const ProcessingOptions usual;
    const double low_pass_hz = usual.torque_cutoff_ratio * cutoff_hz_;
    if (!(cutoff_hz_ > 0) || !(low_pass_hz < 0.5 * options.rate_hz))
      throw Error(fmt::format("a cut-off of {} Hz is out of range", cutoff_hz_), "--cutoff-hz",
                  fmt::format("give 1 to {:.4g} Hz", 0.25 * options.rate_hz), ExitCode::usage);
    options.reversal_reach_s = options.least_away > 0 ? reversal_reach_s(low_pass_hz, options.rate_hz) : 0.0;
  }

  void require_duration(const ExcitationOptions& options) const {
    if (!(duration_s_ > 0) || !(duration_s_ <= 36000))
      throw Error("--duration-s is out of range", "", "give 0 to 36000 s", ExitCode::usage);
    if (options.lowest_hz * duration_s_ < 1 - 1e-9)
      throw Error(fmt::format("a base frequency of {:.4g} Hz is too low for {:.4g} s: its period lasts {:.4g} s",
                              options.lowest_hz, duration_s_, 1 / options.lowest_hz),
                  "--base-frequency-hz",
                  fmt::format("give a lower end of {:.4g} Hz or more, or a longer --duration-s", 1 / duration_s_),
                  ExitCode::usage);
  }

  ExcitationOptions options_;
  std::string criterion_ = "logdet";
  std::vector<double> frequency_ = {0.1, 1.0};
  double duration_s_ = 10, time_limit_s_ = 60, cutoff_hz_ = 40;
  int segments_ = 1, bound_states_ = kUsualStates;
  std::optional<int> harmonics_;
  std::optional<double> least_away_;
  bool periodic_ = false, segment_files_ = false;
};

}  // namespace deltadyn::tools
