// Outputs that cannot be written or must not be, and flags that make no sense.

#include <gtest/gtest.h>

#include "acceptance/bad_input.hpp"

namespace deltadyn::acceptance {
namespace {

using W = Workshop;

std::vector<Row> outputs() {
  return {
      {"DiskFullIdentify",
       [](const W& w) {
         Words words = w.identify();
         words[6] = "/dev/full";
         return words;
       },
       3,
       {"/dev/full", "No space left", "mend: free some space"}},
      {"DiskFullValidate",
       [](const W& w) {
         Words words = w.validate();
         words[6] = "/dev/full";
         return words;
       },
       3,
       {"/dev/full", "No space left", "mend: free some space"}},
      {"DiskFullCreate",
       [](const W&) { return create_delta3("/dev/full", 0.2, 0.05, 0.525, 1.1); },
       3,
       {"/dev/full", "No space left", "mend: free some space"}},
      {"DiskFullPrior",
       [](const W& w) {
         return Words{"delta-model", "prior", w.path("robot.urdf"), "-o", "/dev/full"};
       },
       3,
       {"/dev/full", "No space left", "mend: free some space"}},
      {"DiskFullSummary",
       [](const W& w) {
         return Words{"delta-model", "info", w.path("robot.urdf"), "--summary", "/dev/full"};
       },
       3,
       {"/dev/full", "No space left", "mend: free some space"}},
      {"DiskFullHalfWayThroughResiduals",
       [](const W& w) { return w.validate(); },
       3,
       {"out\\.csv", "File too large", "mend:"},
       {120, 8192}},
      {"DiskFullHalfWayThroughParameters",
       [](const W& w) { return w.identify(); },
       3,
       {"out\\.csv", "File too large", "mend:"},
       {120, 1024}},
      {"DiskFullHalfWayThroughRobot",
       [](const W& w) { return create_delta3(w.path("out.urdf"), 0.2, 0.05, 0.525, 1.1); },
       3,
       {"out\\.urdf", "File too large", "mend:"},
       {120, 4096}},
      {"FolderOfOutputMissing",
       [](const W& w) {
         Words words = w.identify();
         words[6] = w.path("no/out.csv");
         return words;
       },
       3,
       {"no/out\\.csv", "mend: create the folder first"}},
      {"FolderOfBaseMissing",
       [](const W& w) {
         Words words = w.identify();
         words[8] = w.path("no/base.csv");
         return words;
       },
       3,
       {"no/base\\.csv", "mend: create the folder first"}},
      {"FolderOfSummaryMissing",
       [](const W& w) {
         Words words = w.identify();
         words[10] = w.path("no/s.csv");
         return words;
       },
       3,
       {"no/s\\.csv", "mend: create the folder first"}},
      {"FolderOfValidationSummaryMissing",
       [](const W& w) {
         Words words = w.validate();
         words[8] = w.path("no/s.csv");
         return words;
       },
       3,
       {"no/s\\.csv", "mend: create the folder first"}},
      {"OutputIsFolder",
       [](const W& w) {
         Words words = w.validate();
         words[6] = w.folder();
         return words;
       },
       3,
       {"mend: give the name of a file"}},
      {"OutputIsLog",
       [](const W& w) {
         Words words = w.identify();
         words[6] = w.path("log.csv");
         return words;
       },
       2,
       {"log\\.csv", "would overwrite the input", "mend:"}},
      {"OutputIsPrior",
       [](const W& w) {
         Words words = w.identify();
         words[6] = w.path("./prior.csv");
         return words;
       },
       2,
       {"would overwrite the input", "mend:"}},
      {"BaseIsRobotByLink",
       [](const W& w) {
         fs::create_symlink(w.path("robot.urdf"), w.path("link.urdf"));
         Words words = w.identify();
         words[8] = w.path("link.urdf");
         return words;
       },
       2,
       {"would overwrite the input", "mend:"}},
      {"SummaryIsLog",
       [](const W& w) {
         Words words = w.identify();
         words[10] = w.path("log.csv");
         return words;
       },
       2,
       {"log\\.csv", "would overwrite the input", "mend:"}},
      {"SummaryIsRobot",
       [](const W& w) {
         return Words{"delta-model", "info", w.path("robot.urdf"), "--summary", w.path("robot.urdf")};
       },
       2,
       {"would overwrite the input", "mend:"}},
      {"BaseIsOutput",
       [](const W& w) {
         Words words = w.identify();
         words[8] = w.path("out.csv");
         return words;
       },
       2,
       {"out\\.csv", "mend:"}},
      {"ResidualsAreParameters",
       [](const W& w) {
         Words words = w.validate();
         words[6] = w.path("prior.csv");
         return words;
       },
       2,
       {"would overwrite the input", "mend:"}},
      {"PriorIsRobot",
       [](const W& w) {
         return Words{"delta-model", "prior", w.path("robot.urdf"), "-o", w.path("robot.urdf")};
       },
       2,
       {"would overwrite the input", "mend:"}},
  };
}

std::vector<Row> flags() {
  const auto with = [](const Words& more) { return [more](const W& w) { return w.identify() + more; }; };
  const auto instead = [](const std::string& value) {
    return [value](const W& w) {
      Words words = w.identify();
      words.back() = value;
      return words;
    };
  };
  return {
      {"NoArguments", [](const W&) { return Words{"delta-identify"}; }, 2, {"required", "--help"}},
      {"NoSubcommand", [](const W&) { return Words{"delta-model"}; }, 2, {"subcommand is required"}},
      {"NoOutput",
       [](const W& w) {
         return Words{"delta-identify", w.path("robot.urdf"), w.path("log.csv")};
       },
       2,
       {"--output is required"}},
      {"NoParams",
       [](const W& w) {
         return Words{"delta-validate", w.path("robot.urdf"), w.path("log.csv")};
       },
       2,
       {"--params is required"}},
      {"UnknownFlag", with({"--cutof", "5"}), 2, {"--cutof"}},
      {"UnknownType",
       [](const W& w) {
         return Words{"delta-model", "create", "delta5", "-o", w.path("x.urdf")};
       },
       2,
       {"'delta5' is not a robot type", "mend: use delta3"}},
      {"FlagOfOtherType",
       [](const W& w) { return Words{"delta-model", "create", "axis", "--strut", "1", "-o", w.path("x.urdf")}; },
       2,
       {"--strut does not belong to an axis", "mend:"}},
      {"LengthMissing",
       [](const W& w) {
         return Words{"delta-model", "create", "delta3", "-o", w.path("x.urdf")};
       },
       2,
       {"--base-radius is needed", "mend:"}},
      {"NegativeLength",
       [](const W& w) { return create_delta3(w.path("x.urdf"), -0.2, 0.05, 0.525, 1.1); },
       2,
       {"--base-radius is -0\\.2 m", "mend:"}},
      {"NegativeDensity",
       [](const W& w) {
         return Words{"delta-model", "prior", w.path("robot.urdf"), "--strut-density-kg-m3",
                      "-5",          "-o",    w.path("x.csv")};
       },
       2,
       {"density", "mend:"}},
      {"UnknownMetric", with({"--metric", "euclidean"}), 2, {"--metric", "relative"}},
      {"UnknownParameterSet", with({"--parameters", "all"}), 2, {"--parameters", "reduced"}},
      {"CutoffIsText", instead("fast"), 2, {"--cutoff-hz fast is neither a number nor auto", "mend:"}},
      {"CutoffIsNegative", instead("-5"), 2, {"cutoff", "above 0 Hz", "mend:"}},
      {"CutoffAboveNyquist", instead("900"), 2, {"cut-off|cutoff", "mend:"}},
      {"RegularizationIsText", with({"--regularization", "much"}), 2, {"--regularization much", "mend:"}},
      {"RegularizationIsNegative", with({"--regularization", "-1"}), 2, {"regularization", "mend:"}},
      {"PeriodIsNegative", with({"--period-s", "-1"}), 2, {"period", "mend:"}},
      {"ThreadsAreNegative", with({"--threads", "-1"}), 2, {"--threads"}},
      {"SeedIsText", with({"--seed", "x"}), 2, {"--seed"}},
      {"RotorOfNoDrive", with({"--rotor-inertia", "9"}), 2, {"rotor inertia of drive 9", "mend:.*1 to 4"}},
      {"MissingConfig", with({"--config", "/no/such/file.toml"}), 3, {"file\\.toml"}},
      {"UnknownKeyInConfig",
       [](const W& w) {
         return w.identify() + Words{"--config", w.write("c.toml", "cutof=5\n")};
       },
       2,
       {"cutof"}},
  };
}

class Misuse : public ::testing::TestWithParam<Row> {};

TEST_P(Misuse, IsRefusedWithAMessageAndLeavesNothingBehind) {
  expect_refused(GetParam());
}

// Parameters that were found together with effects hold only with them.
TEST(MissingEffects, AreToldByEveryToolWithTheFlagThatMendsIt) {
  const Workshop w;
  const std::string params = w.write("improved.csv", "# effects: effects.csv\n" + to_text(W::prior()));
  const std::string effects = w.path("effects.csv"),
                    given = "improved.csv holds only together with the effects of " + effects;
  const Words convert = {"delta-model", "convert", w.path("robot.urdf"), "--params", params, "--to",
                         "header",      "-o",      w.path("m.hpp")};
  const Words tools[] = {
      w.validate("", "", params),
      w.identify("", "", params),
      convert,
      {"delta-diagnose", w.path("robot.urdf"), w.path("log.csv"), "--params", params, "-o", w.path("d.csv")}};
  const auto told = [](const Words& words) { return run(words).err; };
  EXPECT_NE(told(convert).find(given + ", which is not there: give --effects with the place of effects.csv"),
            std::string::npos);
  (void)w.write("effects.csv", "effect,joint,parameter,value,unit,std\ntorque_offset,drive1,offset,0.1,N*m,\n");
  for (const Words& words : tools) {
    EXPECT_NE(told(words).find("warning: " + params + " holds only together with the effects of " + effects +
                               ": give --effects " + effects),
              std::string::npos)
        << words[0] << told(words);
    EXPECT_EQ(told(words + Words{"--effects", effects}).find("holds only"), std::string::npos) << words[0];
  }
}

INSTANTIATE_TEST_SUITE_P(Outputs, Misuse, ::testing::ValuesIn(outputs()), name_of);
INSTANTIATE_TEST_SUITE_P(Flags, Misuse, ::testing::ValuesIn(flags()), name_of);

}  // namespace
}  // namespace deltadyn::acceptance
