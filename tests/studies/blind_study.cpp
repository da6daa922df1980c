/// \file
/// The blind study of delta-diagnose: hidden effects in a plant of their own, clean logs, pairs, effects outside the
/// catalogue.
///
///     blind_study all OUT.csv [NULL_RUNS]                   the whole study, 460 cases
///     blind_study PART FIRST COUNT OUT.csv [NULL_RUNS]      PART: effects clean pairs outside
///     blind_study summary OUT.csv
///     blind_study write PART INDEX FOLDER               the robot and the three logs of one case, to look at
///
/// Every case is one line of OUT.csv; cases that are there already are left out, so that a run can be stopped and taken
/// up again.

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <set>
#include <string>
#include <vector>

#include "deltadyn/io/log_file.hpp"
#include "deltadyn/io/robot_file.hpp"

#include "studies/blind_case.hpp"

namespace {

using namespace deltadyn;

std::set<std::string> done_cases(const std::string& path) {
  std::set<std::string> done;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) done.insert(line.substr(0, line.find(',')));
  return done;
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

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() == 2 && words[0] == "summary") {
    blind::print_summary(blind::read_outcomes(words[1]));
    return 0;
  }
  if (words.size() == 4 && words[0] == "write") {
    const blind::Case one = blind::make_case(words[1], std::stoi(words[2]));
    std::filesystem::create_directories(words[3]);
    const auto robot = make_robot(one.robot);
    NamedValues parameters;
    for (int k = 0; k < robot->parameters(); ++k)
      parameters[robot->parameter_names()[static_cast<std::size_t>(k)]] = one.parameters(k);
    write_robot_file(words[3] + "/robot.urdf", one.robot, parameters);
    for (const Log& log : blind::record(one)) write_log(words[3] + "/" + log.file + ".csv", log, one.robot);
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
  if (words.size() < 4) {
    std::cerr
        << "usage: blind_study all OUT.csv [NULL_RUNS] | effects|clean|pairs|outside FIRST COUNT OUT.csv [NULL_RUNS] | "
           "summary OUT.csv | write PART "
           "INDEX FOLDER\n";
    return 2;
  }
  run_cases(words[0], std::stoi(words[1]), std::stoi(words[2]), words[3], words.size() > 4 ? std::stoi(words[4]) : 200);
  return 0;
}
