#include <algorithm>

#include "libslam/graph/graph_slam.h"

namespace slam::graph {

void GraphSlam::beginPart(int k) {
  map_->beginPart(k);
  finder_.searchAnew();
}

/// What follows from a loop that was accepted, before its poses do.
void GraphSlam::noteLoop(const loops::LoopCloser::Accepted& loop) {
  // What a loop ties to the rest needs no doubt.
  if (doubt_.begins > loop.old_keyframe && doubt_.begins <= loop.keyframe) endDoubt();
  if (!loop.joins) return;
  tracker_.forgetWheels();
  finder_.forgetPlaces();
}

/// After the keyframes have moved.
void GraphSlam::haveMoved() {
  tracker_.forgetWheels();
  uncertainty_.restartFrom(anchor_, currentPose());
  setMapHere();
}

void GraphSlam::completeClosing() {
  if (loops_.completeClosing()) haveMoved();
}

/// Looks for the place of the keyframes [first, last] in the rest of the map, for as long as one scan may
/// take.
void GraphSlam::lookForPart(int first, int last) {
  const auto loop = finder_.lookForPart(first, last);
  if (!loop) return;
  if (const auto accepted = loops_.accept(*loop)) noteLoop(*accepted);
  finder_.searchAnew();
  setMapHere();
}

/// In the end there is time to look for every part everywhere, the newest first: its places are being
/// followed.
void GraphSlam::joinRemainingParts() {
  for (size_t p = map_->parts().size(); p-- > 0;) {
    const int first = map_->parts()[p].begin, last = endOfPart(p) - 1;
    const int component = map_->componentOf(first);
    if (component == 0) continue;
    if (p + 1 < map_->parts().size()) finder_.searchAnew();
    const size_t shares = finder_.mostShares(component);
    for (size_t n = 0; n < shares && map_->componentOf(first) == component; ++n) lookForPart(first, last);
    completeClosing();
  }
}

void GraphSlam::noteWhatStaysApart() {
  std::vector<int> said;
  for (const auto& part : map_->parts()) {
    if (part.component == 0 || std::count(said.begin(), said.end(), part.component) > 0) continue;
    said.push_back(part.component);
    map_->note(core::JournalEvent::kApart, part.begin, part.begin);
  }
}

}  // namespace slam::graph
