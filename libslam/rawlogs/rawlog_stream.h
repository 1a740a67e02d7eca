#pragma once
// For the .cpp files of this room only: it needs MRPT's stream interface.
#include <mrpt/io/CStream.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "libslam/files/files.h"
#include "libslam/files/trial_run.h"
#include "libslam/objects/object_stream.h"
#include "libslam/rawlogs/unpacking_stream.h"
#include "libslam/resources/gzip.h"

namespace slam::rawlogs {

/// True when this start of a file may be an MRPT object, also of a class that is no log's.
bool looksLikeRawlog(const std::string& start);

/// Unpacks a packed file once and throws the InputError that says where it is damaged. A cut is no damage:
/// what comes before it can be read.
void requireUndamaged(const std::string& path);

/// The objects of a rawlog, one after the other. A packed file is unpacked once before, for its checksum.
/// Errors (InputError with the path): empty file, not a rawlog, truncated, damaged; with byte offset and
/// number of objects read before.
class RawlogObjects : public objects::ObjectSource {
 public:
  /// Whether a copy of this process reads first, from an object on that MRPT may crash at. It goes on to the
  /// end of the log: such a log is read twice.
  enum class Trial { kWhereNeeded, kNone };
  explicit RawlogObjects(const std::string& path, Trial trial = Trial::kWhereNeeded);
  /// Objects that MRPT stores as null pointers are passed over.
  std::shared_ptr<mrpt::serialization::CSerializable> next() override;
  std::uint64_t count() const override { return count_; }
  double fractionRead() const override;
  std::string place() const override { return "entry " + std::to_string(count_); }
  const UnpackingStream& stream() const { return stream_; }
  /// The newest object as the file has it, with the null pointers before it.
  const std::string& bytes() const { return bytes_; }

 private:
  void checkHeader();
  void tryFirst();
  [[noreturn]] void fail(UnpackingStream::Failure failure, const std::string& otherwise = "") const;

  std::string path_;
  Trial trial_;
  std::unique_ptr<files::TrialRun> trial_run_;  ///< from the first object on that needs it
  UnpackingStream stream_;
  std::string bytes_;
  std::uint64_t count_ = 0;
};

/// What MRPT serialises, packed by gzip into a file.
class PackingStream : public mrpt::io::CStream {
 public:
  /// Errors: IoError naming `final_path` when `path` cannot be opened.
  PackingStream(const std::string& path, std::string final_path);

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
  resources::GzipFile file_;
  std::optional<std::string> failure_;  ///< of writing
  std::uint64_t position_ = 0;
};

/// Objects as they come, packed by gzip, into a file written beside and renamed by close().
class RawlogSink : public objects::ObjectSink {
 public:
  /// Errors: IoError when the path is a folder or cannot be written.
  explicit RawlogSink(const std::string& path);
  void write(const mrpt::serialization::CSerializable& object) override;
  void close() override;

 private:
  files::PendingFile pending_;
  PackingStream stream_;
  bool closed_ = false;
};

}  // namespace slam::rawlogs
