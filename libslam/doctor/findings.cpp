#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "libslam/core/pose2.h"
#include "libslam/doctor/log_check.h"

namespace slam::doctor {
namespace {

using core::radToDeg;

// Where a rule draws its line.
constexpr double kWrongView = 0.05;    // of the stated field of view; real logs are within 0.02
constexpr double kWrongClock_s = 0.2;  // at half a radian per second this is 6 degrees
constexpr double kWrongDistance = 0.1, kWrongTurn = 0.1;
constexpr double kWrongDrift_rad_per_m = core::degToRad(2.0);
constexpr double kWrongPosition_m = 0.15, kWrongYaw_rad = core::degToRad(3.0);
constexpr double kMostSweep = 1.2, kWrongSweep = 0.1;  // of the time between two scans
constexpr double kImplausibleMount_m = 2;              // a robot indoors is not longer
constexpr double kManyAsReturns = 0.05;
constexpr double kManyDuplicates = 0.01;
constexpr double kManyLost = 0.2, kManyUnmatched = 0.05;
constexpr double kGraveDisagreement_m = 2, kManyDisagreements = 0.01;
constexpr double kLargeStepBack_s = 1;
constexpr const char* kScanKind = "CObservation2DRangeScan";
constexpr double kMillimetres_m = 500;  // median reading; between here and 60 it is centimetres

std::string text(const char* format, ...) __attribute__((format(printf, 1, 2)));
std::string text(const char* format, ...) {
  std::va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  const int length = std::vsnprintf(nullptr, 0, format, arguments);
  va_end(arguments);
  std::string result(static_cast<std::size_t>(std::max(length, 0)) + 1, '\0');
  std::vsnprintf(result.data(), result.size(), format, again);
  va_end(again);
  result.pop_back();
  return result;
}

unsigned long n(std::uint64_t count) {
  return static_cast<unsigned long>(count);
}

double share(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

std::string plural(std::uint64_t count, const char* one, const char* more) {
  return std::to_string(count) + " " + (count == 1 ? one : more);
}

/// "1.003 (0.998 to 1.008)"
std::string shown(const Estimate& e, double factor, int decimals) {
  const double a = std::min(e.low * factor, e.high * factor), b = std::max(e.low * factor, e.high * factor);
  return text("%.*f (%.*f to %.*f)", decimals, e.value * factor, decimals, a, decimals, b);
}

/// "0 to 3, 17 and 170 to 179", shortened after six runs.
std::string beamList(const std::vector<int>& beams) {
  std::string list;
  int runs = 0;
  for (std::size_t i = 0; i < beams.size();) {
    std::size_t last = i;
    while (last + 1 < beams.size() && beams[last + 1] == beams[last] + 1) ++last;
    if (++runs > 6) return list + ", ...";
    list += (list.empty() ? "" : ", ") + std::to_string(beams[i]);
    if (last > i) list += " to " + std::to_string(beams[last]);
    i = last + 1;
  }
  return list;
}

std::string streamName(const StreamFigures& stream) {
  return stream.kind + (stream.label.empty() ? "" : " '" + stream.label + "'");
}

class Rules {
 public:
  explicit Rules(const LogFigures& figures) : f_(figures) {}

  std::vector<Finding> all() {
    format();
    damage();
    skipped();
    scans();
    if (f_.ranges.scans > 0) {
      stamps();
      units();
      geometry();
      noReturns();
      lost();
      beams();
      duplicates();
      if (isInMetres()) {
        matching();
        view();
        sweep();
      }
    }
    odometry();
    if (f_.best_odometry >= 0 && f_.ranges.scans > 0 && isInMetres()) {
      clock();
      scale();
      disagreements();
    }
    if (f_.ranges.scans > 0) mounting();
    truth();
    return std::move(findings_);
  }

 private:
  void say(const char* key, Severity severity, std::string what, std::string advice = "") {
    findings_.push_back({key, severity, std::move(what), std::move(advice)});
  }
  bool isInMetres() const { return f_.ranges.median_m < 60; }
  bool isViewWrong() const { return f_.view.is_observable && f_.view.factor.distanceTo(1) > kWrongView; }

  void format() {
    const char* form = f_.has_frames
                           ? (f_.has_bare_observations ? ", mixed form" : ", action / sensory frame")
                           : (f_.has_bare_observations ? ", observations only" : "");
    say("format", Severity::kNote,
        text("%s%s, %lu objects in %.2f MB, %.1f s from stamp %.3f", f_.format.c_str(), form, n(f_.objects),
             static_cast<double>(f_.file_bytes) / 1e6, f_.last_s - f_.first_s, f_.first_s));
  }

  void damage() {
    if (f_.damage.empty()) return;
    say("damage", Severity::kError, f_.damage,
        "get the log again, or keep what is whole: rasterslam cut LOG -o OUT --salvage");
  }

  void skipped() {
    if (f_.skipped.empty()) return;
    say("skipped", Severity::kNote, "passed over: " + f_.skipped);
  }

  void scans() {
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

  void stamps() {
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
  bool sharesStamps(const StreamFigures& stream) const {
    if (stream.kind == kScanKind) return false;
    return std::any_of(f_.streams.begin(), f_.streams.end(), [&stream](const StreamFigures& other) {
      return other.kind == kScanKind && other.count == stream.count && other.first_s == stream.first_s &&
             other.last_s == stream.last_s && other.backward == stream.backward &&
             other.largest_backward_s == stream.largest_backward_s;
    });
  }

  void units() {
    if (isInMetres()) return;
    const bool millimetres = f_.ranges.median_m > kMillimetres_m;
    say("units", Severity::kError,
        text("half of the readings are beyond %.0f, up to %.0f: these are %s, not metres", f_.ranges.median_m,
             f_.ranges.largest_m, millimetres ? "millimetres" : "centimetres"),
        millimetres ? "divide all ranges and the maximum range by 1000"
                    : "divide all ranges and the maximum range by 100");
  }

  void geometry() {
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

  void noReturns() {
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
          what + text("; %lu of them are given as distances: a map gets walls at %.2f m", n(spike.as_returns),
                      spike.peak_m),
          text("rasterslam filter LOG -o OUT --no-return %.2f", spike.low_m));
  }

  void lost() {
    const auto& r = f_.ranges;
    const std::uint64_t lost = r.zeros + r.not_finite + r.other_invalid;
    if (lost == 0) return;
    say("lost", share(lost, r.readings) > kManyLost ? Severity::kWarning : Severity::kNote,
        text("%lu of %lu readings (%.1f %%) are lost: %lu of 0 or less, %lu not finite, %lu marked invalid",
             n(lost), n(r.readings), 100 * share(lost, r.readings), n(r.zeros), n(r.not_finite),
             n(r.other_invalid)),
        share(lost, r.readings) > kManyLost ? "look at the lidar: glass, sun, or a dirty window" : "");
  }

  void beams() {
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

  void duplicates() {
    const auto& r = f_.ranges;
    if (r.duplicates == 0) return;
    const bool many = share(r.duplicates, r.scans) > kManyDuplicates;
    say("duplicates", many ? Severity::kWarning : Severity::kNote,
        text("%lu of %lu scans repeat the scan before reading by reading, up to %lu in a row",
             n(r.duplicates), n(r.scans), n(r.longest_duplicate_run)),
        many ? "a real lidar's noise never repeats: a driver polled faster than it measured, or the noise is "
               "off"
             : "");
  }

  void matching() {
    const auto pairs = f_.matched_pairs + f_.unmatched_pairs;
    if (pairs == 0) return;
    const bool many = share(f_.unmatched_pairs, pairs) > kManyUnmatched;
    if (f_.unmatched_pairs > 0)
      say("matching", many ? Severity::kWarning : Severity::kNote,
          text("%lu of %lu scans fit nowhere on the scan before (first after %.3f); %lu more leave a "
               "direction open",
               n(f_.unmatched_pairs), n(pairs), f_.first_unmatched_s, n(f_.unsure_pairs)),
          many ? "scans too far apart, of two places, or of a wrong field of view" : "");
    else
      say("matching", Severity::kNote,
          text("all of %lu scans fit on the scan before; %lu leave a direction open, as a corridor does",
               n(pairs), n(f_.unsure_pairs)));
  }

  void view() {
    const auto& r = f_.ranges;
    const auto& v = f_.view;
    const double stated_deg = radToDeg(r.aperture_rad);
    if (!v.is_observable) {
      say("view", Severity::kNote,
          text("field of view %.2f deg: not checked, %zu pairs of scans half a metre apart%s", stated_deg,
               v.pairs, v.pairs < 20 ? " are too few" : " do not tell"));
      return;
    }
    const std::string evidence =
        text("%zu pairs of scans half a metre apart lie best on one another over %s times that, %.1f deg",
             v.pairs, shown(v.factor, 1, 3).c_str(), stated_deg * v.factor.value);
    if (!isViewWrong()) {
      say("view", Severity::kNote, text("field of view %.2f deg; ", stated_deg) + evidence);
      return;
    }
    const double step_deg = stated_deg / std::max(r.beams - 1, 1) * v.factor.value;
    double nearest_deg = step_deg;
    for (const double usual_deg :
         {0.1, 0.125, 0.2, 0.225, 0.25, 1.0 / 3, 0.36, 0.5, 0.6, 0.72, 1.0, 1.5, 2.0})
      if (std::abs(usual_deg - step_deg) < 0.03 * step_deg &&
          (nearest_deg == step_deg || std::abs(usual_deg - step_deg) < std::abs(nearest_deg - step_deg)))
        nearest_deg = usual_deg;
    say("view", Severity::kError,
        text("field of view %.2f deg is wrong: ", stated_deg) + evidence +
            "; what follows from matching scans is wrong too",
        text("rasterslam filter LOG -o OUT --step %.4g (degrees between two readings)", nearest_deg));
  }

  static std::string sweepText(const Estimate& e) {
    const bool is_clockwise = e.value < 0;
    return shown(e, is_clockwise ? -1 : 1, 3) + " s" + (is_clockwise ? ", clockwise" : "");
  }

  void sweep() {
    const auto& fit = f_.sweep;
    std::string stated = "the log does not state how long a sweep takes";
    double stated_s = 0;
    if (const auto& sweep = f_.stated_sweep) {
      stated_s = sweep->clockwise ? -sweep->duration_s : sweep->duration_s;
      stated = text("the log states a sweep of %.3f s%s", sweep->duration_s,
                    sweep->clockwise ? ", clockwise" : "");
    }
    const double period_s = scanPeriod();
    if (f_.stated_sweep && period_s > 0 && f_.stated_sweep->duration_s > kMostSweep * period_s) {
      say("sweep", Severity::kWarning,
          stated + text(", longer than the %.3f s between two scans: it is not believed", period_s),
          "tell the methods how long it takes: --set method.sweep_s=SECONDS");
      return;
    }
    if (!fit.is_observable) {
      say("sweep", Severity::kNote,
          stated + text("; not checked, %zu pairs of scans between which the turning changes%s", fit.pairs,
                        fit.pairs < 8 ? " are too few" : " do not tell"));
      return;
    }
    const std::string evidence = text("%zu changes of turning show ", fit.pairs) + sweepText(fit.duration_s);
    const bool is_wrong = fit.duration_s.distanceTo(stated_s) > 0 &&
                          std::abs(fit.duration_s.value - stated_s) > kWrongSweep * period_s;
    if (!is_wrong) {
      say("sweep", Severity::kNote, stated + "; " + evidence);
      return;
    }
    say("sweep", Severity::kWarning, stated + ", but " + evidence + ": scans taken on the move are skewed",
        text("rasterslam run METHOD LOG --set method.sweep_s=%.3f%s", std::abs(fit.duration_s.value),
             fit.duration_s.value < 0 ? " --set method.sweep_clockwise=true" : ""));
  }

  double scanPeriod() const {
    for (const auto& stream : f_.streams)
      if (stream.kind == kScanKind && stream.label == f_.lidar) return stream.median_period_s;
    return 0;
  }

  void odometry() {
    if (f_.odometry.empty()) {
      say("odometry", f_.ranges.scans > 0 ? Severity::kNote : Severity::kWarning, "none",
          "scan matching replaces it: rasterslam run works, MRPT's rbpf-slam needs actions (rasterslam "
          "convert)");
      return;
    }
    for (const auto& o : f_.odometry) {
      say("odometry", Severity::kNote,
          text("'%s': %lu readings, %.1f m, %.1f full turns", o.stream.c_str(), n(o.readings), o.path_m,
               o.turned_rad / (2 * core::kPi)));
      if (o.jumps > 0)
        say("jumps", Severity::kWarning,
            text("'%s': %lu steps too far for a robot, the largest %.2f m at %.3f", o.stream.c_str(),
                 n(o.jumps), o.largest_jump_m, o.largest_jump_at_s),
            "the odometer was set back, or readings are missing: cut the log there, or map without odometry");
      if (o.path_m == 0 && o.turned_rad == 0 && o.readings > 20)
        say("odometry", Severity::kWarning, text("'%s' never moves", o.stream.c_str()),
            "a robot at rest, or wheels that nobody reads");
    }
  }

  const OdometryFigures& best() const { return f_.odometry[static_cast<std::size_t>(f_.best_odometry)]; }

  void clock() {
    for (const auto& o : f_.odometry) {
      const auto& c = o.clock;
      if (!c.is_observable) {
        say("clock", Severity::kNote,
            text("'%s' against the scans: cannot be told (%.1f rad of turns, correlation %.2f)",
                 o.stream.c_str(), c.turned_rad, c.correlation));
        continue;
      }
      const bool is_wrong = std::min(std::abs(c.offset_s.low), std::abs(c.offset_s.high)) > kWrongClock_s &&
                            c.offset_s.distanceTo(0) > 0;
      const char* who = c.offset_s.value >= 0 ? "leads" : "lags behind";
      const double sign = c.offset_s.value >= 0 ? 1 : -1;
      say("clock", is_wrong ? Severity::kWarning : Severity::kNote,
          text("'%s' %s the scans by %s s: the turns correlate with %.2f, unshifted with %.2f",
               o.stream.c_str(), who, shown(c.offset_s, sign, 3).c_str(), c.correlation,
               c.correlation_at_zero),
          is_wrong ? shiftAdvice(o) : "");
    }
  }

  static std::string shiftAdvice(const OdometryFigures& odometry) {
    if (odometry.stream == kActionStream)
      return "increments in actions have no label to shift: rasterslam convert to observations, then shift "
             "these";
    return text("rasterslam filter LOG -o OUT --shift '%s=%.3f'", odometry.stream.c_str(),
                odometry.clock.offset_s.value);
  }

  void scale() {
    const auto& fit = f_.fit;
    if (!fit.has_path && !fit.has_turns) {
      say("scale", Severity::kNote,
          text("odometry against scan matching: cannot be told (%zu pieces, %.1f m, %.1f rad)", fit.windows,
               fit.path_m, fit.turned_rad));
      return;
    }
    if (fit.has_path) {
      const double wrong = fit.distance_scale.distanceTo(1);
      std::string advice;
      if (fit.distance_scale.value > 500)
        advice = "the odometry is in millimetres: divide by 1000";
      else if (fit.distance_scale.value > 50)
        advice = "the odometry is in centimetres: divide by 100";
      else if (wrong > kWrongDistance)
        advice = "calibrate the wheels, or widen the motion model by as much";
      say("scale", wrong > kWrongDistance ? Severity::kWarning : Severity::kNote,
          text("'%s' measures %s times the distance that scan matching does, over %.0f m in %zu pieces",
               best().stream.c_str(), shown(fit.distance_scale, 1, 3).c_str(), fit.path_m, fit.windows),
          advice);
    }
    const bool is_turn_wrong = fit.has_turns && fit.turn_scale.distanceTo(1) > kWrongTurn;
    const bool is_drift_wrong = fit.has_path && fit.drift_rad_per_m.distanceTo(0) > kWrongDrift_rad_per_m;
    std::string what;
    if (fit.has_turns) what = text("it turns %s times as far", shown(fit.turn_scale, 1, 3).c_str());
    if (fit.has_path)
      what += (what.empty() ? "it drifts by " : " and drifts by ") +
              shown(fit.drift_rad_per_m, 180 / core::kPi, 2) + " deg per metre";
    std::string advice;
    if (fit.has_turns && fit.turn_scale.value > 40 && fit.turn_scale.value < 80)
      advice = "its heading is in degrees: radians are expected";
    else if (is_turn_wrong || is_drift_wrong)
      advice = "do not trust its heading: a method that matches every scan, or a wider motion model";
    say("heading", is_turn_wrong || is_drift_wrong ? Severity::kWarning : Severity::kNote, what, advice);
  }

  void disagreements() {
    if (f_.disagreements == 0) return;
    const bool is_grave = f_.largest_disagreement_m > kGraveDisagreement_m ||
                          share(f_.disagreements, f_.matched_pairs) > kManyDisagreements;
    say("disagree", is_grave ? Severity::kWarning : Severity::kNote,
        text("%lu steps where scans and '%s' differ by half a metre or half a radian, the largest by %.2f m "
             "and "
             "%.1f deg at %.3f",
             n(f_.disagreements), best().stream.c_str(), f_.largest_disagreement_m,
             radToDeg(f_.largest_disagreement_rad), f_.largest_disagreement_at_s),
        "the robot was lifted or slipped, or one of the two streams is broken there: look at that place");
  }

  void mounting() {
    const auto& m = f_.ranges.T_robot_lidar;
    std::string what = text("x %.3f m, y %.3f m, yaw %.2f deg, as the log says", m.x, m.y, radToDeg(m.phi));
    if (f_.ranges.mount_tilt_rad > core::degToRad(1.0))
      say("mounting", Severity::kWarning,
          text("the lidar is tilted by %.1f deg", radToDeg(f_.ranges.mount_tilt_rad)),
          "a planar map takes it as level: expect floors and ceilings as walls");
    if (std::hypot(m.x, m.y) > kImplausibleMount_m) {
      say("mounting", Severity::kWarning, what + ": far from a robot's centre",
          "check the unit and the sign");
      return;
    }
    const auto& fit = f_.fit;
    if (f_.best_odometry < 0 || !fit.has_position || !fit.has_path || isViewWrong()) {
      say("mounting", Severity::kNote, what + "; the log cannot tell (it needs odometry, turns and driving)");
      return;
    }
    what += text("; turns show x %s m, y %s m, driving yaw %s deg", shown(fit.lidar_x_m, 1, 3).c_str(),
                 shown(fit.lidar_y_m, 1, 3).c_str(), shown(fit.lidar_yaw_rad, 180 / core::kPi, 2).c_str());
    const bool is_place_wrong =
        std::hypot(fit.lidar_x_m.distanceTo(m.x), fit.lidar_y_m.distanceTo(m.y)) > kWrongPosition_m;
    const double yaw_error = std::abs(core::wrapToPi(fit.lidar_yaw_rad.value - m.phi));
    const bool is_yaw_wrong = yaw_error - fit.lidar_yaw_rad.width() / 2 > kWrongYaw_rad;
    if (!is_place_wrong && !is_yaw_wrong) {
      say("mounting", Severity::kNote, what);
      return;
    }
    say("mounting", Severity::kWarning, what,
        text("measure it on the robot, then: rasterslam filter LOG -o OUT --mount X,Y,DEG (the log suggests "
             "%.2f,%.2f,%.1f)",
             fit.lidar_x_m.value, fit.lidar_y_m.value, radToDeg(fit.lidar_yaw_rad.value)));
  }

  void truth() {
    if (!f_.has_truth) return;
    say("truth", Severity::kNote, "the log carries true poses of the robot",
        "for scoring only: rasterslam filter LOG -o OUT --drop-truth gives a log without");
  }

  const LogFigures& f_;
  std::vector<Finding> findings_;
};

}  // namespace

std::string severityName(Severity severity) {
  return severity == Severity::kNote ? "note" : severity == Severity::kWarning ? "warning" : "error";
}

const std::vector<FindingKey>& findingKeys() {
  static const std::vector<FindingKey> keys = {
      {"format", "what kind of log it is"},
      {"damage", "where it breaks off"},
      {"skipped", "what the reader passes over"},
      {"scans", "no laser scans, or scans of no use"},
      {"backward", "stamps earlier than the one before, per stream"},
      {"repeated", "stamps equal to the one before, per stream"},
      {"gaps", "pauses of more than ten periods, per stream"},
      {"unstamped", "scans without a stamp"},
      {"order", "objects of different streams out of order"},
      {"units", "ranges that are not in metres"},
      {"lidar", "beams, field of view, ranges; whether they change"},
      {"no_return", "the reading of a beam that meets nothing, found from the data"},
      {"lost", "readings that are none"},
      {"beams", "beams that are dead, silent or stuck"},
      {"duplicates", "scans that repeat the one before"},
      {"matching", "scans that do not fit on the one before"},
      {"view", "the field of view, by how well scans lie on one another"},
      {"sweep", "how long the lidar takes from its first to its last beam, as turns show it"},
      {"odometry", "what there is"},
      {"jumps", "odometry steps too far for a robot"},
      {"clock", "odometry's stamps against those of the scans"},
      {"scale", "odometry's distances against scan matching"},
      {"heading", "odometry's turns and drift against scan matching"},
      {"disagree", "places where odometry and scans contradict one another"},
      {"mounting", "the lidar's pose on the robot, and what turns say of it"},
      {"truth", "true poses inside the log"}};
  return keys;
}

std::vector<Finding> findingsOf(const LogFigures& figures) {
  return Rules(figures).all();
}

}  // namespace slam::doctor
