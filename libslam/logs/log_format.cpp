#include "libslam/logs/log_format.h"

#include <string_view>

#include "libslam/bags/ros_logs.h"
#include "libslam/core/error.h"
#include "libslam/logs/carmen_log.h"
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
  constexpr size_t kEnough = 1 << 16;  // for the remarks before a CARMEN log's first message
  const std::string start = stream.peek(kEnough);
  const auto begins = [&start](std::string_view magic) {
    return std::string_view(start).substr(0, magic.size()) == magic;
  };
  if (begins("#ROSBAG V")) return LogFormat::kRos1Bag;
  if (begins({"SQLite format 3\0", 16})) return LogFormat::kRos2Db3;
  if (begins("\x89MCAP0\r\n")) return LogFormat::kMcap;
  if (looksLikeCarmen(start)) return LogFormat::kCarmen;
  // Nothing in a file that is not empty is a packed log without entries, or damage that the reader of rawlogs
  // describes.
  if (start.empty() ? stream.fileBytes() > 0 : looksLikeRawlog(start)) return LogFormat::kRawlog;
  requireUndamaged(path);
  throw core::InputError(path + (start.empty() ? ": is empty" : ": is no log: it starts with other data") +
                         ", expected an MRPT rawlog, a CARMEN log, a ROS 1 bag, a ROS 2 bag (.db3) or MCAP");
}

std::unique_ptr<objects::ObjectSource> openLog(const std::string& path) {
  if (bags::looksLikeRos2Folder(path)) return bags::openRos2Folder(path);
  const LogFormat format = detectLogFormat(path);
  switch (format) {
    case LogFormat::kRawlog:
      return std::make_unique<RawlogObjects>(path);
    case LogFormat::kCarmen:
      return std::make_unique<CarmenObjects>(path);
    case LogFormat::kRos1Bag:
      return bags::openRos1Bag(path);
    case LogFormat::kRos2Db3:
      return bags::openRos2Db3(path);
    case LogFormat::kMcap:
      return bags::openMcap(path);
  }
  throw core::ContractError("openLog: unknown format");
}

std::unique_ptr<objects::ObjectSink> createLog(const std::string& path, LogFormat format) {
  switch (format) {
    case LogFormat::kRawlog:
      return std::make_unique<RawlogSink>(path);
    case LogFormat::kCarmen:
      return createCarmenLog(path);
    case LogFormat::kRos1Bag:
      return bags::createRos1Bag(path);
    case LogFormat::kRos2Db3:
      return bags::createRos2Db3(path);
    case LogFormat::kMcap:
      return bags::createMcap(path);
  }
  throw core::ContractError("createLog: unknown format");
}

}  // namespace slam::logs
