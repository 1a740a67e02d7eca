#include <cmath>
#include <opencv2/imgproc.hpp>

#include "libslam/check/rules.h"

namespace slam::check {
namespace {

/// More than this share of the free space is not hidden: then what keeps the robot out should be mended.
constexpr double kMostHidden = 0.5;

void hide(Sheet& sheet, const cv::Mat& where, Finding finding) {
  finding.key = "isolated";
  if (cv::countNonZero(where) > kMostHidden * cv::countNonZero(sheet.mask(world::Cell::kFree))) {
    finding.severity = Severity::kWarning;
    finding.remedy = "leaves so much as it is: open the doors in the picture, or give a smaller --robot-side";
    sheet.findings.push_back(std::move(finding));
    return;
  }
  finding.is_mendable = true;
  finding.remedy = finding.count == 1 ? "makes it unknown" : "makes them unknown";
  sheet.paint(where, world::Cell::kUnknown, Change::kHidden);
  sheet.findings.push_back(std::move(finding));
}

/// Areas with walls all round, or unknown.
void hideEnclosed(Sheet& sheet, const cv::Mat& body, double least_room) {
  const drafting::Regions areas = drafting::regionsOf(sheet.mask(world::Cell::kFree), 4);
  // A robot would fit into a room; a hollow wall may have the area, but not the width.
  const double radius = sheet.toPixels(sheet.options.robot_side_m * std::sqrt(0.5));
  const std::vector<char> wide =
      drafting::labelsUnder(areas, drafting::clearance(sheet.mask(world::Cell::kFree), true) > radius + 0.5);
  std::vector<char> reached = drafting::labelsUnder(areas, body), rooms(reached.size(), 0),
                    nooks(reached.size(), 0);
  Finding room_finding, nook_finding;
  double rooms_area = 0, nooks_area = 0, largest = 0;
  for (int label = 1; label < areas.count; ++label) {
    if (reached[static_cast<size_t>(label)]) continue;
    const bool is_room = areas.area(label) >= least_room && wide[static_cast<size_t>(label)];
    Finding& finding = is_room ? room_finding : nook_finding;
    (is_room ? rooms : nooks)[static_cast<size_t>(label)] = 1;
    (is_room ? rooms_area : nooks_area) += areas.area(label);
    if (is_room) largest = std::max(largest, 1.0 * areas.area(label));
    ++finding.count;
    if (finding.places.size() < 20) finding.places.push_back(sheet.place(areas.anyPixel(label)));
  }
  if (room_finding.count > 0) {
    room_finding.severity = Severity::kWarning;
    room_finding.text =
        counted(room_finding.count, "room has", "rooms have") + " no way in for the robot (" +
        metres(sheet.squareMetres(rooms_area)) + " m2" +
        (room_finding.count > 1 ? ", the largest " + metres(sheet.squareMetres(largest)) + " m2" : "") + ")" +
        atPixel(room_finding.places);
    hide(sheet, drafting::maskOf(areas, rooms), room_finding);
  }
  if (nook_finding.count > 0) {
    nook_finding.severity = Severity::kNote;
    nook_finding.text = counted(nook_finding.count, "small free area is", "small free areas are") +
                        " closed all round (" + metres(sheet.squareMetres(nooks_area)) +
                        " m2: hollow walls, furniture, specks)" + atPixel(nook_finding.places);
    hide(sheet, drafting::maskOf(areas, nooks), nook_finding);
  }
}

/// Rooms that are open, but too narrowly for the robot.
void hideTooNarrow(Sheet& sheet, const Reach& reach, double least_room) {
  const drafting::Regions connected = drafting::regionsOf(sheet.mask(world::Cell::kFree), 4);
  const cv::Mat open = drafting::maskOf(connected, drafting::labelsUnder(connected, reach.body));
  const drafting::Regions areas = drafting::regionsOf(reach.pockets & open, 4);
  std::vector<char> chosen(static_cast<size_t>(areas.count), 0);
  Finding finding;
  double area = 0;
  for (int label = 1; label < areas.count; ++label) {
    if (areas.area(label) < least_room) continue;
    chosen[static_cast<size_t>(label)] = 1;
    area += areas.area(label);
    ++finding.count;
    if (finding.places.size() < 20) finding.places.push_back(sheet.place(areas.anyPixel(label)));
  }
  if (finding.count == 0) return;
  finding.severity = Severity::kWarning;
  finding.text = counted(finding.count, "room", "rooms") + " (" + metres(sheet.squareMetres(area)) +
                 " m2) can only be reached through gaps too narrow for a robot of side " +
                 metres(sheet.options.robot_side_m) + " m" + atPixel(finding.places);
  hide(sheet, drafting::maskOf(areas, chosen), finding);
}

}  // namespace

void checkIsolated(Sheet& sheet) {
  const Reach reach = reachOfRobot(sheet);
  if (cv::countNonZero(reach.body) == 0) return;  // no robot, no reach: another finding
  const double least_room = sheet.toPixels(1) * sheet.toPixels(1) * sheet.options.least_room_m2;
  hideTooNarrow(sheet, reach, least_room);
  hideEnclosed(sheet, reach.body, least_room);
}

}  // namespace slam::check
