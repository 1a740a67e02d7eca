#pragma once
#include <memory>
#include <string>

#include "libslam/objects/object_stream.h"

namespace slam::logs {

enum class LogFormat { kRawlog, kCarmen, kRos1Bag, kRos2Db3, kMcap };

/// "MRPT rawlog", "CARMEN log", ...
const char* formatName(LogFormat format);

/// By the first bytes of the (unpacked) content, never by the name. Errors (InputError with the path):
/// missing, a folder, empty, none of the formats.
LogFormat detectLogFormat(const std::string& path);

/// Errors: as detectLogFormat(), and those of each format's reader.
std::unique_ptr<objects::ObjectSource> openLog(const std::string& path);

/// kRawlog writes objects as they come; turning one of MRPT's two forms into the other is a step before.
std::unique_ptr<objects::ObjectSink> createLog(const std::string& path, LogFormat format);

}  // namespace slam::logs
