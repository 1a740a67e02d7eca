#pragma once
// For the .cpp files of this room only: it needs MRPT's stream interface.
#include <mrpt/io/CStream.h>
#include <zlib.h>

#include <cstdint>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "libslam/logs/object_stream.h"

namespace slam::logs {

/// The bytes of a file, unpacked when it is gzip'ed (one or several members) and as they are when not.
/// Unlike MRPT's stream it knows how the data ended: properly, cut, or damaged (all that was unpacked before
/// the damage is still delivered).
class UnpackingStream : public mrpt::io::CStream {
 public:
  /// Errors: missing, a folder, unreadable (InputError).
  explicit UnpackingStream(const std::string& path);
  ~UnpackingStream() override;
  UnpackingStream(const UnpackingStream&) = delete;
  UnpackingStream& operator=(const UnpackingStream&) = delete;

  /// Up to `count` of the bytes that come next, without taking them; fewer only at the end of the data.
  std::string peek(size_t count);
  /// All of `count` bytes, or a std::runtime_error after noting the failure.
  size_t Read(void* buffer, size_t count) override;

  /// Whatever is unpacked already, at least one byte; "" at the end of the data.
  std::string take();

  enum class Failure { kNone, kTruncated, kChecksum, kDamaged };
  /// Set as soon as bytes are missing that should be there.
  Failure failure() const { return failure_; }
  /// zlib's words for a kDamaged stream.
  const std::string& failureText() const { return failure_text_; }

  bool isPacked() const { return packed_; }
  std::uint64_t fileBytes() const { return file_bytes_; }
  /// How many bytes of the file are used up; unpacking runs at most 8 KiB of content ahead of what was read.
  std::uint64_t fileOffset() const;

  size_t Write(const void*, size_t) override;
  std::uint64_t Seek(std::int64_t, TSeekOrigin) override;
  std::uint64_t getTotalBytesCount() const override { return file_bytes_; }
  std::uint64_t getPosition() const override { return position_; }

 private:
  bool fill();
  bool readFile();
  void inflateSome();

  std::ifstream file_;
  std::uint64_t file_bytes_ = 0, file_read_ = 0, position_ = 0;
  bool packed_ = false;
  bool in_member_ = false;  ///< inside a gzip member: the file must not end here
  z_stream inflater_{};
  std::vector<unsigned char> input_, unpacked_;
  size_t unpacked_begin_ = 0;
  Failure failure_ = Failure::kNone, pending_failure_ = Failure::kNone;
  std::string failure_text_;
};

/// The objects of a rawlog, one after the other. A packed file is unpacked once before, for its checksum.
/// Errors (InputError with the path): empty file, not a rawlog, truncated, damaged; with byte offset and
/// number of objects read before.
class RawlogObjects : public ObjectSource {
 public:
  explicit RawlogObjects(const std::string& path);
  /// Objects that MRPT stores as null pointers are passed over.
  std::shared_ptr<mrpt::serialization::CSerializable> next() override;
  std::uint64_t count() const override { return count_; }
  double fractionRead() const override;
  std::string place() const override { return "entry " + std::to_string(count_); }
  const UnpackingStream& stream() const { return stream_; }

 private:
  void checkHeader();
  [[noreturn]] void fail(UnpackingStream::Failure failure, const std::string& otherwise = "") const;

  std::string path_;
  UnpackingStream stream_;
  std::uint64_t count_ = 0;
};

/// gzip with a header that carries neither name nor time, so that equal content gives equal bytes.
class PackingStream : public mrpt::io::CStream {
 public:
  /// Errors: IoError naming `final_path` when `path` cannot be opened.
  PackingStream(const std::string& path, std::string final_path);
  ~PackingStream() override;
  PackingStream(const PackingStream&) = delete;
  PackingStream& operator=(const PackingStream&) = delete;

  /// All bytes, or IoError.
  size_t Write(const void* buffer, size_t count) override;
  /// The IoError again, when there was one: MRPT's serializers replace exceptions by their own.
  void rethrowFailure() const;
  /// Everything to the disk, or IoError.
  void close();

  size_t Read(void*, size_t) override;
  std::uint64_t Seek(std::int64_t, TSeekOrigin) override;
  std::uint64_t getTotalBytesCount() const override { return position_; }
  std::uint64_t getPosition() const override { return position_; }

 private:
  [[noreturn]] void fail(int error_number);
  std::string final_path_;
  gzFile file_ = nullptr;
  int error_number_ = 0;  ///< errno of the failure
  std::uint64_t position_ = 0;
};

}  // namespace slam::logs
