/// \file
/// The blind study of delta-diagnose: hidden effects in a plant of their own, clean logs, pairs, effects outside the
/// catalogue; of two fixed robots, and of robots drawn at random, clean and dirty.
///
///     blind_study all OUT.csv [NULL_RUNS]                   the fixed robots, 460 cases
///     blind_study drawn FIRST OUT.csv [NULL_RUNS] [SHARE]   robots drawn at random, 480 cases (or a share of them)
///     blind_study PART FIRST COUNT OUT.csv [NULL_RUNS]      PART: effects clean pairs outside, or any-effects
///                                                           any-clean any-pairs any-outside dirty-effects dirty-clean
///     blind_study summary OUT.csv
///     blind_study list PART FIRST COUNT                     what drawn cases hold, without running them
///     blind_study write PART INDEX FOLDER                   robot, parameters and three logs of one case as
///                                                           files, to look at and to try the tools on
///
/// Every case is one line of OUT.csv; cases that are there already are left out, so that a run can be stopped and taken
/// up again. A case is a function of its part and its index. Of the drawn parts, indices below 10000 are tuning seeds,
/// which the diagnosis may be improved on; those from 10000 on are report seeds, whose figures count and on which
/// nothing is tuned. Columns: id, truth, strength, noise, verdict, named, set, explained share, gap shrink, time [s],
/// size, size found, its standard deviation, robot type, dirty 0/1, rate [Hz], motion kind. The strength of a drawn
/// case is the rms torque of its (weaker) effect that no parameters hold, over that of the dirt, or in clean machines
/// over the noise. The environment variable BLIND_VERBOSE makes a run print what each diagnosis said.

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <set>
#include <string>
#include <vector>

#include "deltadyn/io/log_file.hpp"
#include "deltadyn/io/parameter_file.hpp"
#include "deltadyn/io/robot_file.hpp"

#include "studies/blind_case.hpp"
#include "studies/blind_summary.hpp"

namespace {

using namespace deltadyn;

std::set<std::string> done_cases(const std::string& path) {
  std::set<std::string> done;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) done.insert(line.substr(0, line.find(',')));
  return done;
}

bool is_part(const std::string& word) {
  return word == "effects" || word == "clean" || word == "pairs" || word == "outside" || blind::is_drawn(word);
}

/// Runs cases of one part that are not in the file yet.
void run_cases(const std::string& part, int first, int count, const std::string& path, int null_runs) {
  const std::set<std::string> done = done_cases(path);
  for (int k = first; k < first + count; ++k) {
    const std::string id = fmt::format("{}-{}", part, k);
    if (done.count(id) > 0) continue;
    const blind::Outcome outcome = blind::run_case(part, k, null_runs);
    std::ofstream(path, std::ios::app) << blind::to_line(id, outcome) << "\n";
    std::cout << blind::to_line(id, outcome) << std::endl;
  }
}

/// All drawn parts, half of the cases dirty machines.
void run_drawn(int first, const std::string& path, int null_runs, double share) {
  const std::pair<const char*, int> parts[] = {{"dirty-effects", 160}, {"dirty-clean", 80}, {"any-effects", 120},
                                               {"any-clean", 60},      {"any-pairs", 30},   {"any-outside", 30}};
  for (const auto& [part, count] : parts)
    run_cases(part, first, static_cast<int>(std::lround(share * count)), path, null_runs);
  blind::print_summary(blind::read_outcomes(path));
}

void list_cases(const std::string& part, int first, int count) {
  for (int k = first; k < first + count; ++k) {
    const blind::DrawnCase one = blind::make_drawn_case(part, k);
    fmt::print("{}-{} {} {} {} {:g} Hz strength {:.2g}{}\n", part, k, one.type, blind::truth_of(one.hidden),
               blind::motion_name(one.motion), one.rate_hz, one.strength, one.strong ? "" : " weak");
  }
}

/// What a user of a clean machine has: a few per cent off.
ParameterTable user_table(const Robot& model, const Eigen::VectorXd& p) {
  ParameterTable table;
  for (int k = 0; k < model.parameters(); ++k) {
    ParameterEntry entry;
    entry.name = model.parameter_names()[static_cast<std::size_t>(k)];
    entry.value = 1.03 * p(k);
    entry.unit = model.parameter_units()[static_cast<std::size_t>(k)];
    table.entries.push_back(entry);
  }
  return table;
}

void write_files(const std::string& folder, const RobotDescription& robot, const ParameterOptions& layout,
                 const Eigen::VectorXd& p, const std::vector<Log>& logs) {
  std::filesystem::create_directories(folder);
  const auto model = make_robot(robot, layout);
  NamedValues parameters;
  for (int k = 0; k < model->parameters(); ++k)
    parameters[model->parameter_names()[static_cast<std::size_t>(k)]] = p(k);
  write_robot_file(folder + "/robot.urdf", robot, parameters);
  write_parameters(folder + "/params.csv", user_table(*model, p));
  for (const Log& log : logs) write_log(folder + "/" + log.file + ".csv", log, robot);
}

void write_case(const std::string& part, int index, const std::string& folder) {
  if (!blind::is_drawn(part)) {
    const blind::Case one = blind::make_case(part, index);
    write_files(folder, one.robot, {}, one.parameters, blind::record(one));
    return;
  }
  const blind::DrawnCase one = blind::make_drawn_case(part, index);
  write_files(folder, one.machine.robot, one.machine.layout, one.machine.parameters, blind::record_drawn(one));
  fmt::print("{} {} {}, {:g} Hz, strength {:.3g}\n", one.type, blind::truth_of(one.hidden),
             blind::motion_name(one.motion), one.rate_hz, one.strength);
  for (const blind::DriveScale& s : one.machine.scale) {
    fmt::print("  drive: speed {:.3g} range {:.3g} torque {:.3g} friction {:.3g} inertia {:.3g}\n", s.speed, s.range,
               s.torque, s.friction, s.inertia);
  }
}

int run(const std::vector<std::string>& words) {
  if (words.size() == 2 && words[0] == "summary") {
    blind::print_summary(blind::read_outcomes(words[1]));
    return 0;
  }
  if (words.size() == 4 && words[0] == "write") {
    write_case(words[1], std::stoi(words[2]), words[3]);
    return 0;
  }
  if (words.size() == 4 && words[0] == "list" && blind::is_drawn(words[1])) {
    list_cases(words[1], std::stoi(words[2]), std::stoi(words[3]));
    return 0;
  }
  if (words.size() >= 3 && words[0] == "drawn") {
    run_drawn(std::stoi(words[1]), words[2], words.size() > 3 ? std::stoi(words[3]) : 200,
              words.size() > 4 ? std::stod(words[4]) : 1.0);
    return 0;
  }
  if (words.size() >= 2 && words[0] == "all") {
    const int null_runs = words.size() > 2 ? std::stoi(words[2]) : 200;
    run_cases("effects", 0, 230, words[1], null_runs);
    run_cases("clean", 0, 150, words[1], null_runs);
    run_cases("pairs", 0, 40, words[1], null_runs);
    run_cases("outside", 0, 40, words[1], null_runs);
    blind::print_summary(blind::read_outcomes(words[1]));
    return 0;
  }
  if (words.size() < 4 || !is_part(words[0])) {
    std::cerr << "usage: blind_study all OUT.csv [NULL_RUNS] | drawn FIRST OUT.csv [NULL_RUNS] [SHARE] | PART FIRST "
                 "COUNT OUT.csv [NULL_RUNS] | summary OUT.csv | list PART FIRST COUNT | write PART INDEX FOLDER\n";
    return 2;
  }
  run_cases(words[0], std::stoi(words[1]), std::stoi(words[2]), words[3], words.size() > 4 ? std::stoi(words[4]) : 200);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(std::vector<std::string>(argv + 1, argv + argc));
  } catch (const Error& e) {
    std::cerr << e.what() << "\n";
    return static_cast<int>(e.code());
  }
}
