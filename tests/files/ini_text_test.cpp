#include "libslam/files/ini_text.h"

#include <gtest/gtest.h>

namespace slam::files {
namespace {

TEST(IniText, ReadsBackTheSame) {
  EXPECT_EQ(toText(IniFile()), "");
  const auto ini =
      IniFile::parse("[suite]\nworlds = flat, hall\nempty =\n[fault a.b=1] # a name with =\na.b = 1\n", "x");
  const std::string text = toText(ini);
  EXPECT_EQ(text, "[fault a.b=1]\na.b = 1\n\n[suite]\nempty = \nworlds = flat, hall\n");
  EXPECT_EQ(toText(IniFile::parse(text, "y")), text);
}

}  // namespace
}  // namespace slam::files
