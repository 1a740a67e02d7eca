#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "libslam/check/rules.h"
#include "libslam/core/elementary.h"
#include "libslam/core/middle_value.h"
#include "libslam/drafting/door_arcs.h"

namespace slam::check {
namespace {

/// Draws and asks in a door's own directions: u from the hinge through the doorway, v along the leaf.
class DoorFrame {
 public:
  DoorFrame(const drafting::DoorArc& door, const cv::Size& size) : door_(door), size_(size) {}

  cv::Point2d at(double u, double v) const {
    return door_.hinge + u * direction(door_.opening_rad) + v * direction(door_.leaf_rad);
  }
  bool isInk(const cv::Mat& ink, double u, double v) const {
    const cv::Point p = at(u, v);
    return p.x >= 0 && p.y >= 0 && p.x < size_.width && p.y < size_.height && ink.at<std::uint8_t>(p);
  }
  void fill(cv::Mat& mask, double u0, double u1, double v0, double v1) const {
    const std::vector<cv::Point> corners = {at(u0, v0), at(u1, v0), at(u1, v1), at(u0, v1)};
    cv::fillConvexPoly(mask, corners, cv::Scalar(255));
  }

 private:
  static cv::Point2d direction(double angle_rad) { return {core::cos(angle_rad), core::sin(angle_rad)}; }

  const drafting::DoorArc& door_;
  cv::Size size_;
};

/// The usual breadth of the strokes at these places.
template <class PlaceOf>
double strokeBreadth(const cv::Mat& depth, PlaceOf place_of) {
  std::vector<float> depths;
  for (int i = 0; i <= 40; ++i) {
    const cv::Point at = place_of(i / 40.0);
    const cv::Rect around = cv::Rect(at.x - 1, at.y - 1, 3, 3) & cv::Rect({}, depth.size());
    if (around.empty()) continue;
    double most = 0;
    cv::minMaxLoc(depth(around), nullptr, &most);
    if (most > 0) depths.push_back(static_cast<float>(most));
  }
  if (depths.empty()) return 1;
  return 2.0 * core::middleValue(std::move(depths));
}

/// Ink of the arc, of the leaf, and of lines drawn across the doorway parallel to the wall. Ink that is
/// thicker than these strokes are is wall.
cv::Mat inkOfDoor(const drafting::DoorArc& door, const cv::Mat& ink) {
  const DoorFrame frame(door, ink.size());
  const cv::Mat depth = drafting::clearance(ink, false);
  const double r = door.radius;
  const double arc = strokeBreadth(depth, [&](double t) {
    const double angle = 0.2 + 1.1 * t;
    return cv::Point(frame.at(r * core::cos(angle), r * core::sin(angle)));
  });
  const double leaf =
      strokeBreadth(depth, [&](double t) { return cv::Point(frame.at(0, r * (0.2 + 0.6 * t))); });
  const cv::Mat fine = ink & ~drafting::thickStrokes(ink, arc + 2),
                slab = ink & ~drafting::thickStrokes(ink, std::max(arc, leaf) + 2);

  cv::Mat swept(ink.size(), CV_8U, cv::Scalar(0)), leaf_strip = swept.clone(), doorway = swept.clone();
  const auto degrees = [](double angle) { return angle * 180 / CV_PI; };
  double turn = door.leaf_rad - door.opening_rad;
  turn = core::atan2(core::sin(turn), core::cos(turn));
  // From just before the jamb to past the leaf's edge.
  const double first = door.opening_rad + std::copysign(2 / r, turn), last = first + turn * 1.12;
  cv::ellipse(swept, door.hinge, cv::Size2d(r, r), 0, degrees(std::min(first, last)),
              degrees(std::max(first, last)), cv::Scalar(255), static_cast<int>(std::ceil(arc)) + 4);
  frame.fill(leaf_strip, -leaf - 1.5, leaf + 1.5, 1.5, r + 3);
  // Each row of pixels parallel to the wall that is mostly ink is a sill or a face drawn through.
  constexpr double kMargin = 2, kStep = 0.5;
  const int columns = static_cast<int>((r - 2 * kMargin) / kStep);
  for (int row = static_cast<int>(-0.45 * r / kStep); row <= static_cast<int>(0.15 * r / kStep); ++row) {
    const double v = row * kStep;
    int drawn = 0;
    for (int column = 0; column <= columns; ++column) drawn += frame.isInk(fine, kMargin + column * kStep, v);
    if (drawn > 0.7 * (columns + 1)) frame.fill(doorway, kMargin, r - kMargin, v - 0.8, v + 0.8);
  }
  return ((swept | doorway) & fine) | (leaf_strip & slab);
}

/// What is left of strokes that were taken away: specks within the door's sweep.
cv::Mat specksWithin(const drafting::DoorArc& door, const cv::Mat& ink) {
  cv::Mat sweep(ink.size(), CV_8U, cv::Scalar(0));
  cv::circle(sweep, door.hinge, static_cast<int>(door.radius) + 3, cv::Scalar(255), cv::FILLED);
  const cv::Rect area = cv::boundingRect(sweep);
  cv::Mat specks(ink.size(), CV_8U, cv::Scalar(0));
  const drafting::Regions regions = drafting::regionsOf(ink(area), 8);
  std::vector<char> chosen(static_cast<size_t>(regions.count), 0);
  for (int label = 1; label < regions.count; ++label) {
    const cv::Rect box = regions.box(label);
    const bool is_whole = box.x > 0 && box.y > 0 && box.br().x < area.width && box.br().y < area.height;
    chosen[static_cast<size_t>(label)] = is_whole && std::max(box.width, box.height) < 0.35 * door.radius;
  }
  drafting::maskOf(regions, chosen).copyTo(specks(area));
  return specks & sweep;
}

/// What has to be looked at for one door.
cv::Rect surroundings(const drafting::DoorArc& door, const cv::Size& size) {
  const int reach = static_cast<int>(1.5 * door.radius) + 10;
  const cv::Point hinge = door.hinge;
  return cv::Rect(hinge.x - reach, hinge.y - reach, 2 * reach + 1, 2 * reach + 1) & cv::Rect({}, size);
}

std::string range(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::string low = metres(values.front()), high = metres(values.back());
  return low == high ? low : low + " to " + high;
}

}  // namespace

void checkDoors(Sheet& sheet) {
  if (sheet.is_map && !sheet.isAskedFor("doors")) return;
  cv::Mat ink = sheet.mask(world::Cell::kOccupied);
  const std::vector<drafting::DoorArc> doors = doorArcsOf(sheet);
  Finding finding;
  std::vector<double> leaves_m;
  cv::Mat opened(ink.size(), CV_8U, cv::Scalar(0));
  const double usual = drafting::usualRadius(doors);
  for (const drafting::DoorArc& door : doors) {
    // One building's leaves are of a kind; what is far from it is a letter or a curved wall.
    const double leaf_m = door.radius * sheet.resolution_m;
    if (door.radius < 0.6 * usual || door.radius > 1.5 * usual) continue;
    if (leaf_m < 0.6 * sheet.options.door_m || leaf_m > 1.8 * sheet.options.door_m) continue;
    const cv::Rect area = surroundings(door, ink.size());
    drafting::DoorArc local = door;
    local.hinge -= cv::Point2d(area.tl());
    cv::Mat local_ink = ink(area);
    const cv::Mat drawn = inkOfDoor(local, local_ink);
    local_ink.setTo(0, drawn);
    const cv::Mat specks = specksWithin(local, local_ink);
    local_ink.setTo(0, specks);
    opened(area) |= drawn | specks;
    leaves_m.push_back(leaf_m);
    finding.places.push_back(sheet.place(door.hinge));
  }
  if (leaves_m.empty() || sheet.paint(opened, world::Cell::kFree, Change::kOpened) == 0) return;
  finding.key = "doors";
  finding.severity = Severity::kWarning;
  finding.count = static_cast<int>(leaves_m.size());
  finding.text = counted(finding.count, "door is", "doors are") + " drawn as leaf and quarter circle (leaf " +
                 range(leaves_m) + " m), which to a robot is a closed corner" + atPixel(finding.places);
  finding.remedy = "takes away leaf and arc and opens the doorway";
  finding.is_mendable = true;
  sheet.findings.push_back(finding);
}

}  // namespace slam::check
