#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "libslam/keyframes/keyframe_map.h"
#include "libslam/scanmatch/correlative_search.h"
#include "libslam/threads/paced_work.h"

namespace slam::loops {

/// Looks for places where what the keyframes around one of them see was seen before: the best one around one
/// of the nearest old keyframes that drift could have carried apart, and after it the best elsewhere in its
/// window that explain nearly as much. A piece at a time; keyframes that come meanwhile are not looked at.
/// For the rooms of graph SLAM only.
class PlaceSearch {
 public:
  using Where = threads::PacedWork::Where;
  /// The map has to stay where it is; while a search is under way, so have its poses.
  explicit PlaceSearch(keyframes::KeyframeMap& map)
      : map_(&map), options_(&map.options()), place_(std::make_shared<Place>()) {}

  /// Where a place is looked at from now on; at first here.
  void workBy(Where where) { where_ = where; }

  /// For the scans of the keyframes [first, last] around `keyframe`.
  void begin(int keyframe, int first, int last);
  bool isUnderWay() const { return stage_ != Stage::kNone; }
  void giveUp() { stage_ = Stage::kNone, found_.clear(), looking_.reset(); }
  int keyframe() const { return search_.keyframe; }
  /// Whether the keyframe is known to be there already, so that the place needs no match.
  using Known = std::function<bool(const core::Pose2& T_map_robot)>;
  /// One piece, of so much work (multiplications) and what cannot be divided. True when the search is done.
  bool advance(double work, const Known& isKnown);
  /// What was found since this was asked last. Until the search is done a rival may still come.
  std::vector<keyframes::Hypothesis> take() { return std::exchange(found_, {}); }
  /// The widest window of the last search; 0: there was no place to look at.
  double reach_m() const { return reach_m_; }
  /// CPU time of threads of its own, so far; of what was given up none.
  double threadSeconds() const { return thread_s_; }

 private:
  enum class Stage { kNone, kPlace, kBest, kRival, kLikelier };
  void measureWays(int keyframe);
  void gatherQuery(int first, int last);
  double reachOf(int old) const;
  void listCandidates();
  bool nextPlace();
  void preparePlace();
  Stage noteBest(const std::optional<scanmatch::SearchResult>& best, const Known& isKnown, double& work);
  Stage noteRival(const std::optional<scanmatch::SearchResult>& rival, const Known& isKnown, double& work);
  void searchOn(double least_score);
  bool add(const core::Pose2& T_found, double least_score, const Known& isKnown, double& work);
  std::optional<keyframes::Hypothesis> matchAt(const core::Pose2& T_found, double least_score);

  /// The raster of a place and a search on it: all that is worked on while the map goes on.
  struct Place {
    std::vector<core::Point2> points;  ///< of the place, map frame; until they are drawn
    double coarser = 1;
    bool is_drawn = false;
    scanmatch::LikelihoodPyramid pyramid;
    std::vector<core::Point2> query;
    core::Pose2 centre;
    scanmatch::SearchWindow window{};
    double least_score = 0;
    std::optional<scanmatch::SearchInPieces> pieces;
    bool advance(double& work);
  };

  keyframes::KeyframeMap* map_;
  const keyframes::GraphOptions* options_;
  Where where_ = Where::kHere;
  Stage stage_ = Stage::kNone;
  keyframes::LoopSearch search_;
  std::vector<int> candidates_;  ///< old keyframes, the nearest first
  std::vector<char> is_tried_;
  size_t next_ = 0;  ///< of the candidates
  int places_ = 0;   ///< tried
  double reach_m_ = 0;
  // The place at hand.
  int old_ = -1;
  std::vector<int> around_;
  std::shared_ptr<Place> place_;               ///< nobody else touches it while it is looked at
  std::optional<threads::PacedWork> looking_;  ///< at place_
  double thread_s_ = 0;
  scanmatch::SearchResult best_{};
  std::vector<keyframes::Hypothesis> found_;
  bool has_found_ = false;
};

}  // namespace slam::loops
