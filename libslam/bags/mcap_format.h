#pragma once
#include <zlib.h>

#include <cstdint>
#include <string_view>

// MCAP: mcap.dev/spec. A record is one byte of kind, 8 bytes of length, content; all little-endian.

namespace slam::bags {

inline constexpr std::string_view kMcapMagic("\x89MCAP0\r\n", 8);
inline constexpr std::uint64_t kRecordHead = 9;
/// Of a footer, what comes before its check sum: both offsets.
inline constexpr size_t kFooterOffsets = 16;

enum McapOp : std::uint8_t {
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
class Crc32 {
 public:
  void add(std::string_view bytes) {
    value_ = crc32_z(value_, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  }
  std::uint32_t value() const { return static_cast<std::uint32_t>(value_); }

 private:
  uLong value_ = crc32_z(0, nullptr, 0);
};

inline std::uint32_t crcOf(std::string_view bytes) {
  Crc32 crc;
  crc.add(bytes);
  return crc.value();
}

}  // namespace slam::bags
