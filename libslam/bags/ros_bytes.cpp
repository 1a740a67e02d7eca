#include "libslam/bags/ros_bytes.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <memory>

namespace slam::bags {
namespace {

constexpr size_t kPiece = size_t{1} << 18;

/// Collects what an unpacker gives, never more than was announced.
class Collected {
 public:
  explicit Collected(std::uint64_t expected) : expected_(expected) {
    if (expected > kMostChunkBytes)
      throw core::InputError("a chunk of " + std::to_string(expected) + " bytes, expected at most " +
                             std::to_string(kMostChunkBytes));
  }
  char* room() { return piece_.data(); }
  static size_t roomSize() { return kPiece; }
  void add(size_t count) {
    if (count > expected_ - bytes_.size())
      throw core::InputError("a chunk unpacks to more than the " + std::to_string(expected_) +
                             " bytes that it should have");
    bytes_.append(piece_.data(), count);
  }
  Unpacked finish(bool reached_end) {
    if (reached_end && bytes_.size() != expected_)
      throw core::InputError("a chunk unpacks to " + std::to_string(bytes_.size()) + " bytes, expected " +
                             std::to_string(expected_));
    return {std::move(bytes_), reached_end};
  }

 private:
  std::uint64_t expected_;
  std::string bytes_;
  std::string piece_ = std::string(kPiece, '\0');
};

[[noreturn]] void failUnpacking(std::string_view compression, const char* reason) {
  throw core::InputError("a damaged " + std::string(compression) + " chunk (" + reason + ")");
}

Unpacked unpackLz4(std::string_view packed, std::uint64_t expected_bytes) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION))) throw std::bad_alloc();
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owner(
      context, LZ4F_freeDecompressionContext);
  Collected out(expected_bytes);
  size_t hint = 1;
  for (bool gave_full_room = true; hint != 0 && (!packed.empty() || gave_full_room);) {
    size_t given = Collected::roomSize(), used = packed.size();
    hint = LZ4F_decompress(context, out.room(), &given, packed.data(), &used, nullptr);
    if (LZ4F_isError(hint)) failUnpacking("lz4", LZ4F_getErrorName(hint));
    packed.remove_prefix(used);
    out.add(given);
    gave_full_room = given == Collected::roomSize();
  }
  return out.finish(hint == 0);
}

Unpacked unpackZstd(std::string_view packed, std::uint64_t expected_bytes) {
  const std::unique_ptr<ZSTD_DStream, decltype(&ZSTD_freeDStream)> stream(ZSTD_createDStream(),
                                                                          ZSTD_freeDStream);
  if (!stream) throw std::bad_alloc();
  Collected out(expected_bytes);
  ZSTD_inBuffer in{packed.data(), packed.size(), 0};
  size_t hint = 1;
  for (bool gave_full_room = true; hint != 0 && (in.pos < in.size || gave_full_room);) {
    ZSTD_outBuffer room{out.room(), Collected::roomSize(), 0};
    hint = ZSTD_decompressStream(stream.get(), &room, &in);
    if (ZSTD_isError(hint)) failUnpacking("zstd", ZSTD_getErrorName(hint));
    out.add(room.pos);
    gave_full_room = room.pos == room.size;
  }
  return out.finish(hint == 0);
}

Unpacked unpackBz2(std::string_view packed, std::uint64_t expected_bytes) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw std::bad_alloc();
  const std::unique_ptr<bz_stream, decltype(&BZ2_bzDecompressEnd)> owner(&stream, BZ2_bzDecompressEnd);
  Collected out(expected_bytes);
  // libbz2 promises not to write to its input; its interface is older than const.
  stream.next_in = const_cast<char*>(packed.data());
  stream.avail_in = static_cast<unsigned>(packed.size());
  int state = BZ_OK;
  for (bool gave_full_room = true; state == BZ_OK && (stream.avail_in > 0 || gave_full_room);) {
    stream.next_out = out.room();
    stream.avail_out = static_cast<unsigned>(Collected::roomSize());
    state = BZ2_bzDecompress(&stream);
    if (state != BZ_OK && state != BZ_STREAM_END)
      failUnpacking("bz2", ("error " + std::to_string(state)).c_str());
    out.add(Collected::roomSize() - stream.avail_out);
    gave_full_room = stream.avail_out == 0;
  }
  return out.finish(state == BZ_STREAM_END);
}

std::string packLz4(std::string_view bytes) {
  LZ4F_preferences_t preferences = LZ4F_INIT_PREFERENCES;
  preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  std::string packed(LZ4F_compressFrameBound(bytes.size(), &preferences), '\0');
  const size_t size =
      LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), &preferences);
  if (LZ4F_isError(size)) throw std::bad_alloc();
  packed.resize(size);
  return packed;
}

std::string packZstd(std::string_view bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const size_t size =
      ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), ZSTD_CLEVEL_DEFAULT);
  if (ZSTD_isError(size)) throw std::bad_alloc();
  packed.resize(size);
  return packed;
}

}  // namespace

FileBytes::FileBytes(const std::string& path) {
  files::requireReadableFile(path);
  file_.open(path, std::ios::binary);
  file_.seekg(0, std::ios::end);
  const auto end = file_.tellg();
  file_.seekg(0);
  if (!file_ || end < 0) throw core::InputError(path + ": cannot be read: " + std::strerror(errno));
  size_ = static_cast<std::uint64_t>(end);
  if (size_ == 0) throw core::InputError(path + ": is empty");
}

void FileBytes::read(std::uint64_t count, std::string& to) {
  const std::uint64_t available = std::min(count, left());
  to.resize(available);
  file_.read(to.data(), static_cast<std::streamsize>(available));
  // A file that shrinks while it is read: what did not come counts as cut off.
  const auto got = static_cast<std::uint64_t>(file_.gcount());
  to.resize(got);
  position_ += got;
  if (got < available) size_ = position_;
}

void FileBytes::skip(std::uint64_t count) {
  seek(position_ + std::min(count, left()));
}

void FileBytes::seek(std::uint64_t position) {
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(position));
  position_ = position;
}

NewFile::NewFile(const std::string& final_path)
    : final_path_(final_path),
      pending_(final_path),
      out_(pending_.path(), std::ios::binary | std::ios::trunc) {
  requireGood();
}

void NewFile::requireGood() {
  if (!out_) throw core::IoError(final_path_ + ": cannot be written: " + std::strerror(errno));
}

void NewFile::append(std::string_view bytes) {
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  requireGood();
  size_ += bytes.size();
}

void NewFile::overwrite(std::uint64_t position, std::string_view bytes) {
  out_.seekp(static_cast<std::streamoff>(position));
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out_.seekp(static_cast<std::streamoff>(size_));
  requireGood();
}

void NewFile::close() {
  out_.close();
  requireGood();
  pending_.commit();
}

bool knowsCompression(std::string_view name) {
  return name.empty() || name == "none" || name == "lz4" || name == "zstd" || name == "bz2";
}

Unpacked unpack(std::string_view compression, std::string_view packed, std::uint64_t expected_bytes) {
  if (compression == "lz4") return unpackLz4(packed, expected_bytes);
  if (compression == "zstd") return unpackZstd(packed, expected_bytes);
  if (compression == "bz2") return unpackBz2(packed, expected_bytes);
  if (packed.size() > expected_bytes)
    throw core::InputError("a chunk of " + std::to_string(packed.size()) + " bytes, expected " +
                           std::to_string(expected_bytes));
  return {std::string(packed), packed.size() == expected_bytes};
}

std::string pack(std::string_view compression, std::string_view bytes) {
  if (compression == "lz4") return packLz4(bytes);
  if (compression == "zstd") return packZstd(bytes);
  return std::string(bytes);
}

}  // namespace slam::bags
