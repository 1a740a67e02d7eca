#pragma once
#include <string>
#include <vector>

#include "libslam/core/journal.h"
#include "libslam/core/pose2.h"
#include "libslam/draw/canvas.h"
#include "libslam/world/cell_map.h"

namespace slam::pictures {

/// The map and the path with the events where they happened, over a strip of time with a row of ticks per
/// event and, where there is `optimised`, the graph's error after each. Loops `accepted` and `rejected` are
/// lines between both places; `degenerate` and `poor` at scans that follow one another, and everything from
/// `lost` to `recovered`, are stretches of the path; `resampled` and the others are marks. What happens on
/// the way to a loop (`searched`, `found`, `confirmed`, `dropped`) stands in the strip alone. Under the rules
/// of the pictures in picture.h.
void drawJournal(const world::CellMap& map, const core::Trajectory& path,
                 const std::vector<core::JournalLine>& events, const std::string& title,
                 const std::string& file, const draw::Paper& paper = {});

}  // namespace slam::pictures
