// Logs as recorders spoil them: each is mended and said, and the friction that comes out is that of the machine.

#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <regex>

#include "deltadyn/runtime/random.hpp"

#include "acceptance/workshop.hpp"

namespace deltadyn::acceptance {
namespace {

/// Columns: 0 t_s, 1 to 4 the positions, 5 to 8 the torques.
using Table = std::vector<std::vector<std::string>>;

struct Fault {
  const char* name;
  std::function<void(Table&, std::mt19937_64&)> spoil;
  const char* note;      ///< regular expression that the output must match
  double percent = 1.0;  ///< largest error of Coulomb and viscous friction, drives and telescope
};

bool chance(std::mt19937_64& random, double share) {
  return canonical(random) < share;
}

void copy_fields(Table& rows, std::size_t to, std::size_t from, std::size_t first, std::size_t last) {
  for (std::size_t c = first; c <= last; ++c) rows[to][c] = rows[from][c];
}

std::string time(double t_s) {
  return fmt::format("{:.7f}", t_s);
}

void lose_rows(Table& rows, std::mt19937_64& random, double share) {
  Table kept;
  for (auto& row : rows) {
    if (!chance(random, share)) kept.push_back(std::move(row));
  }
  rows = std::move(kept);
}

std::vector<Fault> faults() {
  return {
      {"LostRows", [](Table& rows, auto& random) { lose_rows(rows, random, 0.005); }, "missing before this one"},
      {"ManyLostRows", [](Table& rows, auto& random) { lose_rows(rows, random, 0.05); }, "missing before this one"},
      {"Gaps",
       [](Table& rows, auto&) {
         rows.erase(rows.begin() + 7000, rows.begin() + 7040);
         rows.erase(rows.begin() + 3000, rows.begin() + 3900);
       },
       "a gap of 0\\.901 s.*, the first of 2"},
      {"TwoRecordings",
       [](Table& rows, auto&) {
         for (std::size_t k = 5000; k < rows.size(); ++k) rows[k][0] = time(0.001 * static_cast<double>(k - 5000));
       },
       "holds 2 recordings"},
      {"HeldRows",
       [](Table& rows, auto& random) {
         for (std::size_t k = 1; k < rows.size(); ++k) {
           if (chance(random, 0.01)) copy_fields(rows, k, k - 1, 1, 8);
         }
       },
       "repeats the values of the row before"},
      {"StalePositions",
       [](Table& rows, auto&) {
         for (std::size_t k = 0; k < rows.size(); ++k) copy_fields(rows, k, k / 4 * 4, 1, 4);
       },
       "recorded faster than measured.*q4_rad \\(every 4 rows\\)"},
      {"StaleAtTurns",
       [](Table& rows, auto& random) {
         std::size_t fresh = 0;
         for (std::size_t k = 0, next = 0; k < rows.size(); ++k) {
           if (k == next) {
             fresh = k;
             next = k + 3 + random() % 3;
           }
           copy_fields(rows, k, fresh, 1, 4);
         }
       },
       "recorded faster than measured"},
      {"OneStaleDrive",
       [](Table& rows, auto&) {
         for (std::size_t k = 0; k < rows.size(); ++k) copy_fields(rows, k, k / 3 * 3, 2, 2);
       },
       "recorded faster than measured.*q2_rad"},
      {"StaleTorque",
       [](Table& rows, auto&) {
         for (std::size_t k = 0; k < rows.size(); ++k) copy_fields(rows, k, k / 5 * 5, 5, 8);
       },
       "recorded faster than measured.*tau1_Nm"},
      {"ServoOff",
       [](Table& rows, auto&) {
         for (std::size_t k = 4000; k < 5500; ++k) std::fill(rows[k].begin() + 5, rows[k].end(), "0");
       },
       "the servo is off"},
      {"StampsOfAnOperatingSystem",
       [](Table& rows, auto& random) {
         NormalDistribution jitter(0.0, 5e-5);
         for (std::size_t k = 0; k < rows.size(); ++k) {
           rows[k][0] = time(0.001 * static_cast<double>(k) + std::clamp(jitter(random), -1.5e-4, 1.5e-4) + 2e-4);
         }
       },
       "samples were taken evenly"},
      {"StampsOfAnHourInSinglePrecision",
       [](Table& rows, auto&) {
         for (std::size_t k = 0; k < rows.size(); ++k) {
           rows[k][0] =
               fmt::format("{:.7f}", static_cast<double>(static_cast<float>(3600.0 + 0.001 * static_cast<double>(k))));
         }
       },
       "samples were taken evenly"},
      {"Spikes",
       [](Table& rows, auto& random) {
         for (std::size_t k = 50; k < rows.size(); k += 400) rows[k][1 + random() % 8] = "17";
       },
       "is a spike"},
  };
}

class MendedLog : public ::testing::TestWithParam<Fault> {};

TEST_P(MendedLog, GivesTheFrictionOfTheMachine) {
  const testing_support::TemporaryFolder folder;
  std::vector<std::string> logs;
  std::mt19937_64 random(23);
  for (const char* name : {"identification_fast.csv", "identification_slow.csv"}) {
    Lines lines = to_lines(read_text(installed(std::string("logs/mujoco_delta4/") + name)));
    const std::string header = lines[0];
    Table rows;
    for (std::size_t k = 1; k < lines.size(); ++k) rows.push_back(fields_of(lines[k]));
    GetParam().spoil(rows, random);
    lines = {header};
    for (const auto& row : rows) lines.push_back(join(row));
    logs.push_back(folder.write(name, to_text(lines)));
  }
  // A fixed cut-off keeps it fast; the files themselves are what is on trial.
  const ToolResult result = succeed({"delta-identify", installed("robots/mujoco_delta4.urdf"), logs[0], logs[1],
                                     "--cutoff-hz", "40", "-o", folder.path("p.csv")});
  EXPECT_TRUE(std::regex_search(result.out + result.err, std::regex(GetParam().note))) << result.out << result.err;
  const auto value_of = [](const std::string& file, const std::string& name) {
    for (const std::string& line : to_lines(read_text(file))) {
      if (line.rfind(name + ",", 0) == 0) return std::stod(fields_of(line)[1]);
    }
    throw std::runtime_error("no " + name);
  };
  for (const std::string joint : {"drive1", "drive2", "drive3", "drive4", "telescope"}) {
    for (const std::string law : {".coulomb", ".viscous"}) {
      const double truth = value_of(installed("logs/mujoco_delta4/truth.csv"), joint + law);
      const double found = value_of(folder.path("p.csv"), joint + law);
      EXPECT_LT(100.0 * std::abs(found / truth - 1.0), GetParam().percent)
          << joint << law << " " << found << " for " << truth;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Faults, MendedLog, ::testing::ValuesIn(faults()),
                         [](const auto& information) { return std::string(information.param.name); });

}  // namespace
}  // namespace deltadyn::acceptance
