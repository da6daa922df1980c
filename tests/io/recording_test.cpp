#include "deltadyn/io/recording.hpp"

#include <gmock/gmock.h>

#include "deltadyn/runtime/error.hpp"

#include "io/recorded_motion.hpp"
#include "io/ros_bag.hpp"
#include "io/temporary_folder.hpp"

namespace deltadyn {
namespace {

using ::testing::HasSubstr;
using namespace testing_support;

const RecordedChannel& channel(const Recording& recording, const std::string& name) {
  for (const RecordedChannel& one : recording.channels) {
    if (one.name == name) return one;
  }
  throw std::runtime_error("no channel " + name);
}

std::string error_of(const std::string& path, const std::string& topic = {}) {
  try {
    (void)read_recording(path, topic);
  } catch (const Error& error) {
    EXPECT_FALSE(error.mend().empty()) << error.what();
    return error.what();
  }
  return "no error";
}

/// A small export of TwinCAT Scope: two groups, the slow one ends early, decimal comma in the header, point in the
/// rows.
std::string twincat(char separator, char decimal, bool quoted) {
  const auto join = [&](std::initializer_list<const char*> fields) {
    std::string line;
    for (const char* field : fields) {
      const std::string text = quoted && *field != '\0' ? "\"" + std::string(field) + "\"" : field;
      line += (line.empty() ? "" : std::string(1, separator)) + text;
    }
    return line + "\n";
  };
  std::string text = join({"Name", "Scope Project"}) + join({"File", "x.csv"});
  text += join({"Starttime of export", "132959733843760000", "Montag, 2. Mai 2022", "15:56:24.376"});
  text += join({"Endtime of export", "132959733853750000", "Montag, 2. Mai 2022", "15:56:25.375"}) + "\n\n";
  text += join({"Name", "ActPos", "Set Pos", "Name", "ActTorque"});
  text += join({"Data-Type", "REAL64", "REAL64", "Data-Type", "REAL64"});
  text += join({"SampleTime[ms]", "0,5", "0,5", "SampleTime[ms]", "2"});
  text += join({"SymbolName", "MAIN.p", "MAIN.s", "SymbolName", "MAIN.t"});
  text += join({"Unit", "deg (Angle)", "(None)", "Unit", "(None)"}) + "\n";
  for (int k = 0; k < 40; ++k) {
    std::string line = fmt::format("{}|{}|{}|", 0.5 * k, 0.25 * k, -k);
    line += k < 10 ? fmt::format("{}|{}", 2 * k, 100 * k) : (decimal == ',' ? " | " : "|");
    for (char& c : line) c = c == '|' ? separator : (c == '.' ? decimal : c);
    text += line + "\n";
  }
  return text + "EOF\n";
}

TEST(Recording, TwinCatGroupsOfTheirOwnRates) {
  const TemporaryFolder folder;
  for (const auto& [separator, decimal, quoted] : {std::tuple('\t', '.', false), std::tuple('\t', ',', false),
                                                   std::tuple(';', ',', false), std::tuple(',', '.', true)}) {
    const Recording recording = read_recording(folder.write("scope.csv", twincat(separator, decimal, quoted)));
    SCOPED_TRACE(recording.form);
    EXPECT_THAT(recording.form, HasSubstr("TwinCAT"));
    ASSERT_EQ(recording.timelines.size(), 2U);
    ASSERT_EQ(recording.channels.size(), 3U);
    EXPECT_EQ(channel(recording, "ActPos").unit, "deg");
    EXPECT_EQ(channel(recording, "Set Pos").unit, "");
    EXPECT_EQ(recording.timelines[0].rows(), 40);
    EXPECT_EQ(recording.timelines[1].rows(), 10);
    EXPECT_NEAR(recording.timelines[0].t_s(39), 0.0195, 1e-12);
    EXPECT_NEAR(recording.timelines[1].t_s(9), 0.018, 1e-12);
    EXPECT_EQ(channel(recording, "ActPos").values(39), 9.75);
    EXPECT_EQ(channel(recording, "ActTorque").values(9), 900);
  }
}

TEST(Recording, BinaryFormsAreNamedWithTheWayOut) {
  const TemporaryFolder folder;
  for (const auto& [bytes, words] :
       {std::pair("PK\x03\x04xxxx", "save it as CSV"), std::pair("#ROSBAG V2.0\n", "rostopic echo"),
        std::pair("\x89MCAP0\r\nxx", "ros2 bag convert"), std::pair("MATLAB 5.0 MAT-file, x", "writetable"),
        std::pair("\x89HDF\r\n\x1a\n", "HDF5"), std::pair("<?xml version='1.0'?>", "CSV")}) {
    EXPECT_THAT(error_of(folder.write("log.bin", bytes)), HasSubstr(words));
  }
  EXPECT_THAT(error_of(folder.write("zero.bin", std::string("abc\0def", 7))), HasSubstr("not a text file"));
  EXPECT_THAT(error_of(folder.write("words.txt", "one\ntwo three\nfour\nfive\n")), HasSubstr("no rows of numbers"));
  EXPECT_THAT(error_of(folder.write("empty.csv", "")), HasSubstr("the file is empty"));
  EXPECT_THAT(error_of(folder.path("")), HasSubstr("folder"));
  EXPECT_THAT(error_of(folder.path("no.csv")), HasSubstr("cannot open"));
}

TEST(Recording, LinesThatDoNotFit) {
  const TemporaryFolder folder;
  const auto row = [](int k, double) { return fmt::format("{},{},{}\n", k, 2 * k, 3 * k); };
  const std::string good = recorded("a,b,c\n", row, 50);
  EXPECT_THAT(error_of(folder.write("x.csv", good + "1,2\n" + good.substr(6))), HasSubstr("line 52"));
  EXPECT_THAT(error_of(folder.write("x.csv", "a,b\n" + good.substr(6))),
              HasSubstr("the header has 2 names but the rows have 3 fields"));
  const Recording cut = read_recording(folder.write("x.csv", good + "50,10"));
  EXPECT_EQ(cut.timelines[0].rows(), 50);
  ASSERT_EQ(cut.notes.size(), 1U);
  EXPECT_THAT(cut.notes[0], HasSubstr("line 52: the last line is cut off"));
  const Recording twice = read_recording(folder.write("x.csv", "a,b,a\n" + good.substr(6)));
  EXPECT_EQ(twice.channels[2].name, "a (2)");
}

TEST(Recording, MissingNumbersInTheSpellingsOfTheWorld) {
  const TemporaryFolder folder;
  std::string text = "t;x;y\n";
  for (const char* word : {"1", "", "n/a", "NaN", "-", "#N/A", "1.#QNAN", "null", "7", "8", "9"})
    text += fmt::format("0;{};RUN\n", word);
  const Recording recording = read_recording(folder.write("x.csv", text));
  EXPECT_EQ(channel(recording, "x").values.array().isNaN().count(), 7);
  EXPECT_EQ(channel(recording, "x").text_line, 0);
  EXPECT_EQ(channel(recording, "y").text_line, 2);
  EXPECT_EQ(channel(recording, "y").text, "RUN");
}

// --- rosbag2
// ------------------------------------------------------------------------------------------------------------------

TEST(Rosbag2, JointsByNameInWhateverOrderTheMessagesHaveThem) {
  const TemporaryFolder folder;
  constexpr std::int64_t kStart = 1650000000123456789;
  for (const bool little : {true, false}) {
    const std::string path = folder.path(little ? "little.db3" : "big.db3");
    {
      Bag bag(path);
      bag.topic(1, "/tf", "tf2_msgs/msg/TFMessage");
      bag.topic(2, "/joint_states", "sensor_msgs/msg/JointState");
      for (int k = 0; k < 30; ++k) {
        const std::int64_t stamp = kStart + 2000000LL * k;
        bag.message(1, stamp, "what we do not read");
        bag.message(2, stamp + 70000 * (k % 3),
                    k % 2 == 0 ? joint_state(stamp, {"arm", "yaw"}, {0.1 * k, -0.2 * k}, {1.0 * k, 2.0 * k}, little)
                               : joint_state(stamp, {"yaw", "arm"}, {-0.2 * k, 0.1 * k}, {2.0 * k, 1.0 * k}, little));
      }
    }
    const Recording recording = read_recording(path);
    ASSERT_EQ(recording.timelines.size(), 1U);
    EXPECT_EQ(recording.timelines[0].origin_ns, kStart);
    EXPECT_NEAR(recording.timelines[0].t_s(29), 0.058, 1e-12);  // the publisher's stamps, not those of receipt
    ASSERT_EQ(recording.channels.size(), 4U);
    const RecordedChannel& yaw = channel(recording, "/joint_states/yaw/effort");
    EXPECT_EQ(yaw.values(7), 14.0);
    EXPECT_EQ(yaw.quantity, "torque");
    EXPECT_EQ(yaw.place, 2);
    EXPECT_EQ(channel(recording, "/joint_states/arm/position").values(7), 0.1 * 7);
  }
}

// The publisher's clock is the better one: where only the receipts are out of order, messages are sorted by its stamps;
// a clock that was set back in between is left aside.
TEST(Rosbag2, StampsOfTheHeadersWinOverReceiptsOutOfOrder) {
  const TemporaryFolder folder;
  for (const bool set_back : {false, true}) {
    const std::string path = folder.path(set_back ? "back.db3" : "late.db3");
    {
      Bag bag(path);
      bag.topic(1, "/joint_states", "sensor_msgs/msg/JointState");
      for (int k = 0; k < 40; ++k) {
        const std::int64_t stamp = 1650000000000000000 + 1000000LL * k;
        const std::int64_t received = stamp + (k == 20 ? 2500000 : 100000);  // behind the two that follow
        bag.message(1, received,
                    joint_state(stamp - (set_back && k > 30 ? 5000000000LL : 0), {"x"}, {1.0 * k}, {1.0 * k}));
      }
    }
    const Recording recording = read_recording(path);
    ASSERT_EQ(recording.notes.size(), 1U);
    const Timeline& time = recording.timelines[0];
    if (set_back) {
      EXPECT_THAT(recording.notes[0], HasSubstr("not in order; the times of receipt are taken"));
      EXPECT_NEAR(time.t_s(39), 0.039, 1e-9);
      continue;
    }
    EXPECT_THAT(recording.notes[0],
                HasSubstr("1 message was received out of order; they are taken in the order of the stamps"));
    for (int k = 0; k < 40; ++k) {
      EXPECT_NEAR(time.t_s(k), 0.001 * k, 1e-9);
      EXPECT_EQ(channel(recording, "/joint_states/x/position").values(k), k);
    }
  }
}

TEST(Rosbag2, SaysWhichTopicsThereAre) {
  const TemporaryFolder folder;
  {
    Bag bag(folder.path("two.db3"));
    bag.topic(1, "/a", "sensor_msgs/msg/JointState");
    bag.topic(2, "/b", "sensor_msgs/msg/JointState");
    for (int k = 0; k < 30; ++k) bag.message(2, k, joint_state(1000 + k, {"x"}, {1.0 * k}, {}));
    Bag other(folder.path("none.db3"));
    other.topic(1, "/camera", "sensor_msgs/msg/Image");
    Bag cut(folder.path("cut.db3"));
    cut.topic(1, "/a", "sensor_msgs/msg/JointState");
    cut.message(1, 1, joint_state(5, {"x"}, {1}, {2}).substr(0, 50));
  }
  EXPECT_THAT(error_of(folder.path("two.db3")), HasSubstr("--topic /a"));
  EXPECT_EQ(read_recording(folder.path("two.db3"), "/b").channels.size(), 1U);
  EXPECT_THAT(error_of(folder.path("none.db3")), HasSubstr("/camera (sensor_msgs/msg/Image)"));
  EXPECT_THAT(error_of(folder.path("cut.db3")), HasSubstr("message 1 of /a"));
  EXPECT_THAT(error_of(folder.write("broken.db3", std::string("SQLite format 3\0", 16) + "xxxxxxxxxxxxxxxx")),
              HasSubstr("cannot read the database"));
}

}  // namespace
}  // namespace deltadyn
