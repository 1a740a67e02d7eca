#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "libslam/bags/ros_bytes.h"
#include "libslam/bags/ros_logs.h"
#include "libslam/bags/ros_objects.h"
#include "libslam/core/error.h"

// The format: wiki.ros.org/Bags/Format/2.0. A record is a header of "name=value" fields and data, both with
// their length before them.

namespace slam::bags {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
constexpr std::string_view kAnyVersion = "#ROSBAG V";
constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr std::uint32_t kMostHeaderBytes = 1U << 20;
constexpr size_t kBagHeaderBytes = 4096;
constexpr size_t kChunkBytes = 768U << 10;

enum Op : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

/// The "name=value" fields of a record's or connection's header.
class Fields {
 public:
  explicit Fields(std::string_view bytes) {
    ByteReader reader(bytes);
    while (reader.left() > 0) {
      const auto field = reader.sized<std::uint32_t>();
      const size_t equals = field.find('=');
      if (equals == std::string_view::npos) throw core::InputError("a header field without '='");
      fields_.emplace_back(field.substr(0, equals), field.substr(equals + 1));
    }
  }
  std::optional<std::string_view> find(std::string_view name) const {
    for (const auto& [key, value] : fields_)
      if (key == name) return value;
    return std::nullopt;
  }
  std::string_view text(std::string_view name) const {
    const auto value = find(name);
    if (!value) throw core::InputError("a record without the field '" + std::string(name) + "'");
    return *value;
  }
  template <class Number>
  Number number(std::string_view name) const {
    return ByteReader(text(name)).number<Number>();
  }
  std::int64_t time() const {
    ByteReader reader(text("time"));
    const auto seconds = reader.number<std::uint32_t>(), nanoseconds = reader.number<std::uint32_t>();
    return std::int64_t{seconds} * kNanosecondsPerSecond + nanoseconds;
  }

 private:
  std::vector<std::pair<std::string_view, std::string_view>> fields_;
};

class Ros1Messages : public RosMessages {
 public:
  explicit Ros1Messages(const std::string& path) : path_(path), file_(path) {
    file_.read(kMagic.size(), header_);
    if (header_ == kMagic) return;
    if (header_.substr(0, kAnyVersion.size()) == kAnyVersion)
      throw core::InputError(
          path + ": a ROS bag of version " +
          shownName(header_.substr(kAnyVersion.size(), header_.find('\n') - kAnyVersion.size())) +
          ", expected 2.0 (`rosbag migrate` turns it into one)");
    throw core::InputError(path + ": not a ROS 1 bag (it does not begin with '#ROSBAG V2.0')");
  }

  bool next(RosMessage& message) override {
    try {
      while (true) {
        if (chunk_.left() == 0) {
          if (chunk_is_cut_) failCut();
          if (!nextRecord(message)) return false;
        } else if (!nextInChunk(message)) {
          continue;
        }
        if (message.channel == nullptr) continue;
        ++messages_;
        return true;
      }
    } catch (const Cut&) {
      failCut();
    } catch (const core::InputError& error) {
      if (is_failed_) throw;
      fail(error.what());
    }
  }

  double fractionRead() const override {
    return static_cast<double>(file_.position()) / static_cast<double>(file_.size());
  }

 private:
  struct Cut {};

  /// A record of the file itself. False at the proper end.
  bool nextRecord(RosMessage& message) {
    message.channel = nullptr;
    record_start_ = file_.position();
    if (file_.left() == 0) {
      if (is_unfinished_)
        fail("its recorder did not close it: it has no index (`rosbag reindex` makes one)", "");
      return false;
    }
    readPart(header_, kMostHeaderBytes, "a record header");
    const Fields fields(header_);
    const auto op = fields.number<std::uint8_t>("op");
    if (op != kMessage && op != kConnection && op != kChunk && op != kBagHeader) {
      if (op != kIndex && op != kChunkInfo) throw core::InputError("a record of kind " + std::to_string(op));
      skipData();
      return true;
    }
    readPart(data_, kMostChunkBytes, "a record");
    if (op == kChunk) {
      openChunk(fields);
    } else if (op == kBagHeader) {
      is_unfinished_ = fields.number<std::uint64_t>("index_pos") == 0;
      const auto encryptor = fields.find("encryptor");
      if (encryptor && !encryptor->empty())
        throw core::InputError("encrypted (" + shownName(*encryptor) + "), which is not read");
    } else {
      takeInner(op, fields, data_, message);
    }
    return true;
  }

  /// A record in a chunk. False when there is no whole one.
  bool nextInChunk(RosMessage& message) {
    message.channel = nullptr;
    try {
      const Fields fields(chunk_.sized<std::uint32_t>());
      takeInner(fields.number<std::uint8_t>("op"), fields, chunk_.sized<std::uint32_t>(), message);
      return true;
    } catch (const core::InputError&) {
      // The last record of a chunk that was cut.
      if (!chunk_is_cut_) throw;
      chunk_ = ByteReader({});
      return false;
    }
  }

  void takeInner(std::uint8_t op, const Fields& fields, std::string_view data, RosMessage& message) {
    const auto connection = op == kMessage || op == kConnection ? fields.number<std::uint32_t>("conn") : 0;
    if (op == kConnection) {
      if (!channels_.count(connection)) channels_.emplace(connection, channelOf(fields, Fields(data)));
    } else if (op == kMessage) {
      const auto found = channels_.find(connection);
      if (found == channels_.end())
        throw core::InputError("a message of connection " + std::to_string(connection) +
                               ", which was not introduced");
      message = {&found->second, fields.time(), data};
    }
  }

  static RosChannel channelOf(const Fields& record, const Fields& connection) {
    RosChannel channel;
    channel.topic = shownName(record.text("topic"));
    channel.type = shownName(connection.text("type"));
    channel.encoding = RosEncoding::kRos1;
    const std::string md5(connection.text("md5sum")), expected = rosMd5(channel.type);
    // '*' is what a recorder writes that never learnt the sum.
    if (!expected.empty() && md5 != expected && md5 != "*") channel.other_md5 = shownName(md5);
    return channel;
  }

  void openChunk(const Fields& fields) {
    const std::string compression(fields.text("compression"));
    if (!knowsCompression(compression) || compression == "zstd" || compression.empty())
      throw core::InputError("chunks compressed as '" + shownName(compression) +
                             "', expected none, bz2 or lz4");
    auto unpacked = unpack(compression, data_, fields.number<std::uint32_t>("size"));
    if (!unpacked.complete && !data_is_cut_)
      throw core::InputError("a " + compression + " chunk without its end");
    chunk_is_cut_ = data_is_cut_;
    chunk_bytes_ = std::move(unpacked.bytes);
    chunk_ = ByteReader(chunk_bytes_);
  }

  void readPart(std::string& part, std::uint64_t most, const char* what) {
    const auto length = readLength();
    if (length > most)
      throw core::InputError(std::string(what) + " of " + std::to_string(length) +
                             " bytes, expected at most " + std::to_string(most));
    file_.read(length, part);
    data_is_cut_ = part.size() < length;
    // What a cut chunk still holds is read; nothing else of a cut record is.
    if (data_is_cut_ && (&part == &header_ || Fields(header_).number<std::uint8_t>("op") != kChunk))
      throw Cut();
  }

  void skipData() {
    const auto length = readLength();
    if (length > file_.left()) throw Cut();
    file_.skip(length);
  }

  std::uint32_t readLength() {
    std::string raw;
    file_.read(sizeof(std::uint32_t), raw);
    if (raw.size() < sizeof(std::uint32_t)) throw Cut();
    return ByteReader(raw).number<std::uint32_t>();
  }

  [[noreturn]] void failCut() { fail("the file is cut off: it ends inside this record", "truncated "); }
  [[noreturn]] void fail(const std::string& what, const char* kind = "damaged ") {
    is_failed_ = true;
    throw core::InputError(path_ + ": " + kind + "ROS 1 bag: record at byte " +
                           std::to_string(record_start_) + ", after " + counted(messages_, "message") + ": " +
                           what);
  }

  std::string path_;
  FileBytes file_;
  std::string header_, data_, chunk_bytes_;
  ByteReader chunk_{{}};
  bool data_is_cut_ = false, chunk_is_cut_ = false, is_unfinished_ = false, is_failed_ = false;
  std::uint64_t record_start_ = 0, messages_ = 0;
  std::map<std::uint32_t, RosChannel> channels_;
};

std::string field(std::string_view name, std::string_view value) {
  std::string bytes;
  appendSized<std::uint32_t>(bytes, std::string(name) + "=" + std::string(value));
  return bytes;
}
template <class Number>
std::string numberField(std::string_view name, Number number) {
  std::string raw;
  appendNumberBytes(raw, number);
  return field(name, raw);
}
std::string rawTime(std::int64_t time_ns) {
  std::string raw;
  appendNumberBytes(raw, static_cast<std::uint32_t>(time_ns / kNanosecondsPerSecond));
  appendNumberBytes(raw, static_cast<std::uint32_t>(time_ns % kNanosecondsPerSecond));
  return raw;
}
std::string record(std::string_view header, std::string_view data) {
  std::string bytes;
  appendSized<std::uint32_t>(bytes, header);
  appendSized<std::uint32_t>(bytes, data);
  return bytes;
}

class Ros1Writer : public RosBagWriter {
 public:
  explicit Ros1Writer(const std::string& path) : file_(path) {
    file_.append(kMagic);
    file_.append(bagHeader(0));
  }

  RosEncoding encoding() const override { return RosEncoding::kRos1; }

  void write(const std::string& topic, const std::string& type, bool is_latched, std::int64_t time_ns,
             std::string_view bytes) override {
    const auto connection = connectionOf(topic, type, is_latched);
    if (index_.empty()) chunk_start_ns_ = time_ns;
    chunk_end_ns_ = time_ns;
    auto& entries = index_[connection];
    entries += rawTime(time_ns);
    appendNumberBytes(entries, static_cast<std::uint32_t>(chunk_.size()));
    chunk_ += record(numberField("op", std::uint8_t{kMessage}) + numberField("conn", connection) +
                         field("time", rawTime(time_ns)),
                     bytes);
    if (chunk_.size() >= kChunkBytes) finishChunk();
  }

  void close() override {
    finishChunk();
    const auto index_position = file_.size();
    for (const auto& connection : connections_) file_.append(connection);
    for (const auto& info : chunk_infos_) file_.append(info);
    file_.overwrite(kMagic.size(), bagHeader(index_position));
    file_.close();
  }

 private:
  /// Padded, so that it can be written again over itself when all is known.
  std::string bagHeader(std::uint64_t index_position) const {
    const std::string header = numberField("op", std::uint8_t{kBagHeader}) +
                               numberField("index_pos", index_position) +
                               numberField("conn_count", static_cast<std::uint32_t>(connections_.size())) +
                               numberField("chunk_count", static_cast<std::uint32_t>(chunk_infos_.size()));
    return record(header, std::string(kBagHeaderBytes - header.size(), ' '));
  }

  std::uint32_t connectionOf(const std::string& topic, const std::string& type, bool is_latched) {
    const auto known = ids_.find(topic);
    if (known != ids_.end()) return known->second;
    const auto id = static_cast<std::uint32_t>(ids_.size());
    ids_[topic] = id;
    std::string description = field("topic", topic) + field("type", type) + field("md5sum", rosMd5(type)) +
                              field("message_definition", rosDefinition(RosEncoding::kRos1, type));
    if (is_latched) description += field("latching", "1");
    connections_.push_back(
        record(numberField("op", std::uint8_t{kConnection}) + numberField("conn", id) + field("topic", topic),
               description));
    chunk_ += connections_.back();
    return id;
  }

  void finishChunk() {
    if (index_.empty()) return;
    const auto position = file_.size();
    file_.append(record(numberField("op", std::uint8_t{kChunk}) + field("compression", "none") +
                            numberField("size", static_cast<std::uint32_t>(chunk_.size())),
                        chunk_));
    std::string counts;
    constexpr size_t kEntryBytes = 12;
    for (const auto& [connection, entries] : index_) {
      const auto count = static_cast<std::uint32_t>(entries.size() / kEntryBytes);
      file_.append(record(numberField("op", std::uint8_t{kIndex}) + numberField("ver", std::uint32_t{1}) +
                              numberField("conn", connection) + numberField("count", count),
                          entries));
      appendNumberBytes(counts, connection);
      appendNumberBytes(counts, count);
    }
    chunk_infos_.push_back(
        record(numberField("op", std::uint8_t{kChunkInfo}) + numberField("ver", std::uint32_t{1}) +
                   numberField("chunk_pos", position) + field("start_time", rawTime(chunk_start_ns_)) +
                   field("end_time", rawTime(chunk_end_ns_)) +
                   numberField("count", static_cast<std::uint32_t>(index_.size())),
               counts));
    index_.clear();
    chunk_.clear();
  }

  NewFile file_;
  std::map<std::string, std::uint32_t> ids_;
  std::vector<std::string> connections_, chunk_infos_;  ///< whole records
  std::string chunk_;
  std::map<std::uint32_t, std::string> index_;  ///< of the chunk that is open, by connection
  std::int64_t chunk_start_ns_ = 0, chunk_end_ns_ = 0;
};

}  // namespace

bool looksLikeRos1Bag(std::string_view first_bytes) {
  return first_bytes.substr(0, kAnyVersion.size()) == kAnyVersion;
}

std::unique_ptr<objects::ObjectSource> openRos1Bag(const std::string& path, const RosReadOptions& options) {
  return makeRosSource(
      path, [path] { return std::make_unique<Ros1Messages>(path); }, options);
}

std::unique_ptr<objects::ObjectSink> createRos1Bag(const std::string& path) {
  return makeRosSink(std::make_unique<Ros1Writer>(path));
}

}  // namespace slam::bags
