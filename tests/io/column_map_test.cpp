#include "deltadyn/io/column_map.hpp"

#include <gmock/gmock.h>

#include "deltadyn/runtime/error.hpp"

#include "io/recorded_motion.hpp"
#include "io/temporary_folder.hpp"

namespace deltadyn {
namespace {

using ::testing::HasSubstr;
using namespace testing_support;

constexpr const char* kChannel = "[[channel]]\ndrive = 1\nquantity = \"torque\"\nsource = \"a\"\n";

TEST(ColumnMap, WritesAndReadsBack) {
  const TemporaryFolder folder;
  ColumnMap map;
  map.time_source = "Time \"of\" \\ day";
  map.time_unit = "us";
  map.topic = "/joints";
  ChannelMap channel;
  channel.drive = 2;
  channel.quantity = Quantity::torque;
  channel.source = "M2 [0.1%]";
  channel.unit = "0.1%";
  channel.scale = 0.3;
  channel.offset = -1.25;
  channel.sign = -1;
  channel.gear_ratio = 20.5;
  channel.rated_torque = 1.27;
  channel.wrap = 65536;
  channel.delay_s = 0.002;
  map.channels = {channel};
  const ColumnMap back = read_column_map(folder.write("map.toml", to_toml(map, {"a remark"})), drives(3));
  EXPECT_EQ(back.time_source, map.time_source);
  EXPECT_EQ(back.time_unit, "us");
  EXPECT_EQ(back.topic, "/joints");
  const ChannelMap* found = back.find(Quantity::torque, 2);
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->source, channel.source);
  EXPECT_EQ(found->unit, channel.unit);
  EXPECT_EQ(found->scale, 0.3);
  EXPECT_EQ(found->offset, -1.25);
  EXPECT_EQ(found->sign, -1);
  EXPECT_EQ(found->gear_ratio, 20.5);
  EXPECT_EQ(found->rated_torque, 1.27);
  EXPECT_EQ(found->wrap, 65536);
  EXPECT_EQ(found->delay_s, 0.002);
  EXPECT_FALSE(found->torque_constant.has_value());
}

TEST(ColumnMap, RefusesWithFileAndLine) {
  struct Row {
    std::string text;
    std::vector<const char*> message;
  };
  const std::string channel = kChannel;
  const std::vector<Row> rows = {
      {"", {"neither [time] nor a [[channel]]"}},
      {"[time\n", {"map.toml, line 1", "TOML"}},
      {channel + "gear = 3\n", {"line 5", "'gear' is not known", "gear_ratio"}},
      {channel + "unit = \"rad\"\n", {"line 5", "'rad' is no known unit of a torque", "Nm"}},
      {channel + "gear_ratio = -3\n", {"line 5", "not positive", "sign = -1"}},
      {channel + "scale = \"2\"\n", {"line 5", "scale is no number"}},
      {channel + "scale = 0\n", {"line 5", "scale = 0"}},
      {channel + "sign = 2\n", {"line 5", "neither 1 nor -1"}},
      {channel + channel, {"line 5", "torque of drive 1 is named twice"}},
      {"[[channel]]\ndrive = 4\nquantity = \"torque\"\nsource = \"a\"\n", {"line 2", "1 to 3"}},
      {"[[channel]]\ndrive = 1\nquantity = \"speed\"\nsource = \"a\"\n", {"line 3", "position, velocity"}},
      {"[[channel]]\ndrive = 1\nsource = \"a\"\n", {"no quantity"}},
      {"[time]\nsource = \"a\"\nrate_hz = 5\n", {"line 3", "a time column and a rate"}},
      {"[time]\nunit = \"weeks\"\n", {"line 2", "'weeks'"}},
      {"channel = 3\n", {"line 1", "[[channel]]"}},
  };
  const TemporaryFolder folder;
  for (const Row& row : rows) {
    try {
      (void)read_column_map(folder.write("map.toml", row.text), drives(3));
      ADD_FAILURE() << "accepted: " << row.text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_input);
      for (const char* part : row.message) EXPECT_THAT(error.what(), HasSubstr(part)) << row.text;
      EXPECT_FALSE(error.mend().empty()) << row.text;
    }
  }
  EXPECT_THROW((void)read_column_map(folder.path("no.toml"), drives(3)), Error);
}

TEST(ColumnMap, FactorsToSiAtTheDrive) {
  ChannelMap channel;
  channel.drive = 1;
  channel.unit = "deg";
  channel.gear_ratio = 10;
  EXPECT_NEAR(si_factor(channel, DriveKind::revolute, ""), std::numbers::pi / 1800, 1e-15);
  channel.unit = "cnt";
  channel.counts_per_turn = 4096;
  EXPECT_NEAR(si_factor(channel, DriveKind::revolute, ""), 2 * std::numbers::pi / 40960, 1e-15);
  channel.lead = 0.02;
  EXPECT_NEAR(si_factor(channel, DriveKind::prismatic, ""), 0.02 / 40960, 1e-15);
  channel.unit = "mm";
  EXPECT_THROW((void)si_factor(channel, DriveKind::revolute, ""), Error);
  channel.quantity = Quantity::torque;
  channel.unit = "mA";
  channel.torque_constant = 0.5;
  EXPECT_NEAR(si_factor(channel, DriveKind::revolute, ""), 0.005, 1e-15);
  EXPECT_NEAR(si_factor(channel, DriveKind::prismatic, ""), 0.005 * 2 * std::numbers::pi / 0.02, 1e-12);
  channel.unit = "N";
  EXPECT_THROW((void)si_factor(channel, DriveKind::revolute, ""), Error);
}

}  // namespace
}  // namespace deltadyn
