#include <algorithm>
#include <cmath>

#include "libslam/core/pose2.h"
#include "libslam/doctor/finding_rules.h"
#include "libslam/doctor/finding_text.h"

namespace slam::doctor {
namespace {

using core::radToDeg;

// Where a rule draws its line.
constexpr double kManyAsReturns = 0.05;
constexpr double kManyDuplicates = 0.01;
constexpr double kManyLost = 0.2;
constexpr double kLargeStepBack_s = 1;
constexpr const char* kScanKind = "CObservation2DRangeScan";
constexpr double kMillimetres_m = 500;  // median reading; between here and 60 it is centimetres

std::string streamName(const calibration::StreamFigures& stream) {
  return stream.kind + (stream.label.empty() ? "" : " '" + stream.label + "'");
}

}  // namespace

void FindingRules::format() {
  const char* form = f_.has_frames ? (f_.has_bare_observations ? ", mixed form" : ", action / sensory frame")
                                   : (f_.has_bare_observations ? ", observations only" : "");
  say("format", Severity::kNote,
      text("%s%s, %lu objects in %.2f MB, %.1f s from stamp %.3f", f_.format.c_str(), form, n(f_.objects),
           static_cast<double>(f_.file_bytes) / 1e6, f_.last_s - f_.first_s, f_.first_s));
}

void FindingRules::damage() {
  if (f_.damage.empty()) return;
  say("damage", Severity::kError, f_.damage,
      "get the log again, or keep what is whole: rasterslam cut LOG -o OUT --salvage");
}

void FindingRules::skipped() {
  if (f_.skipped.empty()) return;
  say("skipped", Severity::kNote, "passed over: " + f_.skipped);
}

void FindingRules::scans() {
  if (f_.ranges.scans == 0) {
    say("scans", Severity::kError, "no 2D laser scan (CObservation2DRangeScan)",
        "SLAM here needs scans of a 2D lidar; a point cloud must be cut to one height first");
    return;
  }
  if (f_.refused_scans > 0)
    say("scans", Severity::kError,
        plural(f_.refused_scans, "scan", "scans") + " of no use, the first: " + f_.refused_scan,
        "drop them, or mend what wrote the log");
  if (f_.scans_without_time > 0)
    say("scans", Severity::kError,
        plural(f_.scans_without_time, "scan has", "scans have") +
            " no time stamp, and no odometry reading before has one",
        "stamp the scans where they are recorded; without time no trajectory can be written");
  if (f_.ranges.scans < 2)
    say("scans", Severity::kWarning, "a single scan", "there is no motion to map from");
}

void FindingRules::stamps() {
  std::uint64_t backward = 0;
  for (const auto& stream : f_.streams) {
    backward += stream.backward;
    if (sharesStamps(stream)) continue;
    if (stream.backward > 0)
      say("backward", stream.largest_backward_s > kLargeStepBack_s ? Severity::kWarning : Severity::kNote,
          text("%s: %lu of %lu stamps are earlier than the one before, by up to %.3f s (at %.3f)",
               streamName(stream).c_str(), n(stream.backward), n(stream.count), stream.largest_backward_s,
               stream.backward_at_s),
          "keep the file's order, as the readers here do; match references by stamp, never by line");
    if (stream.repeated > 0)
      say("repeated", share(stream.repeated, stream.count) > 0.5 ? Severity::kWarning : Severity::kNote,
          text("%s: %lu of %lu stamps equal the one before", streamName(stream).c_str(), n(stream.repeated),
               n(stream.count)),
          "what divides by the time between two readings must expect 0");
    if (!stream.gaps.empty())
      say("gaps", Severity::kWarning,
          text("%s: %lu gaps of more than ten periods (%.3f s), the longest %.2f s after %.3f",
               streamName(stream).c_str(), n(stream.gap_count),
               std::max(stream.median_period_s, stream.mean_period_s), stream.gaps.front().length_s,
               stream.gaps.front().from_s),
          "scan matching across a gap may fail: check the map there, or cut the log in two (rasterslam "
          "cut)");
    if (stream.unstamped > 0 && stream.kind == kScanKind && f_.scans_without_time == 0)
      say("unstamped", Severity::kWarning,
          text("%s: %lu of %lu have no stamp; the readers here take that of the newest odometry reading",
               streamName(stream).c_str(), n(stream.unstamped), n(stream.count)),
          "stamp the scans where they are recorded");
  }
  // Streams that are whole in themselves may still be written in the wrong order.
  if (f_.backward_in_file > backward)
    say("order", f_.largest_backward_in_file_s > kLargeStepBack_s ? Severity::kWarning : Severity::kNote,
        text("%lu of %lu objects are stamped earlier than the one before them in the file, by up to %.3f s",
             n(f_.backward_in_file), n(f_.objects), f_.largest_backward_in_file_s),
        "the readers here let later odometry wait for its scan; others may need the log sorted by stamp");
}

/// The odometry that a message of the lidar carries has the scan's stamps, and their faults.
bool FindingRules::sharesStamps(const calibration::StreamFigures& stream) const {
  if (stream.kind == kScanKind) return false;
  return std::any_of(
      f_.streams.begin(), f_.streams.end(), [&stream](const calibration::StreamFigures& other) {
        return other.kind == kScanKind && other.count == stream.count && other.first_s == stream.first_s &&
               other.last_s == stream.last_s && other.backward == stream.backward &&
               other.largest_backward_s == stream.largest_backward_s;
      });
}

void FindingRules::units() {
  if (isInMetres()) return;
  const bool millimetres = f_.ranges.median_m > kMillimetres_m;
  say("units", Severity::kError,
      text("half of the readings are beyond %.0f, up to %.0f: these are %s, not metres", f_.ranges.median_m,
           f_.ranges.largest_m, millimetres ? "millimetres" : "centimetres"),
      millimetres ? "divide all ranges and the maximum range by 1000"
                  : "divide all ranges and the maximum range by 100");
}

void FindingRules::geometry() {
  const auto& r = f_.ranges;
  say("lidar", Severity::kNote,
      text("'%s': %lu scans of %d beams over %.2f deg (%s), %.4f deg apart, maximum range %.2f m, median "
           "reading %.2f m",
           f_.lidar.c_str(), n(r.scans), r.beams, radToDeg(r.aperture_rad),
           f_.is_view_given ? "as the log says" : "inferred from the number of readings",
           radToDeg(r.aperture_rad) / std::max(r.beams - 1, 1), r.max_range_m, r.median_m));
  if (r.geometry_changes > 0)
    say("lidar", Severity::kWarning,
        plural(r.geometry_changes, "scan differs", "scans differ") +
            " from the one before in beams, field of view, maximum range or mounting pose",
        "methods that fix their tables at the first scan will be wrong: filter by label, or cut");
}

void FindingRules::noReturns() {
  const auto& r = f_.ranges;
  if (!r.spike) {
    say("no_return", Severity::kNote,
        text("no pile of readings at the far end (largest %.2f m); %lu of %lu readings (%.1f %%) are at or "
             "beyond the stated maximum of %.2f m",
             r.largest_m, n(r.no_returns), n(r.readings), 100 * share(r.no_returns, r.readings),
             r.max_range_m));
    return;
  }
  const auto& spike = *r.spike;
  const std::string what = text(
      "no-return value found at %.2f m (%.2f to %.2f): %lu of %lu readings (%.1f %%)", spike.peak_m,
      spike.low_m, spike.high_m, n(spike.readings), n(r.readings), 100 * share(spike.readings, r.readings));
  // A few walls at just that distance are no fault.
  if (spike.as_returns == 0)
    say("no_return", Severity::kNote, what + ", all marked as such");
  else if (share(spike.as_returns, spike.readings) < kManyAsReturns)
    say("no_return", Severity::kNote, what + text(", all but %lu marked as such", n(spike.as_returns)));
  else
    say("no_return", Severity::kWarning,
        what + text("; %lu of them are given as distances: who takes them so gets walls at %.2f m",
                    n(spike.as_returns), spike.peak_m),
        text("rasterslam filter LOG -o OUT --no-return %.2f", spike.low_m));
}

void FindingRules::lost() {
  const auto& r = f_.ranges;
  const std::uint64_t lost = r.zeros + r.not_finite + r.other_invalid;
  if (lost == 0) return;
  say("lost", share(lost, r.readings) > kManyLost ? Severity::kWarning : Severity::kNote,
      text("%lu of %lu readings (%.1f %%) are lost: %lu of 0 or less, %lu not finite, %lu marked invalid",
           n(lost), n(r.readings), 100 * share(lost, r.readings), n(r.zeros), n(r.not_finite),
           n(r.other_invalid)),
      share(lost, r.readings) > kManyLost ? "look at the lidar: glass, sun, or a dirty window" : "");
}

void FindingRules::beams() {
  const auto& r = f_.ranges;
  const auto look = [&](const std::vector<int>& list, const char* what, const char* advice) {
    if (list.empty()) return;
    say("beams", Severity::kWarning,
        text("%zu of %d beams %s: %s", list.size(), r.beams, what, beamList(list).c_str()), advice);
  };
  look(r.dead_beams, "never give a reading", "nothing to mend; do not count on their directions");
  look(r.silent_beams, "never meet anything", "look whether the lidar is masked there");
  look(r.stuck_beams, "always give the same reading (to 3 cm)",
       "the robot sees itself, or the lidar repeats: mask these beams before mapping");
}

void FindingRules::duplicates() {
  const auto& r = f_.ranges;
  if (r.duplicates == 0) return;
  const bool many = share(r.duplicates, r.scans) > kManyDuplicates;
  say("duplicates", many ? Severity::kWarning : Severity::kNote,
      text("%lu of %lu scans repeat the scan before reading by reading, up to %lu in a row", n(r.duplicates),
           n(r.scans), n(r.longest_duplicate_run)),
      many ? "a real lidar's noise never repeats: a driver polled faster than it measured, or the noise is "
             "off"
           : "");
}

void FindingRules::truth() {
  if (!f_.has_truth) return;
  say("truth", Severity::kNote, "the log carries true poses of the robot",
      "for scoring only: rasterslam filter LOG -o OUT --drop-truth gives a log without");
}

}  // namespace slam::doctor
