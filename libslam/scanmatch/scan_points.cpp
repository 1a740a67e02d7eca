#include "libslam/scanmatch/scan_points.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"

namespace slam::scanmatch {
namespace {

/// Two returns of neighbouring beams lie on one surface unless it would be seen at more than about 80
/// degrees.
constexpr double kSteepest = 6;
/// The same for the patch that a return stands for, at about 85 degrees.
constexpr double kPatchSteepest = 12;
/// So far to each side returns tell together how a surface lies: less than a corner rounds off, more than
/// their noise.
constexpr double kSurface_m = 0.15;
/// Three returns lie on a line within this share of what lies between two beams there.
constexpr double kStraight = 0.2;
constexpr int kLeastNeighbours = 2, kMostNeighbours = 20;

double squaredDistance(const core::Point2& a, const core::Point2& b) {
  const double dx = a.x - b.x, dy = a.y - b.y;
  return dx * dx + dy * dy;
}

/// Unit vector across the best line through points[first..last], or (0, 0).
core::Point2 normalThrough(const std::vector<core::Point2>& points, int first, int last) {
  const int n = last - first + 1;
  if (n < 3) return {};
  double mx = 0, my = 0;
  for (int i = first; i <= last; ++i) mx += points[i].x, my += points[i].y;
  mx /= n, my /= n;
  double xx = 0, xy = 0, yy = 0;
  for (int i = first; i <= last; ++i) {
    const double x = points[i].x - mx, y = points[i].y - my;
    xx += x * x, xy += x * y, yy += y * y;
  }
  const double half = (xx - yy) / 2, root = std::sqrt(half * half + xy * xy);
  const double along = (xx + yy) / 2 + root, across = (xx + yy) / 2 - root;
  if (!(along > 0) || across > 0.1 * along) return {};
  const core::Point2 tangent = half >= 0 ? core::Point2{half + root, xy} : core::Point2{xy, root - half};
  const double length = std::sqrt(tangent.x * tangent.x + tangent.y * tangent.y);
  if (!(length > 0)) return {};
  return {-tangent.y / length, tangent.x / length};
}

/// All returns within the range, and their beams.
struct Returns {
  std::vector<core::Point2> points;  ///< robot frame
  std::vector<double> ranges_m;
  std::vector<int> beams;
};

Returns returnsOf(const lidar::Scan& scan, double max_range_m) {
  Returns returns;
  const int size = static_cast<int>(scan.ranges_m.size());
  returns.points.reserve(static_cast<size_t>(size)), returns.ranges_m.reserve(static_cast<size_t>(size));
  returns.beams.reserve(static_cast<size_t>(size));
  double c = 0, s = 0;
  const auto [step_s, step_c] = core::sinCos(scan.step_rad);
  for (int i = 0; i < size; ++i) {
    // Anew at every 32nd beam, between them by rotation: good to 1e-14.
    if (i % 32 == 0) {
      const double angle = scan.T_robot_lidar.phi + scan.angle(static_cast<size_t>(i));
      c = core::cos(angle), s = core::sin(angle);
    } else {
      const double turned = c * step_c - s * step_s;
      s = s * step_c + c * step_s, c = turned;
    }
    const float range_m = scan.ranges_m[static_cast<size_t>(i)];
    const double r = range_m;
    if (!lidar::isReturn(range_m) || r > max_range_m) continue;
    returns.points.push_back({scan.T_robot_lidar.x + r * c, scan.T_robot_lidar.y + r * s});
    returns.ranges_m.push_back(r), returns.beams.push_back(i);
  }
  return returns;
}

/// Beyond so many times the spacing a point lies on another surface than the one kept before it.
constexpr double kJump = 4;

/// Which of the points stay: each about the spacing from the one kept before it. A point's own range has no
/// say in whether it stays: were the first kept that lies far enough, those whose noise carries them on in
/// the scan's direction would be preferred, walls would turn all the same way, and so would the path.
std::vector<int> keptOf(const Returns& returns, double spacing_m, double step_rad) {
  const auto& points = returns.points;
  const double spacing2 = spacing_m * spacing_m;
  std::vector<int> kept;
  for (int k = 0; k < static_cast<int>(points.size()); ++k) {
    if (kept.empty()) {
      kept.push_back(k);
      continue;
    }
    const int last = kept.back();
    // Where the beam before ended, and what lies between two beams there.
    const double arc_m = returns.ranges_m[k - 1] * step_rad;
    const double gap2 = k > 1 && returns.beams[k - 1] - returns.beams[k - 2] == 1
                            ? squaredDistance(points[k - 1], points[k - 2])
                            : 0;
    const bool is_joined = gap2 > arc_m * arc_m && gap2 < kPatchSteepest * kPatchSteepest * arc_m * arc_m;
    const double left_m = spacing_m - (is_joined ? std::sqrt(gap2) : arc_m);
    if (left_m <= 0 || squaredDistance(points[k - 1], points[last]) >= left_m * left_m ||
        squaredDistance(points[k], points[last]) >= kJump * kJump * spacing2)
      kept.push_back(k);
  }
  return kept;
}

/// Returns of three beams in a row, each farther than the one before, on one line: a wall seen at a grazing
/// angle, however far apart they are. Across such a wall range noise hardly shows.
bool areGrazing(const Returns& returns, int first, double step_rad, const core::Point2& eye) {
  const int n = static_cast<int>(returns.points.size());
  if (first < 0 || first + 2 >= n || returns.beams[first + 2] - returns.beams[first] != 2) return false;
  const core::Point2 &a = returns.points[first], &b = returns.points[first + 1],
                     &c = returns.points[first + 2];
  const double ra2 = squaredDistance(a, eye), rb2 = squaredDistance(b, eye), rc2 = squaredDistance(c, eye);
  if ((ra2 < rb2) != (rb2 < rc2)) return false;
  const double across = (c.x - a.x) * (b.y - a.y) - (c.y - a.y) * (b.x - a.x);
  return across * across < kStraight * kStraight * step_rad * step_rad * rb2 * squaredDistance(a, c);
}

/// From a return to the next one on its surface: the mean over the returns about it, since noise hides the
/// direction of a single gap. Where no neighbour lies on the surface: what the beams leave open sideways.
core::Point2 meanGap(const Returns& returns, int k, double step_rad, const core::Point2& eye) {
  const auto& points = returns.points;
  const auto& beams = returns.beams;
  const int n = static_cast<int>(points.size());
  const core::Point2& p = points[k];
  const double spot_m = returns.ranges_m[k] * step_rad;
  const double farthest2 = kPatchSteepest * kPatchSteepest * spot_m * spot_m;
  // The returns of neighbouring beams, each on one surface with the one before, as far as the reach.
  const auto lastTowards = [&](int step, double reach2) {
    int at = k;
    for (int next = k + step; next >= 0 && next < n; at = next, next += step)
      if (std::abs(beams[next] - beams[at]) != 1 || squaredDistance(points[next], points[at]) >= farthest2 ||
          squaredDistance(points[next], p) >= reach2)
        break;
    return at;
  };
  int first = lastTowards(-1, kSurface_m * kSurface_m), last = lastTowards(1, kSurface_m * kSurface_m);
  if (first == last) {
    // To the nearer of its neighbours: the other one may lie behind an edge.
    first = lastTowards(-1, farthest2), last = lastTowards(1, farthest2);
    first = std::max(first, k - 1), last = std::min(last, k + 1);
    if (first < k && last > k)
      (squaredDistance(points[first], p) <= squaredDistance(points[last], p) ? last : first) = k;
  }
  for (int from = k - 1; first == last && from >= k - 2; --from)
    if (areGrazing(returns, from, step_rad, eye)) first = from, last = std::min(from + 2, k + 1);
  if (first == last && areGrazing(returns, k, step_rad, eye)) last = k + 1;
  if (first == last) return {-(p.y - eye.y) * step_rad, (p.x - eye.x) * step_rad};
  const double gaps = last - first;
  return {(points[last].x - points[first].x) / gaps, (points[last].y - points[first].y) / gaps};
}

}  // namespace

core::Point2 position(const PatchPoint& point) {
  return {point.x, point.y};
}

PatchPoint operator*(const core::Pose2& T, const PatchPoint& p) {
  const auto [s, c] = core::sinCos(T.phi);
  return {static_cast<float>(T.x + c * p.x - s * p.y), static_cast<float>(T.y + s * p.x + c * p.y),
          static_cast<float>(c * p.along_x - s * p.along_y),
          static_cast<float>(s * p.along_x + c * p.along_y)};
}

std::vector<PatchPoint> patchPoints(const lidar::Scan& scan, const ScanPointOptions& options) {
  const Returns returns = returnsOf(scan, options.max_range_m);
  const auto& points = returns.points;
  const core::Point2 eye{scan.T_robot_lidar.x, scan.T_robot_lidar.y};
  const auto kept = keptOf(returns, options.spacing_m, scan.step_rad);
  std::vector<PatchPoint> result;
  result.reserve(kept.size());
  for (const int k : kept) {
    const core::Point2& p = points[k];
    const core::Point2 gap = meanGap(returns, k, scan.step_rad, eye);
    // Uniform over half of the gap to each side, with the lidar on the left.
    const bool is_left = gap.x * (eye.y - p.y) - gap.y * (eye.x - p.x) >= 0;
    const double share = (is_left ? 0.5 : -0.5) / std::sqrt(3.0);
    result.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(share * gap.x),
                      static_cast<float>(share * gap.y)});
  }
  return result;
}

std::vector<SurfacePoint> surfacePoints(const lidar::Scan& scan, const ScanPointOptions& options) {
  const Returns returns = returnsOf(scan, options.max_range_m);
  const auto& points = returns.points;
  const auto& beams = returns.beams;
  const int n = static_cast<int>(points.size());
  const core::Point2 eye{scan.T_robot_lidar.x, scan.T_robot_lidar.y};
  // joined[k]: point k lies on one surface with point k + 1
  std::vector<char> joined(static_cast<size_t>(std::max(n, 1)), 0);
  for (int k = 0; k + 1 < n; ++k) {
    if (beams[k + 1] - beams[k] > 2) continue;
    const double range =
        std::sqrt(std::min(squaredDistance(points[k], eye), squaredDistance(points[k + 1], eye)));
    const double gap = kSteepest * range * scan.step_rad * (beams[k + 1] - beams[k]) + 0.05;
    joined[k] = squaredDistance(points[k], points[k + 1]) <= gap * gap;
  }
  const auto kept = keptOf(returns, options.spacing_m, scan.step_rad);
  std::vector<SurfacePoint> result;
  result.reserve(kept.size());
  const double reach2 = options.normal_reach_m * options.normal_reach_m;
  for (const int k : kept) {
    int first = k, last = k;
    while (k - first < kMostNeighbours && first > 0 && joined[first - 1] &&
           (k - first < kLeastNeighbours || squaredDistance(points[first - 1], points[k]) < reach2))
      --first;
    while (last - k < kMostNeighbours && last + 1 < n && joined[last] &&
           (last - k < kLeastNeighbours || squaredDistance(points[last + 1], points[k]) < reach2))
      ++last;
    SurfacePoint point;
    point.p = points[k];
    point.n = normalThrough(points, first, last);
    if (point.n.x * (eye.x - point.p.x) + point.n.y * (eye.y - point.p.y) < 0)
      point.n = {-point.n.x, -point.n.y};
    result.push_back(point);
  }
  return result;
}

}  // namespace slam::scanmatch
