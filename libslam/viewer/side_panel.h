#pragma once
#include <string>
#include <vector>

#include "libslam/viewer/snapshot.h"

namespace slam::viewer {

/// Width of the column beside the scene, pixels.
inline constexpr int kPanelWidth = 330;

/// A key and what it does.
struct KeyHelp {
  std::string key, meaning;
};

/// What stands in the panel besides the moment itself.
struct PanelState {
  std::string playback;       ///< "paused", "4 x real time"
  double robot_side_m = 0.3;  ///< in the picture of the obstacles
  std::vector<KeyHelp> keys;  ///< shown instead of the legend; empty: the legend
};

/// The column beside the scene, PNG: what runs and where the robot is, the scan as range over angle, the obstacles around
/// the robot (white in view, grey zone), and what the colours mean. What finds no room in the height is left out from
/// the bottom up. The same input gives the same bytes.
std::string sidePanel(const Snapshot& snapshot, const PanelState& state, int height);

/// The lines at its top: title, method, time and scan, pose, error against the truth, playback, note.
std::vector<std::string> statusLines(const Snapshot& snapshot, const PanelState& state);

}  // namespace slam::viewer
