#include "libslam/resources/ini_yaml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libslam/files/files.h"
#include "libslam/files/ini_text.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::resources {
namespace {
using slam::testing::errorOf;
using ::testing::HasSubstr;

constexpr const char* kSuite = R"(# a comment
suite:
  worlds: [flat, office]
  methods:
    - graph
    - icp_exact
  seeds: 1..10   # another
  failure_ate_m: 1.10
  baseline: "graph"
  logs:
lidar narrow:
  lidar: {fov_deg: 180, max_range_m: 1e1}
  lidar.beams: 010
fault none:
)";

TEST(IniYaml, MeansTheSameAsAnIni) {
  const auto ini = parseYaml(kSuite, "s.yaml");
  EXPECT_EQ(
      files::toText(ini),
      "[fault none]\n\n"
      "[lidar narrow]\nlidar.beams = 010\nlidar.fov_deg = 180\nlidar.max_range_m = 1e1\n\n"
      "[suite]\nbaseline = graph\nfailure_ate_m = 1.10\nlogs = \nmethods = graph, icp_exact\nseeds = 1..10\n"
      "worlds = flat, office\n");
  EXPECT_EQ(ini.find("suite", "seeds")->origin, "s.yaml:7");
  EXPECT_EQ(ini.find("lidar narrow", "lidar.max_range_m")->origin, "s.yaml:12");
  EXPECT_TRUE(parseYaml("", "s.yaml").sections().empty());
}

TEST(IniYaml, IsReadByItsName) {
  const testing::TempFolder folder;
  for (const char* name : {"a.yaml", "a.yml", "a.ini"})
    files::writeFileAtomically(folder / name,
                               std::string(name) == "a.ini" ? "[robot]\na = 1\n" : "robot: {a: 1}\n");
  for (const char* name : {"a.yaml", "a.yml", "a.ini"}) {
    EXPECT_TRUE(isConfigFile(name));
    EXPECT_EQ(readConfigFile(folder / name).find("robot", "a")->value, "1") << name;
  }
  EXPECT_FALSE(isConfigFile("graph"));
  EXPECT_FALSE(isYamlFile("a.ini"));
}

TEST(IniYaml, SaysWhereItIsWrong) {
  const auto error = [](const std::string& text) { return errorOf([&] { parseYaml(text, "s.yaml"); }); };
  EXPECT_THAT(error("suite:\n  a: [1, 2\nb: }\n"), HasSubstr("s.yaml:3: is not YAML: "));
  EXPECT_THAT(error("suite:\n  a: *x\n"), HasSubstr("s.yaml:2: is not YAML: "));
  EXPECT_EQ(error("a: {b: 1}\n---\na: {b: 1}\n"), "s.yaml: goes on behind its first document, expected one");
  EXPECT_EQ(error(",a"), "s.yaml: goes on behind its first document, expected one");
  EXPECT_EQ(error("- a\n"), "s.yaml:1: found a list, expected sections: a map of maps");
  EXPECT_EQ(error("resolution: 0.05\n"),
            "s.yaml:1: found a value, expected keys and values in section 'resolution'");
  EXPECT_EQ(error("s:\n  a: 1\n  a: 2\n"),
            "s.yaml:3: section [s], key 'a' is given twice, first at s.yaml:2");
  EXPECT_EQ(error("s:\n  a: [[1]]\n"), "s.yaml:2: found a list, expected a value of key 'a'");
  EXPECT_EQ(error("s:\n  a: {b: {c: 1}}\n"), "s.yaml:2: found a map, expected a value of key 'a.b'");
  EXPECT_THAT(error("s:\n  a: [\"x, y\"]\n"), HasSubstr("expected a value of key 'a' without a comma"));
  EXPECT_THAT(error("s:\n  a: \"x # y\"\n"), HasSubstr("without line breaks and comments"));
  EXPECT_THAT(error("s:\n  a: |\n    x\n    y\n"), HasSubstr("s.yaml:2: found 'x', expected"));
  EXPECT_THAT(error("? [1]\n: 2\n"), HasSubstr("expected a section's name"));
}

}  // namespace
}  // namespace slam::resources
