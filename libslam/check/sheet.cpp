#include "libslam/check/sheet.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "libslam/check/lettering.h"

namespace slam::check {

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
  return {pixel.x, pixel.y, reading.T_world_plan * p_plan};
}

bool Sheet::isAskedFor(const std::string& key) const {
  return std::find(options.only.begin(), options.only.end(), key) != options.only.end();
}

cv::Rect Regions::box(int label) const {
  return {stats.at<int>(label, cv::CC_STAT_LEFT), stats.at<int>(label, cv::CC_STAT_TOP),
          stats.at<int>(label, cv::CC_STAT_WIDTH), stats.at<int>(label, cv::CC_STAT_HEIGHT)};
}

cv::Point Regions::anyPixel(int label) const {
  const cv::Rect area = box(label);
  for (int y = area.y; y < area.br().y; ++y)
    for (int x = area.x; x < area.br().x; ++x)
      if (labels.at<int>(y, x) == label) return {x, y};
  return area.tl();
}

Regions regionsOf(const cv::Mat& mask, int connectivity) {
  Regions regions;
  regions.count =
      cv::connectedComponentsWithStats(mask, regions.labels, regions.stats, regions.centroids, connectivity);
  return regions;
}

cv::Mat maskOf(const Regions& regions, const std::vector<char>& chosen) {
  cv::Mat mask(regions.labels.size(), CV_8U);
  for (int y = 0; y < mask.rows; ++y) {
    const int* label = regions.labels.ptr<int>(y);
    auto* out = mask.ptr<std::uint8_t>(y);
    for (int x = 0; x < mask.cols; ++x) out[x] = chosen[static_cast<size_t>(label[x])] ? 255 : 0;
  }
  return mask;
}

std::vector<char> labelsUnder(const Regions& regions, const cv::Mat& mask) {
  std::vector<char> under(static_cast<size_t>(regions.count), 0);
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (mask.at<std::uint8_t>(y, x)) under[static_cast<size_t>(regions.labels.at<int>(y, x))] = 1;
  under[0] = 0;
  return under;
}

cv::Mat reachedFromEdge(const cv::Mat& free) {
  const Regions regions = regionsOf(free, 4);
  cv::Mat edge(free.size(), CV_8U, cv::Scalar(0));
  cv::rectangle(edge, cv::Rect(0, 0, edge.cols, edge.rows), cv::Scalar(255));
  return maskOf(regions, labelsUnder(regions, edge));
}

cv::Mat disc(double radius) {
  const int reach = static_cast<int>(std::floor(radius));
  cv::Mat brush(2 * reach + 1, 2 * reach + 1, CV_8U);
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x)
      brush.at<std::uint8_t>(y + reach, x + reach) = x * x + y * y <= radius * radius;
  return brush;
}

cv::Mat clearance(const cv::Mat& mask, bool edge_counts) {
  cv::Mat padded, distance;
  cv::copyMakeBorder(mask, padded, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(edge_counts ? 0 : 255));
  cv::distanceTransform(padded, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  return distance(cv::Rect(1, 1, mask.cols, mask.rows)).clone();
}

cv::Mat grown(const cv::Mat& mask, double radius) {
  if (cv::countNonZero(mask) == 0) return mask.clone();
  if (radius <= 3) {  // then the brush is faster, and the same
    cv::Mat dilated;
    cv::dilate(mask, dilated, disc(radius));
    return dilated;
  }
  cv::Mat distance;
  cv::distanceTransform(~mask, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  return distance <= radius;
}

cv::Mat thickStrokes(const cv::Mat& ink, double diameter) {
  // A stroke of n cells has its middle (n + 1) / 2 from the paper; the page's edge is no paper.
  const double least = (diameter + 1) / 2;
  const cv::Mat middle = clearance(ink, false) >= least;
  return grown(middle, least - 0.4) & ink;
}

const std::vector<DoorArc>& doorArcsOf(Sheet& sheet) {
  if (!sheet.door_arcs) {
    const auto arcsIn = [](const cv::Mat& ink) { return findDoorArcs(ink & ~findLettering(ink).ink); };
    sheet.door_arcs = arcsIn(sheet.mask(world::Cell::kOccupied));
    // Leaves and arcs are drawn finer than walls, so in a scan they are paler.
    if (!sheet.faint.empty()) addDoorArcs(*sheet.door_arcs, arcsIn(sheet.faint));
  }
  return *sheet.door_arcs;
}

Reach reachOfRobot(const Sheet& sheet) {
  const cv::Mat free = sheet.mask(world::Cell::kFree);
  // Distances are between centres, and a cell reaches half a side towards the robot's centre.
  const double radius = sheet.toPixels(sheet.options.robot_side_m * std::sqrt(0.5));
  const cv::Mat places = clearance(free, true) > radius + 0.5;
  const Regions regions = regionsOf(places, 4);
  Reach reach{cv::Mat(free.size(), CV_8U, cv::Scalar(0)), cv::Mat(free.size(), CV_8U, cv::Scalar(0))};
  int best = 0;
  for (int label = 1; label < regions.count; ++label)
    if (best == 0 || regions.area(label) > regions.area(best)) best = label;
  if (best == 0) return reach;
  std::vector<char> chosen(static_cast<size_t>(regions.count), 0);
  chosen[static_cast<size_t>(best)] = 1;
  // One cell more than the body: what it brushes against counts as covered.
  reach.body = grown(maskOf(regions, chosen), radius + 1) & free;
  for (size_t label = 0; label < chosen.size(); ++label) chosen[label] = label > 0 && !chosen[label];
  reach.pockets = grown(maskOf(regions, chosen), radius + 1) & free & ~reach.body;
  return reach;
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
