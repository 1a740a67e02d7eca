#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "libslam/check/rules.h"

namespace slam::check {
namespace {

/// A line one pixel wide that lies between two columns of the raster colours both, and the darker one at
/// least half: a little below a half it stays one piece, and a gap of a pixel stays a gap.
constexpr double kCut = 0.42;
/// A line half a pixel wide, or one that a scan has smoothed over two, is drawn from here on.
constexpr double kFaint = 0.2;
/// Paper whose brightness varies by more than this is lit unevenly.
constexpr double kUneven = 0.12;

/// 0 white .. 1 black, as the reading rule sees it.
cv::Mat darknessOf(const Sheet& sheet) {
  cv::Mat darkness(sheet.cells.size(), CV_32F);
  for (int y = 0; y < darkness.rows; ++y) {
    const std::uint16_t* gray = sheet.picture.gray.data() + static_cast<size_t>(y) * darkness.cols;
    auto* out = darkness.ptr<float>(y);
    for (int x = 0; x < darkness.cols; ++x)
      out[x] = static_cast<float>(sheet.reading.negate ? gray[x] : 65535 - gray[x]) / 65535.0F;
  }
  return darkness;
}

/// The brightness of the paper around each pixel, as darkness, from the brightest of the neighbourhood.
cv::Mat paperAround(const cv::Mat& darkness) {
  const int step = std::max(1, std::max(darkness.cols, darkness.rows) / 400);
  cv::Mat small, paper;
  cv::resize(darkness, small, {}, 1.0 / step, 1.0 / step, cv::INTER_AREA);
  cv::erode(small, small, cv::Mat::ones(25, 25, CV_8U));
  cv::GaussianBlur(small, small, {}, 12);
  cv::resize(small, paper, darkness.size(), 0, 0, cv::INTER_LINEAR);
  return cv::min(paper, 0.5);
}

/// Many gray levels in use: a photograph, a scan or a JPEG, and no drawing program's export.
bool isContinuousTone(const cv::Mat& darkness) {
  std::array<int, 256> used{};
  for (int y = 0; y < darkness.rows; ++y)
    for (int x = 0; x < darkness.cols; ++x)
      ++used[static_cast<size_t>(std::lround(darkness.at<float>(y, x) * 255))];
  return std::count_if(used.begin(), used.end(), [](int count) { return count > 0; }) > 64;
}

struct Levels {
  double paper = 0, ink = 1;
  double at(double share) const { return paper + share * (ink - paper); }
  double cut() const { return at(kCut); }
};

/// The commonest bright and the commonest dark level.
Levels levelsOf(const cv::Mat& darkness) {
  std::array<int, 256> histogram{};
  for (int y = 0; y < darkness.rows; ++y)
    for (int x = 0; x < darkness.cols; ++x)
      ++histogram[static_cast<size_t>(std::lround(std::clamp(darkness.at<float>(y, x), 0.0F, 1.0F) * 255))];
  const auto paper = std::max_element(histogram.begin(), histogram.begin() + 128);
  const auto ink = std::max_element(std::min(paper + 77, histogram.begin() + 191), histogram.end());
  return {static_cast<double>(paper - histogram.begin()) / 255.0,
          *ink > 0 ? static_cast<double>(ink - histogram.begin()) / 255.0 : 1.0};
}

int enclosedAreas(const cv::Mat& walls) {
  const drafting::Regions regions = drafting::regionsOf(~walls, 4);
  int count = 0;
  for (int label = 1; label < regions.count; ++label) count += regions.area(label) >= 25;
  return count;
}

void checkDrawing(Sheet& sheet) {
  cv::Mat darkness = darknessOf(sheet);
  const cv::Mat paper = paperAround(darkness);
  double brightest = 0, darkest = 0;
  cv::minMaxLoc(paper, &brightest, &darkest);
  const bool is_uneven = darkest - brightest > kUneven && isContinuousTone(darkness);
  if (is_uneven) darkness = (darkness - paper) / (1.0 - paper);

  const Levels levels = levelsOf(darkness);
  const cv::Mat ink = darkness > levels.cut();
  sheet.faint = darkness > levels.at(kFaint);
  const cv::Mat old_ink = sheet.mask(world::Cell::kOccupied), between = sheet.mask(world::Cell::kUnknown);
  const int pale = cv::countNonZero(between), gained = cv::countNonZero(ink & ~old_ink);
  const int drawn = cv::countNonZero(ink);
  const int freed = cv::countNonZero(~ink & sheet.mask(world::Cell::kOccupied));
  if (drawn == 0 || pale + gained + freed == 0) return;
  // A finding of its own colour: what the usual reading makes of the outlines.
  const int before = enclosedAreas(old_ink), after = enclosedAreas(ink);

  Finding finding;
  finding.key = "thresholds";
  finding.count = pale;
  finding.severity = pale > drawn / 50 || before != after || is_uneven ? Severity::kWarning : Severity::kNote;
  finding.text = counted(pale, "gray pixel", "gray pixels") + " beside or instead of walls (" +
                 percent(static_cast<double>(pale) / drawn) + " of the ink)";
  if (gained > 0)
    finding.text += ", " + percent(static_cast<double>(gained) / drawn) + " of the ink is too pale";
  if (before < after)
    finding.text += "; " + counted(after - before, "enclosed area runs", "enclosed areas run") +
                    " out through pale walls";
  if (is_uneven) finding.text += "; the paper is lit unevenly";
  finding.remedy = "takes for wall what is darker than gray " +
                   std::to_string(std::lround(255 * (1 - levels.cut()))) + " of 255, and for free the rest" +
                   (is_uneven ? ", after evening out the paper" : "");
  finding.is_mendable = true;
  sheet.paint(ink, world::Cell::kOccupied, Change::kAdded);
  sheet.paint(~ink & sheet.mask(world::Cell::kUnknown), world::Cell::kFree, Change::kNone);
  sheet.paint(~ink, world::Cell::kFree, Change::kRemoved);
  sheet.findings.push_back(finding);
}

cv::Mat usualGray(const Sheet& sheet) {
  cv::Mat usual(sheet.cells.size(), CV_8U);
  for (int y = 0; y < usual.rows; ++y)
    for (int x = 0; x < usual.cols; ++x)
      usual.at<std::uint8_t>(y, x) =
          isMapServersGray(sheet.picture.gray[static_cast<size_t>(y) * usual.cols + x]) ? 255 : 0;
  return usual;
}

/// With the thresholds of some yaml files the gray that map servers write for unknown is free.
void hideUsualGray(Sheet& sheet) {
  const cv::Mat hidden = usualGray(sheet) & sheet.mask(world::Cell::kFree);
  const int count = cv::countNonZero(hidden);
  if (count == 0) return;
  Finding finding;
  finding.key = "thresholds";
  finding.count = count;
  finding.severity = Severity::kWarning;
  finding.text = "gray 205 and 206, which map servers write for unknown (" +
                 percent(static_cast<double>(count) / static_cast<double>(hidden.total())) +
                 " of the picture), counts as free with free_thresh " +
                 files::formatNumber(sheet.reading.free_threshold);
  finding.remedy = "makes it unknown";
  finding.is_mendable = true;
  sheet.paint(hidden, world::Cell::kUnknown, Change::kHidden);
  sheet.findings.push_back(finding);
}

/// In a map gray has a meaning; only thin gray, which no unknown area is, can be a pale wall.
void checkMap(Sheet& sheet) {
  const cv::Mat unknown = sheet.mask(world::Cell::kUnknown);
  cv::Mat flat;
  cv::morphologyEx(unknown, flat, cv::MORPH_OPEN, cv::Mat::ones(3, 3, CV_8U), {-1, -1}, 1,
                   cv::BORDER_REPLICATE);
  const cv::Mat walls = sheet.mask(world::Cell::kOccupied);
  const cv::Mat between = unknown & ~flat & drafting::grown(walls, 1.5) & ~usualGray(sheet),
                darkness = darknessOf(sheet);
  const cv::Mat dark = between & (darkness > kCut), pale = between & ~dark;
  const int count = cv::countNonZero(between);
  if (count == 0) return;
  Finding finding;
  finding.key = "thresholds";
  finding.count = count;
  finding.severity = count > cv::countNonZero(walls) / 50 ? Severity::kWarning : Severity::kNote;
  finding.text = counted(count, "gray pixel", "gray pixels") + " beside walls (" +
                 percent(static_cast<double>(count) / cv::countNonZero(walls)) +
                 " as many as wall pixels), as smoothing leaves them, count as unknown";
  finding.remedy = "takes the darker ones for wall and the paler ones for free";
  finding.is_mendable = true;
  sheet.paint(dark, world::Cell::kOccupied, Change::kAdded);
  sheet.paint(pale, world::Cell::kFree, Change::kNone);
  sheet.findings.push_back(finding);
}

}  // namespace

void checkThresholds(Sheet& sheet) {
  if (!sheet.goes_by_gray) return;
  if (!sheet.is_map) {
    checkDrawing(sheet);
    return;
  }
  hideUsualGray(sheet);
  checkMap(sheet);
}

}  // namespace slam::check
