#include <cmath>
#include <opencv2/imgproc.hpp>

#include "libslam/check/rules.h"
#include "libslam/drafting/clearance_flood.h"
#include "libslam/drafting/passages.h"

namespace slam::check {
namespace {

/// The inside is wider than the gap that leads to it by this much; an alley outside is not.
constexpr double kWider = 1.3;
constexpr int kMostGaps = 500;

struct Gap {
  cv::Point from, to;
  double width;
};

cv::Point nearestInk(const cv::Mat& ink, const cv::Point& middle, int reach, const cv::Point* opposite) {
  const cv::Rect area =
      cv::Rect(middle.x - reach, middle.y - reach, 2 * reach + 1, 2 * reach + 1) & cv::Rect({}, ink.size());
  cv::Point best(-1, -1);
  double nearest = INFINITY;
  const cv::Point away = opposite ? middle - *opposite : cv::Point();
  for (int y = area.y; y < area.br().y; ++y)
    for (int x = area.x; x < area.br().x; ++x) {
      if (!ink.at<std::uint8_t>(y, x)) continue;
      const cv::Point d = cv::Point(x, y) - middle;
      // On the other side: more than 120 degrees from the first post.
      if (opposite && d.dot(away) < 0.5 * cv::norm(d) * cv::norm(away)) continue;
      if (const double distance = d.dot(d); distance < nearest) nearest = distance, best = {x, y};
    }
  return best;
}

/// strip: of paper round the page, in the gaps' coordinates.
Finding findingOf(const Sheet& sheet, const std::vector<Gap>& gaps, int strip) {
  Finding finding;
  finding.key = "leaks";
  finding.severity = Severity::kWarning;
  finding.count = static_cast<int>(gaps.size());
  double narrowest = INFINITY, broadest = 0;
  for (const Gap& gap : gaps) {
    narrowest = std::min(narrowest, gap.width);
    broadest = std::max(broadest, gap.width);
    finding.places.push_back(sheet.place((gap.from + gap.to) / 2 - cv::Point(strip, strip)));
  }
  const std::string low = metres(narrowest * sheet.resolution_m),
                    high = metres(broadest * sheet.resolution_m);
  finding.text = "the inside is open to the outside through " + counted(finding.count, "gap", "gaps") +
                 " of " + (low == high ? low : low + " to " + high) + " m" + atPixel(finding.places);
  finding.remedy =
      "closes them with a wall, being no wider than " + metres(sheet.options.widest_gap_m) + " m";
  finding.is_mendable = true;
  return finding;
}

}  // namespace

void checkLeaks(Sheet& sheet) {
  if (sheet.is_map && !sheet.isAskedFor("leaks")) return;
  // Round the page runs a strip of paper, wide enough to walk around on.
  const double widest = sheet.toPixels(sheet.options.widest_gap_m);
  const int strip = static_cast<int>(std::min(widest / 2, 4000.0)) + 3;
  cv::Mat ink;
  cv::copyMakeBorder(sheet.mask(world::Cell::kOccupied), ink, strip, strip, strip, strip, cv::BORDER_CONSTANT,
                     cv::Scalar(0));
  drafting::ClearanceFlood flood(drafting::clearance(~ink, false));
  flood.markOutside({0, 0});
  const double least_area = sheet.toPixels(1) * sheet.toPixels(1) * sheet.options.least_room_m2;
  const double least_clearance = sheet.toPixels(sheet.options.robot_side_m);
  const auto isRoom = [&](const drafting::Basin& side, double here) {
    return static_cast<double>(side.area) >= least_area && side.peak >= kWider * here &&
           side.peak >= least_clearance;
  };
  std::vector<Gap> gaps;
  cv::Mat closed(ink.size(), CV_8U, cv::Scalar(0));
  flood.run([&](const cv::Point& at, double here, const drafting::Basin& a, const drafting::Basin& b) {
    if (a.is_outside == b.is_outside) return true;
    if (!isRoom(a.is_outside ? b : a, here) || static_cast<int>(gaps.size()) >= kMostGaps) return true;
    const double width = drafting::widthOfGap(here);
    if (width > widest) return true;
    const int reach = static_cast<int>(2 * here) + 3;
    const cv::Point from = nearestInk(ink, at, reach, nullptr);
    const cv::Point to = from.x < 0 ? from : nearestInk(ink, at, reach, &from);
    if (to.x < 0) return true;
    const cv::Rect around(
        cv::Point(std::min({from.x, to.x, at.x}), std::min({from.y, to.y, at.y})) - cv::Point(3, 3),
        cv::Point(std::max({from.x, to.x, at.x}), std::max({from.y, to.y, at.y})) + cv::Point(4, 4));
    cv::line(closed, from, at, cv::Scalar(255), 2);
    cv::line(closed, at, to, cv::Scalar(255), 2);
    const cv::Rect inside = around & cv::Rect({}, ink.size());
    for (int y = inside.y; y < inside.br().y; ++y)
      for (int x = inside.x; x < inside.br().x; ++x)
        if (closed.at<std::uint8_t>(y, x)) flood.dam({x, y});
    gaps.push_back({from, to, width});
    return false;
  });
  if (gaps.empty()) return;
  const Finding finding = findingOf(sheet, gaps, strip);
  const cv::Rect page(strip, strip, sheet.cells.cols, sheet.cells.rows);
  sheet.paint(closed(page), world::Cell::kOccupied, Change::kClosed);
  sheet.findings.push_back(finding);
}

}  // namespace slam::check
