#include "libslam/check/rules.h"

namespace slam::check {
namespace {

/// What a robot's laser misses between its rays; a pillar's or a table's inside is larger.
constexpr double kSpeck_m2 = 0.03;

}  // namespace

void checkSpecks(Sheet& sheet) {
  if (!sheet.is_map && !sheet.isAskedFor("specks")) return;
  const drafting::Regions areas = drafting::regionsOf(sheet.mask(world::Cell::kUnknown), 8);
  const cv::Mat beside_wall = drafting::grown(sheet.mask(world::Cell::kOccupied), 1.5);
  std::vector<char> chosen = drafting::labelsUnder(areas, beside_wall);
  Finding finding;
  for (int label = 1; label < areas.count; ++label) {
    char& is_speck = chosen[static_cast<size_t>(label)];
    is_speck = !is_speck && sheet.squareMetres(areas.area(label)) <= kSpeck_m2;
    if (!is_speck) continue;
    ++finding.count;
    if (finding.places.size() < 20) finding.places.push_back(sheet.place(areas.anyPixel(label)));
  }
  if (finding.count == 0) return;
  finding.key = "specks";
  finding.text =
      counted(finding.count, "speck", "specks") + " of unknown amid free space" + atPixel(finding.places);
  finding.remedy = finding.count == 1 ? "makes it free" : "makes them free";
  finding.is_mendable = true;
  sheet.paint(drafting::maskOf(areas, chosen), world::Cell::kFree, Change::kNone);
  sheet.findings.push_back(finding);
}

}  // namespace slam::check
