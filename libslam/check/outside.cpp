#include <opencv2/imgproc.hpp>

#include "libslam/check/rules.h"

namespace slam::check {
namespace {

/// Ink on the far side of the outer wall: pieces that touch nothing inside, and thin lines that stick out.
cv::Mat drawnOutside(const Sheet& sheet, const cv::Mat& inside) {
  const cv::Mat ink = sheet.mask(world::Cell::kOccupied);
  const cv::Mat by_inside = drafting::grown(inside, 1.5);
  const drafting::Regions pieces = drafting::regionsOf(ink, 8);
  std::vector<char> loose = drafting::labelsUnder(pieces, by_inside & ink);
  for (size_t label = 0; label < loose.size(); ++label) loose[label] = label > 0 && !loose[label];
  const double spur = sheet.toPixels(sheet.options.widest_spur_m);
  const cv::Mat far =
      ink & ~drafting::grown(inside, spur + 1) & ~drafting::thickStrokes(ink, std::max(4.0, spur / 4));
  return drafting::maskOf(pieces, loose) | far;
}

/// A building without a closed outline gets one: a frame around all that is drawn.
void frameEverything(Sheet& sheet) {
  const cv::Rect walls = cv::boundingRect(sheet.mask(world::Cell::kOccupied));
  const int margin = static_cast<int>(std::min(sheet.toPixels(1), 4000.0));
  const cv::Rect page(0, 0, sheet.cells.cols, sheet.cells.rows);
  const cv::Rect frame =
      cv::Rect(walls.x - margin, walls.y - margin, walls.width + 2 * margin, walls.height + 2 * margin) &
      page;
  cv::Mat wall(sheet.cells.size(), CV_8U, cv::Scalar(0)), beyond(sheet.cells.size(), CV_8U, cv::Scalar(255));
  cv::rectangle(wall, frame, cv::Scalar(255), 2);
  cv::rectangle(beyond, frame, cv::Scalar(0), cv::FILLED);
  Finding finding;
  finding.key = "outside";
  finding.severity = Severity::kWarning;
  finding.text = "no closed outline: free space reaches the edge of the picture and no room is apart from it";
  finding.remedy = "builds a wall around all that is drawn; what lies beyond becomes unknown";
  finding.is_mendable = true;
  sheet.paint(wall, world::Cell::kOccupied, Change::kAdded);
  sheet.paint(beyond & sheet.mask(world::Cell::kFree), world::Cell::kUnknown, Change::kHidden);
  sheet.findings.push_back(finding);
}

}  // namespace

void checkOutside(Sheet& sheet) {
  if (sheet.is_map && !sheet.isAskedFor("outside")) return;
  const cv::Mat free = sheet.mask(world::Cell::kFree);
  const cv::Mat outside = drafting::reachedFromEdge(free);
  const int paper = cv::countNonZero(outside);
  if (paper == 0) return;
  // Inside is what could be a room; holes of letters and hollow walls are not.
  const drafting::Regions rooms = drafting::regionsOf(free & ~outside, 4);
  std::vector<char> large(static_cast<size_t>(rooms.count), 0);
  const double least = sheet.toPixels(1) * sheet.toPixels(1) * sheet.options.least_room_m2;
  for (int label = 1; label < rooms.count; ++label)
    large[static_cast<size_t>(label)] = rooms.area(label) >= least;
  const cv::Mat inside = drafting::maskOf(rooms, large);
  if (cv::countNonZero(inside) == 0) {
    frameEverything(sheet);
    return;
  }
  const cv::Mat drawn = drawnOutside(sheet, inside);
  const drafting::Regions pieces = drafting::regionsOf(drawn, 8);
  Finding finding;
  finding.key = "outside";
  finding.severity = Severity::kWarning;
  finding.count = pieces.count - 1;
  finding.text =
      "the paper around the walls counts as free space (" + metres(sheet.squareMetres(paper)) + " m2)";
  if (finding.count > 0)
    finding.text += ", and " + counted(finding.count, "piece", "pieces") + " drawn on it as walls";
  finding.remedy = std::string("makes the outside unknown") +
                   (finding.count > 0 ? " and takes away what is drawn there" : "");
  finding.is_mendable = true;
  // What a removed piece enclosed is outside, too.
  sheet.paint(drawn, world::Cell::kUnknown, Change::kRemoved);
  sheet.paint(outside, world::Cell::kUnknown, Change::kHidden);
  sheet.findings.push_back(finding);
}

}  // namespace slam::check
