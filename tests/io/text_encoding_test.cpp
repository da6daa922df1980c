// Exports in the characters of the computer that wrote them.

#include <gmock/gmock.h>

#include "deltadyn/io/import_log.hpp"

#include "io/recorded_motion.hpp"
#include "io/temporary_folder.hpp"

namespace deltadyn {
namespace {

using ::testing::HasSubstr;
using namespace testing_support;

// German Windows: the degree sign and the per mille sign are one byte each, 0xB0 and 0x89.
TEST(TextEncoding, Windows1252IsReadAndItsMapIsUtf8ThatReadsBack) {
  const TemporaryFolder folder;
  const RobotDescription robot = one_drive();
  const auto row = [](int, double t) {
    return fmt::format("{:.3f};{:.8f};{:.5f};0\n", t, kDegrees * position(t), 1e3 * torque(t) / 2.5);
  };
  const std::string file =
      folder.write("log.csv", recorded("Pr\xFC"
                                       "fstand\n\nZeit [s];Achse 1 Lage [\xB0];Achse 1 Istmoment [\x89];K\xFChlung\n",
                                       row));
  ImportOptions options;
  options.defaults.rated_torque = {2.5};
  const LogImport import({file}, robot, options);
  EXPECT_THAT(import.form(), HasSubstr("in Windows-1252"));
  const std::string map = import.map_text();
  EXPECT_THAT(map, HasSubstr("source = \"Achse 1 Lage [\xC2\xB0]\""));
  EXPECT_THAT(map, HasSubstr("K\xC3\xBChlung"));
  ImportOptions again;
  again.map_file = folder.write("map.toml", map);
  const Log log = LogImport({file}, robot, again).log().log;
  EXPECT_NEAR(log.q(300, 0), position(0.3), 1e-7);
  EXPECT_NEAR(log.tau(300, 0), torque(0.3), 1e-5);
}

TEST(TextEncoding, AMapThatAnEditorSavedInWindows1252IsRead) {
  const TemporaryFolder folder;
  const RobotDescription robot = one_drive();
  const std::string text =
      "[[channel]]\ndrive = 1\nquantity = \"position\"\nsource = \"Lage [\xB0]\"\nunit = \"\xB0\"\n";
  const ColumnMap map = read_column_map(folder.write("map.toml", text), robot);
  EXPECT_EQ(map.channels.at(0).source, "Lage [\xC2\xB0]");
  // UTF-8 is what it is, also in its longest forms.
  const std::string other = folder.write("utf8.toml", "topic = \"\xE2\x80\xB0 \xF0\x9F\x98\x80 \xC3\xBC\"\n");
  EXPECT_EQ(read_column_map(other, robot).topic, "\xE2\x80\xB0 \xF0\x9F\x98\x80 \xC3\xBC");
}

}  // namespace
}  // namespace deltadyn
