#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "libslam/core/progress.h"
#include "libslam/keyframes/keyframe_map.h"
#include "libslam/loops/loop_judge.h"
#include "libslam/loops/place_search.h"
#include "libslam/loops/settling.h"
#include "libslam/threads/paced_work.h"

namespace slam::loops {

/// Closes loops of a KeyframeMap: looks for places that were seen before (PlaceSearch), follows them until
/// they are confirmed or not, and finds all poses anew, a piece with every scan. For the rooms of graph SLAM
/// only.
class LoopCloser {
 public:
  using Where = threads::PacedWork::Where;
  /// The map has to stay where it is.
  explicit LoopCloser(keyframes::KeyframeMap& map) : map_(&map), options_(&map.options()), search_(map) {}

  /// Where searches and poses are worked on from now on; at first here. Nothing else depends on it.
  void workBy(Where where) { where_ = where, search_.workBy(where); }

  /// What a loop has tied together. `joins`: two parts of the map that had no known place in one another.
  struct Accepted {
    int old_keyframe, keyframe;
    bool joins;
  };
  /// Follows the hypotheses to the newest keyframe, accepts what is confirmed, and begins to search for more.
  std::optional<Accepted> closeLoops();
  /// One piece of the search that is under way, or all that is left of it; what it finds is followed at once,
  /// and accepted when the search is done and no rival came.
  std::optional<Accepted> continueSearching();
  std::optional<Accepted> completeSearching();
  /// With the whole path known a place can be looked at from both sides, and what drift had carried out of
  /// reach may have come near. From keyframe `first` on: a map of before was searched then. Calls `moved()`
  /// whenever the keyframes have moved. Errors: what `progress` throws; then loops are left, none half
  /// closed.
  void searchRemainingLoops(int first, const std::function<void()>& moved,
                            core::Progress& progress = core::silentProgress());
  /// Nothing where what was measured on the way does not allow for it. Its poses follow, when it is closed.
  /// REQUIRES that no other loop is being closed.
  std::optional<Accepted> accept(const keyframes::Hypothesis& loop);
  /// Forgets what is followed; the next search comes when the robot has moved on.
  void forget();
  bool isFollowing() const { return !hypotheses_.empty(); }
  /// Whether the newest scans fit a place that is followed, and that lies where the way there has it: a robot
  /// that was kidnapped would hardly be there.
  bool isWhereExpected();

  // closing.cpp
  bool isClosing() const { return closing_.has_value(); }
  /// One piece. True when the keyframes have moved, which waits until `may_move`.
  bool continueClosing(bool may_move);
  /// All that is left. True when there was something, and the keyframes have moved.
  bool completeClosing();
  /// Finds all poses anew by what was measured since the last loop, too: passes through one place that need
  /// no loop say where the way between them went wrong. True when there was something.
  bool closeRest();
  /// CPU time of threads of its own, so far.
  double threadSeconds() const { return thread_s_ + search_.threadSeconds(); }

 private:
  std::optional<Accepted> accept(const keyframes::Hypothesis& loop, LoopJudge& judge);
  std::optional<double> ruledOutBy(const keyframes::Hypothesis& loop, LoopJudge& judge);
  core::Pose2 shiftOf(const keyframes::Hypothesis& loop) const;
  double ruledOutBefore(const keyframes::Hypothesis& loop) const;
  bool isKnownHere(const keyframes::Hypothesis& loop, double innovation) const;
  double timesAsFar(double innovation) const;
  bool isConfirmed(const keyframes::Hypothesis& place) const;
  bool isCompared(const keyframes::Hypothesis& place) const;
  std::optional<Accepted> acceptConfirmed();
  double innovationOf(keyframes::Hypothesis& place, LoopJudge& judge) const;
  bool isFollowedEnough(keyframes::Hypothesis& place, LoopJudge& judge) const;
  LoopJudge judge() const;
  void confirm(keyframes::Hypothesis& hypothesis, int keyframe) const;
  bool isFollowing(int keyframe, const core::Pose2& T_map_robot) const;
  void follow(keyframes::Hypothesis& found);

  std::optional<Accepted> continueSearching(double work);
  double workOfScan() const;

  void beginClosing(const keyframes::Hypothesis& loop, bool is_linked);
  void beginClosing(Settling::What what);
  void takeOver();

  /// A loop that was accepted, while all poses are found anew.
  struct Closing {
    std::shared_ptr<const Settling> settling;
    threads::PacedWork work;             ///< of `settling`
    std::vector<posegraph::Edge> edges;  ///< of the loop, if they are not linked yet
    std::pair<int, int> ends{-1, -1};    ///< keyframes that it joins
    bool is_found = false;
  };

  keyframes::KeyframeMap* map_;
  const keyframes::GraphOptions* options_;
  Where where_ = Where::kHere;
  std::vector<keyframes::Hypothesis> hypotheses_;
  /// A loop that the way between makes impossible: how it would move the newest keyframes.
  struct RuledOut {
    core::Pose2 shift;
    double innovation;
  };
  std::vector<RuledOut> ruled_out_;  ///< since the keyframes moved last
  std::optional<Closing> closing_;
  double thread_s_ = 0;      ///< CPU time for loops that are closed
  size_t solved_edges_ = 0;  ///< of the graph, when all poses were found last
  double searched_m_ = 0;    ///< where on the way the last search was
  PlaceSearch search_;
  double scan_m_ = 0,
         scanned_m_ = 0;  ///< way to the last scan from the one before; where on the way that was
};

}  // namespace slam::loops
