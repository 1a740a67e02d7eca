#pragma once
#include <optional>
#include <string>

#include "libslam/lidar/deskew.h"

namespace slam::objects {

/// What a log says of how one of its lidars turns. MRPT's 2D scans have no field for it, so a rawlog holds it
/// as the text of a CObservationComment, before or in the same frame as the first scan that it is true of; it
/// is so until the next note of the same label. MRPT's programs pass over comments that stand in a frame. The
/// text:
///   [sweep]
///   label = LASER
///   duration_s = 0.05
///   clockwise = false
///   stamped_share = 1
struct SweepNote {
  std::string label;  ///< of the lidar's scans
  lidar::Sweep sweep;
};

std::string formatSweepNote(const SweepNote& note);
/// nullopt for any other text. Errors: InputError for a text that begins as such a note and is none (without
/// a file: the caller adds it): a missing or malformed key, a duration below 0 or not finite, a share outside
/// 0 to 1.
std::optional<SweepNote> parseSweepNote(const std::string& text);

}  // namespace slam::objects
