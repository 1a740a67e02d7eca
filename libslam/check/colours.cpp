#include <algorithm>
#include <map>
#include <vector>

#include "libslam/check/rules.h"

namespace slam::check {
namespace {

struct Hue {
  const char* name;
  int count = 0, walls = 0, free = 0;
};

/// A colour's everyday name by its strongest channels; nullptr for what the eye takes for gray.
const char* nameOf(int red, int green, int blue) {
  const int high = std::max({red, green, blue}), low = std::min({red, green, blue});
  if (high - low < 48) return nullptr;
  const int middle = (high + low) / 2;
  const int code = (red > middle ? 4 : 0) + (green > middle ? 2 : 0) + (blue > middle ? 1 : 0);
  static const char* const kNames[] = {"gray", "blue", "green", "cyan", "red", "magenta", "yellow", "gray"};
  return kNames[code];
}

}  // namespace

void checkColours(Sheet& sheet) {
  const auto& pixels = sheet.pixels;
  std::map<std::string, Hue> hues;
  int coloured = 0;
  const auto& opaque = sheet.picture.opaque;
  for (size_t i = 0; i < pixels.size(); ++i) {
    if (!opaque.empty() && !opaque[i]) continue;  // nobody sees what colour lies there
    const char* name = nameOf(pixels[i].red, pixels[i].green, pixels[i].blue);
    if (!name) continue;
    ++coloured;
    Hue& hue = hues[name];
    ++hue.count;
    const auto cell = static_cast<world::Cell>(sheet.cells.data[i]);
    hue.walls += cell == world::Cell::kOccupied;
    hue.free += cell == world::Cell::kFree;
  }
  if (coloured == 0) return;
  Finding finding;
  finding.key = "colours";
  finding.count = static_cast<int>(hues.size());
  std::vector<std::pair<int, std::string>> rows;
  for (const auto& [name, hue] : hues) {
    const double all = hue.count;
    const std::string kind = hue.walls > 0.6 * all  ? "wall"
                             : hue.free > 0.6 * all ? "free"
                             : hue.walls > 0.1 * all && hue.free > 0.1 * all
                                 ? "wall where dark, free where pale"
                                 : "mostly unknown";
    rows.emplace_back(hue.count, name + " counts as " + kind);
  }
  std::sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  });
  finding.text = percent(static_cast<double>(coloured) / static_cast<double>(pixels.size())) +
                 " of the pixels are coloured; " +
                 (sheet.goes_by_alpha ? "only transparency is read: " : "only brightness is read: ");
  for (size_t i = 0; i < rows.size(); ++i) finding.text.append(i ? ", " : "").append(rows[i].second);
  finding.remedy = sheet.goes_by_alpha ? "leaves it so; make transparent what should be free"
                                       : "leaves it so; redraw in black what should be a wall";
  sheet.findings.push_back(finding);
}

}  // namespace slam::check
