#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <map>
#include <memory>
#include <numeric>
#include <sqlite3.h>

#include "deltadyn/runtime/error.hpp"

#include "field.hpp"
#include "recognisers.hpp"

namespace deltadyn::forms {
namespace {

constexpr const char* kJointState = "sensor_msgs/msg/JointState";
constexpr std::string_view kSqliteMagic("SQLite format 3\0", 16);

bool is_sqlite(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  char head[16] = {};
  file.read(head, sizeof head);
  return file.gcount() == sizeof head && std::string_view(head, sizeof head) == kSqliteMagic;
}

/// Reads a database without ever changing it.
class Database {
 public:
  explicit Database(const std::string& path) : path_(path) {
    sqlite3* raw = nullptr;
    const int code = sqlite3_open_v2(path.c_str(), &raw, SQLITE_OPEN_READONLY, nullptr);
    database_.reset(raw);
    if (code != SQLITE_OK) fail();
  }

  using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;
  [[nodiscard]] Statement prepare(const char* sql) const {
    sqlite3_stmt* raw = nullptr;
    if (sqlite3_prepare_v2(database_.get(), sql, -1, &raw, nullptr) != SQLITE_OK) fail();
    return {raw, &sqlite3_finalize};
  }
  /// Next row; false at the end.
  [[nodiscard]] bool step(const Statement& statement) const {
    const int code = sqlite3_step(statement.get());
    if (code != SQLITE_ROW && code != SQLITE_DONE) fail();
    return code == SQLITE_ROW;
  }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  [[noreturn]] void fail() const {
    throw Error(fmt::format("cannot read the database: {}", sqlite3_errmsg(database_.get())), path_,
                "check that it is the .db3 file of a rosbag2 and complete; ros2 bag info shows what it holds");
  }
  std::string path_;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> database_{nullptr, &sqlite3_close};
};

struct Topic {
  sqlite3_int64 id = 0;
  std::string name, type, format;
};

std::string text_of(const Database::Statement& statement, int column) {
  const unsigned char* text = sqlite3_column_text(statement.get(), column);
  return text == nullptr ? "" : reinterpret_cast<const char*>(text);
}

Topic choose_topic(const Database& database, const std::string& wanted) {
  const auto statement = database.prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY id");
  std::vector<Topic> fitting;
  std::vector<std::string> all;
  while (database.step(statement)) {
    Topic topic{sqlite3_column_int64(statement.get(), 0), text_of(statement, 1), text_of(statement, 2),
                text_of(statement, 3)};
    all.push_back(fmt::format("{} ({})", topic.name, topic.type));
    const bool named = wanted.empty() || topic.name == wanted || topic.name == "/" + wanted;
    if (topic.type == kJointState && named) fitting.push_back(topic);
  }
  if (fitting.empty()) {
    throw Error(
        fmt::format("the bag holds no joint states{}; its topics are {}", wanted.empty() ? "" : " on topic " + wanted,
                    all.empty() ? "none" : fmt::format("{}", fmt::join(all, ", "))),
        database.path(),
        fmt::format("record a topic of type {}, or export another one as CSV (PlotJuggler)", kJointState));
  }
  if (fitting.size() > 1) {
    std::vector<std::string> names;
    for (const Topic& topic : fitting) names.push_back(topic.name);
    throw Error(
        fmt::format("several topics hold joint states: {}", fmt::join(names, ", ")), database.path(),
        fmt::format("say which: --topic {}, or topic = \"{}\" in the column map", names.front(), names.front()));
  }
  if (fitting.front().format != "cdr" && !fitting.front().format.empty()) {
    throw Error(fmt::format("the messages are serialised as '{}', only 'cdr' is read", fitting.front().format),
                database.path(), "convert the bag: ros2 bag convert");
  }
  return fitting.front();
}

/// Reads values of a CDR message (OMG, XCDR1): aligned to their size from the end of the four bytes of encapsulation.
class Cdr {
 public:
  Cdr(const void* data, int size)
      : data_(static_cast<const unsigned char*>(data)), size_(static_cast<std::size_t>(std::max(0, size))) {
    good_ = size_ >= 4 && data_ != nullptr;
    if (good_) little_ = (data_[1] & 1) != 0;
    at_ = 4;
  }
  [[nodiscard]] bool good() const { return good_; }

  template <class T>
  T get() {
    at_ += (sizeof(T) - (at_ - 4) % sizeof(T)) % sizeof(T);
    if (!good_ || at_ + sizeof(T) > size_) {
      good_ = false;
      return T{};
    }
    unsigned char bytes[sizeof(T)];
    for (std::size_t k = 0; k < sizeof(T); ++k) bytes[k] = data_[at_ + (little_ ? k : sizeof(T) - 1 - k)];
    at_ += sizeof(T);
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
  }
  std::string text() {
    const auto length = get<std::uint32_t>();  // with the final zero
    if (!good_ || length > size_ - at_) {
      good_ = false;
      return {};
    }
    std::string value(reinterpret_cast<const char*>(data_) + at_, length > 0 ? length - 1 : 0);
    at_ += length;
    return value;
  }
  /// Length of a sequence whose elements have at least `bytes` bytes each.
  std::size_t count(std::size_t bytes) {
    const auto length = get<std::uint32_t>();
    if (!good_ || length > (size_ - at_) / bytes) good_ = false;
    return good_ ? length : 0;
  }
  std::vector<double> doubles() {
    std::vector<double> values(count(1));
    for (double& value : values) value = get<double>();
    return values;
  }

 private:
  const unsigned char* data_;
  std::size_t size_, at_ = 0;
  bool good_ = false, little_ = true;
};

struct JointState {
  std::int64_t stamp_ns = 0;
  std::vector<std::string> name;
  std::vector<double> parts[3];  ///< position, velocity, effort
};

bool decode(const void* data, int size, JointState& state) {
  Cdr cdr(data, size);
  const auto seconds = static_cast<std::int64_t>(cdr.get<std::int32_t>());
  const auto nanoseconds = static_cast<std::int64_t>(cdr.get<std::uint32_t>());
  state.stamp_ns = seconds * 1000000000LL + nanoseconds;
  (void)cdr.text();  // the frame
  state.name.resize(cdr.count(4));
  for (std::string& name : state.name) name = cdr.text();
  for (auto& part : state.parts) part = cdr.doubles();
  return cdr.good();
}

/// The series of all joints as the messages come in.
class Series {
 public:
  void add(const JointState& state, std::int64_t received_ns, long message) {
    line.push_back(message);
    stamp_ns.push_back(state.stamp_ns);
    receipt_ns.push_back(received_ns);
    for (std::size_t k = 0; k < std::max(state.name.size(), state.parts[0].size()); ++k) {
      // Publishers may change the order of joints from message to message; the names decide.
      const std::string joint = k < state.name.size() ? state.name[k] : fmt::format("joint{}", k + 1);
      const auto [found, is_new] = place_.emplace(joint, joints.size());
      if (is_new) {
        joints.push_back(joint);
        values.emplace_back();
      }
      auto& parts = values[found->second];
      for (std::size_t part = 0; part < 3; ++part) {
        parts[part].resize(line.size() - 1, kNan);  // a joint may be missing in some messages
        parts[part].push_back(k < state.parts[part].size() ? state.parts[part][k] : kNan);
      }
    }
  }
  void finish() {
    for (auto& parts : values) {
      for (auto& part : parts) part.resize(line.size(), kNan);
    }
  }

  /// Returns how many messages came after one with a later stamp.
  std::size_t sort_by_stamps() {
    std::vector<std::size_t> order(line.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::size_t late = 0;
    for (std::size_t k = 1; k < order.size(); ++k) late += stamp_ns[k] < stamp_ns[k - 1] ? 1 : 0;
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return stamp_ns[a] < stamp_ns[b]; });
    const auto sort = [&order](auto& series) {
      const auto before = series;
      for (std::size_t k = 0; k < order.size(); ++k) series[k] = before[order[k]];
    };
    for (auto& parts : values) {
      for (auto& part : parts) sort(part);
    }
    sort(line);
    sort(receipt_ns);
    sort(stamp_ns);
    return late;
  }

  std::vector<long> line;
  std::vector<std::int64_t> stamp_ns, receipt_ns;
  std::vector<std::string> joints;
  std::vector<std::array<std::vector<double>, 3>> values;

 private:
  std::map<std::string, std::size_t> place_;
};

/// Whether the headers' stamps are one clock that only the receipts mixed up: the way from one to the other takes a
/// like time.
bool is_one_clock(const Series& series) {
  constexpr double kLongestDelaySpread = 1e9;  // ns
  std::vector<double> delays;
  for (std::size_t k = 0; k < series.line.size(); ++k)
    delays.push_back(static_cast<double>(series.receipt_ns[k]) - static_cast<double>(series.stamp_ns[k]));
  const auto [low, high] = std::ranges::minmax(delays);
  return high - low < kLongestDelaySpread;
}

/// The publisher's stamps, unless it left them at zero or let them run backwards; then the times of receipt. Messages
/// that were received out of order come into the order of their stamps.
const std::vector<std::int64_t>& stamps_of(Series& series, Recording& recording) {
  const auto& stamps = series.stamp_ns;
  const auto [first, last] = std::ranges::minmax_element(stamps);
  const bool given = *last > *first;
  if (given && std::ranges::is_sorted(stamps)) return stamps;
  if (given && is_one_clock(series)) {
    const std::size_t moved = series.sort_by_stamps();
    recording.notes.push_back(
        fmt::format("{}: {} message{} received out of order; they are taken in the order of the stamps in their "
                    "headers, the better clock",
                    recording.file, moved, moved == 1 ? " was" : "s were"));
    return stamps;
  }
  recording.notes.push_back(
      fmt::format("{}: the stamps in the headers of the messages are {}; the times of receipt are taken, which jitter",
                  recording.file, given ? "not in order" : "all alike"));
  return series.receipt_ns;
}

void add_channels(const std::string& topic, Series& series, Recording& recording) {
  static constexpr const char* kParts[3] = {"position", "velocity", "effort"};
  static constexpr const char* kQuantities[3] = {"position", "velocity", "torque"};
  for (std::size_t part = 0; part < 3; ++part) {
    for (std::size_t joint = 0; joint < series.joints.size(); ++joint) {
      auto& values = series.values[joint][part];
      if (std::ranges::all_of(values, [](double v) { return std::isnan(v); })) continue;
      const std::string& name = series.joints[joint];
      RecordedChannel channel;
      channel.name = fmt::format("{}/{}/{}", topic, name, kParts[part]);  // as PlotJuggler names it
      for (const char* alias : {"{1}/{2}", "{2}/{1}", "{1}.{2}", "{0}/{2}/{1}", "{2}[{3}]", "{0}/{2}[{3}]",
                                "{0}.{2}[{3}]", "{2}_{1}", "{1}_{2}", "{2}[{1}]"})
        channel.aliases.push_back(fmt::format(fmt::runtime(alias), topic, name, kParts[part], joint));
      channel.quantity = kQuantities[part];
      channel.place = static_cast<int>(joint) + 1;
      channel.joint = name;
      channel.values = Eigen::Map<Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
      recording.channels.push_back(std::move(channel));
    }
  }
}

}  // namespace

std::optional<std::string> rosbag2_database(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(path, ignored)) return is_sqlite(path) ? std::optional(path) : std::nullopt;
  std::vector<std::string> databases;
  for (const auto& entry : std::filesystem::directory_iterator(path, ignored)) {
    if (entry.path().extension() == ".mcap") refuse_binary_form(entry.path().string(), "\x89MCAP0\r\n");
    if (entry.path().extension() == ".db3") databases.push_back(entry.path().string());
  }
  std::ranges::sort(databases);
  if (databases.empty()) return std::nullopt;
  if (databases.size() > 1) {
    throw Error(fmt::format("this rosbag2 is split into {} files", databases.size()), path,
                fmt::format("give one of them, each is a log of its own: {}", databases.front()));
  }
  return databases.front();
}

Recording read_rosbag2(const std::string& path, const std::string& wanted_topic) {
  const Database database(path);
  const Topic topic = choose_topic(database, wanted_topic);
  Recording recording;
  recording.file = path;
  const auto statement =
      database.prepare("SELECT timestamp, data FROM messages WHERE topic_id = ?1 ORDER BY timestamp, id");
  sqlite3_bind_int64(statement.get(), 1, topic.id);
  Series series;
  JointState state;
  for (long message = 1; database.step(statement); ++message) {
    const void* data = sqlite3_column_blob(statement.get(), 1);
    if (!decode(data, sqlite3_column_bytes(statement.get(), 1), state)) {
      throw Error("the message is cut off or no joint state",
                  fmt::format("{}, message {} of {}", path, message, topic.name),
                  "record the bag again; ros2 bag info shows what it holds");
    }
    series.add(state, sqlite3_column_int64(statement.get(), 0), message);
  }
  if (series.line.empty())
    throw Error(fmt::format("the topic {} holds no messages", topic.name), path,
                "check that the recording is complete");
  series.finish();
  const auto& stamps = stamps_of(series, recording);
  Timeline timeline;
  timeline.name = topic.name;
  timeline.unit = "ns";
  timeline.origin_ns = stamps.front();
  timeline.t_s.resize(static_cast<Eigen::Index>(stamps.size()));
  const auto first = static_cast<std::uint64_t>(stamps.front());  // stamps are in order; a broken one may be very large
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    timeline.t_s(static_cast<Eigen::Index>(k)) =
        1e-9 * static_cast<double>(static_cast<std::uint64_t>(stamps[k]) - first);
  }
  timeline.line = series.line;
  recording.timelines.push_back(std::move(timeline));
  recording.form = fmt::format("rosbag2, joint states on {}", topic.name);
  add_channels(topic.name, series, recording);
  return recording;
}

}  // namespace deltadyn::forms
