#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "libslam/odometry/methods.h"
#include "libslam/odometry/profile_correlation.h"

namespace slam::odometry {
namespace {

/// The scan as the original document sees it: index 0 straight ahead of the robot, indices growing
/// counter-clockwise, N of them to the full circle. Beams outside a partial field of view do not exist.
class OriginalScan {
 public:
  explicit OriginalScan(const lidar::Scan& scan)
      : scan_(scan),
        circle_(std::lround(2 * core::kPi / scan.step_rad)),
        ahead_(std::lround((-scan.T_robot_lidar.phi - scan.first_angle_rad) / scan.step_rad)) {}

  long circle() const { return circle_; }

  bool hasBeam(long index) const { return beam(index) < scan_.ranges_m.size(); }

  /// Reading at an index; lost where there is no such beam.
  float at(long index) const { return hasBeam(index) ? scan_.ranges_m[beam(index)] : lidar::kLostReading; }

  /// Index of the largest range; of equal ones the first. A no-return is the largest range there is.
  std::optional<long> longest() const {
    std::optional<long> best;
    float best_range = 0;
    for (long i = 0; i < circle_; ++i) {
      const float range = at(i);
      if (!(range > best_range)) continue;  // also skips lost readings: NaN compares false
      best = i;
      best_range = range;
    }
    return best;
  }

 private:
  size_t beam(long index) const {
    return static_cast<size_t>((((ahead_ + index) % circle_) + circle_) % circle_);
  }

  const lidar::Scan& scan_;
  long circle_, ahead_;
};

/// As the document has it: an index that went on by half the circle or more came the other way round, so
/// exactly half a turn changes its sign.
long wrapIndex(long shift, long circle) {
  if (2 * shift >= circle) return shift - circle;
  return 2 * shift <= -circle ? shift + circle : shift;
}

std::optional<double> difference(float before, float after) {
  if (!lidar::isReturn(before) || !lidar::isReturn(after)) return std::nullopt;
  return static_cast<double>(before) - static_cast<double>(after);
}

/// The original method: a turn is the shift of the longest range, a move the change of the readings straight
/// ahead and straight behind. Nothing else of the scan is used. The lidar is taken to sit on the robot's
/// axis, as in the document; of its mounting pose only the heading counts.
///
/// The document's robot scans before and after every command and knows which one it was. So the motion is
/// that between the scan before the command and this one, however many scans were taken during it; a scan in
/// between says how far the command has come. Every reading is a difference of what two scans show, so those
/// from scan to scan would add up to the same, but only where every scan in between has the readings: here
/// one without them moves nothing, and the next with them makes up for it. What is given is the increment
/// since the scan before: those of a command compose to the motion of the whole. A robot that was told
/// nothing stood.
///
/// argmax_blind, and argmax where the caller does not say (kUnknown), guesses from scan to scan: a longest
/// range that moved by at least one beam means a turn, anything else a move.
///
/// The document takes two move readings and leaves open how they become one step; here the step is the mean
/// of front and minus rear, or the one that exists (front only for lidars that do not look back).
///
/// The document has no arcs. Here the turn of one is read as any turn, and front and rear along its chord,
/// which lies half the turn beside the heading before it and as much on the other side of the heading after
/// it.
class ArgmaxOdometry : public ScanOdometry {
 public:
  explicit ArgmaxOdometry(const ScanOdometryOptions& options) : options_(options) {}

  void reset() override { before_.reset(), previous_.reset(); }

  ScanMotion update(const lidar::Scan& scan, const Commanded& commanded) override {
    requireUsable(scan);
    const Commanded told = options_.method == "argmax_blind" ? Commanded() : commanded;
    const std::optional<lidar::Scan> previous = std::exchange(previous_, scan);
    if (!previous || told.kind == MotionKind::kRest) {
      before_.reset();
      return noMotionYet();
    }
    if (!told.continues || !before_) {
      before_ = previous;
      so_far_ = {};
    }
    ScanMotion motion = sinceCommand(scan, told.kind);
    const core::Pose2 T_before_previous = so_far_.T_previous_current;
    if (hasReading(motion))
      so_far_ = motion;
    else
      keepReadings(so_far_, motion);
    motion.T_previous_current = core::between(T_before_previous, so_far_.T_previous_current);
    return motion;
  }

 private:
  static bool hasReading(const ScanMotion& motion) {
    return motion.reliable || motion.front_reading_m != 0 || motion.rear_reading_m != 0;
  }

  /// What the command had come to when there was last a reading.
  static void keepReadings(const ScanMotion& so_far, ScanMotion& motion) {
    motion.turn_reading_rad = so_far.turn_reading_rad;
    motion.rear_reading_m = so_far.rear_reading_m;
    motion.front_reading_m = so_far.front_reading_m;
  }

  /// From the scan before the command to this one.
  ScanMotion sinceCommand(const lidar::Scan& scan, MotionKind kind) const {
    if (!sameBeams(*before_, scan)) return unknownMotion(options_);
    const OriginalScan before(*before_), after(scan);
    const std::optional<long> longest_before = before.longest(), longest_after = after.longest();
    const bool comparable = longest_before && longest_after;
    const long shift = comparable ? wrapIndex(*longest_before - *longest_after, before.circle()) : 0;
    if (kind == MotionKind::kMove || (kind == MotionKind::kUnknown && shift == 0))
      return move(before, after, 0, scan);
    if (!comparable) return unknownMotion(options_);
    return kind == MotionKind::kArc ? move(before, after, shift, scan)
                                    : turn(static_cast<double>(shift) * scan.step_rad, scan);
  }

  ScanMotion turn(double angle_rad, const lidar::Scan& scan) const {
    ScanMotion motion;
    motion.turn_reading_rad = angle_rad;
    motion.T_previous_current.phi = core::wrapToPi(angle_rad);
    setCovariance(motion, scan, 1);
    return motion;
  }

  /// A move while the robot turned by `shift` beams, 0 for a pure one.
  ScanMotion move(const OriginalScan& before, const OriginalScan& after, long shift,
                  const lidar::Scan& scan) const {
    const long behind = before.circle() / 2, chord = shift / 2;
    const auto front = difference(before.at(chord), after.at(chord - shift));
    const auto rear = difference(before.at(chord + behind), after.at(chord - shift + behind));
    if (!front && !rear) return unknownMotion(options_);
    ScanMotion motion;
    motion.turn_reading_rad = static_cast<double>(shift) * scan.step_rad;
    motion.front_reading_m = front.value_or(0);
    motion.rear_reading_m = rear.value_or(0);
    const double step_m = front && rear ? (*front - *rear) / 2 : (front ? *front : -*rear);
    const core::Pose2 half_turn{0, 0, motion.turn_reading_rad / 2};
    motion.T_previous_current =
        shift == 0 ? core::Pose2{step_m, 0, 0} : half_turn * core::Pose2{step_m, 0, 0} * half_turn;
    motion.reliable = front && (rear || !after.hasBeam(behind));
    setCovariance(motion, scan, front && rear ? 2 : 1);
    return motion;
  }

  /// What quantisation and range noise alone explain. The method's real errors are blunders, for which no
  /// covariance stands.
  static void setCovariance(ScanMotion& motion, const lidar::Scan& scan, int readings) {
    const double sigma = std::max(scan.range_sigma_m, 0.001);
    // Two indices, each uniform over one beam: 2 step^2 / 12.
    motion.covariance[8] = scan.step_rad * scan.step_rad / 6;
    // Two ranges in each reading, averaged over the readings.
    motion.covariance[0] = motion.covariance[4] = 2 * sigma * sigma / readings;
  }

  ScanOdometryOptions options_;
  std::optional<lidar::Scan> before_, previous_;  ///< before_: the command that is under way
  ScanMotion so_far_;                             ///< from before_, as it was read last
};

}  // namespace

std::unique_ptr<ScanOdometry> makeArgmaxOdometry(const ScanOdometryOptions& options) {
  return std::make_unique<ArgmaxOdometry>(options);
}

}  // namespace slam::odometry
