#pragma once
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libslam/lidar/scan.h"
#include "libslam/logs/log_reader.h"

namespace slam::logs {

/// The scans of a log, kept in a file while they are read, so that who needs them once more need not unpack
/// and read the log again. The file has no name and goes with the object, or with the process.
class KeptScans {
 public:
  /// `folder`: where there is room for the file; `most_bytes`: 4 bytes a beam and 48 a scan are needed.
  explicit KeptScans(const std::string& folder, std::uint64_t most_bytes = kMostBytes);
  static constexpr std::uint64_t kMostBytes = 1'000'000'000;  ///< a million scans of 230 beams

  /// All scans of the entry. Where there is no room for them (the disk, most_bytes), nothing is kept from
  /// then on, nor of what came before. REQUIRES no rewind() before (ContractError).
  void add(const LogEntry& entry);
  /// To the first entry. False where there was no room for all: nothing can be read.
  bool rewind();
  /// The scans of the next entry, the entry's own one first; nullopt after the last one. Of each the
  /// mounting, the beams' angles and the readings, to the bit; the rest is not kept. REQUIRES that rewind()
  /// was true (ContractError). Errors: IoError with the folder when the file cannot be read.
  std::optional<std::vector<lidar::Scan>> next();

 private:
  struct Closing {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  bool write(const lidar::Scan& scan, bool is_last);
  void read(void* data, std::size_t bytes);

  std::string folder_;
  std::unique_ptr<std::FILE, Closing> file_;
  std::uint64_t most_bytes_, bytes_ = 0;
  std::size_t entries_ = 0, entries_read_ = 0;
  bool is_reading_ = false;
};

}  // namespace slam::logs
