#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "libslam/core/error.h"

namespace slam::world {

/// A file's bytes with its path for messages. Reads past the end are the "truncated" error.
class Bytes {
 public:
  Bytes(const std::string& path, std::string_view data) : path_(path), data_(data) {}

  size_t size() const { return data_.size(); }
  const char* data() const { return data_.data(); }
  bool startsWith(std::string_view magic) const { return data_.substr(0, magic.size()) == magic; }

  std::uint32_t byte(size_t at) const {
    if (at >= data_.size()) throw truncated("its bytes end after " + std::to_string(data_.size()));
    return static_cast<unsigned char>(data_[at]);
  }
  std::uint32_t bigEndian(size_t at, int bytes) const {
    std::uint32_t value = 0;
    for (int i = 0; i < bytes; ++i) value = value << 8 | byte(at + i);
    return value;
  }
  std::uint32_t littleEndian(size_t at, int bytes) const {
    std::uint32_t value = 0;
    for (int i = bytes; i-- > 0;) value = value << 8 | byte(at + i);
    return value;
  }
  std::string_view text(size_t at, size_t count) const {
    if (count > 0) byte(at + count - 1);
    return data_.substr(at, count);
  }

  core::InputError truncated(const std::string& why) const {
    return error("the picture is truncated: " + why);
  }
  core::InputError damaged(const std::string& why) const { return error("the picture is damaged: " + why); }
  core::InputError error(const std::string& what) const { return core::InputError(path_ + ": " + what); }

 private:
  const std::string& path_;
  std::string_view data_;
};

/// InputError for a picture without a pixel, or larger than a plan may be.
void requireSensibleSize(const Bytes& file, std::int64_t columns, std::int64_t rows);

}  // namespace slam::world
