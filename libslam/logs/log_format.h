#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "libslam/objects/object_stream.h"

namespace slam::logs {

enum class LogFormat { kRawlog, kCarmen, kRos1Bag, kRos2Db3, kMcap };

/// A format of logs. A new one is a row of logFormats(), beside its reader and its writer.
struct LogFormatInfo {
  LogFormat format;
  const char* name;  ///< "CARMEN log"
  const char* word;  ///< "carmen", where one is chosen
  /// Of files that are to become such a log, the usual one first: ".clf".
  std::vector<std::string> suffixes;
  /// Whether a log that begins so is one; no two formats say so of one start. REQUIRES a start, not empty.
  bool (*looksLike)(const std::string& start);
  std::unique_ptr<objects::ObjectSource> (*open)(const std::string& path);
  std::unique_ptr<objects::ObjectSink> (*create)(const std::string& path);
};
const std::vector<LogFormatInfo>& logFormats();

/// "MRPT rawlog", "CARMEN log", ...
const char* formatName(LogFormat format);

/// By the first bytes of the (unpacked) content, never by the name. Errors (InputError with the path):
/// missing, a folder, empty, none of the formats.
LogFormat detectLogFormat(const std::string& path);

/// Errors: as detectLogFormat(), and those of each format's reader.
std::unique_ptr<objects::ObjectSource> openLog(const std::string& path);

/// A log's path without what says how it is packed (.gz .bz2 .xz) and what it is (a suffix of logFormats()):
/// "a/intel.clf.bz2" gives "a/intel". Any other path stays whole.
std::string logStem(const std::string& path);

/// kRawlog writes objects as they come; turning one of MRPT's two forms into the other is a step before.
std::unique_ptr<objects::ObjectSink> createLog(const std::string& path, LogFormat format);

}  // namespace slam::logs
