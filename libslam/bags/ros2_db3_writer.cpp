#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "libslam/bags/db3_database.h"
#include "libslam/bags/ros_bytes.h"
#include "libslam/bags/ros_logs.h"
#include "libslam/bags/ros_objects.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"

// What is written is rosbag2's schema of version 2 (no table "schema"), which every release since 2020 reads.

namespace slam::bags {
namespace fs = std::filesystem;
namespace {

class Db3Writer : public RosBagWriter {
 public:
  explicit Db3Writer(const std::string& path) : path_(path) {
    if (fs::path(path).extension() == ".db3") {
      std::error_code ignored;
      if (fs::is_directory(path, ignored)) throw core::IoError(path + ": cannot be written: is a folder");
      file_ = std::make_unique<files::PendingFile>(path);
      open(file_->path());
    } else {
      folder_ = std::make_unique<files::PendingFolder>(path, false);
      name_ = fs::path(folder_->finalPath()).filename().string() + "_0.db3";
      open((fs::path(folder_->path()) / name_).string());
    }
  }

  RosEncoding encoding() const override { return RosEncoding::kCdr; }

  void write(const std::string& topic, const std::string& type, bool is_latched, std::int64_t time_ns,
             std::string_view bytes) override {
    auto& entry = topicOf(topic, type, is_latched);
    if (count_ == 0) first_ns_ = time_ns;
    last_ns_ = time_ns;
    sqlite3_bind_int64(insert_.get(), 1, time_ns);
    sqlite3_bind_int64(insert_.get(), 2, entry.id);
    sqlite3_bind_blob64(insert_.get(), 3, bytes.data(), bytes.size(), SQLITE_STATIC);
    step(insert_.get());
    ++entry.messages;
    ++count_;
  }

  void close() override {
    insert_.reset();
    execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC); COMMIT");
    if (sqlite3_close(database_.release()) != SQLITE_OK) throw core::IoError(path_ + ": cannot be closed");
    if (file_) return file_->commit();
    files::writeFileAtomically((fs::path(folder_->path()) / kMetadataName).string(), metadata());
    folder_->commit();
  }

 private:
  struct Topic {
    std::int64_t id = 0;
    std::string name, type, qos;
    std::uint64_t messages = 0;
  };

  void open(const std::string& path) {
    std::error_code ignored;
    fs::remove(path, ignored);
    sqlite3* handle = nullptr;
    const int state = sqlite3_open_v2(
        path.c_str(), &handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX, nullptr);
    database_.reset(handle);
    if (state != SQLITE_OK) fail();
    // The file is not there until it is whole, so it needs no journal beside it.
    execute(
        "PRAGMA page_size=4096; PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF; PRAGMA temp_store=FILE; "
        "BEGIN;"
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
        "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT "
        "NULL, "
        "data BLOB NOT NULL)");
    insert_ = prepare("INSERT INTO messages (timestamp, topic_id, data) VALUES (?, ?, ?)");
  }

  Topic& topicOf(const std::string& name, const std::string& type, bool is_latched) {
    for (auto& topic : topics_)
      if (topic.name == name) return topic;
    Topic topic;
    topic.id = static_cast<std::int64_t>(topics_.size()) + 1;
    topic.name = name;
    topic.type = withMsg(type);
    if (is_latched) topic.qos = kLatchedQos;
    const auto insert = prepare("INSERT INTO topics VALUES (?, ?, ?, 'cdr', ?)");
    sqlite3_bind_int64(insert.get(), 1, topic.id);
    sqlite3_bind_text(insert.get(), 2, topic.name.c_str(), -1, SQLITE_STATIC);
    sqlite3_bind_text(insert.get(), 3, topic.type.c_str(), -1, SQLITE_STATIC);
    sqlite3_bind_text(insert.get(), 4, topic.qos.c_str(), -1, SQLITE_STATIC);
    step(insert.get());
    topics_.push_back(std::move(topic));
    return topics_.back();
  }

  /// As rosbag2 writes it, version 5 (2022), which later releases read.
  std::string metadata() const {
    const auto number = [](auto value) { return std::to_string(value); };
    const auto quoted = [](const std::string& text) {
      std::string escaped = "\"";
      for (const char c : text) escaped += c == '\n' ? std::string("\\n") : std::string(1, c);
      return escaped + "\"";
    };
    const std::string duration = number(last_ns_ - first_ns_), start = number(first_ns_);
    std::string yaml =
        "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n"
        "  duration:\n    nanoseconds: " +
        duration + "\n  starting_time:\n    nanoseconds_since_epoch: " + start +
        "\n  message_count: " + number(count_) +
        "\n  topics_with_message_count:" + (topics_.empty() ? " []" : "") + "\n";
    for (const auto& topic : topics_)
      yaml += "    - topic_metadata:\n        name: " + topic.name + "\n        type: " + topic.type +
              "\n        serialization_format: cdr\n        offered_qos_profiles: " + quoted(topic.qos) +
              "\n      message_count: " + number(topic.messages) + "\n";
    return yaml + "  compression_format: \"\"\n  compression_mode: \"\"\n  relative_file_paths:\n    - " +
           name_ + "\n  files:\n    - path: " + name_ +
           "\n      starting_time:\n        nanoseconds_since_epoch: " + start +
           "\n      duration:\n        nanoseconds: " + duration +
           "\n      message_count: " + number(count_) + "\n";
  }

  Statement prepare(const char* sql) {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(database_.get(), sql, -1, &statement, nullptr) != SQLITE_OK) fail();
    return Statement(statement);
  }
  void execute(const char* sql) {
    if (sqlite3_exec(database_.get(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
  }
  void step(sqlite3_stmt* statement) {
    if (sqlite3_step(statement) != SQLITE_DONE) fail();
    sqlite3_reset(statement);
  }
  [[noreturn]] void fail() const {
    throw core::IoError(path_ + ": cannot be written: " + sqlite3_errmsg(database_.get()));
  }

  std::string path_, name_;
  std::unique_ptr<files::PendingFile> file_;
  std::unique_ptr<files::PendingFolder> folder_;
  Database database_;
  Statement insert_;
  std::vector<Topic> topics_;
  std::uint64_t count_ = 0;
  std::int64_t first_ns_ = 0, last_ns_ = 0;
};

}  // namespace

std::unique_ptr<objects::ObjectSink> createRos2Db3(const std::string& path) {
  return makeRosSink(std::make_unique<Db3Writer>(path));
}

}  // namespace slam::bags
