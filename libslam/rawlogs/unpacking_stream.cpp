#include "libslam/rawlogs/unpacking_stream.h"

#include <bzlib.h>
#include <lzma.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <new>
#include <stdexcept>

#include "libslam/core/error.h"
#include "libslam/files/files.h"

namespace slam::rawlogs {
namespace {

constexpr size_t kInputBytes = 1 << 16;
constexpr size_t kUnpackedBytes = 1 << 16;
constexpr int kGzipWindowBits = 15 + 16;  // zlib.h, inflateInit2: 16 more than the window means gzip only

class GzipUnpacker : public Unpacker {
 public:
  GzipUnpacker() {
    if (inflateInit2(&stream_, kGzipWindowBits) != Z_OK) throw std::bad_alloc();
  }
  ~GzipUnpacker() override { inflateEnd(&stream_); }
  GzipUnpacker(const GzipUnpacker&) = delete;
  GzipUnpacker& operator=(const GzipUnpacker&) = delete;

  Result unpack(Bytes& bytes) override {
    stream_.next_in = const_cast<unsigned char*>(bytes.input);
    stream_.avail_in = static_cast<uInt>(bytes.input_size);
    stream_.next_out = bytes.output;
    stream_.avail_out = static_cast<uInt>(bytes.output_size);
    const int result = inflate(&stream_, Z_NO_FLUSH);
    bytes = {stream_.next_in, stream_.avail_in, stream_.next_out, stream_.avail_out};
    if (result == Z_STREAM_END) return Result::kMemberEnd;
    if (result == Z_OK || result == Z_BUF_ERROR) return Result::kMore;
    const std::string text = failureText();
    const bool at_trailer = text == "incorrect data check" || text == "incorrect length check";
    return at_trailer ? Result::kChecksum : Result::kDamaged;
  }
  bool restart() override {
    inflateReset(&stream_);
    return false;
  }
  const char* name() const override { return "gzip"; }
  std::string failureText() const override { return stream_.msg ? stream_.msg : "cannot be unpacked"; }

 private:
  z_stream stream_{};
};

class Bzip2Unpacker : public Unpacker {
 public:
  Bzip2Unpacker() { start(); }
  ~Bzip2Unpacker() override { BZ2_bzDecompressEnd(&stream_); }
  Bzip2Unpacker(const Bzip2Unpacker&) = delete;
  Bzip2Unpacker& operator=(const Bzip2Unpacker&) = delete;

  Result unpack(Bytes& bytes) override {
    stream_.next_in = reinterpret_cast<char*>(const_cast<unsigned char*>(bytes.input));
    stream_.avail_in = static_cast<unsigned>(bytes.input_size);
    stream_.next_out = reinterpret_cast<char*>(bytes.output);
    stream_.avail_out = static_cast<unsigned>(bytes.output_size);
    const int result = BZ2_bzDecompress(&stream_);
    bytes = {reinterpret_cast<unsigned char*>(stream_.next_in), stream_.avail_in,
             reinterpret_cast<unsigned char*>(stream_.next_out), stream_.avail_out};
    if (result == BZ_STREAM_END) return Result::kMemberEnd;
    if (result == BZ_OK) return Result::kMore;
    if (result == BZ_MEM_ERROR) throw std::bad_alloc();
    failure_ = result == BZ_DATA_ERROR_MAGIC ? "incorrect header" : "incorrect block or checksum";
    return Result::kDamaged;
  }
  bool restart() override {
    BZ2_bzDecompressEnd(&stream_);
    stream_ = {};
    start();
    return false;
  }
  const char* name() const override { return "bzip2"; }
  std::string failureText() const override { return failure_; }

 private:
  void start() {
    if (BZ2_bzDecompressInit(&stream_, 0, 0) != BZ_OK) throw std::bad_alloc();
  }
  bz_stream stream_{};
  std::string failure_;
};

/// For liblzma: touched at once, so that a dictionary (of 64 MiB at most, as xz makes them) does not grow
/// while a method's memory is measured. A broken header can ask for much more.
void* touchedMemory(void*, size_t count, size_t size) {
  constexpr size_t kMostTouched = size_t{65} << 20;
  void* memory = std::malloc(count * size);
  if (memory != nullptr && count * size <= kMostTouched) std::memset(memory, 0, count * size);
  return memory;
}
void freeMemory(void*, void* memory) {
  std::free(memory);
}
constexpr lzma_allocator kTouching = {touchedMemory, freeMemory, nullptr};

class XzUnpacker : public Unpacker {
 public:
  XzUnpacker() { start(); }
  ~XzUnpacker() override { lzma_end(&stream_); }
  XzUnpacker(const XzUnpacker&) = delete;
  XzUnpacker& operator=(const XzUnpacker&) = delete;

  Result unpack(Bytes& bytes) override {
    stream_.next_in = bytes.input;
    stream_.avail_in = bytes.input_size;
    stream_.next_out = bytes.output;
    stream_.avail_out = bytes.output_size;
    const lzma_ret result = lzma_code(&stream_, LZMA_RUN);
    bytes = {stream_.next_in, stream_.avail_in, stream_.next_out, stream_.avail_out};
    if (result == LZMA_STREAM_END) return Result::kMemberEnd;
    if (result == LZMA_OK || result == LZMA_BUF_ERROR) return Result::kMore;
    if (result == LZMA_MEM_ERROR) throw std::bad_alloc();
    failure_ = result == LZMA_FORMAT_ERROR     ? "incorrect header"
               : result == LZMA_OPTIONS_ERROR  ? "a filter that is not supported"
               : result == LZMA_MEMLIMIT_ERROR ? "a dictionary of more than 1 GiB"
                                               : "incorrect block or checksum";
    return Result::kDamaged;
  }
  bool restart() override {
    start();  // on a stream in use this releases what it held
    return true;
  }
  const char* name() const override { return "xz"; }
  std::string failureText() const override { return failure_; }

 private:
  // A few bytes of a header can ask for 4 GiB.
  static constexpr std::uint64_t kMostMemory = 1ULL << 30;
  void start() {
    stream_.allocator = &kTouching;
    if (lzma_stream_decoder(&stream_, kMostMemory, 0) != LZMA_OK) throw std::bad_alloc();
  }
  lzma_stream stream_ = LZMA_STREAM_INIT;
  std::string failure_;
};

/// By the first bytes of a file: RFC 1952, 2.3.1; the bzip2 manual; the .xz file format, 2.1.1.1.
std::unique_ptr<Unpacker> unpackerFor(std::string_view start) {
  const auto begins = [start](std::string_view magic) { return start.substr(0, magic.size()) == magic; };
  if (begins("\x1F\x8B")) return std::make_unique<GzipUnpacker>();
  if (begins("BZh")) return std::make_unique<Bzip2Unpacker>();
  if (begins({"\xFD"
              "7zXZ\0",
              6}))
    return std::make_unique<XzUnpacker>();
  return nullptr;
}

[[noreturn]] void notOffered(const char* what) {
  throw core::ContractError(std::string("unpacking stream: ") + what + " is not offered");
}

}  // namespace

UnpackingStream::UnpackingStream(const std::string& path) : input_(kInputBytes) {
  files::requireReadableFile(path);
  file_.open(path, std::ios::binary);
  std::error_code error;
  file_bytes_ = std::filesystem::file_size(path, error);
  if (!file_ || error) throw core::InputError(path + ": cannot be read: " + std::strerror(errno));
  readFile();
  unpacker_ = unpackerFor({reinterpret_cast<const char*>(input_.data()), input_size_});
  in_member_ = isPacked();
  if (isPacked()) fill();
}

UnpackingStream::~UnpackingStream() = default;

bool UnpackingStream::readFile() {
  file_.read(reinterpret_cast<char*>(input_.data()), static_cast<std::streamsize>(input_.size()));
  input_size_ = input_left_ = static_cast<size_t>(file_.gcount());
  file_read_ += input_size_;
  return input_size_ > 0;
}

void UnpackingStream::unpackSome() {
  const size_t old_size = unpacked_.size();
  unpacked_.resize(old_size + kUnpackedBytes);
  Unpacker::Bytes bytes{input_.data() + (input_size_ - input_left_), input_left_, unpacked_.data() + old_size,
                        kUnpackedBytes};
  const auto result = unpacker_->unpack(bytes);
  unpacked_.resize(old_size + kUnpackedBytes - bytes.output_size);
  input_left_ = bytes.input_size;
  if (result == Unpacker::Result::kMemberEnd) {
    in_member_ = false;
  } else if (result != Unpacker::Result::kMore) {
    failure_text_ = unpacker_->failureText();
    pending_failure_ = result == Unpacker::Result::kChecksum ? Failure::kChecksum : Failure::kDamaged;
  }
}

/// Only when bytes are left: the end of the file between two members is the proper end.
void UnpackingStream::startMember() {
  if (unpacker_->restart())
    while (input_left_ > 0 && input_[input_size_ - input_left_] == 0) --input_left_;
  in_member_ = input_left_ > 0;
}

/// More bytes into unpacked_; false when there are none.
bool UnpackingStream::fill() {
  unpacked_.erase(unpacked_.begin(), unpacked_.begin() + static_cast<std::ptrdiff_t>(unpacked_begin_));
  unpacked_begin_ = 0;
  const size_t size_before = unpacked_.size();
  while (unpacked_.size() == size_before && pending_failure_ == Failure::kNone) {
    if (input_left_ == 0 && !readFile()) {
      // What a packer still holds back comes out without further input.
      if (in_member_) unpackSome();
      if (in_member_ && unpacked_.size() == size_before && pending_failure_ == Failure::kNone)
        pending_failure_ = Failure::kTruncated;
      break;
    }
    if (!isPacked()) {
      const auto begin = input_.begin() + static_cast<std::ptrdiff_t>(input_size_ - input_left_);
      const size_t count = std::min(input_left_, kUnpackedBytes);
      unpacked_.insert(unpacked_.end(), begin, begin + static_cast<std::ptrdiff_t>(count));
      input_left_ -= count;
      continue;
    }
    if (!in_member_) startMember();
    if (in_member_) unpackSome();
  }
  return unpacked_.size() > size_before;
}

std::string UnpackingStream::peek(size_t count) {
  while (unpacked_.size() - unpacked_begin_ < count && fill()) {
  }
  const size_t available = std::min(count, unpacked_.size() - unpacked_begin_);
  if (available < count) failure_ = pending_failure_;
  const auto begin = unpacked_.begin() + static_cast<std::ptrdiff_t>(unpacked_begin_);
  return {begin, begin + static_cast<std::ptrdiff_t>(available)};
}

std::string UnpackingStream::take() {
  if (unpacked_begin_ == unpacked_.size() && !fill()) {
    failure_ = pending_failure_;
    return "";
  }
  std::string piece(unpacked_.begin() + static_cast<std::ptrdiff_t>(unpacked_begin_), unpacked_.end());
  unpacked_begin_ = unpacked_.size();
  return piece;
}

bool UnpackingStream::takeLine(Line& line, size_t longest) {
  // Looking for more moves the bytes, also when there are none.
  const auto available = [this] {
    return std::string_view(reinterpret_cast<const char*>(unpacked_.data()) + unpacked_begin_,
                            unpacked_.size() - unpacked_begin_);
  };
  size_t searched = 0, end = available().find('\n');
  while (end == std::string_view::npos && available().size() < longest) {
    searched = available().size();
    if (!fill()) break;
    end = available().find('\n', searched);
  }
  const bool is_whole = end != std::string_view::npos && end < longest;
  line = {available().substr(0, is_whole ? end : longest), is_whole};
  unpacked_begin_ += line.text.size() + (is_whole ? 1 : 0);
  if (is_whole || !line.text.empty()) return true;
  failure_ = pending_failure_;
  return false;
}

size_t UnpackingStream::Read(void* buffer, size_t count) {
  auto* target = static_cast<unsigned char*>(buffer);
  size_t missing = count;
  while (missing > 0) {
    if (unpacked_begin_ == unpacked_.size() && !fill()) {
      failure_ = pending_failure_ == Failure::kNone ? Failure::kTruncated : pending_failure_;
      throw std::runtime_error("no more bytes");
    }
    const size_t step = std::min(missing, unpacked_.size() - unpacked_begin_);
    std::memcpy(target, unpacked_.data() + unpacked_begin_, step);
    unpacked_begin_ += step;
    target += step;
    missing -= step;
  }
  position_ += count;
  return count;
}

size_t UnpackingStream::Write(const void*, size_t) {
  notOffered("writing");
}
std::uint64_t UnpackingStream::Seek(std::int64_t, TSeekOrigin) {
  notOffered("seeking");
}

}  // namespace slam::rawlogs
