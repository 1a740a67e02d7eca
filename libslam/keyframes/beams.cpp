#include "libslam/keyframes/beams.h"

#include <array>
#include <cmath>

#include "libslam/core/elementary.h"

namespace slam::keyframes {
namespace {

using core::Point2;

/// Half of what two walls are apart at least.
constexpr double kSame_m = 0.3;

/// The angle from straight ahead by where a direction meets the square |x| + |y| = 1: 1 - x goes from 0 ahead
/// to 2 behind. Straight lines between so many angles err by 1.5e-6 rad at most.
class AngleOfSquare {
 public:
  static constexpr int kPieces = 1024, kPiecesAhead = kPieces / 2;
  static constexpr double kError_rad = 2e-6;

  AngleOfSquare() {
    for (int i = 0; i <= kPieces; ++i) {
      const double x = 1 - 2.0 * i / kPieces;
      angles_[static_cast<size_t>(i)] = core::atan2(1 - std::abs(x), x);
    }
  }
  const double* angles() const { return angles_.data(); }
  /// `at` from 0 ahead to, not including, kPieces behind.
  static double between(const double* angles, double at) {
    const int piece = static_cast<int>(at);
    const double* from = angles + piece;
    return from[0] + (at - piece) * (from[1] - from[0]);
  }

 private:
  std::array<double, kPieces + 1> angles_{};
};

const AngleOfSquare& angleOfSquare() {
  static const AngleOfSquare table;
  return table;
}

}  // namespace

Beams::Beams(const lidar::Scan& scan, const core::Pose2& T_robot_points)
    : scan_(scan),
      T_lidar_points_(core::inverse(scan.T_robot_lidar) * T_robot_points),
      beams_per_rad_(1 / scan.step_rad),
      beams_per_turn_(2 * core::kPi / scan.step_rad),
      error_(AngleOfSquare::kError_rad / scan.step_rad),
      angles_(angleOfSquare().angles()) {}

/// As core::atan2() rounded has it. REQUIRES that this is asked seldom: it is slow.
long Beams::beamAt(const Point2& p) const {
  const double angle = core::atan2(p.y, p.x) - scan_.first_angle_rad;
  return std::lround((angle < 0 ? angle + 2 * core::kPi : angle) / scan_.step_rad);
}

/// The beam, counted from the first, nearest to the direction of a point: that of beamAt(), but most
/// directions are farther from the middle between two beams than a table errs.
[[gnu::always_inline]] inline long Beams::beamTowards(const Point2& p) const {
  const double at = (1 - p.x / (std::abs(p.x) + std::abs(p.y))) * AngleOfSquare::kPiecesAhead;
  if (!(at < AngleOfSquare::kPieces)) return beamAt(p);
  const double angle = std::copysign(AngleOfSquare::between(angles_, at), p.y);
  double beam = (angle - scan_.first_angle_rad) * beams_per_rad_;
  beam += beam < 0 ? beams_per_turn_ : 0;
  // NOLINTNEXTLINE(bugprone-incorrect-roundings): std::lround() is slow, and this is asked of every point
  const long above = static_cast<long>(beam + error_ + 0.5);
  // NOLINTNEXTLINE(bugprone-incorrect-roundings): the same
  return above == static_cast<long>(beam - error_ + 0.5) ? above : beamAt(p);
}

/// Without branches where scans say now this, now that; numbers by value, which std::min() does not take.
[[gnu::always_inline]] inline Sight Beams::sayTo(const Point2& p_lidar) const {
  const long beam = beamTowards(p_lidar);
  // Beams are compared with their neighbours.
  if (beam < 1 || beam + 1 >= static_cast<long>(scan_.ranges_m.size())) return Sight::kUnseen;
  const double distance_m = std::sqrt(p_lidar.x * p_lidar.x + p_lidar.y * p_lidar.y);
  const float* range_m = scan_.ranges_m.data() + beam;
  constexpr double kNone_m = 1e9;
  const auto reading = [&](int beside) -> double { return range_m[beside] > 0 ? range_m[beside] : kNone_m; };
  const auto lesser = [](double a, double b) { return a < b ? a : b; };
  const double before_m = reading(-1), its_m = reading(0), behind_m = reading(1);
  const double off_m = lesser(lesser(std::abs(before_m - distance_m), std::abs(its_m - distance_m)),
                              std::abs(behind_m - distance_m));
  const double nearest_m = lesser(lesser(before_m, its_m), behind_m);
  const bool has_agreed = off_m < kSame_m, has_passed = static_cast<int>(nearest_m < kNone_m) &
                                                        static_cast<int>(nearest_m > distance_m + kSame_m);
  return has_agreed ? Sight::kAgreed : has_passed ? Sight::kPassed : Sight::kUnseen;
}

Sight Beams::say(const Point2& p) const {
  return sayTo(T_lidar_points_ * p);
}

View Beams::sayOf(const std::vector<scanmatch::PatchPoint>& points, size_t stride) const {
  View result;
  for (size_t i = 0; i < points.size(); i += stride) {
    const Sight seen = sayTo(T_lidar_points_ * position(points[i]));
    result.agreed += static_cast<int>(seen == Sight::kAgreed);
    result.passed += static_cast<int>(seen == Sight::kPassed);
  }
  return result;
}

}  // namespace slam::keyframes
