#include "libslam/files/ros_map.h"

#include <algorithm>
#include <cctype>

#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"

namespace slam::files {
namespace {

bool isPlainScalar(const std::string& text) {
  return !text.empty() && text.front() != '-' && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '.' || c == '/' || c == '-' || c >= 0x80;
  });
}

}  // namespace

std::string yamlScalar(const std::string& text) {
  if (isPlainScalar(text)) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("''") : std::string(1, c);
  return quoted + "'";
}

std::string rosMapYaml(const RosMap& map) {
  const auto& origin = map.T_map_image;
  return "image: " + yamlScalar(map.image) +
         "\nmode: trinary\nresolution: " + formatNumber(map.resolution_m) + "\norigin: [" +
         formatNumber(origin.x) + ", " + formatNumber(origin.y) + ", " + formatNumber(origin.phi) +
         "]\nnegate: " + (map.negate ? "1" : "0") +
         "\noccupied_thresh: " + formatNumber(map.occupied_threshold) +
         "\nfree_thresh: " + formatNumber(map.free_threshold) + "\n";
}

}  // namespace slam::files
