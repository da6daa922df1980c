#pragma once

/// \file
/// What a user does with three logs of a machine: reads them, has them checked, and of a dirty machine runs
/// delta-identify first. As tools/delta-identify.cpp and tools/delta-diagnose.cpp do it with their default flags.

#include <filesystem>
#include <fmt/format.h>
#include <string>
#include <utility>
#include <vector>

#include "deltadyn/diagnosis/diagnose.hpp"
#include "deltadyn/identification/fine_delay.hpp"
#include "deltadyn/identification/identify.hpp"
#include "deltadyn/identification/log_gate.hpp"
#include "deltadyn/io/log_file.hpp"
#include "deltadyn/runtime/nominal_parameters.hpp"

namespace deltadyn::blind {

/// The parameter file: what delta-identify writes and delta-diagnose reads.
struct ParameterFile {
  Eigen::VectorXd p;
  ProcessingOptions known;  ///< bristles and ripples
  std::string remark;       ///< what was found beside the parameters
};

/// Through files, as the logs come to the tools: rate and encoders are known from them alone.
class LogFiles {
 public:
  LogFiles(const std::vector<Log>& logs, const RobotDescription& robot, const std::string& name)
      : folder_(std::filesystem::temp_directory_path() / ("blind-study-" + name)), robot_(robot) {
    std::filesystem::create_directories(folder_);
    for (const Log& log : logs) write_log(path(log.file), log, robot);
  }
  ~LogFiles() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  LogFiles(const LogFiles&) = delete;
  LogFiles& operator=(const LogFiles&) = delete;
  LogFiles(LogFiles&&) = delete;
  LogFiles& operator=(LogFiles&&) = delete;

  [[nodiscard]] std::vector<Log> read(const std::vector<std::string>& names) const {
    LogReadOptions options;
    options.checks.refuse_positions = false;
    std::vector<Log> logs;
    for (const std::string& name : names) {
      for (Log& part : read_log_parts(path(name), robot_, options)) logs.push_back(std::move(part));
    }
    return logs;
  }

 private:
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / (name + ".csv")).string(); }

  std::filesystem::path folder_;
  const RobotDescription& robot_;
};

inline void refuse_if(const GateResult& gate, const std::string& tool) {
  if (!gate.stop()) return;
  std::string why;
  for (const LogFinding& one : gate.findings) {
    if (one.level == FindingLevel::fault) why += (why.empty() ? "" : "; ") + one.text;
  }
  throw Error(tool + " refuses the logs: " + why, "", "", ExitCode::not_trusted);
}

/// delta-identify ROBOT fast.csv slow.csv -o params.csv
inline ParameterFile run_identify(const Robot& robot, const std::vector<Log>& read) {
  const NominalParameters prior = nominal_parameters(robot, PartShapes(robot.description()));
  const GateResult gate = examine_logs(robot, read, prior.value, prior.std);
  refuse_if(gate, "delta-identify");
  std::vector<Log> logs = gate.logs;
  const IdentificationOptions options;
  Identification found = identify(robot, logs, prior.value, prior.std, options);
  const FineDelay delay = find_fine_delay(robot, found.base, logs, found.processing);
  if (delay.certain) {
    logs = without_delay(std::move(logs), delay.delay_s);
    found = identify(robot, logs, prior.value, prior.std, options);
  }
  ParameterFile file;
  file.p = found.fit.p;
  int bristles = 0;
  file.known.presliding = Eigen::VectorXd::Zero(robot.friction_joints());
  file.known.presliding_damping_s = file.known.presliding;
  for (std::size_t joint = 0; joint < found.presliding.size(); ++joint) {
    const auto at = static_cast<Eigen::Index>(joint);
    if (!(found.presliding[joint].displacement > 0)) continue;
    file.known.presliding(at) = found.presliding[joint].displacement;
    file.known.presliding_damping_s(at) = std::max(0.0, found.presliding[joint].damping_s);
    ++bristles;
  }
  file.known.ripples = found.processing.ripples;
  file.remark = fmt::format("{:.3g} Hz {} bristles {} ripples{}", found.processing.cutoff_hz, bristles,
                            file.known.ripples.size(), delay.certain ? " delay" : "");
  return file;
}

/// Trust in the parameters, as delta-diagnose has it in its prior.
inline Eigen::VectorXd trust_in(const Robot& robot, const Eigen::VectorXd& p) {
  Eigen::VectorXd std = nominal_parameters(robot, PartShapes(robot.description())).std;
  for (Eigen::Index k = 0; k < std.size(); ++k) {
    if (p(k) != 0) std(k) = std::max(std(k), 0.5 * std::abs(p(k)));
  }
  return std;
}

/// delta-diagnose ROBOT --params params.csv fast.csv slow.csv --holdout holdout.csv -o diagnosis.csv
inline Diagnosis run_diagnose(const Robot& robot, const LogFiles& files, const ParameterFile& file, int null_runs) {
  GateOptions gate_options;
  gate_options.keep_delay = true;
  gate_options.offsets_known = true;
  const auto check = [&](const std::vector<std::string>& names) {
    GateResult gate = examine_logs(robot, files.read(names), {}, {}, gate_options);
    refuse_if(gate, "delta-diagnose");
    return std::move(gate.logs);
  };
  const std::vector<Log> logs = check({"fast", "slow"});
  const std::vector<Log> proof = check({"holdout"});
  const auto holdout = std::max_element(proof.begin(), proof.end(),
                                        [](const Log& a, const Log& b) { return a.samples() < b.samples(); });
  DiagnosisOptions options;
  options.null_runs = null_runs;
  options.identify = false;
  options.processing.presliding = file.known.presliding;
  options.processing.presliding_damping_s = file.known.presliding_damping_s;
  options.processing.ripples = file.known.ripples;
  return diagnose(robot, logs, &*holdout, file.p, trust_in(robot, file.p), {}, options);
}

}  // namespace deltadyn::blind
