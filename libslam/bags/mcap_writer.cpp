#include <algorithm>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "libslam/bags/mcap_format.h"
#include "libslam/bags/ros_bytes.h"
#include "libslam/bags/ros_logs.h"
#include "libslam/bags/ros_objects.h"
#include "libslam/core/error.h"

namespace slam::bags {
namespace {

constexpr size_t kChunkBytes = size_t{1} << 20;

std::string record(McapOp op, std::string_view content) {
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
    append(kMcapMagic);
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
    const auto add = [&](McapOp op, const std::string& records) {
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
    file_.append(kMcapMagic);
  }

  std::string compression_;  ///< "" for none, as in the file
  RosEncoding encoding_;
  NewFile file_;
  Crc32 crc_;
  std::map<std::string, Channel> channels_;  ///< by topic
  std::map<std::string, std::uint16_t> schema_ids_;
  std::string schemas_, channel_records_, chunk_indices_;  ///< whole records, for the summary
  std::string chunk_;
  std::map<std::uint16_t, std::string> index_;  ///< of the chunk that is open, by channel
  std::uint64_t messages_ = 0, first_ = 0, last_ = 0, chunk_first_ = 0;
  std::uint32_t chunks_ = 0;
};

}  // namespace

std::unique_ptr<objects::ObjectSink> createMcap(const std::string& path, const McapWriteOptions& options) {
  return makeRosSink(std::make_unique<McapWriter>(path, options));
}

}  // namespace slam::bags
