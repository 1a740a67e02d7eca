#include <zlib.h>

#include <algorithm>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "libslam/bags/ros2_bags.h"
#include "libslam/bags/ros_bytes.h"
#include "libslam/bags/ros_logs.h"
#include "libslam/core/error.h"

// The format: mcap.dev/spec. A record is one byte of kind, 8 bytes of length, content; all little-endian.

namespace slam::bags {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::uint64_t kRecordHead = 9;
constexpr size_t kChunkBytes = size_t{1} << 20;
/// Of a footer, what comes before its check sum: both offsets.
constexpr size_t kFooterOffsets = 16;

enum Op : std::uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kStatistics = 11,
  kSummaryOffset = 14,
  kDataEnd = 15
};

/// zlib's CRC-32, which is the format's, of one part after the other.
class Crc {
 public:
  void add(std::string_view bytes) {
    value_ = crc32_z(value_, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  }
  std::uint32_t value() const { return static_cast<std::uint32_t>(value_); }

 private:
  uLong value_ = crc32_z(0, nullptr, 0);
};

std::uint32_t crcOf(std::string_view bytes) {
  Crc crc;
  crc.add(bytes);
  return crc.value();
}

class McapMessages : public RosMessages {
 public:
  explicit McapMessages(const std::string& path) : path_(path), file_(path) {
    std::string magic;
    file_.read(kMagic.size(), magic);
    if (magic != kMagic) throw core::InputError(path + ": not an MCAP file of version 0");
    crc_.add(magic);
  }

  bool next(RosMessage& message) override {
    if (is_ended_) return false;
    try {
      while (true) {
        message.channel = nullptr;
        if (chunk_.left() > 0) {
          nextInChunk(message);
        } else if (chunk_is_cut_) {
          failCut();
        } else if (!nextRecord(message)) {
          is_ended_ = true;
          return false;
        }
        if (message.channel == nullptr) continue;
        ++messages_;
        return true;
      }
    } catch (const core::InputError& error) {
      if (is_failed_) throw;
      fail("damaged", error.what());
    }
  }

  double fractionRead() const override {
    return static_cast<double>(file_.position()) / static_cast<double>(file_.size());
  }

 private:
  /// A record of the file itself. False after the footer.
  bool nextRecord(RosMessage& message) {
    record_start_ = file_.position();
    file_.read(kRecordHead, head_);
    if (head_.size() < kRecordHead) failCut();
    ByteReader reader(head_);
    const auto op = reader.number<std::uint8_t>();
    const auto length = reader.number<std::uint64_t>();
    if (op == 0) throw core::InputError("a record of kind 0");
    const bool is_read =
        op == kSchema || op == kChannel || op == kMessage || op == kChunk || op == kDataEnd || op == kFooter;
    if (!is_read) {
      crc_.add(head_);
      skip(length);
      return true;
    }
    if (length > kMostChunkBytes)
      throw core::InputError("a record of " + std::to_string(length) + " bytes, expected at most " +
                             std::to_string(kMostChunkBytes));
    file_.read(length, data_);
    const bool is_cut = data_.size() < length;
    if (is_cut && op != kChunk) failCut();
    if (op == kDataEnd) {
      checkCrc(ByteReader(data_).number<std::uint32_t>(), crc_.value(), "data section");
      crc_ = {};
      return true;
    }
    crc_.add(head_);
    if (op == kFooter) {
      finish();
      return false;
    }
    crc_.add(data_);
    if (op == kChunk)
      openChunk(is_cut);
    else
      take(op, data_, message);
    return true;
  }

  void skip(std::uint64_t length) {
    constexpr std::uint64_t kPiece = std::uint64_t{1} << 20;
    while (length > 0) {
      file_.read(std::min(length, kPiece), data_);
      if (data_.empty()) failCut();
      crc_.add(data_);
      length -= data_.size();
    }
  }

  void finish() {
    ByteReader reader(data_);
    crc_.add(reader.take(kFooterOffsets));
    checkCrc(reader.number<std::uint32_t>(), crc_.value(), "summary");
    std::string magic;
    file_.read(kMagic.size(), magic);
    if (magic.size() < kMagic.size()) failCut();
    if (magic != kMagic || file_.left() > 0)
      throw core::InputError("bytes after the footer that are not its end");
  }

  void openChunk(bool is_cut) {
    ByteReader reader(data_);
    try {
      reader.take(sizeof(std::uint64_t) * 2);  // the times of the first and last message
      const auto size = reader.number<std::uint64_t>();
      const auto crc = reader.number<std::uint32_t>();
      const std::string compression(reader.sized<std::uint32_t>());
      if (!knowsCompression(compression) || compression == "bz2" || compression == "none")
        throw core::InputError("a chunk compressed as '" + printable(compression) +
                               "', expected lz4, zstd or none");
      const auto packed_size = reader.number<std::uint64_t>();
      auto unpacked = unpack(compression, is_cut ? reader.rest() : reader.take(packed_size), size);
      if (!unpacked.complete && !is_cut) throw core::InputError("a chunk without its end");
      if (unpacked.complete) checkCrc(crc, crcOf(unpacked.bytes), "chunk");
      chunk_bytes_ = std::move(unpacked.bytes);
    } catch (const core::InputError&) {
      if (is_cut) failCut();
      throw;
    }
    chunk_ = ByteReader(chunk_bytes_);
    chunk_is_cut_ = is_cut;
  }

  void nextInChunk(RosMessage& message) {
    try {
      const auto op = chunk_.number<std::uint8_t>();
      const auto content = chunk_.sized<std::uint64_t>();
      take(op, content, message);
    } catch (const core::InputError&) {
      // The last record of a chunk that was cut.
      if (!chunk_is_cut_) throw;
      chunk_ = ByteReader({});
    }
  }

  void take(std::uint8_t op, std::string_view content, RosMessage& message) {
    ByteReader reader(content);
    if (op == kSchema) {
      const auto id = reader.number<std::uint16_t>();
      schemas_[id] = reader.sized<std::uint32_t>();
    } else if (op == kChannel) {
      takeChannel(reader);
    } else if (op == kMessage) {
      const auto id = reader.number<std::uint16_t>();
      reader.number<std::uint32_t>();  // sequence
      const auto log_time = reader.number<std::uint64_t>();
      reader.number<std::uint64_t>();  // publish time
      const auto found = channels_.find(id);
      if (found == channels_.end())
        throw core::InputError("a message of channel " + std::to_string(id) + ", which was not introduced");
      if (log_time > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
        throw core::InputError("a message with the time " + std::to_string(log_time));
      message = {&found->second, static_cast<std::int64_t>(log_time), reader.rest()};
    }
  }

  void takeChannel(ByteReader reader) {
    const auto id = reader.number<std::uint16_t>();
    const auto schema = reader.number<std::uint16_t>();
    RosChannel channel;
    channel.topic = printable(reader.sized<std::uint32_t>());
    const auto encoding = reader.sized<std::uint32_t>();
    channel.encoding = encoding == "ros1" ? RosEncoding::kRos1 : RosEncoding::kCdr;
    if (encoding != "ros1" && encoding != "cdr") channel.obstacle = "encoded as " + printable(encoding);
    const auto found = schemas_.find(schema);
    if (found != schemas_.end()) channel.type = printable(withoutMsg(found->second));
    channels_.emplace(id, std::move(channel));
  }

  static void checkCrc(std::uint32_t stated, std::uint32_t computed, const char* what) {
    // 0 stands for "not computed".
    if (stated != 0 && stated != computed)
      throw core::InputError(std::string("the check sum of the ") + what + " does not fit");
  }

  [[noreturn]] void failCut() {
    fail("truncated", "the file ends before its footer (cut off, or its recorder did not finish it)");
  }
  [[noreturn]] void fail(const std::string& kind, const std::string& what) {
    is_failed_ = true;
    throw core::InputError(path_ + ": " + kind + " MCAP file: record at byte " +
                           std::to_string(record_start_) + ", after " + counted(messages_, "message") + ": " +
                           what);
  }

  std::string path_;
  FileBytes file_;
  Crc crc_;  ///< of the data section, then of the summary
  std::string head_, data_, chunk_bytes_;
  ByteReader chunk_{{}};
  bool chunk_is_cut_ = false, is_ended_ = false, is_failed_ = false;
  std::uint64_t record_start_ = 0, messages_ = 0;
  std::map<std::uint16_t, std::string> schemas_;  ///< names
  std::map<std::uint16_t, RosChannel> channels_;
};

std::string record(Op op, std::string_view content) {
  std::string bytes;
  appendNumberBytes(bytes, static_cast<std::uint8_t>(op));
  appendSized<std::uint64_t>(bytes, content);
  return bytes;
}
void appendText(std::string& bytes, std::string_view text) {
  appendSized<std::uint32_t>(bytes, text);
}

class McapWriter : public RosBagWriter {
 public:
  McapWriter(const std::string& path, const McapWriteOptions& options)
      : compression_(options.compression == "none" ? "" : options.compression),
        encoding_(options.ros1 ? RosEncoding::kRos1 : RosEncoding::kCdr),
        file_(path) {
    if (compression_ == "bz2" || !knowsCompression(compression_))
      throw core::ContractError("createMcap: unknown compression " + compression_);
    std::string header;
    appendText(header, options.ros1 ? "ros1" : "ros2");
    appendText(header, "rasterslam");
    append(kMagic);
    append(record(kHeader, header));
  }

  RosEncoding encoding() const override { return encoding_; }

  void write(const std::string& topic, const std::string& type, bool is_latched, std::int64_t time_ns,
             std::string_view bytes) override {
    auto& channel = channelOf(topic, type, is_latched);
    const auto time = static_cast<std::uint64_t>(time_ns);
    if (messages_ == 0) first_ = time;
    last_ = time;
    if (index_.empty()) chunk_first_ = time;
    auto& entries = index_[channel.id];
    appendNumberBytes(entries, time);
    appendNumberBytes(entries, static_cast<std::uint64_t>(chunk_.size()));
    std::string content;
    appendNumberBytes(content, channel.id);
    appendNumberBytes(content, static_cast<std::uint32_t>(channel.messages));
    appendNumberBytes(content, time);
    appendNumberBytes(content, time);
    content += bytes;
    chunk_ += record(kMessage, content);
    ++channel.messages;
    ++messages_;
    if (chunk_.size() >= kChunkBytes) finishChunk();
  }

  void close() override {
    finishChunk();
    std::string data_end;
    appendNumberBytes(data_end, crc_.value());
    file_.append(record(kDataEnd, data_end));
    writeSummary();
    file_.close();
  }

 private:
  struct Channel {
    std::uint16_t id = 0;
    std::uint64_t messages = 0;
  };

  void append(std::string_view bytes) {
    crc_.add(bytes);
    file_.append(bytes);
  }

  Channel& channelOf(const std::string& topic, const std::string& type, bool is_latched) {
    const auto known = channels_.find(topic);
    if (known != channels_.end()) return known->second;
    const bool is_ros1 = encoding_ == RosEncoding::kRos1;
    auto& schema_id = schema_ids_[type];
    if (schema_id == 0) {
      schema_id = static_cast<std::uint16_t>(schema_ids_.size());
      std::string schema;
      appendNumberBytes(schema, schema_id);
      appendText(schema, is_ros1 ? type : withMsg(type));
      appendText(schema, is_ros1 ? "ros1msg" : "ros2msg");
      appendText(schema, rosDefinition(encoding_, type));
      schemas_ += record(kSchema, schema);
      chunk_ += record(kSchema, schema);
    }
    Channel channel;
    channel.id = static_cast<std::uint16_t>(channels_.size() + 1);
    std::string content;
    appendNumberBytes(content, channel.id);
    appendNumberBytes(content, schema_id);
    appendText(content, topic);
    appendText(content, is_ros1 ? "ros1" : "cdr");
    std::string metadata;
    if (is_latched) {
      appendText(metadata, is_ros1 ? "latching" : "offered_qos_profiles");
      appendText(metadata, is_ros1 ? "1" : kLatchedQos);
    }
    appendText(content, metadata);
    channel_records_ += record(kChannel, content);
    chunk_ += record(kChannel, content);
    return channels_[topic] = channel;
  }

  void finishChunk() {
    if (index_.empty()) return;
    const auto start = file_.size();
    const std::string packed = pack(compression_, chunk_);
    std::string content;
    appendNumberBytes(content, chunk_first_);
    appendNumberBytes(content, last_);
    appendNumberBytes(content, static_cast<std::uint64_t>(chunk_.size()));
    appendNumberBytes(content, crcOf(chunk_));
    appendText(content, compression_);
    appendSized<std::uint64_t>(content, packed);
    append(record(kChunk, content));
    const auto indices_start = file_.size();

    std::string offsets;
    for (const auto& [channel, entries] : index_) {
      appendNumberBytes(offsets, channel);
      appendNumberBytes(offsets, file_.size());
      std::string index;
      appendNumberBytes(index, channel);
      appendText(index, entries);
      append(record(kMessageIndex, index));
    }

    std::string summary;
    appendNumberBytes(summary, chunk_first_);
    appendNumberBytes(summary, last_);
    appendNumberBytes(summary, start);
    appendNumberBytes(summary, indices_start - start);
    appendText(summary, offsets);
    appendNumberBytes(summary, file_.size() - indices_start);
    appendText(summary, compression_);
    appendNumberBytes(summary, static_cast<std::uint64_t>(packed.size()));
    appendNumberBytes(summary, static_cast<std::uint64_t>(chunk_.size()));
    chunk_indices_ += record(kChunkIndex, summary);
    ++chunks_;
    index_.clear();
    chunk_.clear();
  }

  std::string statistics() const {
    std::string content, counts;
    appendNumberBytes(content, messages_);
    appendNumberBytes(content, static_cast<std::uint16_t>(schema_ids_.size()));
    appendNumberBytes(content, static_cast<std::uint32_t>(channels_.size()));
    appendNumberBytes(content, std::uint32_t{0});  // attachments
    appendNumberBytes(content, std::uint32_t{0});  // metadata
    appendNumberBytes(content, chunks_);
    appendNumberBytes(content, first_);
    appendNumberBytes(content, last_);
    for (const auto& [topic, channel] : channels_) {
      appendNumberBytes(counts, channel.id);
      appendNumberBytes(counts, channel.messages);
    }
    appendText(content, counts);
    return record(kStatistics, content);
  }

  void writeSummary() {
    const auto start = file_.size();
    std::string summary, offsets;
    const auto add = [&](Op op, const std::string& records) {
      if (records.empty()) return;
      std::string offset;
      appendNumberBytes(offset, static_cast<std::uint8_t>(op));
      appendNumberBytes(offset, start + summary.size());
      appendNumberBytes(offset, static_cast<std::uint64_t>(records.size()));
      offsets += record(kSummaryOffset, offset);
      summary += records;
    };
    add(kSchema, schemas_);
    add(kChannel, channel_records_);
    add(kStatistics, statistics());
    add(kChunkIndex, chunk_indices_);
    const auto offsets_start = start + summary.size();
    summary += offsets;

    std::string footer;
    appendNumberBytes(footer, start);
    appendNumberBytes(footer, offsets_start);
    appendNumberBytes(footer, std::uint32_t{0});
    std::string end = summary + record(kFooter, footer);
    // The sum covers everything from the summary's start to itself.
    end.resize(end.size() - sizeof(std::uint32_t));
    appendNumberBytes(end, crcOf(end));
    file_.append(end);
    file_.append(kMagic);
  }

  std::string compression_;  ///< "" for none, as in the file
  RosEncoding encoding_;
  NewFile file_;
  Crc crc_;
  std::map<std::string, Channel> channels_;  ///< by topic
  std::map<std::string, std::uint16_t> schema_ids_;
  std::string schemas_, channel_records_, chunk_indices_;  ///< whole records, for the summary
  std::string chunk_;
  std::map<std::uint16_t, std::string> index_;  ///< of the chunk that is open, by channel
  std::uint64_t messages_ = 0, first_ = 0, last_ = 0, chunk_first_ = 0;
  std::uint32_t chunks_ = 0;
};

}  // namespace

std::unique_ptr<RosMessages> openMcapMessages(const std::string& path) {
  return std::make_unique<McapMessages>(path);
}

bool looksLikeMcap(std::string_view first_bytes) {
  return first_bytes.substr(0, kMagic.size()) == kMagic;
}

std::unique_ptr<objects::ObjectSource> openMcap(const std::string& path, const RosReadOptions& options) {
  return makeRosSource(
      path, [path] { return openMcapMessages(path); }, options);
}

std::unique_ptr<objects::ObjectSink> createMcap(const std::string& path, const McapWriteOptions& options) {
  return makeRosSink(std::make_unique<McapWriter>(path, options));
}

}  // namespace slam::bags
