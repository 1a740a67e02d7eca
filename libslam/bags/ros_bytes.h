#pragma once
// For the .cpp files of this room only: bytes of the bag formats, in memory and on disk.
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <type_traits>

#include "libslam/core/error.h"
#include "libslam/files/files.h"

namespace slam::bags {

/// Little-endian fields taken from the front of bytes in memory, never beyond their end.
/// Errors: InputError without a place; the caller adds it.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <class Number>
  Number number() {
    static_assert(std::is_arithmetic_v<Number>);
    Number value{};
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  std::string_view take(std::uint64_t count) {
    if (count > bytes_.size())
      throw core::InputError("a field of " + std::to_string(count) + " bytes where " +
                             std::to_string(bytes_.size()) + " are left");
    const auto taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  /// A text or block with its length before it.
  template <class Length>
  std::string_view sized() {
    return take(number<Length>());
  }
  std::uint64_t left() const { return bytes_.size(); }
  std::string_view rest() const { return bytes_; }

 private:
  std::string_view bytes_;
};

template <class Number>
void appendNumberBytes(std::string& bytes, Number value) {
  static_assert(std::is_arithmetic_v<Number>);
  std::array<char, sizeof value> raw{};
  std::memcpy(raw.data(), &value, sizeof value);
  bytes.append(raw.data(), raw.size());
}
template <class Length>
void appendSized(std::string& bytes, std::string_view content) {
  appendNumberBytes(bytes, static_cast<Length>(content.size()));
  bytes += content;
}

/// A file read from the front.
class FileBytes {
 public:
  /// Errors: missing, a folder, unreadable, empty (InputError with the path).
  explicit FileBytes(const std::string& path);
  std::uint64_t size() const { return size_; }
  std::uint64_t position() const { return position_; }
  std::uint64_t left() const { return size_ - position_; }
  /// The next bytes into `to`, fewer than `count` only at the file's end. Takes memory as the bytes come.
  void read(std::uint64_t count, std::string& to);
  void skip(std::uint64_t count);
  void seek(std::uint64_t position);

 private:
  std::ifstream file_;
  std::uint64_t size_ = 0, position_ = 0;
};

/// A file being written beside its final name; close() renames it. Errors: IoError with the final path.
class NewFile {
 public:
  explicit NewFile(const std::string& final_path);
  void append(std::string_view bytes);
  /// Writes over bytes that are there already.
  void overwrite(std::uint64_t position, std::string_view bytes);
  std::uint64_t size() const { return size_; }
  void close();

 private:
  void requireGood();
  std::string final_path_;
  files::PendingFile pending_;
  std::ofstream out_;
  std::uint64_t size_ = 0;
};

/// The largest chunk, unpacked, and the largest single record that is taken into memory.
inline constexpr std::uint64_t kMostChunkBytes = std::uint64_t{1} << 30;

/// "" and "none" (as it is), "lz4" (frame format), "zstd", "bz2".
bool knowsCompression(std::string_view name);

struct Unpacked {
  std::string bytes;
  bool complete = false;  ///< false: the packed bytes end too early, and this is what they gave
};
/// Memory grows with what really comes out, up to `expected_bytes`. Errors (InputError without a place):
/// damaged, or more or fewer bytes than expected come out. REQUIRES a known compression.
Unpacked unpack(std::string_view compression, std::string_view packed, std::uint64_t expected_bytes);

/// "none", "lz4" or "zstd".
std::string pack(std::string_view compression, std::string_view bytes);

}  // namespace slam::bags
