#include "libslam/check/rules.h"

namespace slam::check {

void checkRays(Sheet& sheet) {
  const cv::Mat free = sheet.mask(world::Cell::kFree), unknown = sheet.mask(world::Cell::kUnknown);
  // Nothing unknown, no rays: a drawing has none.
  if (!sheet.is_map && !sheet.isAskedFor("rays")) return;
  // Free strips too narrow for the robot that run through the unknown; corners lie between walls.
  const double radius = sheet.toPixels(sheet.options.robot_side_m) / 2;
  const cv::Mat wide = drafting::grown(
      drafting::clearance(free | sheet.mask(world::Cell::kOccupied), true) > radius + 0.5, radius + 1);
  const drafting::Regions strips = drafting::regionsOf(free & ~wide, 8);
  const cv::Mat beside_unknown = drafting::grown(unknown, 1) & free;
  std::vector<int> open_edge(static_cast<size_t>(strips.count), 0);
  for (int y = 0; y < free.rows; ++y)
    for (int x = 0; x < free.cols; ++x)
      if (beside_unknown.at<std::uint8_t>(y, x))
        ++open_edge[static_cast<size_t>(strips.labels.at<int>(y, x))];
  std::vector<char> chosen(static_cast<size_t>(strips.count), 0);
  Finding finding;
  for (int label = 1; label < strips.count; ++label) {
    if (open_edge[static_cast<size_t>(label)] < 0.3 * strips.area(label)) continue;
    chosen[static_cast<size_t>(label)] = 1;
    ++finding.count;
    if (finding.places.size() < 20) finding.places.push_back(sheet.place(strips.anyPixel(label)));
  }
  if (finding.count == 0) return;
  const int pixels = sheet.paint(drafting::maskOf(strips, chosen), world::Cell::kUnknown, Change::kHidden);
  finding.key = "rays";
  const double share = static_cast<double>(pixels) / cv::countNonZero(free);
  finding.severity = share > 0.002 ? Severity::kWarning : Severity::kNote;
  finding.text = counted(finding.count, "free strip", "free strips") + " narrower than the robot (" +
                 metres(sheet.squareMetres(pixels)) + " m2, " + percent(share) +
                 " of the free space) run into the unknown, as rays do through windows and gaps" +
                 atPixel(finding.places);
  finding.remedy = "makes them unknown";
  finding.is_mendable = true;
  sheet.findings.push_back(finding);
}

}  // namespace slam::check
