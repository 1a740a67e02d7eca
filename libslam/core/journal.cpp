#include "libslam/core/journal.h"

#include <algorithm>

namespace slam::core {

const std::vector<JournalEventInfo>& journalEventInfos() {
  using Event = JournalEvent;
  static const std::vector<JournalEventInfo> kInfos = {
      {Event::kDistrusted, "distrusted",
       "the scans contradicted the odometry, whose motion was not used; value: gain in score"},
      {Event::kLeapt, "leapt", "odometry leapt as no robot drives and was not used; value: m"},
      {Event::kSilent, "silent",
       "the robot moved and its wheels never did: scans alone tell of motion until they do; value: 0"},
      {Event::kRematched, "rematched", "the scan fitted only after a search around its place; value: score"},
      {Event::kPoor, "poor", "the map explains less of the scan than it should; value: score"},
      {Event::kLost, "lost", "the method no longer knows where the robot is; value: score"},
      {Event::kRecovered, "recovered", "the method knows again where the robot is; value: score"},
      {Event::kRestarted, "restarted", "the map goes on from the odometry's pose; value: scans lost"},
      {Event::kJoined, "joined",
       "two parts of the map, neither the newest, became one; value: metres of way"},
      {Event::kApart, "apart", "a part of the map that was joined to nothing; value: its first keyframe"},
      {Event::kOutside, "outside", "the robot left the finished map; value: score"},
      {Event::kInside, "inside", "the robot is back in the finished map; value: score"},
      {Event::kDegenerate, "degenerate",
       "the scan leaves a direction open, as along a corridor; value: share of information along it"},
      {Event::kSearched, "searched", "a loop closure was searched for; value: best score"},
      {Event::kFound, "found", "a place that may close a loop; value: score"},
      {Event::kConfirmed, "confirmed", "the keyframes that followed fit that place, too"},
      {Event::kDropped, "dropped", "the keyframes that followed did not fit that place"},
      {Event::kAccepted, "accepted", "a loop closure; value: metres of path that the loop closes"},
      {Event::kRejected, "rejected",
       "a loop closure that the path between rules out; value: its innovation, squared, in standard "
       "deviations"},
      {Event::kOptimised, "optimised", "all poses were refined jointly; value: chi2"},
      {Event::kCalibrated, "calibrated",
       "how long a metre of odometry is, by the scans, and what its turns are off by; value: metres"},
      {Event::kResampled, "resampled",
       "likely particles took the place of unlikely ones; value: effective share of the particles"},
      {Event::kFailed, "failed", "the method failed, and the run ended; value: the scan not taken in"},
      {Event::kInterrupted, "interrupted", "the run was interrupted; value: the scan not taken in"},
  };
  return kInfos;
}

const char* wordOf(JournalEvent event) {
  return journalEventInfos()[static_cast<size_t>(event)].word;
}

std::optional<JournalEvent> journalEventOf(const std::string& word) {
  const auto& infos = journalEventInfos();
  const auto it =
      std::find_if(infos.begin(), infos.end(), [&](const auto& info) { return word == info.word; });
  if (it == infos.end()) return std::nullopt;
  return it->event;
}

}  // namespace slam::core
