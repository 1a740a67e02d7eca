#pragma once
#include <memory>
#include <string>

#include "libslam/objects/object_stream.h"

namespace slam::rawlogs {

/// MRPT's two forms of a log: action and sensory frame in turn, which all of its programs read; or bare
/// observations, which rbpf-slam does not (it crashes: on a bare comment too).
enum class RawlogForm { kActionFrame, kObservationOnly };

/// The same log in one of the two forms, object by object. `path` is for messages.
///
/// To actions and frames: before each bare scan, of whichever lidar, a CActionCollection with the odometry's
/// increment since the scan before it (LogReader's rule; MRPT's Gaussian model with its default noise; null
/// for the first; empty when the odometry says nothing), then a CSensoryFrame with the scan and all other
/// observations that stood before it (comments among them), in their order; the scan comes first when the
/// first of them has no stamp (icp-slam stops at such a frame). What stands after the last scan, and each
/// 1000 observations without a scan, gets a frame of its own behind an empty CActionCollection. Lost:
/// odometry readings themselves, what moved before the first scan and after the last. Actions and frames of
/// the source pass as they are; from the first action with an increment on, bare odometry counts no more.
///
/// To observations: each frame's observations as they are, before them a CObservationOdometry "ODOMETRY" with
/// the increments of all actions so far, composed from the origin; its stamp is that of the frame's first
/// scan, else of its first observation, else of the action. Lost: the actions' noise, other actions, and,
/// from the first action with an increment on, the source's own CObservationOdometry (another odometry
/// frame).
///
/// What an object cannot hold is counted: skipped(). Errors: the source's; odometry that is not finite
/// (InputError).
std::unique_ptr<objects::ObjectSource> inForm(std::unique_ptr<objects::ObjectSource> source, RawlogForm form,
                                              const std::string& path);

}  // namespace slam::rawlogs
