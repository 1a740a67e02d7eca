#pragma once
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/report/canvas.h"
#include "libslam/world/plan.h"

namespace slam::report {

/// Something that a method said of its own work, where it happened. Map frame.
struct PlacedEvent {
  int scan = 0;
  double time_s = 0;  ///< since the first scan
  std::string event;  ///< what the words mean stands with the method; unknown ones get a mark of their own
  double value = 0;
  core::Point2 place;
  core::Point2 other_place;  ///< of the scan that it refers to; NaN: none
};

/// The map and the path with the events where they happened, over a strip of time with a row of ticks per
/// event and, where there is `optimised`, the graph's error after each. Loops `accepted` and `rejected` are
/// lines between both places; `degenerate` and `poor` at scans that follow one another, and everything from
/// `lost` to `recovered`, are stretches of the path; `resampled` and other events are marks. What happens on
/// the way to a loop (`searched`, `found`, `confirmed`, `dropped`) stands in the strip alone. Under the rules
/// of the pictures in picture.h.
void drawJournal(const world::Plan& map, const core::Trajectory& path, const std::vector<PlacedEvent>& events,
                 const std::string& title, const std::string& file, const Paper& paper = {});

}  // namespace slam::report
