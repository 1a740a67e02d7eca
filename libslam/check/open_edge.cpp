#include <opencv2/imgproc.hpp>

#include "libslam/check/rules.h"

namespace slam::check {

void checkOpenEdge(Sheet& sheet) {
  const cv::Mat free = sheet.mask(world::Cell::kFree), unknown = sheet.mask(world::Cell::kUnknown);
  if (!sheet.is_map && cv::countNonZero(unknown) == 0) return;
  // Corner to corner counts: a ray through a corner would get out.
  cv::Mat beside_free;
  cv::dilate(free, beside_free, cv::Mat::ones(3, 3, CV_8U));
  const cv::Mat edge = beside_free & unknown;
  cv::Mat rim(free.size(), CV_8U, cv::Scalar(0));
  cv::rectangle(rim, cv::Rect(0, 0, rim.cols, rim.rows), cv::Scalar(255));
  const cv::Mat at_rim = rim & free;
  const int length = cv::countNonZero(edge), at_page = cv::countNonZero(at_rim);
  if (length + at_page == 0) return;
  cv::Mat beside_wall;
  cv::dilate(sheet.mask(world::Cell::kOccupied), beside_wall, cv::Mat::ones(3, 3, CV_8U));
  const int walls = cv::countNonZero(beside_free & sheet.mask(world::Cell::kOccupied));
  const double share = static_cast<double>(length + at_page) / (length + at_page + walls);
  Finding finding;
  finding.key = "open_edge";
  finding.count = length + at_page;
  finding.severity = share > 0.01 ? Severity::kWarning : Severity::kNote;
  finding.text = "free space meets the unknown without a wall along " + metres(length * sheet.resolution_m) +
                 " m, and the picture's edge along " + metres(at_page * sheet.resolution_m) + " m (" +
                 percent(share) + " of its outline): a robot could drive and look out";
  finding.remedy = "builds a wall there, one pixel thick, on the unknown side";
  finding.is_mendable = true;
  cv::Point first;
  cv::Mat all = edge | at_rim;
  std::vector<cv::Point> points;
  cv::findNonZero(all, points);
  finding.places.push_back(sheet.place(points.front()));
  sheet.paint(all, world::Cell::kOccupied, Change::kAdded);
  sheet.findings.push_back(finding);
}

}  // namespace slam::check
