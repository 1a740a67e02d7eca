#include "libslam/odometry/range_flow_levels.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/odometry/local_lines.h"

namespace slam::odometry {
namespace {

constexpr size_t kFewestBeams = 40;  // of the coarsest level
constexpr size_t kMostLevels = 5;    // as in the paper

Level finestLevel(const lidar::Scan& scan) {
  Level level{scan.first_angle_rad, scan.step_rad, scan.isFullCircle(), beamDirections(scan), {}};
  level.inverse_range.assign(scan.ranges_m.size(), 0.0);
  for (size_t i = 0; i < scan.ranges_m.size(); ++i)
    if (lidar::isReturn(scan.ranges_m[i])) level.inverse_range[i] = 1 / static_cast<double>(scan.ranges_m[i]);
  return level;
}

bool sameSurface(double a, double b, double step_rad, double sigma_m) {
  if (a == 0 || b == 0) return false;
  // |1/a - 1/b| against the gap of two steep beams, times a b.
  return std::abs(a - b) < kSteepest * step_rad * std::min(a, b) + 4 * sigma_m * a * b;
}

/// Every other beam, smoothed with its neighbours by 1 2 1 where they lie on its surface (the paper filters
/// bilaterally for the same reason: a mean over an edge is a point in the air).
Level halve(const Level& fine, double sigma_m) {
  const size_t n = fine.size();
  Level coarse;
  coarse.first_angle_rad = fine.first_angle_rad;
  coarse.step_rad = 2 * fine.step_rad;
  coarse.full_circle = fine.full_circle && n % 2 == 0;
  for (size_t i = 0; i < n; i += 2) {
    const double middle = fine.inverse_range[i];
    double sum = 2 * middle, weight = 2;
    const auto take = [&](size_t k) {
      if (!sameSurface(middle, fine.inverse_range[k], fine.step_rad, sigma_m)) return;
      sum += fine.inverse_range[k];
      weight += 1;
    };
    // Both or none: one alone would shift the beam along a slanted wall.
    if (i > 0 && i + 1 < n && sameSurface(fine.inverse_range[i - 1], middle, fine.step_rad, sigma_m) &&
        sameSurface(middle, fine.inverse_range[i + 1], fine.step_rad, sigma_m)) {
      take(i - 1);
      take(i + 1);
    }
    coarse.inverse_range.push_back(sum / weight);
    coarse.directions.push_back(fine.directions[i]);
  }
  return coarse;
}

}  // namespace

Pyramid makePyramid(const lidar::Scan& scan) {
  Pyramid pyramid;
  // What a sensor states may be several times too small.
  pyramid.sigma_m = std::clamp(std::max(scan.range_sigma_m, estimateNoise(scan)), 0.002, 0.1);
  pyramid.levels.push_back(finestLevel(scan));
  while (pyramid.levels.size() < kMostLevels && pyramid.levels.back().size() >= 2 * kFewestBeams)
    pyramid.levels.push_back(halve(pyramid.levels.back(), pyramid.sigma_m));
  return pyramid;
}

void warp(const Level& moving, const core::Pose2& T, const Level& reference, double sigma_m,
          std::vector<double>& warped) {
  const long n = static_cast<long>(reference.size());
  warped.assign(static_cast<size_t>(n), 0.0);
  const double c = core::cos(T.phi), s = core::sin(T.phi), per_step = 1 / reference.step_rad;
  const double circle = 2 * core::kPi * per_step;
  double last_u = 0, last_inverse = 0, last_original = 0;
  const size_t count = moving.size() + (moving.full_circle ? 1 : 0);
  for (size_t k = 0; k < count; ++k) {
    const size_t i = k < moving.size() ? k : 0;
    const double inverse = moving.inverse_range[i];
    if (inverse == 0) {
      last_original = 0;
      continue;
    }
    const core::Point2& d = moving.directions[i];
    // In units of the range: arm of length 1, shift divided by the range.
    const core::Point2 arm{c * d.x - s * d.y, s * d.x + c * d.y};
    const core::Point2 q{arm.x + T.x * inverse, arm.y + T.y * inverse};
    const double across = arm.x * q.y - arm.y * q.x, ahead = arm.x * q.x + arm.y * q.y, t = across / ahead;
    // Error of the series below 0.1 t^7: a ten-thousandth of a beam at the bound.
    const double parallax =
        ahead > 0 && std::abs(t) < 0.2 ? t * (1 - t * t * (1.0 / 3 - t * t / 5)) : core::atan2(across, ahead);
    const double angle = moving.first_angle_rad + static_cast<double>(k) * moving.step_rad + T.phi + parallax;
    const double u = (angle - reference.first_angle_rad) * per_step;
    const double seen = inverse / std::sqrt(q.x * q.x + q.y * q.y);
    if (sameSurface(last_original, inverse, moving.step_rad, sigma_m) && u > last_u && u - last_u < 8) {
      const double slope = (seen - last_inverse) / (u - last_u);
      const double first = std::ceil(last_u);
      for (int step = 0; first + step <= u; ++step) {
        const double beam = first + step;
        const double turned = beam - circle * std::floor((beam + 0.5) / circle);
        const long j = std::lround(turned);
        if (j < 0 || j >= n) continue;
        double& slot = warped[static_cast<size_t>(j)];
        slot = std::max(slot, last_inverse + (beam - last_u) * slope);
      }
    }
    last_u = u, last_inverse = seen, last_original = inverse;
  }
}

}  // namespace slam::odometry
