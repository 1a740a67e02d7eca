#include "libslam/logs/log_format.h"

#include "libslam/bags/ros_logs.h"
#include "libslam/core/error.h"
#include "libslam/rawlogs/carmen_log.h"
#include "libslam/rawlogs/rawlog_stream.h"

namespace slam::logs {
namespace {

bool begins(const std::string& start, std::string_view magic) {
  return std::string_view(start).substr(0, magic.size()) == magic;
}

/// False for a name that is nothing else.
bool removeSuffix(std::string& path, std::string_view suffix) {
  const size_t name = path.find_last_of('/') + 1;
  if (path.size() - name <= suffix.size() ||
      path.compare(path.size() - suffix.size(), suffix.size(), suffix) != 0)
    return false;
  path.resize(path.size() - suffix.size());
  return true;
}

const LogFormatInfo& infoOf(LogFormat format) {
  for (const auto& info : logFormats())
    if (info.format == format) return info;
  throw core::ContractError("logs: unknown format");
}

}  // namespace

const std::vector<LogFormatInfo>& logFormats() {
  using Source = std::unique_ptr<objects::ObjectSource>;
  using Sink = std::unique_ptr<objects::ObjectSink>;
  using Text = const std::string&;
  static const std::vector<LogFormatInfo> kFormats = {
      {LogFormat::kRawlog,
       "MRPT rawlog",
       "rawlog",
       {".rawlog"},
       rawlogs::looksLikeRawlog,
       [](Text path) -> Source { return std::make_unique<rawlogs::RawlogObjects>(path); },
       [](Text path) -> Sink { return std::make_unique<rawlogs::RawlogSink>(path); }},
      {LogFormat::kCarmen,
       "CARMEN log",
       "carmen",
       {".clf", ".carmen", ".log"},
       [](Text start) { return rawlogs::looksLikeCarmen(start); },
       [](Text path) -> Source { return std::make_unique<rawlogs::CarmenObjects>(path); },
       [](Text path) -> Sink { return rawlogs::createCarmenLog(path); }},
      {LogFormat::kRos1Bag,
       "ROS 1 bag",
       "bag",
       {".bag"},
       [](Text start) { return begins(start, "#ROSBAG V"); },
       [](Text path) -> Source { return bags::openRos1Bag(path); },
       [](Text path) -> Sink { return bags::createRos1Bag(path); }},
      {LogFormat::kRos2Db3,
       "ROS 2 bag (SQLite)",
       "db3",
       {".db3"},
       [](Text start) {
         return begins(start, {"SQLite format 3\0", 16});
       },
       [](Text path) -> Source { return bags::openRos2Db3(path); },
       [](Text path) -> Sink { return bags::createRos2Db3(path); }},
      {LogFormat::kMcap,
       "MCAP",
       "mcap",
       {".mcap"},
       [](Text start) { return begins(start, "\x89MCAP0\r\n"); },
       [](Text path) -> Source { return bags::openMcap(path); },
       [](Text path) -> Sink { return bags::createMcap(path); }},
  };
  return kFormats;
}

const char* formatName(LogFormat format) {
  return infoOf(format).name;
}

LogFormat detectLogFormat(const std::string& path) {
  rawlogs::UnpackingStream stream(path);
  constexpr size_t kEnough = 1 << 16;  // for the remarks before a CARMEN log's first message
  const std::string start = stream.peek(kEnough);
  if (!start.empty())
    for (const auto& info : logFormats())
      if (info.looksLike(start)) return info.format;
  // Nothing in a file that is not empty is a packed log without entries, or damage that the reader of rawlogs
  // describes.
  if (start.empty() && stream.fileBytes() > 0) return LogFormat::kRawlog;
  rawlogs::requireUndamaged(path);
  throw core::InputError(path + (start.empty() ? ": is empty" : ": is no log: it starts with other data") +
                         ", expected an MRPT rawlog, a CARMEN log, a ROS 1 bag, a ROS 2 bag (.db3) or MCAP");
}

std::unique_ptr<objects::ObjectSource> openLog(const std::string& path) {
  if (bags::looksLikeRos2Folder(path)) return bags::openRos2Folder(path);
  return infoOf(detectLogFormat(path)).open(path);
}

std::string logStem(const std::string& path) {
  std::string stem = path;
  for (const char* packing : {".gz", ".bz2", ".xz"})
    if (removeSuffix(stem, packing)) break;
  for (const auto& info : logFormats())
    for (const auto& suffix : info.suffixes)
      if (removeSuffix(stem, suffix)) return stem;
  return path;
}

std::unique_ptr<objects::ObjectSink> createLog(const std::string& path, LogFormat format) {
  return infoOf(format).create(path);
}

}  // namespace slam::logs
