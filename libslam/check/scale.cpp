#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "libslam/check/rules.h"
#include "libslam/core/elementary.h"
#include "libslam/drafting/door_arcs.h"
#include "libslam/drafting/passages.h"

namespace slam::check {
namespace {

/// Clear widths of doors in dwellings and offices, a little wider on both sides than usual leaves of 0.7 to
/// 1.0 m; ours.
constexpr double kLeastDoor_m = 0.65, kMostDoor_m = 1.15;
/// What no door is, unless for vehicles.
constexpr double kNoDoor_m = 0.4;
constexpr double kLeastBuilding_m = 1.5, kMostBuilding_m = 1000;

/// What the drawing says of its scale.
struct Evidence {
  double door_pixels = 0;  ///< 0: nothing to go by
  std::string text;
};

Evidence evidenceOf(Sheet& sheet) {
  const cv::Mat ink = sheet.mask(world::Cell::kOccupied);
  if (!sheet.is_map) {
    const std::vector<drafting::DoorArc> doors = doorArcsOf(sheet);
    if (!doors.empty()) {
      const double usual = drafting::usualRadius(doors);
      return {usual, counted(static_cast<int>(doors.size()), "door leaf", "door leaves") + " of about " +
                         std::to_string(std::lround(usual)) + " pixels"};
    }
  }
  std::vector<double> widths;
  const double least_area = 0.0005 * static_cast<double>(ink.total());
  // A few pixels are too coarse to tell a door by.
  for (const drafting::Passage& passage :
       drafting::findPassages(sheet.mask(world::Cell::kFree), least_area).passages)
    if (passage.width >= 4) widths.push_back(passage.width);
  if (widths.size() < 3) return {};
  // Widths that agree are doors; a spread is a crowd of unlike gaps.
  std::sort(widths.begin(), widths.end());
  const double low = widths[widths.size() / 4], high = widths[widths.size() * 3 / 4];
  if (high > 1.5 * low) return {};
  return {widths[widths.size() / 2], std::to_string(widths.size()) + " passages of about " +
                                         std::to_string(std::lround(widths[widths.size() / 2])) + " pixels"};
}

std::string resolutionText(double resolution_m) {
  return files::formatNumber(resolution_m) + " m a pixel";
}

/// To two digits: more would say more than a door knows.
double rounded(double resolution_m) {
  const double unit = core::powerOfTen(static_cast<int>(std::floor(core::log10(resolution_m))) - 1);
  return std::round(resolution_m / unit) / std::round(1 / unit);
}

}  // namespace

void checkScale(Sheet& sheet) {
  const Evidence evidence = evidenceOf(sheet);
  const double door_m = evidence.door_pixels * sheet.resolution_m;
  const cv::Rect walls = cv::boundingRect(sheet.mask(world::Cell::kOccupied));
  const double side_m = std::max(walls.width, walls.height) * sheet.resolution_m;
  Finding finding;
  finding.key = "scale";
  const std::string by_doors =
      evidence.door_pixels > 0 ? evidence.text + " would be " + metres(door_m) + " m" : "";

  if (sheet.has_scale) {
    const bool doors_absurd = evidence.door_pixels > 0 && door_m < kNoDoor_m;
    const bool size_absurd = side_m < kLeastBuilding_m || side_m > kMostBuilding_m;
    if (!doors_absurd && !size_absurd) return;
    finding.severity = Severity::kError;
    finding.text = "the scale of " + resolutionText(sheet.resolution_m) + " is implausible: ";
    finding.text += doors_absurd ? by_doors : "the walls would span " + metres(side_m) + " m";
    finding.remedy = "keeps what was given";
    if (evidence.door_pixels > 0)
      finding.remedy += "; doors of " + metres(sheet.options.door_m) + " m give --resolution " +
                        files::formatNumber(rounded(sheet.options.door_m / evidence.door_pixels));
    sheet.findings.push_back(finding);
    return;
  }

  finding.severity = Severity::kWarning;
  finding.is_mendable = true;
  finding.text = "no yaml says the scale; " + resolutionText(sheet.resolution_m) + " is assumed";
  if (evidence.door_pixels <= 0) {
    finding.text += ", nothing in the picture tells: the walls would span " + metres(side_m) + " m";
    finding.remedy =
        "writes a yaml with " + resolutionText(sheet.resolution_m) + "; give --resolution to say better";
    if (side_m < kLeastBuilding_m || side_m > kMostBuilding_m) finding.severity = Severity::kError;
  } else if (door_m >= kLeastDoor_m && door_m <= kMostDoor_m) {
    finding.text += ", and plausible: " + by_doors;
    finding.remedy = "writes a yaml with " + resolutionText(sheet.resolution_m);
  } else {
    finding.text += ", but " + by_doors;
    sheet.resolution_m = rounded(sheet.options.door_m / evidence.door_pixels);
    finding.remedy = "writes a yaml with " + resolutionText(sheet.resolution_m) + ", so that they are " +
                     metres(evidence.door_pixels * sheet.resolution_m) + " m and the walls span " +
                     metres(std::max(walls.width, walls.height) * sheet.resolution_m) +
                     " m; give --resolution to say better";
  }
  sheet.findings.push_back(finding);
}

}  // namespace slam::check
