#include "libslam/odometry/local_lines.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/middle_value.h"

namespace slam::odometry {
namespace {

constexpr long kReach = 20;                 // beams to each side
constexpr double kLongest_m = 1.5;          // a longer line gains nothing and begins to bridge bends
constexpr double kSmallestSpread_m = 0.01;  // walls are not straighter than this, nor drawn finer
constexpr double kSteepest = 8;             // two beams on one surface seen at up to about 83 degrees

constexpr long kFewPoints = 5;
constexpr double kWorstNormal_rad = 0.15;

double squaredDistance(const core::Point2& a, const core::Point2& b) {
  const double dx = a.x - b.x, dy = a.y - b.y;
  return dx * dx + dy * dy;
}

/// Sums over a run of points and, about their mean, the scatter matrix.
struct Moments {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  void scatter(double& sxx, double& sxy, double& syy) const {
    sxx = xx - x * x / n, sxy = xy - x * y / n, syy = yy - y * y / n;
  }
  /// Whether the mean squared distance from the best line is at most `largest`: whether the smaller
  /// eigenvalue of the scatter matrix is at most n * largest, by the signs of the shifted minors.
  bool straight(double largest) const {
    double sxx, sxy, syy;
    scatter(sxx, sxy, syy);
    const double t = n * largest;
    return sxx <= t || syy <= t || (sxx - t) * (syy - t) <= sxy * sxy;
  }
};

/// Grows lines in a scan laid out flat: a full circle is continued by kReach beams at both ends, and running
/// sums over it give the moments of any run of beams at once.
class LineGrower {
 public:
  LineGrower(const lidar::Scan& scan, const ScanLines& model)
      : model_(model),
        pad_(model.full_circle ? std::min<long>(kReach, static_cast<long>(model.points.size())) : 0) {
    const double sigma = std::max(1.5 * model.sigma_m, kSmallestSpread_m);
    largest_spread_ = sigma * sigma;
    const long n = static_cast<long>(model.points.size());
    const size_t flat = static_cast<size_t>(n + 2 * pad_);
    points_.resize(flat);
    sums_.resize(flat + 1);
    joined_.assign(flat, 0);
    for (size_t k = 0; k < flat; ++k) {
      const size_t beam = static_cast<size_t>((static_cast<long>(k) - pad_ + n) % n);
      points_[k] = model.points[beam];
      const core::Point2& p = points_[k];
      const Moments& s = sums_[k];
      sums_[k + 1] = {s.n + 1, s.x + p.x, s.y + p.y, s.xx + p.x * p.x, s.xy + p.x * p.y, s.yy + p.y * p.y};
      const size_t next = static_cast<size_t>((static_cast<long>(k) - pad_ + 1 + n) % n);
      joined_[k] = k + 1 < flat && sameSurface(scan, beam, next);
    }
  }

  /// Lines of all beams, in order.
  void growAll(std::vector<LocalLine>& lines) const {
    long reach = 0;
    for (size_t beam = 0; beam < lines.size(); ++beam) {
      if (!model_.is_return[beam]) {
        reach = 0;
        continue;
      }
      const long centre = static_cast<long>(beam) + pad_;
      reach = symmetricReach(centre, reach + 1);
      lines[beam] = grow(centre, reach);
    }
  }

 private:
  bool sameSurface(const lidar::Scan& scan, size_t a, size_t b) const {
    if (!model_.is_return[a] || !model_.is_return[b]) return false;
    const double range = std::min(scan.ranges_m[a], scan.ranges_m[b]);
    const double gap = kSteepest * range * model_.step_rad + 4 * model_.sigma_m;
    return squaredDistance(model_.points[a], model_.points[b]) <= gap * gap;
  }

  bool joined(long k) const {
    return k >= 0 && k < static_cast<long>(joined_.size()) && joined_[static_cast<size_t>(k)];
  }

  const core::Point2& point(long k) const { return points_[static_cast<size_t>(k)]; }

  Moments moments(long first, long last) const {
    const Moments &a = sums_[static_cast<size_t>(first)], &b = sums_[static_cast<size_t>(last + 1)];
    return {b.n - a.n, b.x - a.x, b.y - a.y, b.xx - a.xx, b.xy - a.xy, b.yy - a.yy};
  }

  /// A run may be taken for one line. Far walls have their beams far apart: a few points may always stretch
  /// further.
  bool good(long first, long last) const {
    if (last - first >= kFewPoints && squaredDistance(point(first), point(last)) > kLongest_m * kLongest_m)
      return false;
    return moments(first, last).straight(largest_spread_);
  }

  /// How far a line reaches to both sides alike, found from where that of the beam before came to: along a
  /// wall it grows by one beam per beam until something stops it.
  long symmetricReach(long centre, long hint) const {
    long widest = 0;
    const long most = std::min<long>(hint, kReach);
    while (widest < most && joined(centre - widest - 1) && joined(centre + widest)) ++widest;
    while (widest > 0 && !good(centre - widest, centre + widest)) --widest;
    return widest;
  }

  LocalLine grow(long centre, long reach) const {
    long end[2] = {centre - reach, centre + reach};
    bool open[2] = {true, true};
    while (open[0] || open[1])
      for (const int side : {0, 1}) {
        if (!open[side]) continue;
        const long next = end[side] + (side == 0 ? -1 : 1);
        open[side] = std::abs(next - centre) <= kReach && joined(side == 0 ? next : end[side]) &&
                     good(side == 0 ? next : end[0], side == 0 ? end[1] : next);
        if (open[side]) end[side] = next;
      }
    return finish(centre, end[0], end[1]);
  }

  LocalLine finish(long centre, long first, long last) const {
    LocalLine line;
    const Moments m = moments(first, last);
    if (m.n < 3) return line;
    double sxx, sxy, syy;
    m.scatter(sxx, sxy, syy);
    const double half = (sxx - syy) / 2, root = std::sqrt(half * half + sxy * sxy);
    const double along = (sxx + syy) / 2 + root;
    if (!(along > 0)) return line;
    // The eigenvector of the larger eigenvalue, from the row that does not cancel.
    core::Point2 tangent = half >= 0 ? core::Point2{half + root, sxy} : core::Point2{sxy, root - half};
    const double length = std::sqrt(tangent.x * tangent.x + tangent.y * tangent.y);
    if (!(length > 0)) return line;
    tangent = {tangent.x / length, tangent.y / length};
    line.valid = model_.sigma_m * model_.sigma_m < kWorstNormal_rad * kWorstNormal_rad * along;
    line.normal = {-tangent.y, tangent.x};
    // Variance of a fitted slope: sigma^2 / sum of squared abscissae.
    line.normal_variance_per_m2 = 1 / along;
    const auto abscissa = [&](long k) {
      return tangent.x * (point(k).x - point(centre).x) + tangent.y * (point(k).y - point(centre).y);
    };
    const double t0 = abscissa(first), t1 = abscissa(last);
    line.low_m = std::min({t0, t1, 0.0});
    line.high_m = std::max({t0, t1, 0.0});
    return line;
  }

  const ScanLines& model_;
  long pad_;
  double largest_spread_;
  std::vector<core::Point2> points_;
  std::vector<Moments> sums_;  // before each beam
  std::vector<char> joined_;   // with the next beam
};

}  // namespace

// A straight wall at distance d and bearing a has the inverse ranges
// cos(angle - a) / d, a sinusoid of the angle, so that u[i-1] - 2 cos(step) u[i] + u[i+1] is 0 on any wall,
// however steeply seen; what is left is noise, which dr = -r^2 du takes to metres. The median over all beams
// ignores corners and edges.
double estimateNoise(const lidar::Scan& scan) {
  const double c = 2 * core::cos(scan.step_rad);
  const double gain = std::sqrt(2 + c * c);
  std::vector<double> noise;
  noise.reserve(scan.ranges_m.size());
  for (size_t i = 1; i + 1 < scan.ranges_m.size(); ++i) {
    const double left = scan.ranges_m[i - 1], middle = scan.ranges_m[i], right = scan.ranges_m[i + 1];
    if (!lidar::isReturn(scan.ranges_m[i - 1]) || !lidar::isReturn(scan.ranges_m[i]) ||
        !lidar::isReturn(scan.ranges_m[i + 1]))
      continue;
    noise.push_back(middle * middle * std::abs(1 / left - c / middle + 1 / right) / gain);
  }
  return 1.4826 * core::middleValue(std::move(
                      noise));  // median of the size to standard deviation, for a normal distribution
}

// Sine and cosine anew at every 32nd, between them by rotation, which is good
// to 1e-14.
std::vector<core::Point2> beamDirections(const lidar::Scan& scan) {
  std::vector<core::Point2> directions(scan.ranges_m.size());
  const auto [s, c] = core::sinCos(scan.step_rad);
  for (size_t i = 0; i < directions.size(); ++i) {
    if (i % 32 == 0) {
      directions[i] = core::polar(1, scan.angle(i));
    } else {
      const core::Point2& d = directions[i - 1];
      directions[i] = {c * d.x - s * d.y, s * d.x + c * d.y};
    }
  }
  return directions;
}

ScanLines findLocalLines(const lidar::Scan& scan) {
  const size_t n = scan.ranges_m.size();
  ScanLines model;
  model.first_angle_rad = scan.first_angle_rad;
  model.step_rad = scan.step_rad;
  model.full_circle = scan.isFullCircle();
  // What a sensor states may be several times too small.
  model.sigma_m = std::clamp(std::max(scan.range_sigma_m, estimateNoise(scan)), 0.002, 0.1);
  model.is_return.assign(n, 0);
  model.points.assign(n, {});
  const std::vector<core::Point2> directions = beamDirections(scan);
  for (size_t i = 0; i < n; ++i) {
    if (!lidar::isReturn(scan.ranges_m[i])) continue;
    const double range = static_cast<double>(scan.ranges_m[i]);
    model.is_return[i] = 1;
    model.points[i] = {range * directions[i].x, range * directions[i].y};
  }
  model.lines.resize(n);
  LineGrower(scan, model).growAll(model.lines);
  return model;
}

}  // namespace slam::odometry
