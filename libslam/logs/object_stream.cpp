#include "libslam/logs/object_stream.h"

#include "libslam/core/error.h"
#include "libslam/logs/rawlog_stream.h"

namespace slam::logs {

const char* formatName(LogFormat format) {
  switch (format) {
    case LogFormat::kRawlog:
      return "MRPT rawlog";
    case LogFormat::kCarmen:
      return "CARMEN log";
    case LogFormat::kRos1Bag:
      return "ROS 1 bag";
    case LogFormat::kRos2Db3:
      return "ROS 2 bag (SQLite)";
    case LogFormat::kMcap:
      return "MCAP";
  }
  return "";
}

LogFormat detectLogFormat(const std::string& path) {
  UnpackingStream stream(path);
  return LogFormat::kRawlog;
}

std::unique_ptr<ObjectSource> openLog(const std::string& path) {
  detectLogFormat(path);
  return std::make_unique<RawlogObjects>(path);
}

std::unique_ptr<ObjectSink> createLog(const std::string& path, LogFormat format) {
  throw core::InputError(path + ": " + formatName(format) + " cannot be written yet");
}

}  // namespace slam::logs
