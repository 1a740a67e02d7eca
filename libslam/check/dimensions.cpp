#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "libslam/check/rules.h"
#include "libslam/core/middle_value.h"
#include "libslam/drafting/lettering.h"

namespace slam::check {
namespace {

/// A horizontal stroke: columns x0 .. x1 about row y.
struct Stroke {
  int x0, x1, y;
};

/// Pixels of a line's end that an arrow head or an oblique tick may take.
int endSize(const cv::Size& size) {
  return std::clamp(std::max(size.width, size.height) / 120, 5, 40);
}

/// Thickness of the ink at a pixel, upwards and downwards.
int thickness(const cv::Mat& ink, int x, int y) {
  int top = y, bottom = y;
  while (top >= 0 && ink.at<std::uint8_t>(top, x)) --top;
  while (bottom < ink.rows && ink.at<std::uint8_t>(bottom, x)) ++bottom;
  return std::max(0, bottom - top - 1);
}

int usualThickness(const cv::Mat& ink, const Stroke& stroke) {
  std::vector<int> all;
  const int length = stroke.x1 - stroke.x0;
  for (int x = stroke.x0 + length / 4; x <= stroke.x1 - length / 4; ++x)
    all.push_back(thickness(ink, x, stroke.y));
  return core::middleValue(std::move(all));
}

/// The decoration of a line's end, an arrow head or an oblique tick: some columns near the end where the ink
/// is broader than the line, and farther in none. A wall that the line ends at is broad in its own columns
/// only. Empty when there is no decoration.
cv::Rect decoration(const cv::Mat& ink, const Stroke& stroke, bool left, int end_size) {
  const auto column = [&](int inwards) { return left ? stroke.x0 + inwards : stroke.x1 - inwards; };
  const int y0 = std::max(0, stroke.y - end_size), y1 = std::min(ink.rows - 1, stroke.y + end_size);
  const auto height = [&](int inwards) {
    int count = 0;
    for (int y = y0; y <= y1; ++y) count += ink.at<std::uint8_t>(y, column(inwards)) != 0;
    return count;
  };
  const int length = stroke.x1 - stroke.x0;
  std::vector<int> line;
  for (int i = length / 4; i <= length * 3 / 4; ++i) line.push_back(height(i));
  const int usual = core::middleValue(std::move(line));
  int broad = 0, plain = 0, last = 0;
  for (int i = 2; i < 3 * end_size; ++i)
    if (height(i) > usual) ++broad, last = i;
  for (int i = 3 * end_size; i < 5 * end_size; ++i) plain += height(i) <= usual;
  if (broad < std::max(2, end_size / 3) || broad > 5 * end_size / 2 || plain < 3 * end_size / 2) return {};
  const int inner = column(last + 1), outer = column(-end_size);
  return cv::Rect(std::min(inner, outer), y0, std::abs(inner - outer) + 1, y1 - y0 + 1) &
         cv::Rect({}, ink.size());
}

/// Horizontal dimension lines: thin, long, decorated at both ends, with a figure beside. 255 on their ink.
cv::Mat horizontalDimensions(const cv::Mat& ink, const cv::Mat& lettering, std::vector<cv::Point>& places) {
  const int end_size = endSize(ink.size());
  const int least_length = std::max(11 * end_size, 30);
  const double broadest = std::max(2.0, 0.002 * std::max(ink.cols, ink.rows));
  cv::Mat runs, uprights, gone(ink.size(), CV_8U, cv::Scalar(0));
  cv::morphologyEx(ink, runs, cv::MORPH_OPEN, cv::Mat::ones(1, least_length, CV_8U));
  cv::morphologyEx(ink, uprights, cv::MORPH_OPEN, cv::Mat::ones(3 * end_size, 1, CV_8U));
  const drafting::Regions regions = drafting::regionsOf(runs, 8);
  cv::Mat walls = runs.clone();
  for (int label = 1; label < regions.count; ++label) {
    const cv::Rect box = regions.box(label);
    if (box.height > broadest) continue;
    // Without the walls that it ends at: their columns are tall.
    Stroke stroke{box.x, box.br().x - 1, box.y + box.height / 2};
    while (stroke.x0 < stroke.x1 && thickness(ink, stroke.x0, stroke.y) > 3 * end_size) ++stroke.x0;
    while (stroke.x0 < stroke.x1 && thickness(ink, stroke.x1, stroke.y) > 3 * end_size) --stroke.x1;
    if (stroke.x1 - stroke.x0 < least_length || usualThickness(ink, stroke) > broadest) continue;
    const cv::Rect left = decoration(ink, stroke, true, end_size),
                   right = decoration(ink, stroke, false, end_size);
    if (left.empty() || right.empty()) continue;
    const int reach = std::clamp(box.width / 3, 15, 8 * end_size);
    const cv::Rect beside =
        cv::Rect(box.x, stroke.y - reach, box.width, 2 * reach) & cv::Rect({}, ink.size());
    if (cv::countNonZero(lettering(beside)) == 0) continue;
    const cv::Rect line(stroke.x0, box.y, stroke.x1 - stroke.x0 + 1, box.height);
    for (const cv::Rect& part : {line, left, right}) cv::rectangle(gone, part, cv::Scalar(255), cv::FILLED);
    walls(box).setTo(0, regions.labels(box) == label);
    places.push_back(box.tl());
  }
  // Walls that the line meets or crosses stay whole: they run on upwards or to the side.
  return gone & ink & ~uprights & ~walls;
}

}  // namespace

void checkDimensions(Sheet& sheet) {
  if (sheet.is_map && !sheet.isAskedFor("dimensions")) return;
  const cv::Mat ink = sheet.mask(world::Cell::kOccupied);
  const drafting::Lettering lettering = drafting::findLettering(ink);
  if (lettering.words.empty()) return;
  Finding finding;
  std::vector<cv::Point> across, upright;
  cv::Mat gone = horizontalDimensions(ink & ~lettering.ink, lettering.ink, across);
  gone |= horizontalDimensions((ink & ~lettering.ink).t(), lettering.ink.t(), upright).t();
  finding.count = static_cast<int>(across.size() + upright.size());
  if (finding.count == 0) return;
  for (const auto& p : across) finding.places.push_back(sheet.place(p));
  for (const auto& p : upright) finding.places.push_back(sheet.place({p.y, p.x}));
  // Extension lines: what is left of the dimension and hangs on nothing.
  const cv::Mat left = ink & ~gone & ~lettering.ink;
  const drafting::Regions pieces = drafting::regionsOf(left, 8);
  const cv::Mat touched = drafting::grown(gone, 2.5) & left;
  std::vector<char> loose = drafting::labelsUnder(pieces, touched);
  for (int label = 1; label < pieces.count; ++label) {
    const cv::Rect box = pieces.box(label);
    const bool is_short_line = std::min(box.width, box.height) <= 5 &&
                               std::max(box.width, box.height) < 0.2 * std::max(ink.cols, ink.rows);
    loose[static_cast<size_t>(label)] = loose[static_cast<size_t>(label)] && is_short_line;
  }
  gone |= drafting::maskOf(pieces, loose);
  finding.key = "dimensions";
  finding.severity = Severity::kWarning;
  finding.text = counted(finding.count, "dimension line", "dimension lines") +
                 " with arrow heads or ticks and a figure beside, to a robot thin walls" +
                 atPixel(finding.places);
  finding.remedy = "takes them away; walls that they cross stay whole";
  finding.is_mendable = true;
  sheet.paint(gone, world::Cell::kFree, Change::kRemoved);
  sheet.findings.push_back(finding);
}

}  // namespace slam::check
