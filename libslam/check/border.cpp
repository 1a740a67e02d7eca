#include <opencv2/imgproc.hpp>

#include "libslam/check/rules.h"

namespace slam::check {
namespace {

/// Share of a side of the box along which the region is drawn, within `depth` pixels of the box's edge.
double sideCoverage(const cv::Mat& piece, int side, int depth) {
  const cv::Rect strips[] = {{0, 0, piece.cols, depth},
                             {0, piece.rows - depth, piece.cols, depth},
                             {0, 0, depth, piece.rows},
                             {piece.cols - depth, 0, depth, piece.rows}};
  cv::Mat most;
  cv::reduce(piece(strips[side]), most, side < 2 ? 0 : 1, cv::REDUCE_MAX);
  return static_cast<double>(cv::countNonZero(most)) / static_cast<double>(most.total());
}

bool framesThePage(const cv::Mat& piece, const cv::Rect& box, const cv::Size& page) {
  if (box.width < 0.8 * page.width || box.height < 0.8 * page.height) return false;
  const int depth = std::max(4, std::min(page.width, page.height) / 100);
  if (box.width <= 4 * depth || box.height <= 4 * depth) return false;
  for (int side = 0; side < 4; ++side)
    if (sideCoverage(piece, side, depth) < 0.95) return false;
  // Little of it lies within: a title block at most.
  const cv::Rect inner(depth, depth, piece.cols - 2 * depth, piece.rows - 2 * depth);
  return cv::countNonZero(piece(inner)) < 0.4 * cv::countNonZero(piece);
}

/// What else is drawn encloses a fair part of the frame, doorways thought shut: the building. Without it the
/// frame may well be the outer wall of a hall with pillars.
bool holdsABuilding(const cv::Mat& ink, const cv::Mat& frame, const cv::Rect& box) {
  const double doorway = 0.04 * std::max(box.width, box.height);
  const cv::Mat walls = drafting::grown((ink & ~frame)(box), doorway / 2);
  return cv::countNonZero(~drafting::reachedFromEdge(~walls) & ~walls) > 0.1 * box.area();
}

}  // namespace

void checkBorder(Sheet& sheet) {
  if (sheet.is_map && !sheet.isAskedFor("border")) return;
  const cv::Mat ink = sheet.mask(world::Cell::kOccupied);
  const drafting::Regions pieces = drafting::regionsOf(ink, 8);
  for (int label = 1; label < pieces.count; ++label) {
    const cv::Rect box = pieces.box(label);
    const cv::Mat piece = pieces.labels(box) == label;
    if (!framesThePage(piece, box, sheet.cells.size()) || !holdsABuilding(ink, pieces.labels == label, box))
      continue;
    Finding finding;
    finding.key = "border";
    finding.severity = Severity::kWarning;
    finding.count = 1;
    finding.text = "a frame is drawn around the page (" + std::to_string(box.width) + " x " +
                   std::to_string(box.height) + " pixels): to a robot a wall around everything";
    finding.remedy = "takes it away, with the lines that hang on it";
    finding.is_mendable = true;
    finding.places.push_back(sheet.place(box.tl()));
    sheet.paint(pieces.labels == label, world::Cell::kFree, Change::kRemoved);
    sheet.findings.push_back(finding);
    return;
  }
}

}  // namespace slam::check
