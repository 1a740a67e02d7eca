#include "libslam/drafting/door_arcs.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "libslam/core/elementary.h"
#include "libslam/drafting/regions.h"

namespace slam::drafting {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kMostPixels = 1600;  ///< larger pictures are looked at smaller: their leaves are long enough
constexpr double kLeastRadius = 11, kMostRadius = 160;
constexpr double kThinLine = 5;  ///< pixels; arcs and leaves are no thicker

bool isInk(const cv::Mat& ink, const cv::Point2d& p) {
  if (!(p.x >= 0 && p.y >= 0)) return false;
  const int x = cvRound(p.x), y = cvRound(p.y);
  return x < ink.cols && y < ink.rows && ink.at<std::uint8_t>(y, x);
}

cv::Point2d along(double angle_rad) {
  return {core::cos(angle_rad), core::sin(angle_rad)};
}

/// A thin line's point and the direction across it.
struct LinePoint {
  cv::Point2f at, normal;
};

std::vector<LinePoint> linePoints(const cv::Mat& ink) {
  cv::Mat thin = ink & ~thickStrokes(ink, kThinLine + 0.5), smooth, tensor;
  cv::GaussianBlur(thin, smooth, {}, 1.0);
  cv::cornerEigenValsAndVecs(smooth, tensor, 7, 3);
  std::vector<LinePoint> points;
  for (int y = 0; y < thin.rows; ++y)
    for (int x = 0; x < thin.cols; ++x) {
      if (!thin.at<std::uint8_t>(y, x)) continue;
      const auto& e = tensor.at<cv::Vec6f>(y, x);
      // The eigenvector of the larger value: brightness changes along it.
      const bool first = e[0] >= e[1];
      const float large = first ? e[0] : e[1], little = first ? e[1] : e[0];
      if (large < 3 * little) continue;
      points.push_back({cv::Point2f(static_cast<float>(x), static_cast<float>(y)),
                        first ? cv::Point2f(e[2], e[3]) : cv::Point2f(e[4], e[5])});
    }
  return points;
}

/// Where the normals of a quarter circle's worth of points meet at this radius. The votes' directions tell a
/// quarter from a straight line and from a full circle: the mean of exp(2 i angle) has length 1 for a line,
/// sin(x) / x with x = pi / 2 for a quarter, 0 for a half or a whole.
std::vector<cv::Point2d> centresAt(const std::vector<LinePoint>& points, double radius, cv::Size size) {
  constexpr int kBin = 2;
  cv::Mat votes(size.height / kBin + 1, size.width / kBin + 1, CV_32FC3, cv::Scalar::all(0));
  for (const auto& p : points) {
    // The doubled angle is the same for the normal and its opposite.
    const float cosine = p.normal.x * p.normal.x - p.normal.y * p.normal.y,
                sine = 2 * p.normal.x * p.normal.y;
    for (const float side : {-1.0F, 1.0F}) {
      const cv::Point2f c = p.at + p.normal * (side * static_cast<float>(radius));
      if (c.x >= 0 && c.y >= 0 && c.x < static_cast<float>(size.width) &&
          c.y < static_cast<float>(size.height))
        votes.at<cv::Vec3f>(static_cast<int>(c.y) / kBin, static_cast<int>(c.x) / kBin) +=
            cv::Vec3f(1, cosine, sine);
    }
  }
  cv::Mat sums, counts, highest;
  cv::boxFilter(votes, sums, CV_32F, {3, 3}, {-1, -1}, false);
  cv::extractChannel(sums, counts, 0);
  cv::dilate(counts, highest, cv::Mat::ones(3, 3, CV_8U));
  const auto least = static_cast<float>(0.8 * radius);
  std::vector<cv::Point2d> centres;
  for (int y = 0; y < sums.rows; ++y)
    for (int x = 0; x < sums.cols; ++x) {
      const cv::Vec3f& v = sums.at<cv::Vec3f>(y, x);
      if (v[0] < least || v[0] < highest.at<float>(y, x)) continue;
      const auto spread = static_cast<float>(core::hypot(v[1], v[2]) / v[0]);
      if (spread > 0.35F && spread < 0.85F) centres.emplace_back(kBin * x, kBin * y);
    }
  return centres;
}

/// The longest piece of a circle that is drawn.
struct Run {
  double middle_rad = 0, length_rad = 0;
};

/// The pixels of circles about a pixel, by radius in halves.
class Rings {
 public:
  explicit Rings(double most_radius) : rings_(static_cast<size_t>(2 * most_radius) + 2) {
    for (size_t i = 0; i < rings_.size(); ++i) {
      const double radius = 0.5 * static_cast<double>(i);
      const int steps = std::max(48, static_cast<int>(2 * kPi * radius));
      for (int k = 0; k < steps; ++k) rings_[i].emplace_back(radius * along(2 * kPi * k / steps));
    }
  }
  const std::vector<cv::Point>& at(double radius) const {
    return rings_[std::min(rings_.size() - 1, static_cast<size_t>(cvRound(2 * radius)))];
  }

 private:
  std::vector<std::vector<cv::Point>> rings_;
};

/// Nothing where less than a sixth of every fourth pixel is drawn.
Run longestRun(const cv::Mat& ink, const cv::Point& centre, const std::vector<cv::Point>& ring) {
  const auto isDrawn = [&](size_t i) {
    const cv::Point p = centre + ring[i];
    return p.x >= 0 && p.y >= 0 && p.x < ink.cols && p.y < ink.rows && ink.at<std::uint8_t>(p) != 0;
  };
  const size_t steps = ring.size();
  size_t drawn = 0;
  for (size_t i = 0; i < steps; i += 4) drawn += isDrawn(i);
  if (24 * drawn < steps) return {};
  if (4 * drawn + 4 > steps) {
    size_t i = 0;
    while (i < steps && isDrawn(i)) ++i;
    if (i == steps) return {0, 2 * kPi};
  }
  size_t best = 0, best_end = 0, length = 0;
  for (size_t i = 0; i < 2 * steps; ++i) {
    length = isDrawn(i < steps ? i : i - steps) ? length + 1 : 0;
    if (length > best) best = length, best_end = i;
  }
  const double step_rad = 2 * kPi / static_cast<double>(steps);
  return {step_rad * (static_cast<double>(best_end) - 0.5 * (static_cast<double>(best) - 1)),
          step_rad * static_cast<double>(best)};
}

double coverage(const cv::Mat& ink, const cv::Point2d& from, double angle_rad, double near, double far) {
  const int steps = std::max(3, static_cast<int>(std::abs(far - near)));
  int drawn = 0;
  for (int i = 0; i <= steps; ++i)
    drawn += isInk(ink, from + (near + (far - near) * i / steps) * along(angle_rad));
  return static_cast<double>(drawn) / (steps + 1);
}

/// The picture, and the same with its lines one and three pixels broader all round: a candidate may be off a
/// little.
struct Ink {
  cv::Mat exact, broad, broadest;
};

struct Candidate {
  DoorArc door;
  double quality = 0;
};

/// How well a line is drawn from the hinge in about this direction; turns the angle to where it is drawn
/// best.
double leafCoverage(const Ink& ink, const cv::Point2d& hinge, double radius, double& angle_rad) {
  double best = -1, best_drawn = 0, best_angle = angle_rad;
  for (int turn = -6; turn <= 6; ++turn) {
    const double angle = angle_rad + turn * (2 * kPi / 180);
    const double drawn = coverage(ink.broad, hinge, angle, 0.15 * radius, 0.92 * radius);
    // Many directions cover the broad line; the exact one tells which goes along it.
    const double value = drawn + 0.5 * coverage(ink.exact, hinge, angle, 0.15 * radius, 0.92 * radius);
    const bool is_nearer = std::abs(angle - angle_rad) < std::abs(best_angle - angle_rad);
    if (value > best + 1e-9 || (value > best - 1e-9 && is_nearer))
      best = value, best_drawn = drawn, best_angle = angle;
  }
  angle_rad = best_angle;
  return best_drawn;
}

/// How much the direction looks like a wall with a doorway from the hinge on: ink behind the hinge and beyond
/// the doorway, up to 3 pixels beside the line.
double wallAround(const Ink& ink, const cv::Point2d& hinge, double radius, double angle_rad) {
  constexpr double kMargin = 3;
  double behind = 0, beyond = 0;
  for (int shift = -3; shift <= 3; ++shift) {
    const cv::Point2d from = hinge + shift * along(angle_rad + kPi / 2);
    behind = std::max(behind, coverage(ink.exact, from, angle_rad, -0.35 * radius - kMargin, -kMargin));
    beyond =
        std::max(beyond, coverage(ink.exact, from, angle_rad, radius + kMargin, 1.35 * radius + kMargin));
  }
  return behind + beyond;
}

/// The middle of a quarter circle from what is drawn of it. What touches its ends makes it longer, so where
/// the drawn run holds the quarter between two of the picture's axes, it is taken for that one.
double middleOf(const Run& run) {
  const double diagonal = (std::round(run.middle_rad / (kPi / 2) - 0.5) + 0.5) * (kPi / 2);
  const bool holds_quarter = std::abs(run.middle_rad - diagonal) + kPi / 4 - 0.1 < run.length_rad / 2;
  return holds_quarter ? diagonal : run.middle_rad;
}

/// How much of the exact circle is drawn, 40 degrees to both sides of a direction.
double arcCoverage(const Ink& ink, const cv::Point2d& centre, double radius, double middle_rad) {
  const int steps = static_cast<int>(radius * 1.4);
  int drawn = 0;
  for (int i = 0; i <= steps; ++i)
    drawn +=
        isInk(ink.exact, centre + radius * along(middle_rad + 1.4 * (static_cast<double>(i) / steps - 0.5)));
  return static_cast<double>(drawn) / (steps + 1);
}

/// The best quarter circle near by; quality 0 when there is none. leaf_rad is its middle.
Candidate bestQuarter(const Ink& ink, const Rings& rings, const Candidate& start, int reach, int step) {
  Candidate best;
  for (int dr = -reach; dr <= reach; dr += step)
    for (int dy = -reach; dy <= reach; dy += step)
      for (int dx = -reach; dx <= reach; dx += step) {
        DoorArc arc = start.door;
        arc.hinge += cv::Point2d(dx, dy);
        arc.radius += dr;
        const Run run = longestRun(ink.broad, arc.hinge, rings.at(arc.radius));
        // A quarter, less what a hole may take and more by what the breadth of leaf and jamb adds.
        if (run.length_rad < 1.2 || run.length_rad > kPi / 2 + 6 / arc.radius + 0.15) continue;
        arc.leaf_rad = middleOf(run);
        const double drawn = arcCoverage(ink, arc.hinge, arc.radius, arc.leaf_rad);
        const double quality =
            drawn + 0.3 * std::min(run.length_rad, kPi / 2) - 0.01 * (std::abs(dx) + std::abs(dy));
        if (drawn > 0.5 && quality > best.quality) best = {arc, quality};
      }
  return best;
}

/// The sector between leaf and arc is empty floor.
bool isSwept(const Ink& ink, const DoorArc& arc, double middle_rad) {
  int drawn = 0, asked = 0;
  for (int i = 0; i <= 5; ++i)
    for (int k = -6; k <= 6; ++k, ++asked)
      drawn += isInk(ink.exact, arc.hinge + (0.35 + 0.1 * i) * arc.radius * along(middle_rad + 0.1 * k));
  return drawn < 0.08 * asked;
}

/// Most walls run along the picture's axes: an angle that nearly does is taken to do so.
double alongTheAxes(double angle_rad) {
  const double axis = std::round(angle_rad / (kPi / 2)) * (kPi / 2);
  return std::abs(angle_rad - axis) < 6 * kPi / 180 ? axis : angle_rad;
}

/// A first glance: a quarter of the broadened circle or somewhat more is drawn.
bool mayBeADoor(const Ink& ink, const Rings& rings, const cv::Point2d& centre, double radius) {
  const double length = longestRun(ink.broadest, centre, rings.at(radius)).length_rad;
  return length > 1.2 && length < 4;
}

/// Quality 0: no door.
Candidate examine(const Ink& ink, const Rings& rings, const cv::Point2d& centre, double radius) {
  if (!mayBeADoor(ink, rings, centre, radius)) return {};
  Candidate start;
  start.door.hinge = centre;
  start.door.radius = radius;
  Candidate best = bestQuarter(ink, rings, start, 2, 2);
  if (best.quality > 0) best = bestQuarter(ink, rings, best, 1, 1);
  if (best.quality <= 0) return {};
  DoorArc& door = best.door;
  const double middle = door.leaf_rad;
  if (!isSwept(ink, door, middle)) return {};
  double one = middle - kPi / 4, other = middle + kPi / 4;
  const double leaf_one = leafCoverage(ink, door.hinge, door.radius, one);
  const double leaf_other = leafCoverage(ink, door.hinge, door.radius, other);
  one = alongTheAxes(one), other = alongTheAxes(other);
  const double walls_one = wallAround(ink, door.hinge, door.radius, one);
  const double walls_other = wallAround(ink, door.hinge, door.radius, other);
  const bool one_is_leaf =
      std::abs(walls_one - walls_other) > 0.3 ? walls_one < walls_other : leaf_one > leaf_other;
  if ((one_is_leaf ? leaf_one : leaf_other) < 0.85) return {};
  if (std::max(walls_one, walls_other) < 0.5) return {};
  door.leaf_rad = one_is_leaf ? one : other;
  door.opening_rad = door.leaf_rad + (one_is_leaf ? kPi / 2 : -kPi / 2);
  best.quality += one_is_leaf ? leaf_one : leaf_other;
  return best;
}

/// An angle's deviation from another, up to right angles.
double offSquare(double angle_rad, double other_rad) {
  return std::abs(std::remainder(angle_rad - other_rad, kPi / 2));
}

/// The walls of a building stand at right angles; what stands athwart most doors is a letter or a curve.
void keepTheSquare(std::vector<DoorArc>& doors) {
  constexpr double kSquare = 8 * kPi / 180;
  long most = 0;
  double usual = 0;
  for (const DoorArc& door : doors) {
    const auto count = std::count_if(doors.begin(), doors.end(), [&](const DoorArc& other) {
      return offSquare(door.leaf_rad, other.leaf_rad) < kSquare;
    });
    if (count > most) most = count, usual = door.leaf_rad;
  }
  doors.erase(std::remove_if(doors.begin(), doors.end(),
                             [&](const DoorArc& door) { return offSquare(door.leaf_rad, usual) >= kSquare; }),
              doors.end());
}

/// Doors hang on walls: what is drawn at the hinge reaches far beyond the leaf. A stool between chairs does
/// not.
void keepThoseOnWalls(const cv::Mat& ink, std::vector<Candidate>& candidates) {
  const Regions pieces = regionsOf(ink, 8);
  const auto hangsOnAWall = [&](const DoorArc& door) {
    for (int y = -2; y <= 2; ++y)
      for (int x = -2; x <= 2; ++x) {
        const cv::Point at = cv::Point(door.hinge) + cv::Point(x, y);
        if (!isInk(ink, at)) continue;
        const cv::Rect box = pieces.box(pieces.labels.at<int>(at));
        if (std::max(box.width, box.height) >= 3 * door.radius) return true;
      }
    return false;
  };
  candidates.erase(std::remove_if(candidates.begin(), candidates.end(),
                                  [&](const Candidate& c) { return !hangsOnAWall(c.door); }),
                   candidates.end());
}

bool isSame(const DoorArc& a, const DoorArc& b) {
  // The arcs' middles; hinges of two doors may share a post.
  const auto middle = [](const DoorArc& d) {
    return d.hinge + std::sqrt(0.5) * d.radius * (along(d.leaf_rad) + along(d.opening_rad));
  };
  return cv::norm(middle(a) - middle(b)) < 0.4 * std::max(a.radius, b.radius);
}

void addApart(std::vector<DoorArc>& doors, const DoorArc& door) {
  if (std::none_of(doors.begin(), doors.end(), [&](const DoorArc& d) { return isSame(d, door); }))
    doors.push_back(door);
}

/// In halves of pixels, so close that a circle between two is found by its neighbours.
std::vector<double> radiiUpTo(double most) {
  std::vector<double> radii = {kLeastRadius};
  while (radii.back() <= most)
    radii.push_back(std::max(radii.back() + 1.5, std::round(2.08 * radii.back()) / 2));
  radii.pop_back();
  return radii;
}

}  // namespace

std::vector<DoorArc> findDoorArcs(const cv::Mat& full_ink) {
  const int longest = std::max(full_ink.cols, full_ink.rows);
  const int scale = (longest + kMostPixels - 1) / kMostPixels;
  Ink ink;
  ink.exact = full_ink;
  if (scale > 1) {
    cv::resize(full_ink, ink.exact, {}, 1.0 / scale, 1.0 / scale, cv::INTER_AREA);
    ink.exact = ink.exact > 60;
  }
  if (ink.exact.rows < 2 * kLeastRadius || ink.exact.cols < 2 * kLeastRadius) return {};
  cv::dilate(ink.exact, ink.broad, cv::Mat::ones(3, 3, CV_8U));
  cv::dilate(ink.exact, ink.broadest, cv::Mat::ones(7, 7, CV_8U));
  const std::vector<LinePoint> points = linePoints(ink.exact);
  const double most = std::min(kMostRadius, 0.2 * std::max(ink.exact.cols, ink.exact.rows));
  const Rings rings(most + 4);
  std::vector<Candidate> candidates;
  for (const double radius : radiiUpTo(most))
    for (const auto& centre : centresAt(points, radius, ink.exact.size())) {
      const Candidate candidate = examine(ink, rings, centre, radius);
      if (candidate.quality > 0 && candidate.door.radius >= kLeastRadius) candidates.push_back(candidate);
    }
  keepThoseOnWalls(ink.broad, candidates);
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.quality > b.quality; });
  std::vector<DoorArc> doors;
  for (const auto& candidate : candidates) addApart(doors, candidate.door);
  keepTheSquare(doors);
  for (auto& door : doors) {
    door.hinge = (door.hinge + cv::Point2d(0.5, 0.5)) * scale - cv::Point2d(0.5, 0.5);
    door.radius *= scale;
  }
  return doors;
}

double usualRadius(const std::vector<DoorArc>& doors) {
  std::vector<double> best;
  for (const DoorArc& middle : doors) {
    std::vector<double> near;
    for (const DoorArc& door : doors)
      if (std::abs(door.radius - middle.radius) <= 0.15 * middle.radius) near.push_back(door.radius);
    std::sort(near.begin(), near.end());
    const bool is_better = near.size() > best.size() ||
                           (near.size() == best.size() && near[near.size() / 2] > best[best.size() / 2]);
    if (is_better) best = near;
  }
  return best.empty() ? 0 : best[best.size() / 2];
}

void addDoorArcs(std::vector<DoorArc>& doors, const std::vector<DoorArc>& more) {
  std::vector<DoorArc> all = doors;
  all.insert(all.end(), more.begin(), more.end());
  const double usual = usualRadius(all);
  for (const DoorArc& door : more)
    if (std::abs(door.radius - usual) <= 0.25 * usual) addApart(doors, door);
}

}  // namespace slam::drafting
