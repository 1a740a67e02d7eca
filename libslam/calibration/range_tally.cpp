#include "libslam/calibration/range_tally.h"

#include <mrpt/obs/CObservation2DRangeScan.h>

#include <algorithm>
#include <cmath>

#include "libslam/core/middle_value.h"

namespace slam::calibration {
namespace {

constexpr double kBin_m = 0.01;
constexpr std::size_t kBins = 1 << 16;

// The pile of no-returns. Its peak lies within 3 % of the largest reading and stands out of what lies below
// it (from 0.8 of the largest on); a wall that a robot at rest looks at makes such a pile too, but in a few
// beams.
constexpr double kTopShare = 0.97, kBelowShare = 0.80;
constexpr double kPeakOverBelow = 10, kEdgeOverBelow = 5;
constexpr std::size_t kWidestHole = 6;  // bins; some lidars speak in steps of 5 cm
constexpr std::uint32_t kFewestInPeak = 20;
constexpr double kLeastShare = 1e-4, kLeastBeamSpread = 0.1;

constexpr std::uint64_t kFewScans = 20;  // too few to say "always"
constexpr double kStuck_m = 0.03, kLively_m = 0.3;
constexpr double kFarShare = 0.99;  // as lidar::fromMrpt: an invalid reading from here on is a no-return

std::size_t binOf(float range_m) {
  return static_cast<std::size_t>(std::lround(static_cast<double>(range_m) / kBin_m));
}

}  // namespace

RangeTally::RangeTally() : bins_(kBins) {}

void RangeTally::takeGeometry(const mrpt::obs::CObservation2DRangeScan& scan) {
  RangeFigures now;
  now.beams = static_cast<int>(scan.getScanSize());
  now.aperture_rad = scan.aperture;
  now.max_range_m = scan.maxRange;
  const auto& mount = scan.sensorPose;
  now.T_robot_lidar = {mount.x(), mount.y(), mount.yaw()};
  now.mount_z_m = mount.z();
  now.mount_tilt_rad = std::max(std::abs(mount.pitch()), std::abs(mount.roll()));
  if (sums_.scans == 0) {
    sums_ = now;
    beams_.resize(scan.getScanSize());
  } else if (now.beams != last_.beams || now.aperture_rad != last_.aperture_rad ||
             now.max_range_m != last_.max_range_m || now.T_robot_lidar.x != last_.T_robot_lidar.x ||
             now.T_robot_lidar.y != last_.T_robot_lidar.y ||
             now.T_robot_lidar.phi != last_.T_robot_lidar.phi) {
    ++sums_.geometry_changes;
  }
  last_ = now;
}

void RangeTally::add(const mrpt::obs::CObservation2DRangeScan& scan) {
  takeGeometry(scan);
  ++sums_.scans;
  const std::size_t beams = scan.getScanSize();
  const bool has_beams = beams == beams_.size();
  bool is_equal = beams > 0 && before_.size() == beams && sums_.scans > 1;
  before_.resize(beams);
  sums_.readings += beams;
  for (std::size_t i = 0; i < beams; ++i) {
    const float range_m = scan.getScanRange(i);
    // Bit for bit, so that lost readings (NaN) are equal too.
    is_equal = is_equal && (range_m == before_[i] || (std::isnan(range_m) && std::isnan(before_[i])));
    before_[i] = range_m;
    if (!std::isfinite(range_m)) {
      ++sums_.not_finite;
      continue;
    }
    sums_.largest_m = std::max(sums_.largest_m, static_cast<double>(range_m));
    if (range_m <= 0) {
      ++sums_.zeros;
      continue;
    }
    const bool is_valid = scan.getScanRangeValidity(i);
    const bool is_far = range_m >= scan.maxRange || (!is_valid && range_m >= kFarShare * scan.maxRange);
    const bool is_return = is_valid && !is_far;
    if (const std::size_t bin = binOf(range_m); bin < kBins) {
      ++bins_[bin].all;
      bins_[bin].as_returns += is_return;
      const auto beam = static_cast<std::uint16_t>(std::min<std::size_t>(i, 0xFFFE));
      bins_[bin].first_beam = std::min(bins_[bin].first_beam, beam);
      bins_[bin].last_beam = std::max(bins_[bin].last_beam, beam);
    }
    sums_.no_returns += is_far;
    sums_.other_invalid += !is_valid && !is_far;
    if (has_beams) beams_[i].no_returns += is_far;
    if (!is_return) continue;
    ++sums_.returns;
    returns_m_.add(range_m);
    if (!has_beams) continue;
    Beam& beam = beams_[i];
    ++beam.returns;
    const double departure_m = range_m - beam.mean_m;
    beam.mean_m += departure_m / static_cast<double>(beam.returns);
    beam.squares_m2 += departure_m * (range_m - beam.mean_m);
  }
  run_ = is_equal ? run_ + 1 : 0;
  sums_.duplicates += is_equal;
  sums_.longest_duplicate_run = std::max(sums_.longest_duplicate_run, run_);
}

std::optional<NoReturnSpike> RangeTally::findSpike() const {
  std::size_t top = kBins;
  while (top > 0 && bins_[top - 1].all == 0) --top;
  if (top == 0) return std::nullopt;
  --top;
  const auto at = [&](double share) { return static_cast<std::size_t>(share * static_cast<double>(top)); };
  std::size_t peak = top;
  for (std::size_t bin = at(kTopShare); bin <= top; ++bin)
    if (bins_[bin].all > bins_[peak].all) peak = bin;
  double below = 0;
  for (std::size_t bin = at(kBelowShare); bin < at(kTopShare); ++bin) below += bins_[bin].all;
  below = 1 + below / static_cast<double>(std::max<std::size_t>(at(kTopShare) - at(kBelowShare), 1));
  if (bins_[peak].all < kFewestInPeak || bins_[peak].all < kPeakOverBelow * below) return std::nullopt;

  std::size_t low = peak;
  for (std::size_t bin = peak, hole = 0; bin > 0 && hole <= kWidestHole; --bin) {
    const bool stands_out = bins_[bin].all >= kEdgeOverBelow * below;
    hole = stands_out ? 0 : hole + 1;
    if (stands_out) low = bin;
  }
  NoReturnSpike spike;
  spike.low_m = kBin_m * static_cast<double>(low);
  spike.high_m = kBin_m * static_cast<double>(top);
  spike.peak_m = kBin_m * static_cast<double>(peak);
  spike.threshold_m = spike.low_m - kBin_m / 2;
  std::uint16_t first_beam = 0xFFFF, last_beam = 0;
  for (std::size_t bin = low; bin <= top; ++bin) {
    spike.readings += bins_[bin].all;
    spike.as_returns += bins_[bin].as_returns;
    if (bins_[bin].all == 0) continue;
    first_beam = std::min(first_beam, bins_[bin].first_beam);
    last_beam = std::max(last_beam, bins_[bin].last_beam);
  }
  const double spread = static_cast<double>(last_beam - first_beam) / std::max(sums_.beams, 1);
  if (static_cast<double>(spike.readings) < kLeastShare * static_cast<double>(sums_.readings) ||
      spread < kLeastBeamSpread)
    return std::nullopt;
  return spike;
}

void RangeTally::findBadBeams(RangeFigures& figures) const {
  if (sums_.scans < kFewScans || beams_.empty()) return;
  std::vector<double> deviations_m;
  std::size_t with_returns = 0;
  for (const Beam& beam : beams_) {
    with_returns += beam.returns > 0;
    if (beam.returns > 1)
      deviations_m.push_back(std::sqrt(beam.squares_m2 / static_cast<double>(beam.returns - 1)));
  }
  if (2 * with_returns < beams_.size()) return;
  const bool is_lively = core::middleValue(std::move(deviations_m)) > kLively_m;
  for (std::size_t i = 0; i < beams_.size(); ++i) {
    const Beam& beam = beams_[i];
    const int index = static_cast<int>(i);
    if (beam.returns == 0 && beam.no_returns == 0) figures.dead_beams.push_back(index);
    if (beam.returns == 0 && beam.no_returns > 0) figures.silent_beams.push_back(index);
    if (is_lively && beam.returns >= kFewScans &&
        std::sqrt(beam.squares_m2 / static_cast<double>(beam.returns - 1)) < kStuck_m)
      figures.stuck_beams.push_back(index);
  }
}

RangeFigures RangeTally::figures() const {
  RangeFigures figures = sums_;
  figures.median_m = returns_m_.median();
  figures.spike = findSpike();
  findBadBeams(figures);
  return figures;
}

}  // namespace slam::calibration
