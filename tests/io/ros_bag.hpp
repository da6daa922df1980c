#pragma once

/// \file
/// ROS bags of joint states, made for a test.

#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <memory>
#include <sqlite3.h>
#include <stdexcept>
#include <string>
#include <vector>

namespace deltadyn::testing_support {

/// Writes CDR, either order of bytes.
class CdrWriter {
 public:
  explicit CdrWriter(bool little) : little_(little) { bytes_ = {'\0', little ? '\1' : '\0', '\0', '\0'}; }
  template <class T>
  void put(T value) {
    while ((bytes_.size() - 4) % sizeof(T) != 0) bytes_ += '\0';
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    for (std::size_t k = 0; k < sizeof(T); ++k) bytes_ += raw[little_ ? k : sizeof(T) - 1 - k];
  }
  void put_text(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    bytes_ += text + '\0';
  }
  void put_doubles(const std::vector<double>& values) {
    put(static_cast<std::uint32_t>(values.size()));
    for (const double value : values) put(value);
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  bool little_;
};

inline std::string joint_state(std::int64_t stamp_ns, const std::vector<std::string>& names,
                               const std::vector<double>& q, const std::vector<double>& tau, bool little = true) {
  CdrWriter cdr(little);
  cdr.put(static_cast<std::int32_t>(stamp_ns / 1000000000));
  cdr.put(static_cast<std::uint32_t>(stamp_ns % 1000000000));
  cdr.put_text("base");
  cdr.put(static_cast<std::uint32_t>(names.size()));
  for (const auto& name : names) cdr.put_text(name);
  cdr.put_doubles(q);
  cdr.put_doubles({});
  cdr.put_doubles(tau);
  return cdr.bytes();
}

/// A bag under construction.
class Bag {
 public:
  explicit Bag(const std::string& path) {
    sqlite3* raw = nullptr;
    if (sqlite3_open(path.c_str(), &raw) != SQLITE_OK) throw std::runtime_error("no database");
    database_.reset(raw);
    run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, "
        "offered_qos_profiles "
        "TEXT)");
    run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)");
    run("BEGIN");
  }
  ~Bag() { run("COMMIT"); }
  Bag(const Bag&) = delete;
  Bag& operator=(const Bag&) = delete;
  void topic(int id, const std::string& name, const std::string& type) {
    run(fmt::format("INSERT INTO topics VALUES({}, '{}', '{}', 'cdr', '')", id, name, type));
  }
  void message(int topic, std::int64_t received_ns, const std::string& data) {
    sqlite3_stmt* statement = nullptr;
    sqlite3_prepare_v2(database_.get(), "INSERT INTO messages(topic_id, timestamp, data) VALUES(?1, ?2, ?3)", -1,
                       &statement, nullptr);
    sqlite3_bind_int(statement, 1, topic);
    sqlite3_bind_int64(statement, 2, received_ns);
    sqlite3_bind_blob(statement, 3, data.data(), static_cast<int>(data.size()), SQLITE_TRANSIENT);
    sqlite3_step(statement);
    sqlite3_finalize(statement);
  }

 private:
  void run(const std::string& sql) { sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr); }
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> database_{nullptr, &sqlite3_close};
};

}  // namespace deltadyn::testing_support
