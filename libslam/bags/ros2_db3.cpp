#include <algorithm>
#include <filesystem>
#include <map>
#include <utility>

#include "libslam/bags/db3_database.h"
#include "libslam/bags/ros_bytes.h"
#include "libslam/bags/ros_logs.h"
#include "libslam/bags/ros_objects.h"
#include "libslam/core/error.h"

namespace slam::bags {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kMagic("SQLite format 3\0", 16);
constexpr int kMostBlobBytes = 1 << 30;

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
      channel.topic = shownName(text(topics.get(), 1));
      channel.type = shownName(withoutMsg(text(topics.get(), 2)));
      channel.encoding = RosEncoding::kCdr;
      const auto format = text(topics.get(), 3);
      if (format != "cdr") channel.obstacle = "serialized as " + shownName(format);
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
                           ": SQLite says '" + shownName(sqlite3_errmsg(database_.get())) + "'");
  }

  std::string path_;
  Database database_;
  Statement messages_;
  std::map<std::int64_t, RosChannel> channels_;
  std::uint64_t count_ = 0;
  std::int64_t last_id_ = 0;
  bool is_cut_ = false;
};

}  // namespace

std::unique_ptr<RosMessages> openDb3Messages(const std::string& path) {
  return std::make_unique<Db3Messages>(path);
}

bool looksLikeRos2Db3(std::string_view first_bytes) {
  return first_bytes.substr(0, kMagic.size()) == kMagic;
}

std::unique_ptr<objects::ObjectSource> openRos2Db3(const std::string& path, const RosReadOptions& options) {
  return makeRosSource(
      path, [path] { return openDb3Messages(path); }, options);
}

}  // namespace slam::bags
