#pragma once
#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "libslam/check/plan_check.h"
#include "libslam/testing/temp_folder.h"
#include "tests/check/architect_plan.h"

namespace slam::check {

/// Pictures in memory, checked as files.
class PlanChecks : public ::testing::Test {
 protected:
  std::string write(const cv::Mat& picture, const std::string& name = "plan.png") const {
    cv::imwrite(folder_ / name, picture);
    return folder_ / name;
  }
  /// A yaml beside a picture.
  std::string write(const cv::Mat& picture, double resolution_m,
                    const std::string& free_thresh = "0.196") const {
    write(picture);
    std::ofstream(folder_ / "plan.yaml")
        << "image: plan.png\nresolution: " << resolution_m
        << "\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: " << free_thresh << "\n";
    return folder_ / "plan.yaml";
  }
  static PlanCheckOptions only(std::vector<std::string> keys, double resolution_m = 0) {
    PlanCheckOptions options;
    options.only = std::move(keys);
    if (resolution_m > 0) options.resolution_m = resolution_m;
    return options;
  }
  static PlanCheckOptions at(double resolution_m) { return only({}, resolution_m); }
  /// The mended plan after one more look at it.
  PlanCheck again(const PlanCheck& check, PlanCheckOptions options) const {
    world::savePlan(check.after, folder_ / "again.yaml");
    options.resolution_m.reset();
    return checkPlan(folder_ / "again.yaml", options);
  }

  testing::TempFolder folder_;
};

/// Two rooms of 6 x 9 m side by side; an opening of `outer_px` in the left one's outer wall, one of 1.5 m
/// between them. 5 cm.
inline cv::Mat twoRooms(int outer_px) {
  cv::Mat picture(240, 320, CV_8U, cv::Scalar(255));
  cv::rectangle(picture, cv::Rect(30, 20, 250, 190), cv::Scalar(0), cv::FILLED);
  cv::rectangle(picture, cv::Rect(34, 24, 119, 182), cv::Scalar(255), cv::FILLED);
  cv::rectangle(picture, cv::Rect(157, 24, 119, 182), cv::Scalar(255), cv::FILLED);
  cv::rectangle(picture, cv::Rect(153, 60, 4, 30), cv::Scalar(255), cv::FILLED);
  if (outer_px > 0) cv::rectangle(picture, cv::Rect(30, 100, 4, outer_px), cv::Scalar(255), cv::FILLED);
  return picture;
}

inline const Finding* find(const PlanCheck& check, const std::string& key) {
  for (const Finding& finding : check.findings)
    if (finding.key == key) return &finding;
  return nullptr;
}
inline std::string keysOf(const PlanCheck& check) {
  std::string keys;
  for (const Finding& finding : check.findings) keys += (keys.empty() ? "" : " ") + finding.key;
  return keys;
}
/// 255 where the plan has such cells, as the picture lies.
inline cv::Mat maskOf(const world::Plan& plan, world::Cell cell) {
  cv::Mat mask(plan.rows, plan.columns, CV_8U);
  for (int row = 0; row < plan.rows; ++row)
    for (int column = 0; column < plan.columns; ++column)
      mask.at<std::uint8_t>(plan.rows - 1 - row, column) = plan.at(column, row) == cell ? 255 : 0;
  return mask;
}
inline int different(const cv::Mat& a, const cv::Mat& b) {
  return cv::countNonZero(a != b);
}
inline cv::Mat paper(int columns, int rows) {
  return {rows, columns, CV_8U, cv::Scalar(255)};
}
inline void box(cv::Mat& sheet, int x0, int y0, int x1, int y1, int gray, int thickness = cv::FILLED) {
  cv::rectangle(sheet, cv::Point(x0, y0), cv::Point(x1 - 1, y1 - 1), cv::Scalar(gray), thickness);
}
/// A room of 120 x 100 pixels in walls of 5 pixels on white paper, at 0.05 m a pixel 6 x 5 m.
inline cv::Mat roomOnPaper() {
  cv::Mat sheet = paper(200, 180);
  box(sheet, 35, 35, 165, 145, 0);
  box(sheet, 40, 40, 160, 140, 255);
  return sheet;
}
/// The middles of the architect's rooms that a disc of 0.283 m (the circle around the usual robot) reaches
/// from where it starts; clearances between cell centres, so half a cell on the safe side.
inline int roomsReached(const world::Plan& plan, const ArchitectPlan& drawn) {
  const auto start = world::findStartPose(plan, 0.283);
  if (!start) return 0;
  cv::Mat clearance, places;
  cv::distanceTransform(~maskOf(plan, world::Cell::kOccupied), clearance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  places = (clearance > 0.283 / plan.resolution_m + 0.5) & maskOf(plan, world::Cell::kFree);
  cv::Mat labels;
  cv::connectedComponents(places, labels, 4);
  const core::Point2 cell = world::pointToCells(plan, core::position(*start));
  const int home = labels.at<int>(plan.rows - 1 - static_cast<int>(cell.y), static_cast<int>(cell.x));
  int reached = 0;
  for (const auto& middle : ArchitectPlan::roomMiddles())
    reached += home > 0 && labels.at<int>(drawn.pixel(middle)) == home;
  return reached;
}

}  // namespace slam::check
