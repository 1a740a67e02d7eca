#pragma once
#include <string>
#include <vector>

#include "libslam/draw/map_view.h"
#include "libslam/report/html_report.h"

namespace slam::report {

// The HTML report's player, and the grounds that its maps stand on.

/// What of one world the maps of a page show, and how fine. Replays in the same plan share it, and all that
/// shows them moves together.
struct Ground {
  draw::Window window;
  double cell_m = 0.05;
  const world::Plan* plan = nullptr;  ///< the true one, if known
  std::vector<std::size_t> runs;      ///< those on it
};
struct Grounds {
  std::vector<Ground> grounds;
  std::vector<std::size_t> of_replay;  ///< index of each replay's
};
/// REQUIRES a replay for every run. The page must outlive it.
Grounds groundsOf(const ReportPage& page);

/// Ids of the pictures that the page holds, by which the player finds them.
std::string mapId(std::size_t run);
std::string planId(std::size_t ground);
/// Of what lies under paths: the true plan, else the map of the best run; "" where there is none.
std::string groundPictureId(const ReportPage& page, const Grounds& grounds, std::size_t ground);

/// Those listed of a run or a replay: all of them where they are at most kMostListedEvents; else every n-th
/// of the kinds that are too many, and all of the rarer ones. In their order.
template <class Event>
struct Listed {
  std::vector<Event> events;
  std::string note;  ///< "1000 events, of which 250 are listed: resampled one in 4"
};
Listed<core::JournalLine> listed(const std::vector<core::JournalLine>& events);
Listed<ReportMoment> listed(const std::vector<ReportMoment>& moments);

/// The whole section, and the data for the script; both "" where there is nothing to replay. The data is JSON
/// that may stand in a `script`: nothing in it can end the element.
struct ReplayParts {
  std::string section, data;
};
ReplayParts replayParts(const ReportPage& page, const Grounds& grounds);

}  // namespace slam::report
