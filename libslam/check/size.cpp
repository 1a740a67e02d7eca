#include <cmath>

#include "libslam/check/rules.h"

namespace slam::check {
namespace {

constexpr double kMuchMegabytes = 1500;

Finding unusable(const std::string& text) {
  Finding finding;
  finding.key = "size";
  finding.severity = Severity::kError;
  finding.text = text;
  finding.remedy = "cannot help: draw it anew, or check which file this is";
  return finding;
}

}  // namespace

double megabytesToSimulate(size_t cells) {
  // The cells, the casting table of a byte per octant and cell, and a distance field for the score.
  constexpr double kBytesPerCell = 1 + 8 + 4;
  return static_cast<double>(cells) * kBytesPerCell / 1e6;
}

void checkSize(Sheet& sheet) {
  const std::string size =
      std::to_string(sheet.cells.cols) + " x " + std::to_string(sheet.cells.rows) + " pixels";
  const int walls = cv::countNonZero(sheet.mask(world::Cell::kOccupied));
  const int free = cv::countNonZero(sheet.mask(world::Cell::kFree));
  if (sheet.cells.total() == 1)
    sheet.findings.push_back(unusable("a single pixel"));
  else if (walls == 0)
    sheet.findings.push_back(unusable("no wall at all in " + size + ": nothing is " +
                                      (sheet.goes_by_alpha ? "opaque" : "dark enough")));
  else if (free == 0)
    sheet.findings.push_back(unusable("no free space at all in " + size + ": nothing is " +
                                      (sheet.goes_by_alpha ? "transparent" : "bright enough")));
  else if (const double megabytes = megabytesToSimulate(sheet.cells.total()); megabytes > kMuchMegabytes) {
    Finding finding;
    finding.key = "size";
    finding.severity = Severity::kWarning;
    finding.text = size + " need about " + std::to_string(std::lround(megabytes)) + " MB to simulate in";
    finding.remedy = "leaves the size; scale the picture down to 0.05 m a pixel";
    sheet.findings.push_back(finding);
  }
}

}  // namespace slam::check
