#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <utility>
#include <vector>

#include "libslam/bags/ros2_bags.h"
#include "libslam/bags/ros_bytes.h"
#include "libslam/bags/ros_logs.h"
#include "libslam/core/error.h"
#include "libslam/core/files.h"

// The tables: github.com/ros2/rosbag2, rosbag2_storage_sqlite3, sqlite_storage.cpp. What is written is its
// schema of version 2 (no table "schema"), which every release since 2020 reads.

namespace slam::bags {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kMagic("SQLite format 3\0", 16);
constexpr int kMostBlobBytes = 1 << 30;

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;
struct FinishStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, FinishStatement>;

/// As a URI: `immutable` keeps SQLite from making locks, journals or -wal files.
std::string readOnlyUri(const std::string& path) {
  std::string uri = "file:";
  for (const char c : fs::absolute(path).string()) {
    const bool is_special = c == '?' || c == '#' || c == '%';
    if (!is_special) {
      uri += c;
      continue;
    }
    constexpr std::string_view kDigits = "0123456789ABCDEF";
    uri += '%';
    uri += kDigits[static_cast<size_t>(c) >> 4];
    uri += kDigits[static_cast<size_t>(c) & 15];
  }
  return uri + "?mode=ro&immutable=1";
}

std::string text(sqlite3_stmt* statement, int column) {
  const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  return bytes == nullptr ? ""
                          : std::string(bytes, static_cast<size_t>(sqlite3_column_bytes(statement, column)));
}

/// Shorter than its header says (sqlite.org/fileformat.html, 1.3): the size of a page at 16, how many there
/// are at 28, which holds if the counters at 24 and 92 are the same; all big-endian.
bool isCut(const std::string& path) {
  constexpr size_t kHeaderBytes = 100;
  std::string header;
  FileBytes file(path);
  file.read(kHeaderBytes, header);
  if (header.size() < kHeaderBytes) return true;
  const auto number = [&header](size_t at, size_t bytes) {
    std::uint64_t value = 0;
    for (size_t i = 0; i < bytes; ++i) value = value << 8 | static_cast<unsigned char>(header[at + i]);
    return value;
  };
  const std::uint64_t page_bytes = number(16, 2) == 1 ? 65536 : number(16, 2);
  return number(24, 4) == number(92, 4) && file.size() < page_bytes * number(28, 4);
}

class Db3Messages : public RosMessages {
 public:
  explicit Db3Messages(const std::string& path) : path_(path) {
    std::string start;
    FileBytes(path).read(kMagic.size(), start);
    if (!looksLikeRos2Db3(start)) throw core::InputError(path + ": not a ROS 2 bag (no SQLite database)");
    sqlite3* handle = nullptr;
    const int state = sqlite3_open_v2(readOnlyUri(path).c_str(), &handle,
                                      SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, nullptr);
    database_.reset(handle);
    if (state != SQLITE_OK) fail();
    sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, kMostBlobBytes);
    // A damaged file must not make SQLite run code that its schema holds, nor trust its pages.
    sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_exec(handle, "PRAGMA cell_size_check=ON", nullptr, nullptr, nullptr);
    is_cut_ = isCut(path);
    // Without this SQLite refuses a file that is shorter than it should be; nothing is written in any case.
    if (is_cut_) sqlite3_db_config(handle, SQLITE_DBCONFIG_WRITABLE_SCHEMA, 1, nullptr);
    requireTables();
    readTopics();
    if (!is_cut_) findLast();
    // Of a cut file the index by time may be lost, the rows before the cut are not.
    messages_ =
        prepare(is_cut_ ? "SELECT topic_id, timestamp, data, id FROM messages ORDER BY id"
                        : "SELECT topic_id, timestamp, data, id FROM messages ORDER BY timestamp, id");
  }

  bool next(RosMessage& message) override {
    const int state = sqlite3_step(messages_.get());
    if (state == SQLITE_DONE && !is_cut_) return false;
    if (state != SQLITE_ROW) fail();
    const auto topic = sqlite3_column_int64(messages_.get(), 0);
    const auto found = channels_.find(topic);
    if (found == channels_.end())
      throw core::InputError(path_ + ": after " + counted(count_, "message") + ": a message of topic " +
                             std::to_string(topic) + ", which the table of topics does not have");
    ++count_;
    message.channel = &found->second;
    message.received_ns = sqlite3_column_int64(messages_.get(), 1);
    message.bytes = {};
    // The bytes of what is not read stay on the disk.
    if (rosMd5(found->second.type).empty()) return true;
    const void* bytes = sqlite3_column_blob(messages_.get(), 2);
    if (bytes == nullptr && sqlite3_errcode(database_.get()) == SQLITE_NOMEM) fail();
    const auto size = static_cast<size_t>(sqlite3_column_bytes(messages_.get(), 2));
    if (bytes != nullptr) message.bytes = {static_cast<const char*>(bytes), size};
    return true;
  }

  double fractionRead() const override {
    return last_id_ > 0 ? std::min(1.0, static_cast<double>(count_) / static_cast<double>(last_id_)) : 0;
  }

  std::string remark() const override {
    for (const char* ending : {"-wal", "-journal"}) {
      std::error_code missing;
      const auto size = fs::file_size(path_ + ending, missing);
      if (!missing && size > 0)
        return "what is still in " + path_ + ending + " (its recorder did not close the bag) is not read";
    }
    return "";
  }

 private:
  /// Names in use must be tables: a view could be a program.
  void requireTables() {
    for (const char* table : {"topics", "messages"}) {
      const auto found = prepare("SELECT 1 FROM sqlite_master WHERE type='table' AND name=?");
      sqlite3_bind_text(found.get(), 1, table, -1, SQLITE_STATIC);
      const int state = sqlite3_step(found.get());
      if (state == SQLITE_DONE)
        throw core::InputError(path_ + ": not a ROS 2 bag: an SQLite database without a table '" + table +
                               "'");
      if (state != SQLITE_ROW) fail();
    }
  }

  void readTopics() {
    const auto topics = prepare("SELECT id, name, type, serialization_format FROM topics");
    int state = SQLITE_ROW;
    while ((state = sqlite3_step(topics.get())) == SQLITE_ROW) {
      RosChannel channel;
      channel.topic = printable(text(topics.get(), 1));
      channel.type = printable(withoutMsg(text(topics.get(), 2)));
      channel.encoding = RosEncoding::kCdr;
      const auto format = text(topics.get(), 3);
      if (format != "cdr") channel.obstacle = "serialized as " + printable(format);
      channels_.emplace(sqlite3_column_int64(topics.get(), 0), std::move(channel));
    }
    if (state != SQLITE_DONE) fail();
  }

  void findLast() {
    const auto last = prepare("SELECT MAX(id) FROM messages");
    if (sqlite3_step(last.get()) != SQLITE_ROW) fail();
    last_id_ = sqlite3_column_int64(last.get(), 0);
  }

  Statement prepare(const char* sql) {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(database_.get(), sql, -1, &statement, nullptr) != SQLITE_OK) fail();
    return Statement(statement);
  }

  [[noreturn]] void fail() const {
    if (is_cut_)
      throw core::InputError(path_ + ": truncated ROS 2 bag: after " + counted(count_, "message") +
                             ": the file is shorter than the database that it holds");
    throw core::InputError(path_ + ": damaged or no ROS 2 bag: after " + counted(count_, "message") +
                           ": SQLite says '" + printable(sqlite3_errmsg(database_.get())) + "'");
  }

  std::string path_;
  Database database_;
  Statement messages_;
  std::map<std::int64_t, RosChannel> channels_;
  std::uint64_t count_ = 0;
  std::int64_t last_id_ = 0;
  bool is_cut_ = false;
};

/// The files of a bag one after the other.
class ChainedMessages : public RosMessages {
 public:
  ChainedMessages(std::vector<std::string> paths, bool is_mcap)
      : paths_(std::move(paths)), is_mcap_(is_mcap) {
    openNext();
  }
  bool next(RosMessage& message) override {
    while (!current_->next(message)) {
      if (opened_ == paths_.size()) return false;
      addRemark();
      openNext();
    }
    return true;
  }
  double fractionRead() const override {
    return (static_cast<double>(opened_ - 1) + current_->fractionRead()) / static_cast<double>(paths_.size());
  }
  std::string remark() const override {
    const auto newest = current_->remark();
    return remarks_.empty() || newest.empty() ? remarks_ + newest : remarks_ + "; " + newest;
  }

 private:
  void addRemark() { remarks_ = remark(); }
  void openNext() {
    const std::string& path = paths_[opened_++];
    // Channels are pointed to by the newest message only.
    current_ = is_mcap_ ? openMcapMessages(path) : openDb3Messages(path);
  }

  std::vector<std::string> paths_;
  bool is_mcap_;
  size_t opened_ = 0;
  std::unique_ptr<RosMessages> current_;
  std::string remarks_;
};

constexpr const char* kMetadataName = "metadata.yaml";

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\"'");
  if (first == std::string_view::npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(" \t\r\"'") - first + 1));
}

struct FolderContent {
  bool is_mcap = false;
  std::vector<std::string> paths;
};

/// The few lines of metadata.yaml that matter; rosbag2 writes it in YAML's block style with one key a line.
FolderContent readMetadata(const std::string& folder) {
  const std::string path = (fs::path(folder) / kMetadataName).string();
  const std::string content = core::readTextFile(path);
  FolderContent result;
  std::string storage, compression;
  bool in_paths = false;
  for (size_t begin = 0; begin < content.size();) {
    const size_t end = std::min(content.find('\n', begin), content.size());
    const std::string line = trimmed(std::string_view(content).substr(begin, end - begin));
    begin = end + 1;
    const size_t colon = line.find(':');
    const std::string key = line.substr(0, colon);
    if (line.substr(0, 2) == "- " && in_paths) {
      result.paths.push_back((fs::path(folder) / trimmed(std::string_view(line).substr(2))).string());
      continue;
    }
    if (colon == std::string::npos) continue;
    in_paths = key == "relative_file_paths";
    const std::string value = trimmed(std::string_view(line).substr(colon + 1));
    if (key == "storage_identifier") storage = value;
    if (key == "compression_mode") compression = value;
  }
  if (storage != "sqlite3" && storage != "mcap")
    throw core::InputError(path + ": storage_identifier: found '" + printable(storage) +
                           "', expected sqlite3 or mcap");
  if (!compression.empty() && compression != "NONE" && compression != "none")
    throw core::InputError(path + ": compression_mode: found '" + compression +
                           "', expected none (`ros2 bag convert` writes such a bag)");
  if (result.paths.empty())
    throw core::InputError(path + ": relative_file_paths: found none, expected the bag's files");
  result.is_mcap = storage == "mcap";
  return result;
}

class Db3Writer : public RosBagWriter {
 public:
  explicit Db3Writer(const std::string& path) : path_(path) {
    if (fs::path(path).extension() == ".db3") {
      std::error_code ignored;
      if (fs::is_directory(path, ignored)) throw core::IoError(path + ": cannot be written: is a folder");
      file_ = std::make_unique<core::PendingFile>(path);
      open(file_->path());
    } else {
      folder_ = std::make_unique<core::PendingFolder>(path, false);
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
    core::writeFileAtomically((fs::path(folder_->path()) / kMetadataName).string(), metadata());
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
  std::unique_ptr<core::PendingFile> file_;
  std::unique_ptr<core::PendingFolder> folder_;
  Database database_;
  Statement insert_;
  std::vector<Topic> topics_;
  std::uint64_t count_ = 0;
  std::int64_t first_ns_ = 0, last_ns_ = 0;
};

}  // namespace

std::unique_ptr<RosMessages> openDb3Messages(const std::string& path) {
  return std::make_unique<Db3Messages>(path);
}

bool looksLikeRos2Db3(std::string_view first_bytes) {
  return first_bytes.substr(0, kMagic.size()) == kMagic;
}

bool looksLikeRos2Folder(const std::string& path) {
  std::error_code ignored;
  return fs::is_regular_file(fs::path(path) / kMetadataName, ignored);
}

std::unique_ptr<objects::ObjectSource> openRos2Db3(const std::string& path, const RosReadOptions& options) {
  return makeRosSource(
      path, [path] { return openDb3Messages(path); }, options);
}

std::unique_ptr<objects::ObjectSource> openRos2Folder(const std::string& path,
                                                      const RosReadOptions& options) {
  const auto content = readMetadata(path);
  return makeRosSource(
      path, [content] { return std::make_unique<ChainedMessages>(content.paths, content.is_mcap); }, options);
}

std::unique_ptr<objects::ObjectSink> createRos2Db3(const std::string& path) {
  return makeRosSink(std::make_unique<Db3Writer>(path));
}

}  // namespace slam::bags
