#include <algorithm>

#include "libslam/graph/graph_slam.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "libslam/scanmatch/information.h"

/// What a scan measures of the keyframes around it, of each pass through the place by itself. Passes that do
/// not lie as one another say where the way between them went wrong.
namespace slam::graph {
namespace {

using core::Pose2;

/// A pass that says something of less of a scan holds it too weakly to measure how the passes lie.
constexpr double kLeastTelling = 0.2;

}  // namespace

/// Ties keyframe k to those that it was matched to. Those of an earlier pass may not lie as these do: each
/// pass gets the pose that a match to it alone gives, so that an edge says what was measured between its
/// ends, and not where their mean was.
void GraphSlam::addMatchEdges(int k, const Pose2& T_map_robot, const Eigen::Matrix3d& information) {
  std::vector<int> lately, before;
  for (const int other : around().keyframes()) {
    const bool is_late = std::abs(map_->path_m() - map_->keyframe(other).path_m) < options_.map_path_m;
    (is_late ? lately : before).push_back(other);
  }
  const bool are_two = !lately.empty() && !before.empty();
  const auto partners = map_->partnersOf(k, around().keyframes(), T_map_robot);
  for (const auto* pass : {&lately, &before}) {
    Pose2 T = T_map_robot;
    Eigen::Matrix3d told = information;
    double share = static_cast<double>(std::max<size_t>(partners.size(), 1));
    std::vector<int> own;
    for (const int partner : partners)
      if (std::find(pass->begin(), pass->end(), partner) != pass->end()) own.push_back(partner);
    if (own.empty()) continue;
    if (are_two) {
      const auto matched = matchToPass(k, *pass, T_map_robot);
      if (!matched && pass == &before) continue;
      if (matched)
        T = matched->T_map_robot, told = matched->information, share = static_cast<double>(own.size());
    }
    map_->tie(k, own, T, told, share);
  }
}

/// Keyframe k matched to these alone, from where it lies; nothing where that is another place. In the memory
/// of the map around, which addKeyframe() makes anew.
std::optional<scanmatch::MatchResult> GraphSlam::matchToPass(int k, const std::vector<int>& pass,
                                                             const Pose2& T_map_robot) {
  scanmatch::SurfelMap& map = around().lentMap();
  map.clear(core::position(T_map_robot), keyframes::kMapReach_m);
  for (const int other : pass) map.add(map_->inCells(other), other);
  scanmatch::PosePrior flat;
  flat.mean = T_map_robot;
  flat.information.setIdentity();
  auto matched =
      alignToSurfels(map_->keyframe(k).points, map, T_map_robot, flat, keyframes::matchOptions(10));
  if (!keyframes::isFollowed(matched.T_map_robot, T_map_robot)) return std::nullopt;
  matched.information = keyframes::toldInformation(map_->keyframe(k).points, map, matched.T_map_robot);
  if (matched.score >= options_.loop_confirm_score) return matched;
  // Of what lies beyond the pass nothing can be explained.
  const double telling = std::min(map_->toldBy(keyframes::firstOf(pass, keyframes::kAskedViewers),
                                               map_->keyframe(k).points, matched.T_map_robot)
                                      .telling,
                                  1.0);
  if (telling < kLeastTelling || matched.score < options_.loop_confirm_score * telling) return std::nullopt;
  return matched;
}

}  // namespace slam::graph
