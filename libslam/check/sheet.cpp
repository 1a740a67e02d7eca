#include "libslam/check/sheet.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "libslam/drafting/lettering.h"

namespace slam::check {
namespace {

constexpr double kWidestGap_m = 4;

/// What the paper reaches where no gap of the walls up to kWidestGap_m lets it through: from beyond the
/// picture's edge over cells that far from every wall, and back to the walls from there.
cv::Mat paperAround(const Sheet& sheet, const cv::Mat& drawn) {
  const cv::Mat walls = drawn == static_cast<int>(world::Cell::kOccupied);
  const double radius = std::min(sheet.toPixels(kWidestGap_m / 2), 4000.0);
  const int margin = static_cast<int>(std::ceil(radius)) + 2;
  cv::Mat page;
  cv::copyMakeBorder(walls, page, margin, margin, margin, margin, cv::BORDER_CONSTANT, cv::Scalar(0));
  const cv::Mat reached = drafting::reachedFromEdge(~drafting::grown(page, radius));
  return drafting::grown(reached, radius)(cv::Rect(margin, margin, walls.cols, walls.rows)).clone();
}

}  // namespace

int Sheet::paint(const cv::Mat& where, world::Cell cell, Change change) {
  const cv::Mat differs = where & (cells != static_cast<int>(cell));
  cells.setTo(static_cast<int>(cell), differs);
  // What was taken away and is then outside stays shown as taken away.
  const cv::Mat is_told = change == Change::kHidden ? cv::Mat(changes == static_cast<int>(Change::kRemoved))
                                                    : cv::Mat(cells.size(), CV_8U, cv::Scalar(0));
  changes.setTo(static_cast<int>(change), differs & ~is_told);
  return cv::countNonZero(differs);
}

FindingPlace Sheet::place(const cv::Point& pixel) const {
  const core::Point2 p_plan{(pixel.x + 0.5) * resolution_m, (cells.rows - pixel.y - 0.5) * resolution_m};
  return {pixel.x, pixel.y, reading.T_frame_raster * p_plan};
}

bool Sheet::isAskedFor(const std::string& key) const {
  return std::find(options.only.begin(), options.only.end(), key) != options.only.end();
}

const std::vector<drafting::DoorArc>& doorArcsOf(Sheet& sheet) {
  if (!sheet.door_arcs) {
    const auto arcsIn = [](const cv::Mat& ink) {
      return drafting::findDoorArcs(ink & ~drafting::findLettering(ink).ink);
    };
    sheet.door_arcs = arcsIn(sheet.mask(world::Cell::kOccupied));
    // Leaves and arcs are drawn finer than walls, so in a scan they are paler.
    if (!sheet.faint.empty()) drafting::addDoorArcs(*sheet.door_arcs, arcsIn(sheet.faint));
  }
  return *sheet.door_arcs;
}

Reach reachOfRobot(const Sheet& sheet) {
  const cv::Mat free = sheet.mask(world::Cell::kFree);
  // Distances are between centres, and a cell reaches half a side towards the robot's centre.
  const double radius = sheet.toPixels(sheet.options.robot_side_m * std::sqrt(0.5));
  const cv::Mat places = drafting::clearance(free, true) > radius + 0.5;
  const drafting::Regions regions = drafting::regionsOf(places, 4);
  Reach reach{cv::Mat(free.size(), CV_8U, cv::Scalar(0)), cv::Mat(free.size(), CV_8U, cv::Scalar(0))};
  int best = 0;
  for (int label = 1; label < regions.count; ++label)
    if (best == 0 || regions.area(label) > regions.area(best)) best = label;
  if (best == 0) return reach;
  std::vector<char> chosen(static_cast<size_t>(regions.count), 0);
  chosen[static_cast<size_t>(best)] = 1;
  // One cell more than the body: what it brushes against counts as covered.
  reach.body = drafting::grown(drafting::maskOf(regions, chosen), radius + 1) & free;
  for (size_t label = 0; label < chosen.size(); ++label) chosen[label] = label > 0 && !chosen[label];
  reach.pockets = drafting::grown(drafting::maskOf(regions, chosen), radius + 1) & free & ~reach.body;
  return reach;
}

HiddenSpace hiddenSpace(const Sheet& sheet, const cv::Mat& before, const cv::Mat& drawn) {
  cv::Mat amid = before == static_cast<int>(world::Cell::kFree);
  if (!sheet.is_map) amid &= ~paperAround(sheet, drawn);
  return {cv::countNonZero(amid), cv::countNonZero(amid & sheet.mask(world::Cell::kUnknown))};
}

std::string metres(double value) {
  char text[32];
  const double size = std::abs(value);
  std::snprintf(text, sizeof text, size >= 100 ? "%.0f" : size >= 3 ? "%.1f" : "%.2f", value);
  return text;
}

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, share > 0 && share < 0.0995 ? "%.1f %%" : "%.0f %%", 100 * share);
  return text;
}

std::string counted(int count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string atPixel(const std::vector<FindingPlace>& places) {
  if (places.empty()) return "";
  const FindingPlace& first = places.front();
  return (places.size() > 1 ? ", the first at pixel (" : " at pixel (") + std::to_string(first.x) + ", " +
         std::to_string(first.y) + ") = (" + metres(first.p_world.x) + ", " + metres(first.p_world.y) + ") m";
}

}  // namespace slam::check
