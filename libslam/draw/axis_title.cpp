#include "libslam/draw/axis_title.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace slam::draw {

std::string axisTitle(const std::string& key) {
  static const std::vector<std::pair<std::string, std::string>> units = {
      {"_percent", " (%)"}, {"_deg", " (deg)"}, {"_ms", " (ms)"},
      {"_mb", " (MB)"},     {"_m", " (m)"},     {"_s", " (s)"}};
  std::string title = key, unit;
  const auto endsWith = [&](const std::string& end) {
    return title.size() > end.size() && title.compare(title.size() - end.size(), end.size(), end) == 0;
  };
  if (!endsWith("_per_m") && !endsWith("_per_s"))
    for (const auto& [suffix, text] : units)
      if (unit.empty() && endsWith(suffix)) title.resize(title.size() - suffix.size()), unit = text;
  std::replace(title.begin(), title.end(), '_', ' ');
  for (const std::string name : {"ate", "rpe"})
    if (title.compare(0, name.size(), name) == 0)
      title.replace(0, name.size(), name == "ate" ? "ATE" : "RPE");
  return title + unit;
}

}  // namespace slam::draw
