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
  std::string hidden;         ///< keys of the layerSwitches() that are off; grey in the legend
};

/// The column beside the scene, PNG: what runs and where the robot is, the scan as range over angle, the
/// obstacles around the robot (white in view, grey zone), what the colours mean with the key that switches
/// each layer, and how to get help. In a low window the parts are smaller; from 500 pixels on nothing of the
/// legend and the help is left out, below that first the obstacles, then the scan. The same input gives the
/// same bytes.
std::string sidePanel(const Snapshot& snapshot, const PanelState& state, int height);

/// The bar of the scale, PNG: a length in metres and how many pixels it has.
std::string scaleBar(double length_m, double pixels);

/// The lines at its top: title, method, time and scan, pose, error against the truth, playback, note.
std::vector<std::string> statusLines(const Snapshot& snapshot, const PanelState& state);

}  // namespace slam::viewer
