#include "libslam/odometry/local_lines.h"

#include <algorithm>
#include <cmath>

namespace slam::odometry {
namespace {

constexpr int kReach = 20;                  // beams to each side
constexpr double kLongest_m = 1.5;          // a longer line gains nothing and begins to bridge bends
constexpr double kSmallestSpread_m = 0.01;  // walls are not straighter than this, nor drawn finer
constexpr double kSteepest = 8;             // two beams on one surface seen at up to about 83 degrees

constexpr int kFewPoints = 5;
constexpr double kWorstNormal_rad = 0.15;

double squaredDistance(const core::Point2& a, const core::Point2& b) {
  const double dx = a.x - b.x, dy = a.y - b.y;
  return dx * dx + dy * dy;
}

/// Running second moments of a set of points.
struct Moments {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  void add(const core::Point2& p) {
    n += 1, x += p.x, y += p.y;
    xx += p.x * p.x, xy += p.x * p.y, yy += p.y * p.y;
  }
  /// Scatter matrix about the mean.
  void scatter(double& sxx, double& sxy, double& syy) const {
    sxx = xx - x * x / n, sxy = xy - x * y / n, syy = yy - y * y / n;
  }
  /// Mean squared distance from the best line.
  double spread() const {
    double sxx, sxy, syy;
    scatter(sxx, sxy, syy);
    const double half = (sxx - syy) / 2;
    return std::max(0.0, (sxx + syy) / 2 - std::sqrt(half * half + sxy * sxy)) / n;
  }
};

/// Range noise seen in the scan itself. A straight wall at distance d and bearing a has the inverse ranges
/// cos(angle - a) / d, a sinusoid of the angle, so that u[i-1] - 2 cos(step) u[i] + u[i+1] is 0 on any wall,
/// however steeply seen; what is left is noise, which dr = -r^2 du takes to metres. The median over all beams
/// ignores corners and edges.
double estimateNoise(const robot::Scan& scan) {
  const double c = 2 * std::cos(scan.step_rad);
  const double gain = std::sqrt(2 + c * c);
  std::vector<double> noise;
  for (size_t i = 1; i + 1 < scan.ranges_m.size(); ++i) {
    const double left = scan.ranges_m[i - 1], middle = scan.ranges_m[i], right = scan.ranges_m[i + 1];
    if (!robot::isReturn(scan.ranges_m[i - 1]) || !robot::isReturn(scan.ranges_m[i]) ||
        !robot::isReturn(scan.ranges_m[i + 1]))
      continue;
    noise.push_back(middle * middle * std::abs(1 / left - c / middle + 1 / right) / gain);
  }
  if (noise.empty()) return 0;
  const auto median = noise.begin() + static_cast<long>(noise.size() / 2);
  std::nth_element(noise.begin(), median, noise.end());
  return 1.4826 * *median;  // median of the size to standard deviation, for a normal distribution
}

class LineGrower {
 public:
  LineGrower(const robot::Scan& scan, const ScanLines& model) : scan_(scan), model_(model) {
    const double sigma = std::max(1.5 * model.sigma_m, kSmallestSpread_m);
    largest_spread_ = sigma * sigma;
  }

  LocalLine grow(size_t beam) const {
    LocalLine line;
    if (!model_.is_return[beam]) return line;
    // Moments about the return itself keep the sums small and exact.
    const core::Point2 origin = model_.points[beam];
    Moments moments;
    moments.add({0, 0});
    long end[2] = {static_cast<long>(beam), static_cast<long>(beam)};
    bool open[2] = {true, true};
    core::Point2 tip[2] = {{0, 0}, {0, 0}};
    for (int reach = 1; reach <= kReach && (open[0] || open[1]); ++reach) {
      for (int side = 0; side < 2; ++side) {
        if (!open[side]) continue;
        const long next = wrap(end[side] + (side == 0 ? -1 : 1));
        open[side] = next >= 0 && sameSurface(static_cast<size_t>(end[side]), static_cast<size_t>(next));
        if (!open[side]) continue;
        const core::Point2 p{model_.points[static_cast<size_t>(next)].x - origin.x,
                             model_.points[static_cast<size_t>(next)].y - origin.y};
        Moments grown = moments;
        grown.add(p);
        // Far walls have their beams far apart: a few points may always stretch further.
        const bool short_enough =
            moments.n < kFewPoints || squaredDistance(p, tip[1 - side]) <= kLongest_m * kLongest_m;
        open[side] = short_enough && grown.spread() <= largest_spread_;
        if (!open[side]) continue;
        moments = grown;
        end[side] = next;
        tip[side] = p;
      }
    }
    finish(moments, tip, model_.sigma_m, line);
    return line;
  }

 private:
  long wrap(long beam) const {
    const long n = static_cast<long>(model_.points.size());
    if (beam >= 0 && beam < n) return beam;
    return model_.full_circle ? (beam + n) % n : -1;
  }

  bool sameSurface(size_t a, size_t b) const {
    if (!model_.is_return[b]) return false;
    const double range = std::min(scan_.ranges_m[a], scan_.ranges_m[b]);
    const double gap = kSteepest * range * model_.step_rad + 4 * model_.sigma_m;
    return squaredDistance(model_.points[a], model_.points[b]) <= gap * gap;
  }

  static void finish(const Moments& moments, const core::Point2 (&tip)[2], double sigma_m, LocalLine& line) {
    if (moments.n < 3) return;
    double sxx, sxy, syy;
    moments.scatter(sxx, sxy, syy);
    const double along = (sxx + syy) / 2 + std::hypot((sxx - syy) / 2, sxy);
    if (along <= 0) return;
    const double direction = 0.5 * std::atan2(2 * sxy, sxx - syy);
    line.valid = sigma_m * sigma_m / along < kWorstNormal_rad * kWorstNormal_rad;
    line.normal = {-std::sin(direction), std::cos(direction)};
    // Variance of a fitted slope: sigma^2 / sum of squared abscissae.
    line.normal_variance_per_m2 = 1 / along;
    const core::Point2 tangent{-line.normal.y, line.normal.x};
    const double t0 = tangent.x * tip[0].x + tangent.y * tip[0].y;
    const double t1 = tangent.x * tip[1].x + tangent.y * tip[1].y;
    line.low_m = std::min({t0, t1, 0.0});
    line.high_m = std::max({t0, t1, 0.0});
  }

  const robot::Scan& scan_;
  const ScanLines& model_;
  double largest_spread_;
};

}  // namespace

ScanLines findLocalLines(const robot::Scan& scan) {
  const size_t n = scan.ranges_m.size();
  ScanLines model;
  model.first_angle_rad = scan.first_angle_rad;
  model.step_rad = scan.step_rad;
  model.full_circle = scan.isFullCircle();
  // What a sensor states may be several times too small.
  model.sigma_m = std::clamp(std::max(scan.range_sigma_m, estimateNoise(scan)), 0.002, 0.1);
  model.is_return.assign(n, 0);
  model.points.assign(n, {});
  for (size_t i = 0; i < n; ++i) {
    if (!robot::isReturn(scan.ranges_m[i])) continue;
    const double range = static_cast<double>(scan.ranges_m[i]);
    model.is_return[i] = 1;
    model.points[i] = {range * std::cos(scan.angle(i)), range * std::sin(scan.angle(i))};
  }
  const LineGrower grower(scan, model);
  model.lines.resize(n);
  for (size_t i = 0; i < n; ++i) model.lines[i] = grower.grow(i);
  return model;
}

}  // namespace slam::odometry
