#pragma once
#include <cstddef>
#include <map>
#include <optional>
#include <utility>

#include "libslam/core/pose2.h"
#include "libslam/paths/free_space.h"
#include "libslam/paths/path_planner.h"

namespace slam::choices {

/// Where the robot has been how sure of its pose, and whether it pays to go back there for a loop: active
/// SLAM by the covariances that the SLAM method reports, and nothing else. One figure for each: the pose's
/// spread, how far (m, one standard deviation) what is seen from there may lie off.
///
/// What the pose's spread has grown by since a place of before is what a loop closed there takes away, from
/// the pose and from all that is to be mapped from here on. Back along the way that was driven the spread has
/// grown slowly, and such a detour gains little per metre; where the way has come round to a place that was
/// left long ago, it gains much: the opening of a loop as Stachniss, Haehnel and Burgard have it
/// ("Exploration with active loop-closing for FastSLAM", IROS 2004), who compare two maps for it. Ours is by
/// the covariances.
///
/// A place has the spread of the newest visit, and where a way back has ended no place around is taken for
/// surer than the robot was then: what closed no loop draws nobody again. All detours together are at most
/// kMostShare of what was driven.
class Certainty {
 public:
  /// A way back.
  struct Return {
    paths::PathPlanner::Node node;
    core::Point2 p_map;
    double gain_m;    ///< of the pose's spread
    double detour_m;  ///< more than driving straight to the next goal
    double spread_m;  ///< the pose's, there
  };
  static constexpr double kLeastGain_m = 0.03, kMostShare = 0.25;

  /// price: metres of detour that a metre of spread is worth; 0 never goes back.
  explicit Certainty(double price) : price_(price) {}

  /// Of the pose that see() gets next; never called where the method reports none.
  void tell(double spread_m) { spread_m_ = spread_m; }
  /// Every pose in turn.
  void see(const core::Pose2& T_map_robot);
  /// The pose's spread; nothing: the method does not say.
  std::optional<double> spread_m() const { return spread_m_; }
  /// Whether best() may find anything, by straight lines: cheap.
  bool mayPay() const;
  /// The return whose gain pays most beyond its detour, if any pays; none when the way on leads there anyway.
  /// `next`: where the robot drives to without it, if anywhere; reached. `planner` is that of `space`.
  std::optional<Return> best(const paths::FreeSpace& space, const paths::PathPlanner& planner,
                             std::optional<paths::PathPlanner::Node> next) const;
  /// It drives there now: counts against the share.
  void begin(const Return& chosen) { detours_m_ += chosen.detour_m; }
  /// Most of what a return promises has come, or cannot any more.
  bool isDone(const Return& chosen) const;
  /// The way back has ended here, or short of it.
  void end(const core::Point2& p_map);

 private:
  struct Place {
    core::Point2 p_map;
    double spread_m;
  };
  double budget_m() const { return kMostShare * driven_m_ - detours_m_; }
  bool pays(double gain_m, double detour_m) const {
    return gain_m >= kLeastGain_m && detour_m <= price_ * gain_m && detour_m <= budget_m();
  }

  double price_;
  std::optional<double> spread_m_;
  std::optional<core::Pose2> last_;
  double driven_m_ = 0, detours_m_ = 0;
  std::map<std::pair<int, int>, Place> places_;  ///< by squares of the map
};

}  // namespace slam::choices
