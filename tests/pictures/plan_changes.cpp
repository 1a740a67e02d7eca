#include "libslam/pictures/plan_changes.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "libslam/core/error.h"
#include "libslam/draw/canvas.h"
#include "libslam/files/files.h"
#include "libslam/testing/temp_folder.h"

namespace slam::pictures {
namespace {
using check::Change;
using world::Cell;

world::Plan blank(int columns, int rows) {
  world::Plan plan;
  plan.columns = columns;
  plan.rows = rows;
  plan.cells.assign(static_cast<size_t>(columns) * rows, Cell::kFree);
  return plan;
}

/// Pixels of exactly this colour.
int pixelsOf(const std::string& path, draw::Colour colour) {
  const cv::Mat picture = cv::imread(path, cv::IMREAD_COLOR);
  cv::Mat mask;
  const cv::Scalar bgr(colour.blue, colour.green, colour.red);
  cv::inRange(picture, bgr, bgr, mask);
  return cv::countNonZero(mask);
}

TEST(PlanChanges, ShowsWhatGoesOnlyBeforeAndWhatCameInBoth) {
  const testing::TempFolder folder;
  const std::string path = folder / "changes.png";
  world::Plan before = blank(40, 30), after = before;
  std::vector<Change> changes(before.cells.size(), Change::kNone);
  for (size_t i = 0; i < 40; ++i) {
    before.cells[i] = Cell::kOccupied;
    changes[i] = Change::kRemoved;
    after.cells[400 + i] = Cell::kOccupied;
    changes[400 + i] = Change::kClosed;
  }
  drawPlanChanges(before, after, changes, "test", path);
  const int removed = pixelsOf(path, draw::kVermillion), closed = pixelsOf(path, draw::kPurple);
  EXPECT_GT(removed, 100);
  // Both rows are as large; the closed one is drawn twice. The legend's boxes add a little to each.
  EXPECT_NEAR(1.0 * closed / removed, 2, 0.2);
  const std::string first = files::readTextFile(path);
  drawPlanChanges(before, after, changes, "test", path);
  EXPECT_EQ(files::readTextFile(path), first);
}

TEST(PlanChanges, DrawsPlansOfAnyShapeAndRefusesUnlikeOnes) {
  const testing::TempFolder folder;
  const std::string path = folder / "changes.png";
  for (const auto& [columns, rows] : {std::pair(1, 1), std::pair(3000, 2), std::pair(2, 3000)}) {
    const world::Plan plan = blank(columns, rows);
    drawPlanChanges(plan, plan, std::vector<Change>(plan.cells.size()), "shape", path);
    EXPECT_LE(cv::imread(path).cols, 2000);
    EXPECT_GE(cv::imread(path).cols, 600);
    EXPECT_LE(cv::imread(path).rows, 2000);
  }
  EXPECT_THROW(drawPlanChanges(blank(2, 3), blank(3, 2), std::vector<Change>(6), "x", path),
               core::ContractError);
  EXPECT_THROW(drawPlanChanges(blank(2, 3), blank(2, 3), {}, "x", path), core::ContractError);
}

}  // namespace
}  // namespace slam::pictures
