#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "libslam/record/record.h"

namespace slam::record {

/// Writes what a simulated robot senses and does, as record() documents it: each file grows as it comes, so
/// that memory does not, and gets its name at finish(). Without finish() nothing is left behind.
class Recorder {
 public:
  Recorder(const std::string& log_path, const RecordConfig& config);
  ~Recorder();
  /// The first look.
  void begin(const sim::Simulator& simulator, const sim::Sensed& sensed);
  /// What `command` led to. Commands that are one in the original document's sense (robot::CommandSeries)
  /// become one operation; `is_whole`: one of its own in any case.
  void add(const robot::Command& command, const sim::Simulator& simulator, const sim::Sensed& sensed,
           bool is_whole = false);
  /// Closes the log, writes the files beside it, and tells what came out.
  Recording finish(const sim::Simulator& simulator, std::uint64_t seed, resources::Manifest manifest);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slam::record
