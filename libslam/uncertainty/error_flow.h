#pragma once
#include <Eigen/Core>
#include <functional>
#include <vector>

#include "libslam/sparse/block_cholesky.h"
#include "libslam/uncertainty/error_sources.h"

namespace slam::uncertainty {

/// How a map's poses were found. kTracked: each from those before it, as a filter has no second thoughts.
/// kFitted: together, from all that was seen, see bundle::SurfaceBundle.
enum class Poses { kTracked, kFitted };
/// Whether the noise of a point is the same for all keyframes that are matched to it, or another for each:
/// then the system is half as large, and ways between poses that were tracked are hardly surer or less sure.
enum class ViewNoise { kShared, kApart };

/// How the errors of a map's keyframes hang together, by all that is known when this is made. Of poses that
/// were tracked each one's is what it has inherited, and something new (see keyframes::Inheritance). What a
/// keyframe saw first lies in the map with its pose's error and the noise of its own points, which all that
/// are matched to it share; what two such matches say of the keyframes before is counted as nothing. Loops
/// are measurements of the way between their ends. Of poses that were fitted those matches are measurements,
/// too, each view for itself, and so are odometry's steps: what comes later makes sure of what was before.
/// But what a spinning lidar's pose errs by beyond its points, as it is not known exactly how it moved in its
/// sweep, stays with it, however often its walls are seen.
///
/// So the errors are a sparse linear system, of two unknowns a keyframe: its pose, and the noise of what it
/// saw first. Cost: one factorisation; memory: some kB a keyframe. A snapshot: later changes of the map do
/// not reach it. What is open has a large variance. For the rooms of graph SLAM only.
class ErrorFlow {
 public:
  /// Errors: MethodError when rounding leaves no factor.
  ErrorFlow(const keyframes::KeyframeMap& map, Poses poses);
  /// `T_map_keyframes`: where each keyframe lies. REQUIRES that noise is shared where poses are fitted.
  ErrorFlow(const ErrorSources& sources, std::vector<core::Pose2> T_map_keyframes, Poses poses,
            ViewNoise noise);
  /// Of each keyframe's x, y (m) and phi (rad) in the map; zero for the first.
  std::vector<Eigen::Matrix3d> covariances() const;
  /// Of b's pose in a's frame. Cost: two chains of an elimination tree.
  Eigen::Matrix3d relative(int a, int b) const;
  /// Turns independent draws with variance 1, for each keyframe but the first, into draws of what they err
  /// by: a piece of them, of kPieces that are all to be done. Poses that were tracked, ViewNoise::kApart.
  static constexpr int kPieces = keyframes::ErrorSamples::kCount / 16;
  void draw(std::vector<keyframes::ErrorSamples>& samples, int piece) const;

 private:
  struct Part {
    int unknown;
    Eigen::Matrix3d factor;
  };
  /// The sum of factors times unknowns is zero give or take a covariance.
  struct Equation {
    std::vector<Part> parts;
    Eigen::Matrix3d information;
  };
  using Use = std::function<void(const Equation&)>;
  void numberUnknowns(const ErrorSources& sources, ViewNoise noise);
  Equation inherited(const ErrorSources& sources, int k) const;
  Equation way(const ErrorSources::Way& way) const;
  void useMeasured(const ErrorSources& sources, int k, const Use& use) const;
  void forEachEquation(const ErrorSources& sources, const Use& use) const;
  void analyse(const ErrorSources& sources);
  void fill(const ErrorSources& sources);
  static void addPart(Equation& equation, int unknown, const Eigen::Matrix3d& factor);

  std::vector<core::Pose2> poses_;
  Poses found_;
  std::vector<int> pose_, seen_first_;  ///< unknown of each keyframe; -1: none
  std::vector<Eigen::Matrix3d> own_;    ///< of each keyframe's pose, besides that
  int unknowns_ = 0;
  sparse::BlockCholesky cholesky_;
};

}  // namespace slam::uncertainty
