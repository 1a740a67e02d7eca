#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "libslam/world/check/lettering.h"
#include "libslam/world/check/rules.h"

namespace slam::world::check {
namespace {

/// A horizontal stroke: columns x0 .. x1 about row y.
struct Stroke {
  int x0, x1, y;
};

/// Pixels of a line's end that an arrow head or an oblique tick may take.
int endSize(const cv::Size& size) {
  return std::clamp(std::max(size.width, size.height) / 120, 5, 24);
}

/// In the columns of the line's end the ink is broader than the line, and farther in it is not: an arrow head
/// or an oblique tick. A wall that the line ends at is broad in its own columns only.
bool isDecorated(const cv::Mat& thin, const Stroke& stroke, bool left, int end_size) {
  const auto height = [&](int inwards) {
    const int x = left ? stroke.x0 + inwards : stroke.x1 - inwards;
    int count = 0;
    for (int y = std::max(0, stroke.y - end_size); y <= std::min(thin.rows - 1, stroke.y + end_size); ++y)
      count += x >= 0 && x < thin.cols && thin.at<std::uint8_t>(y, x) != 0;
    return count;
  };
  std::vector<int> line;
  for (int i = end_size + 2; i < 3 * end_size + 2; ++i) line.push_back(height(i));
  std::nth_element(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(line.size() / 2), line.end());
  const int usual = line[line.size() / 2];
  int broad = 0, plain = 0;
  for (int i = 1; i <= end_size; ++i) broad += height(i) > usual;
  for (const int h : line) plain += h <= usual;
  // The line's own columns from the second on: a crossing wall as thick as the line fills fewer.
  return broad >= std::max(2, end_size / 3) && plain >= static_cast<int>(line.size()) * 2 / 3;
}

/// Horizontal dimension lines: thin, long, decorated at both ends, with a figure beside.
cv::Mat horizontalDimensions(const cv::Mat& ink, const cv::Mat& lettering, int& count, std::vector<cv::Point>& places) {
  const int end_size = endSize(ink.size());
  const int least_length = std::max(5 * end_size, 30);
  const double broadest = std::max(4.0, 0.0015 * std::max(ink.cols, ink.rows));
  const cv::Mat thin = ink & ~thickStrokes(ink, broadest + 1);
  cv::Mat runs, uprights, gone(ink.size(), CV_8U, cv::Scalar(0));
  cv::morphologyEx(ink, runs, cv::MORPH_OPEN, cv::Mat::ones(1, least_length, CV_8U));
  cv::morphologyEx(ink, uprights, cv::MORPH_OPEN, cv::Mat::ones(2 * end_size, 1, CV_8U));
  const Regions regions = regionsOf(runs, 8);
  for (int label = 1; label < regions.count; ++label) {
    const cv::Rect box = regions.box(label);
    if (box.height > broadest) continue;
    const Stroke stroke{box.x, box.br().x - 1, box.y + box.height / 2};
    if (!isDecorated(ink, stroke, true, end_size) || !isDecorated(ink, stroke, false, end_size)) continue;
    const int reach = std::clamp(box.width / 3, 15, 8 * end_size);
    const cv::Rect beside = cv::Rect(box.x, stroke.y - reach, box.width, 2 * reach) & cv::Rect({}, ink.size());
    if (cv::countNonZero(lettering(beside)) == 0) continue;
    cv::rectangle(gone, box, cv::Scalar(255), cv::FILLED);
    for (const int x : {stroke.x0, stroke.x1}) {
      const cv::Rect end = cv::Rect(x - end_size, stroke.y - end_size, 2 * end_size + 1, 2 * end_size + 1) &
                           cv::Rect({}, ink.size());
      cv::rectangle(gone, end, cv::Scalar(255), cv::FILLED);
    }
    ++count;
    places.push_back(box.tl());
  }
  // Walls that the line meets or crosses stay whole: they are thick, or run on upwards or to the side.
  cv::Mat walls = runs.clone();
  for (int label = 1; label < regions.count; ++label) {
    const cv::Rect box = regions.box(label);
    if (cv::countNonZero(gone(box)) == static_cast<int>(box.area())) walls(box).setTo(0, regions.labels(box) == label);
  }
  return gone & ink & ~uprights & ~walls & (thin | (gone & ~uprights));
}

}  // namespace

void checkDimensions(Sheet& sheet) {
  if (sheet.is_map && !sheet.isAskedFor("dimensions")) return;
  const cv::Mat ink = sheet.mask(Cell::kOccupied);
  const Lettering lettering = findLettering(ink);
  if (lettering.words.empty()) return;
  Finding finding;
  std::vector<cv::Point> across, upright;
  cv::Mat gone = horizontalDimensions(ink & ~lettering.ink, lettering.ink, finding.count, across);
  gone |= horizontalDimensions((ink & ~lettering.ink).t(), lettering.ink.t(), finding.count, upright).t();
  if (finding.count == 0) return;
  for (const auto& p : across) finding.places.push_back(sheet.place(p));
  for (const auto& p : upright) finding.places.push_back(sheet.place({p.y, p.x}));
  // Extension lines: what is left of the dimension and hangs on nothing.
  const cv::Mat left = ink & ~gone & ~lettering.ink;
  const Regions pieces = regionsOf(left, 8);
  const cv::Mat touched = grown(gone, 2.5) & left;
  std::vector<char> loose = labelsUnder(pieces, touched);
  for (int label = 1; label < pieces.count; ++label) {
    const cv::Rect box = pieces.box(label);
    const bool is_short_line = std::min(box.width, box.height) <= 5 &&
                               std::max(box.width, box.height) < 0.2 * std::max(ink.cols, ink.rows);
    loose[static_cast<size_t>(label)] = loose[static_cast<size_t>(label)] && is_short_line;
  }
  gone |= maskOf(pieces, loose);
  finding.key = "dimensions";
  finding.severity = Severity::kWarning;
  finding.text = counted(finding.count, "dimension line", "dimension lines") +
                 " with arrow heads or ticks and a figure beside, to a robot thin walls" + atPixel(finding.places);
  finding.remedy = "takes them away; walls that they cross stay whole";
  finding.is_mendable = true;
  sheet.paint(gone, Cell::kFree, Change::kRemoved);
  sheet.findings.push_back(finding);
}

}  // namespace slam::world::check
