#include "libslam/files/ini_text.h"

namespace slam::files {

std::string toText(const IniFile& ini) {
  std::string text;
  for (const auto& [section, entries] : ini.sections()) {
    text += (text.empty() ? "[" : "\n[") + section + "]\n";
    for (const auto& [key, entry] : entries) text += key + " = " + entry.value + "\n";
  }
  return text;
}

}  // namespace slam::files
