#pragma once
#include "libslam/core/pose2.h"

namespace slam::loops {

/// Where a known part of a map lies in the rest of it, and what speaks for that. See GraphSlam::joinParts().
struct PartPlace {
  bool is_joined = false;   ///< all else is void without
  core::Pose2 T_map_part;   ///< of the frame in which its keyframes were given, as its first one now lies
  int fitting = 0;          ///< keyframes that fit where they were followed
  double extent_m = 0;      ///< over which they fit
  double ahead_nats = 0;    ///< log likelihood ratio to the next best place
  double shared = 0;        ///< share of the part's keyframes that see what another part has seen, in the end
  double contradicted = 0;  ///< share of what they see there that speaks against the other part
};

}  // namespace slam::loops
