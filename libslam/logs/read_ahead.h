#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libslam/logs/log_reader.h"

namespace slam::logs {

/// A LogReader that reads some scans ahead, by a thread of its own: unpacking and reading a log takes as long
/// as some methods do. What it gives, and its errors, are the reader's, in the same order.
///
/// MRPT draws random numbers in the thread that reads actions of model mmThrun (see LogReader): a method that
/// draws from the same generator gets other ones than it would without.
class ReadAhead {
 public:
  /// `is_ahead` false: all is read by the caller's thread, when it is asked for. Errors: as LogReader().
  ReadAhead(const std::string& path, const std::string& lidars, bool is_ahead);
  ~ReadAhead();
  /// As LogReader has them; lidars() and remarks() as they were when the first scan was read, and empty
  /// before next() was called.
  std::optional<LogEntry> next();
  double fractionRead() const;
  const std::vector<std::string>& lidars() const;
  const std::vector<std::string>& remarks() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slam::logs
