#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "libslam/core/journal.h"
#include "libslam/core/pose2.h"
#include "libslam/keyframes/beams.h"
#include "libslam/keyframes/graph_options.h"
#include "libslam/keyframes/links.h"
#include "libslam/keyframes/types.h"
#include "libslam/posegraph/pose_graph.h"

namespace slam::keyframes {

/// What GraphSlam, TrackedPath, LoopCloser and PartFinder share: the keyframes, the graph that ties them
/// together, how they hang together, and what they say of scans. For the rooms of graph SLAM only.
class KeyframeMap {
 public:
  explicit KeyframeMap(const GraphOptions& options);
  const GraphOptions& options() const { return options_; }

  int size() const { return graph_.nodeCount(); }
  int lastKeyframe() const { return size() - 1; }
  const Keyframe& keyframe(int k) const { return keyframes_[static_cast<size_t>(k)]; }
  const core::Pose2& pose(int k) const { return graph_.pose(k); }
  Keyframes& keyframes() { return keyframes_; }
  const Keyframes& keyframes() const { return keyframes_; }
  posegraph::PoseGraph& graph() { return graph_; }
  const posegraph::PoseGraph& graph() const { return graph_; }
  Links& links() { return links_; }
  PointNoise& pointNoise() { return point_noise_; }
  const PointNoise& pointNoise() const { return point_noise_; }
  /// The keyframe that k was reached from; -1: it is the first.
  int keyframeBefore(int k) const;
  bool mayBeMatchedTo(int k) const { return !keyframe(k).unsure && !keyframe(k).is_retired; }
  void link(int a, int b);

  /// Metres since the start.
  double path_m() const { return path_m_; }
  void drive(double metres) { path_m_ += metres; }
  /// Grows when keyframes that were there before have moved, or what they saw has changed.
  int revision() const { return revision_; }
  void countRevision() { ++revision_; }

  const std::vector<core::JournalEntry>& journal() const { return journal_; }
  /// Of the scan at hand.
  void note(core::JournalEvent event, double value, int other_keyframe = -1, const std::string& detail = "");
  int scan() const { return scan_; }
  void nextScan() { ++scan_; }

  /// A loop's edges, and that its ends lie in one place once the poses follow.
  void addLoop(const std::vector<posegraph::Edge>& edges);
  void addClosure(int a, int b) { closures_.push_back({a, b}); }
  void removeClosure(int a, int b);
  /// The shortest way from a keyframe to every earlier one: what the drift between them grows with.
  std::vector<double> pathTo(int keyframe) const;
  /// Takes over what was found for the first keyframes. Those that came since lie to the one that they were
  /// reached from as before.
  void settle(const Settled& found);

  /// The map around a new keyframe explains this share of its scan, 0..1.
  void noteExplained(double share);
  /// The least share of a scan that an old map has to explain, adapted to this log: `score`, or less where
  /// scans lie far apart, or have few beams, and even the map around explains little of them.
  double adapted(double score) const;

  // Parts of the map that have no known place in one another.
  const std::vector<Part>& parts() const { return parts_; }
  void beginPart(int keyframe) { parts_.push_back({keyframe, keyframe}); }
  int componentOf(int keyframe) const;
  bool isCutOff(int keyframe) const { return componentOf(keyframe) != 0; }
  /// The component that holds the map's origin keeps its number, 0.
  void joinComponents(int a, int b);
  /// Parts that begin after keyframe a, up to b.
  int gapsBetween(int a, int b) const;

  /// Those that are linked with `start`, see Links::around(), as far as they may be matched to.
  std::vector<int> keyframesAround(int start, const core::Point2& centre, double path_m,
                                   double radius_m) const;
  /// The same, `most` of them, those first that a robot at this pose shares most of its view with: with a
  /// lidar that looks ahead, not those nearest, if they look the other way. Nearness counts by places and by
  /// the centres of views alike. The robot's view is taken to be that of `start`.
  std::vector<int> keyframesLookingAlike(int start, const core::Pose2& T_map_robot, double path_m,
                                         double radius_m, int most) const;
  /// The same by Links::linkedWith(): wherever they are, in no order.
  std::vector<int> keyframesLinkedWith(int start, double path_m) const;
  /// All keyframes within the radius, however they are linked, the nearest first.
  std::vector<int> keyframesWithin(const core::Point2& centre, double radius_m) const;
  /// The nearest keyframes of a component.
  std::vector<int> keyframesNear(const core::Point2& centre, int component, int most) const;
  /// Keyframes of the same component around one of them, the nearest first.
  std::vector<int> keyframesAtPlace(int place) const;
  /// The points of these keyframes, map frame.
  std::vector<core::Point2> placeAround(const std::vector<int>& keyframes) const;

  /// A keyframe's points in cells of cell_m at its pose, until another one is asked for. Maps of many of the
  /// same keyframes are made in a row: those asked for lately are kept.
  const scanmatch::ScanInCells& inCells(int keyframe) const;
  void fill(LevelMaps& maps, const std::vector<int>& keyframes, const core::Point2& centre) const;
  /// A map of these keyframes, until the next one is asked for.
  const LevelMaps& mapOf(const std::vector<int>& keyframes, const core::Point2& centre) const;
  /// To the map of these keyframes, from a pose near the right one, without regard to any prior.
  scanmatch::MatchResult matchFreely(const std::vector<scanmatch::PatchPoint>& points,
                                     const std::vector<int>& keyframes, const core::Pose2& T_start,
                                     bool with_coarse = false) const;
  /// A match of keyframe k to the nearest of `around`, as edges.
  void addLoopEdges(std::vector<posegraph::Edge>& edges, const std::vector<int>& around, int keyframe,
                    const core::Pose2& T_map_robot, const scanmatch::SurfelMap& map) const;

  // views.cpp: what keyframes' beams say of other scans
  /// Of each of these keyframes, for points in map axes; as long as no keyframe comes or changes.
  std::vector<Beams> beamsOf(const std::vector<int>& viewers) const;
  View view(int viewer, const core::Pose2& T_viewer_points,
            const std::vector<scanmatch::PatchPoint>& points) const;
  /// What the beams of keyframes say of the points of a scan at a pose, on average; 0 without keyframes.
  double meanConflict(const std::vector<int>& viewers, const core::Pose2& T_map_points,
                      const std::vector<scanmatch::PatchPoint>& points) const;
  /// What keyframes say of a scan at a pose; and the scan, where it is given, of them.
  Told toldBy(const std::vector<int>& viewers, const std::vector<scanmatch::PatchPoint>& points,
              const core::Pose2& T_map_robot, const lidar::Scan* scan = nullptr) const;

  /// Ties keyframe k, matched at this pose, to its partners: edges that share what the match tells, and
  /// links.
  void tie(int keyframe, const std::vector<int>& partners, const core::Pose2& T_map_robot,
           const Eigen::Matrix3d& information, double share);
  /// Of these, in their order, `most` at most that look at half of what a scan looks at: see
  /// sharedView(). Others say nothing of it.
  std::vector<int> viewersOf(const lidar::Scan& scan, const core::Pose2& T_map_robot,
                             const std::vector<int>& among, int most) const;
  /// How often those keyframes that lie nearby see what a scan looks at: see sharedView().
  double viewsOf(const lidar::Scan& scan, const core::Pose2& T_map_robot,
                 const std::vector<int>& among) const;
  /// Of `near`, in its order, the keyframes that k's match at this pose is shared among: not two in a row,
  /// and only those whose beams agree.
  std::vector<int> partnersOf(int keyframe, const std::vector<int>& near,
                              const core::Pose2& T_map_robot) const;

  // settle.cpp
  /// What keyframe k's pose errs by in the map. The first one's lies where it lies.
  ErrorSamples errorsOf(int k) const;
  /// So it is found to err. REQUIRES its noise; where that changes it is to be set again.
  void setErrors(int k, const ErrorSamples& errors);
  /// Of all loops, those edges that are on.
  std::vector<LoopEdge> loopEdges() const;

 private:
  GraphOptions options_;
  posegraph::PoseGraph graph_;
  Keyframes keyframes_;
  Links links_;
  std::vector<std::pair<int, int>> closures_;  ///< keyframes that accepted loops join
  std::vector<int> loop_begins_;               ///< first edge of every loop
  std::vector<Part> parts_{{0, 0}};
  std::vector<core::JournalEntry> journal_;
  PointNoise point_noise_;
  double path_m_ = 0;
  double explained_ = 1, explained_count_ = 0;
  int revision_ = 0, scan_ = 0;
  mutable LevelMaps scratch_;  ///< of mapOf()
  struct Sorted {
    int keyframe = -1, revision = 0;
    std::int64_t asked = 0;  ///< when last, in questions
    core::Pose2 T_map_robot;
    scanmatch::ScanInCells scan;
  };
  mutable std::vector<Sorted> sorted_;  ///< of inCells(), those asked for last
  mutable std::int64_t asked_ = 0;
  void takeOver(const std::vector<ErrorSamples>& errors);
};

}  // namespace slam::keyframes
