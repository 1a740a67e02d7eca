#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/pose2.h"
#include "libslam/doctor/finding_rules.h"
#include "libslam/doctor/finding_text.h"

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
constexpr double kManyUnmatched = 0.05;
constexpr double kGraveDisagreement_m = 2, kManyDisagreements = 0.01;
constexpr const char* kScanKind = "CObservation2DRangeScan";

}  // namespace

bool FindingRules::isViewWrong() const {
  return f_.view.is_observable && f_.view.factor.distanceTo(1) > kWrongView;
}

void FindingRules::matching() {
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

void FindingRules::view() {
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
  for (const double usual_deg : {0.1, 0.125, 0.2, 0.225, 0.25, 1.0 / 3, 0.36, 0.5, 0.6, 0.72, 1.0, 1.5, 2.0})
    if (std::abs(usual_deg - step_deg) < 0.03 * step_deg &&
        (nearest_deg == step_deg || std::abs(usual_deg - step_deg) < std::abs(nearest_deg - step_deg)))
      nearest_deg = usual_deg;
  say("view", Severity::kError,
      text("field of view %.2f deg is wrong: ", stated_deg) + evidence +
          "; what follows from matching scans is wrong too",
      text("rasterslam filter LOG -o OUT --step %.4g (degrees between two readings)", nearest_deg));
}

std::string FindingRules::sweepText(const calibration::Estimate& e) {
  const bool is_clockwise = e.value < 0;
  return shown(e, is_clockwise ? -1 : 1, 3) + " s" + (is_clockwise ? ", clockwise" : "");
}

void FindingRules::sweep() {
  const auto& fit = f_.sweep;
  std::string stated = "the log does not state how long a sweep takes";
  double stated_s = 0;
  if (const auto& sweep = f_.stated_sweep) {
    stated_s = sweep->clockwise ? -sweep->duration_s : sweep->duration_s;
    stated =
        text("the log states a sweep of %.3f s%s", sweep->duration_s, sweep->clockwise ? ", clockwise" : "");
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

double FindingRules::scanPeriod() const {
  for (const auto& stream : f_.streams)
    if (stream.kind == kScanKind && stream.label == f_.lidar) return stream.median_period_s;
  return 0;
}

void FindingRules::odometry() {
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

const calibration::OdometryFigures& FindingRules::best() const {
  return f_.odometry[static_cast<std::size_t>(f_.best_odometry)];
}

void FindingRules::clock() {
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
             o.stream.c_str(), who, shown(c.offset_s, sign, 3).c_str(), c.correlation, c.correlation_at_zero),
        is_wrong ? shiftAdvice(o) : "");
  }
}

std::string FindingRules::shiftAdvice(const calibration::OdometryFigures& odometry) {
  if (odometry.stream == calibration::kActionStream)
    return "increments in actions have no label to shift: rasterslam convert to observations, then shift "
           "these";
  return text("rasterslam filter LOG -o OUT --shift '%s=%.3f'", odometry.stream.c_str(),
              odometry.clock.offset_s.value);
}

void FindingRules::scale() {
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

void FindingRules::disagreements() {
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

void FindingRules::mounting() {
  const auto& m = f_.ranges.T_robot_lidar;
  std::string what = text("x %.3f m, y %.3f m, yaw %.2f deg, as the log says", m.x, m.y, radToDeg(m.phi));
  if (f_.ranges.mount_tilt_rad > core::degToRad(1.0))
    say("mounting", Severity::kWarning,
        text("the lidar is tilted by %.1f deg", radToDeg(f_.ranges.mount_tilt_rad)),
        "a planar map takes it as level: expect floors and ceilings as walls");
  if (core::hypot(m.x, m.y) > kImplausibleMount_m) {
    say("mounting", Severity::kWarning, what + ": far from a robot's centre", "check the unit and the sign");
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
      core::hypot(fit.lidar_x_m.distanceTo(m.x), fit.lidar_y_m.distanceTo(m.y)) > kWrongPosition_m;
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

}  // namespace slam::doctor
