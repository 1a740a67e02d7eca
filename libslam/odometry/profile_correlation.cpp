#include "libslam/odometry/profile_correlation.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"

namespace slam::odometry {
namespace {

constexpr double kPeakDistance_rad = 5 * core::kPi / 180;
constexpr size_t kFewestBeams = 8;

/// Values and where they are known; an unknown value is 0 so that it adds nothing to any sum.
struct Profile {
  std::vector<double> value, known;
};

Profile logProfile(const lidar::Scan& scan) {
  Profile profile;
  profile.value.assign(scan.ranges_m.size(), 0.0);
  profile.known.assign(scan.ranges_m.size(), 0.0);
  for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
    double range = static_cast<double>(scan.ranges_m[i]);
    if (range == lidar::kNoReturn) range = scan.max_range_m;
    if (!std::isfinite(range) || range <= 0) continue;
    profile.value[i] = core::log(range);
    profile.known[i] = 1;
  }
  return profile;
}

/// The profile on the beams of `target`: nearest beam, unknown where `source` does not look.
Profile resample(const Profile& profile, const lidar::Scan& source, const lidar::Scan& target) {
  const size_t n = target.ranges_m.size();
  Profile out;
  out.value.assign(n, 0.0);
  out.known.assign(n, 0.0);
  for (size_t i = 0; i < n; ++i) {
    const double offset = core::wrapToPi(target.angle(i) - source.first_angle_rad - core::kPi) + core::kPi;
    const auto j = static_cast<size_t>(std::lround(offset / source.step_rad));
    if (j >= profile.value.size()) continue;
    out.value[i] = profile.value[j];
    out.known[i] = profile.known[j];
  }
  return out;
}

struct Sums {
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
};

/// Adds a[i0 + k] against b[j0 + k] for k = 0 .. length-1.
void addSums(const Profile& a, size_t i0, const Profile& b, size_t j0, size_t length, Sums& sums) {
  for (size_t k = 0; k < length; ++k) {
    const double va = a.value[i0 + k], ka = a.known[i0 + k], vb = b.value[j0 + k], kb = b.known[j0 + k];
    sums.n += ka * kb;
    sums.a += va * kb;
    sums.b += vb * ka;
    sums.aa += va * va * kb;
    sums.bb += vb * vb * ka;
    sums.ab += va * vb;
  }
}

/// Pearson's r of after[i] against before[i + shift].
double correlation(const Profile& before, const Profile& after, long shift, bool circular) {
  const size_t n = after.value.size();
  Sums sums;
  const size_t k = static_cast<size_t>(std::abs(shift));
  if (shift >= 0) {
    addSums(before, k, after, 0, n - k, sums);
    if (circular) addSums(before, 0, after, n - k, k, sums);
  } else {
    addSums(before, 0, after, k, n - k, sums);
    if (circular) addSums(before, n - k, after, 0, k, sums);
  }
  if (sums.n < std::max(static_cast<double>(kFewestBeams), static_cast<double>(n) / 3)) return 0;
  const double var_a = sums.aa - sums.a * sums.a / sums.n, var_b = sums.bb - sums.b * sums.b / sums.n;
  // Below this the profile is flat but for rounding: a relative range spread of 1e-5.
  const double flat = 1e-10 * sums.n;
  if (var_a < flat || var_b < flat) return 0;
  return (sums.ab - sums.a * sums.b / sums.n) / std::sqrt(var_a * var_b);
}

/// Where the parabola through three equidistant values has its top, in steps from the middle one.
double parabolaTop(double left, double middle, double right) {
  const double curvature = left - 2 * middle + right;
  return curvature < 0 ? std::clamp(0.5 * (left - right) / curvature, -0.5, 0.5) : 0;
}

}  // namespace

bool sameBeams(const lidar::Scan& a, const lidar::Scan& b) {
  return a.ranges_m.size() == b.ranges_m.size() && std::abs(a.step_rad - b.step_rad) < 1e-3 * a.step_rad &&
         std::abs(a.first_angle_rad - b.first_angle_rad) < 1e-3 * a.step_rad;
}

std::vector<TurnCandidate> correlateProfiles(const lidar::Scan& before, const lidar::Scan& after,
                                             double max_turn_rad, size_t count) {
  const long n = static_cast<long>(after.ranges_m.size());
  const bool circular = after.isFullCircle();
  Profile a = logProfile(before);
  const Profile b = logProfile(after);
  if (!sameBeams(before, after)) a = resample(a, before, after);

  const long widest = circular ? n / 2 : n - 1;
  const long reach = std::min(static_cast<long>(std::ceil(max_turn_rad / after.step_rad)), widest);
  std::vector<double> r(static_cast<size_t>(2 * reach + 1));
  for (long s = -reach; s <= reach; ++s) r[static_cast<size_t>(s + reach)] = correlation(a, b, s, circular);

  std::vector<TurnCandidate> peaks;
  for (size_t i = 0; i < r.size(); ++i) {
    const double left = i > 0 ? r[i - 1] : -1, right = i + 1 < r.size() ? r[i + 1] : -1;
    if (r[i] <= 0 || r[i] < left || r[i] < right) continue;
    const bool inside = i > 0 && i + 1 < r.size();
    const double steps =
        static_cast<double>(static_cast<long>(i) - reach) + (inside ? parabolaTop(left, r[i], right) : 0.0);
    peaks.push_back({steps * after.step_rad, r[i]});
  }
  std::stable_sort(peaks.begin(), peaks.end(), [](const TurnCandidate& p, const TurnCandidate& q) {
    if (p.correlation != q.correlation) return p.correlation > q.correlation;
    return std::abs(p.turn_rad) < std::abs(q.turn_rad);
  });
  std::vector<TurnCandidate> chosen;
  for (const auto& peak : peaks) {
    if (chosen.size() == count) break;
    const bool taken = std::any_of(chosen.begin(), chosen.end(), [&peak](const TurnCandidate& c) {
      return std::abs(core::angleDifference(c.turn_rad, peak.turn_rad)) < kPeakDistance_rad;
    });
    if (!taken) chosen.push_back(peak);
  }
  return chosen;
}

}  // namespace slam::odometry
