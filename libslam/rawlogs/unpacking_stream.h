#pragma once
// For the .cpp files of this room only: it needs MRPT's stream interface.
#include <mrpt/io/CStream.h>

#include <cstdint>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace slam::rawlogs {

/// One way of packing, undone piece by piece.
class Unpacker {
 public:
  enum class Result { kMore, kMemberEnd, kChecksum, kDamaged };
  struct Bytes {
    const unsigned char* input = nullptr;
    size_t input_size = 0;
    unsigned char* output = nullptr;
    size_t output_size = 0;
  };
  virtual ~Unpacker() = default;
  /// Unpacks as much as fits and moves `bytes` past what was used.
  virtual Result unpack(Bytes& bytes) = 0;
  /// Ready for the next member of the file. True when bytes of value 0 may stand before it.
  virtual bool restart() = 0;
  virtual const char* name() const = 0;
  /// Words for kDamaged.
  virtual std::string failureText() const = 0;
};

/// The bytes of a file, unpacked when it is packed by gzip, bzip2 or xz (one or several members, told by
/// their first bytes) and as they are when not. Unlike MRPT's stream it knows how the data ended: properly,
/// cut, or damaged (all that was unpacked before the damage is still delivered).
class UnpackingStream : public mrpt::io::CStream {
 public:
  /// Has unpacked a first piece already: what reading takes of memory is taken then. Errors: missing, a
  /// folder, unreadable (InputError).
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

  struct Line {
    std::string_view text;  ///< without its newline; good until the next call of any function
    bool is_whole = true;   ///< false: the data end, or the longest line does, before a newline comes
  };
  /// The next line. False at the end of the data. A line ends after `longest` bytes at the latest.
  bool takeLine(Line& line, size_t longest);

  enum class Failure { kNone, kTruncated, kChecksum, kDamaged };
  /// Set as soon as bytes are missing that should be there. kChecksum comes from gzip alone: bzip2 and xz do
  /// not tell a wrong checksum from other damage.
  Failure failure() const { return failure_; }
  /// The unpacker's words for a kDamaged stream.
  const std::string& failureText() const { return failure_text_; }

  bool isPacked() const { return unpacker_ != nullptr; }
  /// "gzip", "bzip2", "xz", or "" for a file that is not packed.
  std::string packing() const { return unpacker_ ? unpacker_->name() : ""; }
  std::uint64_t fileBytes() const { return file_bytes_; }
  /// How many bytes of the file are used up; unpacking runs at most 64 KiB of content ahead of what was read
  /// (bzip2: a block of up to 900 kB).
  std::uint64_t fileOffset() const { return file_read_ - input_left_; }

  size_t Write(const void*, size_t) override;
  std::uint64_t Seek(std::int64_t, TSeekOrigin) override;
  std::uint64_t getTotalBytesCount() const override { return file_bytes_; }
  std::uint64_t getPosition() const override { return position_; }

 private:
  bool fill();
  bool readFile();
  void unpackSome();
  void startMember();

  std::ifstream file_;
  std::uint64_t file_bytes_ = 0, file_read_ = 0, position_ = 0;
  std::unique_ptr<Unpacker> unpacker_;
  bool in_member_ = false;  ///< inside a packed member: the file must not end here
  std::vector<unsigned char> input_, unpacked_;
  size_t input_left_ = 0;  ///< at the end of what input_ holds
  size_t input_size_ = 0;
  size_t unpacked_begin_ = 0;
  Failure failure_ = Failure::kNone, pending_failure_ = Failure::kNone;
  std::string failure_text_;
};

}  // namespace slam::rawlogs
