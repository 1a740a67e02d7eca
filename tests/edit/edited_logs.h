#pragma once
#include <mrpt/obs/CObservationComment.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "libslam/core/progress.h"
#include "libslam/edit/log_edit.h"
#include "libslam/logs/log_format.h"
#include "libslam/objects/object_stream.h"
#include "libslam/testing/temp_folder.h"
#include "tests/logs/log_fixtures.h"
#include "tests/logs/objects_of.h"

namespace slam::edit {

using logs::kStart_s;
using logs::objectsOf;
using logs::RawObjects;
using logs::rawOdometry;
using logs::rawScan;
using logs::readBytes;
using logs::sampleEntries;
using logs::unpacked;
using logs::writeLog;

// Logs to cut, merge and filter, and what is in them afterwards.

template <class Class>
inline const Class& as(const std::shared_ptr<mrpt::serialization::CSerializable>& object) {
  return dynamic_cast<const Class&>(*object);
}

/// "LASER 0.2" per observation, seconds after kStart_s; frames and actions by name.
inline std::vector<std::string> outline(const std::string& path) {
  std::vector<std::string> lines;
  const auto describe = [](const mrpt::obs::CObservation& observation) {
    const auto ticks = observation.timestamp.time_since_epoch().count();
    if (ticks == objects::kNoStamp) return observation.sensorLabel;
    char text[64];
    std::snprintf(text, sizeof(text), "%s %.1f", observation.sensorLabel.c_str(),
                  objects::secondsFromMrptTicks(ticks) - kStart_s);
    return std::string(text);
  };
  for (const auto& object : objectsOf(path)) {
    if (const auto* frame = dynamic_cast<const mrpt::obs::CSensoryFrame*>(object.get())) {
      std::string line = "frame";
      for (const auto& observation : *frame) line += " [" + describe(*observation) + "]";
      lines.push_back(line);
    } else if (const auto* observation = dynamic_cast<const mrpt::obs::CObservation*>(object.get())) {
      lines.push_back(describe(*observation));
    } else {
      lines.push_back("actions");
    }
  }
  return lines;
}

/// "" in an outline: MRPT does not store the label of a comment.
inline mrpt::obs::CObservationComment unstampedRemark() {
  mrpt::obs::CObservationComment remark;
  remark.timestamp = {};
  return remark;
}

/// Odometry and scan at 0, 1, 2 ... s.
inline std::string bareLog(const testing::TempFolder& folder, const std::string& name, int seconds,
                           const std::string& label = "LASER", double first_s = 0) {
  RawObjects log(folder / name);
  for (int i = 0; i < seconds; ++i)
    log << rawOdometry(kStart_s + first_s + i, i) << rawScan(kStart_s + first_s + i, label);
  return folder / name;
}

inline std::string actionLog(const testing::TempFolder& folder, const std::string& name, int steps) {
  writeLog(sampleEntries(steps), folder / name, rawlogs::RawlogForm::kActionFrame);
  return folder / name;
}

inline EditCounts cut(const std::string& path, const std::string& output, CutOptions options) {
  return cutLog(path, output, options, core::silentProgress());
}
inline EditCounts filter(const std::string& path, const std::string& output, const FilterOptions& options) {
  return filterLog(path, output, options, core::silentProgress());
}

}  // namespace slam::edit
