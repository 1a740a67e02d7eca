#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "libslam/bags/mcap_format.h"
#include "libslam/bags/ros_bytes.h"
#include "libslam/bags/ros_logs.h"
#include "libslam/bags/ros_objects.h"
#include "libslam/core/error.h"

namespace slam::bags {
namespace {

class McapMessages : public RosMessages {
 public:
  explicit McapMessages(const std::string& path) : path_(path), file_(path) {
    std::string magic;
    file_.read(kMcapMagic.size(), magic);
    if (magic != kMcapMagic) throw core::InputError(path + ": not an MCAP file of version 0");
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
    file_.read(kMcapMagic.size(), magic);
    if (magic.size() < kMcapMagic.size()) failCut();
    if (magic != kMcapMagic || file_.left() > 0)
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
        throw core::InputError("a chunk compressed as '" + shownName(compression) +
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
    channel.topic = shownName(reader.sized<std::uint32_t>());
    const auto encoding = reader.sized<std::uint32_t>();
    channel.encoding = encoding == "ros1" ? RosEncoding::kRos1 : RosEncoding::kCdr;
    if (encoding != "ros1" && encoding != "cdr") channel.obstacle = "encoded as " + shownName(encoding);
    const auto found = schemas_.find(schema);
    if (found != schemas_.end()) channel.type = shownName(withoutMsg(found->second));
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
  Crc32 crc_;  ///< of the data section, then of the summary
  std::string head_, data_, chunk_bytes_;
  ByteReader chunk_{{}};
  bool chunk_is_cut_ = false, is_ended_ = false, is_failed_ = false;
  std::uint64_t record_start_ = 0, messages_ = 0;
  std::map<std::uint16_t, std::string> schemas_;  ///< names
  std::map<std::uint16_t, RosChannel> channels_;
};

}  // namespace

std::unique_ptr<RosMessages> openMcapMessages(const std::string& path) {
  return std::make_unique<McapMessages>(path);
}

bool looksLikeMcap(std::string_view first_bytes) {
  return first_bytes.substr(0, kMcapMagic.size()) == kMcapMagic;
}

std::unique_ptr<objects::ObjectSource> openMcap(const std::string& path, const RosReadOptions& options) {
  return makeRosSource(
      path, [path] { return openMcapMessages(path); }, options);
}

}  // namespace slam::bags
