#pragma once
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CActionRobotMovement3D.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CSerializable.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libslam/edit/log_edit.h"
#include "libslam/files/files.h"
#include "libslam/objects/mrpt_time.h"
#include "libslam/objects/object_stream.h"
#include "libslam/rawlogs/rawlog_stream.h"

namespace slam::edit {

/// An object of a log, and its bytes.
struct LogObject {
  std::shared_ptr<mrpt::serialization::CSerializable> content;
  std::string bytes;  ///< as in the file; "" where it has none of MRPT's, or other content now
  bool is_changed = false;
};

/// What is kept or dropped together: a frame with the actions that lead to it, or anything else alone.
struct LogStep {
  std::vector<LogObject> actions;
  std::optional<LogObject> rest;  ///< none: actions at the end of the log
  std::int64_t ticks = objects::kNoStamp;

  std::uint64_t objects() const { return actions.size() + (rest ? 1 : 0); }
  bool isFrame() const { return rest && dynamic_cast<const mrpt::obs::CSensoryFrame*>(rest->content.get()); }
};

/// The steps of a log, one after the other.
class StepReader {
 public:
  explicit StepReader(const std::string& path);
  std::optional<LogStep> next();
  double fractionRead() const { return source_->fractionRead(); }
  std::uint64_t count() const { return source_->count(); }

 private:
  static void setTime(LogStep& step);
  std::unique_ptr<objects::ObjectSource> source_;
  const rawlogs::RawlogObjects* rawlog_ = nullptr;
  std::vector<LogObject> waiting_;  ///< actions before their frame
};

/// The robot's way through several steps in one action per way of measuring it.
class ComposedActions {
 public:
  void add(const mrpt::obs::CActionCollection& actions);
  std::shared_ptr<mrpt::obs::CActionCollection> collection() const;

 private:
  void addWheels(const mrpt::obs::CActionRobotMovement2D& next);
  void addMatched(const mrpt::obs::CActionRobotMovement2D& next);
  void addSpatial(const mrpt::obs::CActionRobotMovement3D& next);
  std::optional<mrpt::obs::CActionRobotMovement2D> wheels_, matched_;
  std::optional<mrpt::obs::CActionRobotMovement3D> spatial_;
  std::vector<mrpt::obs::CAction::Ptr> others_;  ///< of the newest step
};

/// Writes steps, and takes up the actions of those that are dropped in between.
class StepWriter {
 public:
  explicit StepWriter(const std::string& path)
      : path_(path), pending_(path), stream_(pending_.path(), path) {}
  void write(const LogStep& step);
  /// A step in the middle that is left out.
  void drop(const LogStep& step);
  void close(std::uint64_t read);
  EditCounts& counts() { return counts_; }

 private:
  void take(const LogObject& actions);
  void write(const LogObject& object);
  void serialize(const mrpt::serialization::CSerializable& object);
  std::optional<ComposedActions> dropped_;
  std::string path_;
  files::PendingFile pending_;
  rawlogs::PackingStream stream_;
  EditCounts counts_;
};

}  // namespace slam::edit
