#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

namespace {
namespace fs = std::filesystem;

// Who may include whom. The truth wall: nothing on the robot's side (navigate, odometry, mapping) may name a
// room that knows the truth (world, buildings, check, sim, metrics, oracle, report); only the rooms from
// `record` to `pages`, and those above, see both.
const std::map<std::string, std::set<std::string>> kMayInclude = {
    {"core", {}},
    {"threads", {"core"}},
    {"files", {"core"}},
    {"resources", {"core", "files"}},
    {"lidar", {"core", "files"}},
    {"robot", {"core", "files", "lidar"}},
    {"objects", {"core", "files", "lidar"}},
    {"bags", {"core", "files", "lidar", "objects"}},
    {"rawlogs", {"core", "files", "resources", "lidar", "objects"}},
    {"logs", {"core", "files", "resources", "lidar", "objects", "bags", "rawlogs"}},
    {"edit", {"core", "files", "objects", "rawlogs", "logs"}},
    {"stats", {"core"}},
    {"table", {"core", "files"}},
    // the truth's side
    {"world", {"core", "files", "resources"}},
    {"rays", {"core", "threads", "world"}},
    {"buildings", {"core", "files", "world"}},
    {"drafting", {"core"}},
    {"check", {"core", "files", "world", "drafting"}},
    {"movers", {"core", "files", "world", "rays"}},
    {"sim", {"core", "files", "lidar", "robot", "world", "rays", "movers"}},
    {"mrptworld", {"core", "world", "rays"}},
    {"metrics", {"core", "world", "rays"}},
    {"oracle", {"core", "world", "rays", "metrics"}},
    {"draw", {"core", "files", "world", "metrics"}},
    {"pictures", {"core", "lidar", "world", "check", "metrics", "draw"}},
    {"report", {"core", "files", "resources", "lidar", "world", "metrics", "table", "draw", "pictures"}},
    {"viewer", {"core", "lidar", "robot", "gridmap", "world", "draw"}},
    // the robot's side
    {"gridmap", {"core", "threads", "lidar"}},
    {"scanmatch", {"core", "lidar", "gridmap"}},
    {"sparse", {"core"}},
    {"posegraph", {"core", "threads", "files", "sparse"}},
    {"certified", {"core", "posegraph"}},
    {"obstacles", {"core", "files", "lidar", "robot"}},
    {"safety", {"core", "lidar", "robot", "obstacles"}},
    {"paths", {"core", "lidar", "robot", "gridmap", "safety"}},
    {"goals", {"core", "files", "lidar", "robot", "obstacles", "safety"}},
    {"choices", {"core", "lidar", "robot", "obstacles", "paths"}},
    {"strategies",
     {"core", "files", "lidar", "robot", "gridmap", "obstacles", "safety", "paths", "goals", "choices"}},
    {"navigate", {"core", "lidar", "robot", "gridmap", "safety", "paths", "goals", "strategies"}},
    {"mrptnav", {"core", "files", "lidar", "robot", "gridmap", "safety", "goals", "strategies", "navigate"}},
    {"odometry", {"core", "files", "lidar", "robot"}},
    {"wheels", {"core"}},
    {"keyframes", {"core", "threads", "files", "lidar", "scanmatch", "posegraph"}},
    {"uncertainty", {"core", "scanmatch", "sparse", "posegraph", "keyframes"}},
    {"tracking", {"core", "lidar", "scanmatch", "odometry", "wheels", "keyframes", "uncertainty"}},
    {"loops", {"core", "threads", "lidar", "scanmatch", "posegraph", "keyframes", "uncertainty"}},
    {"bundle", {"core", "scanmatch", "sparse", "posegraph", "keyframes", "tracking"}},
    {"graph",
     {"core", "lidar", "scanmatch", "posegraph", "keyframes", "uncertainty", "tracking", "loops", "bundle"}},
    {"particles",
     {"core", "threads", "files", "lidar", "gridmap", "scanmatch", "keyframes", "uncertainty", "tracking",
      "loops", "wheels"}},
    {"builders", {"core", "files", "lidar", "robot", "graph", "particles"}},
    {"methods", {"core", "files", "lidar", "gridmap", "odometry", "loops", "builders"}},
    {"mapping",
     {"core", "files", "resources", "lidar", "robot", "gridmap", "scanmatch", "posegraph", "odometry",
      "loops", "graph", "builders", "methods"}},
    // read logs and match their scans; nobody's estimate
    {"calibration", {"core", "lidar", "odometry"}},
    {"doctor", {"core", "lidar", "objects", "rawlogs", "logs", "calibration"}},
    // both: from the floor up; each may include those that stand above it here and nothing below
    {"process", {"core", "files", "resources"}},
    {"truth", {"core", "files", "resources", "logs", "sim"}},
    {"record",
     {"core", "files", "resources", "lidar", "robot", "world", "buildings", "logs", "movers", "sim",
      "odometry", "mapping", "safety", "strategies", "navigate", "truth"}},
    {"results",
     {"core", "files", "resources", "stats", "lidar", "gridmap", "world", "logs", "graph", "mapping",
      "metrics", "draw", "viewer"}},
    {"run",
     {"core", "threads", "files", "resources", "lidar", "world", "rays", "objects", "rawlogs", "logs", "edit",
      "sim", "odometry", "mapping", "metrics", "process", "truth", "record", "results"}},
    {"sessions",
     {"core", "files", "resources", "world", "logs", "loops", "graph", "mapping", "table", "pictures",
      "report", "results", "run"}},
    {"score",
     {"core", "threads", "files", "resources", "stats", "world", "logs", "sim", "mapping", "metrics", "table",
      "pictures", "process", "truth", "record", "results", "run"}},
    {"explore", {"core",    "threads",    "files",    "resources", "robot",  "world", "logs", "sim",
                 "mapping", "strategies", "navigate", "metrics",   "oracle", "table", "draw", "pictures",
                 "process", "truth",      "record",   "results",   "run",    "score"}},
    {"teams",
     {"core", "threads", "files", "resources", "robot", "gridmap", "world", "sim", "mapping", "strategies",
      "navigate", "table", "pictures", "record", "results", "explore"}},
    {"reach",
     {"core", "files", "resources", "lidar", "robot", "world", "logs", "movers", "sim", "mapping",
      "obstacles", "goals", "mrptnav", "table", "draw", "pictures", "truth", "record", "run"}},
    {"sweep",
     {"core", "files", "resources", "logs", "mapping", "table", "process", "truth", "record", "run",
      "score"}},
    {"summary", {"core", "files", "resources", "stats", "table", "score", "sweep"}},
    {"study",
     {"core", "files", "resources", "stats", "buildings", "mapping", "table", "draw", "score", "sweep",
      "summary"}},
    {"learn",
     {"core", "files", "resources", "robot", "posegraph", "world", "rays", "logs", "sim", "odometry",
      "strategies", "metrics", "table", "process", "record", "run", "reach", "sweep", "summary"}},
    {"pages",
     {"core", "files", "resources", "stats", "world", "logs", "sim", "metrics", "table", "draw", "pictures",
      "report", "truth", "record", "results", "score", "summary"}},
    {"live",
     {"core", "files", "resources", "robot", "logs", "graph", "mapping", "obstacles", "metrics", "viewer",
      "record", "results", "run", "score"}},
    {"plugin",
     {"core", "files", "resources", "lidar", "objects", "sim", "mapping", "navigate", "record", "run"}},
    {"testing", {"core", "files", "posegraph"}},
};

std::string problemsOf(const std::string& file_name, const std::string& room, const std::string& text) {
  static const std::regex kInclude(R"re(#\s*include\s*["<]libslam/([a-z]+)/)re");
  const auto& allowed = kMayInclude.at(room);
  std::string problems;
  for (std::sregex_iterator it(text.begin(), text.end(), kInclude), end; it != end; ++it) {
    const std::string other = (*it)[1];
    if (other != room && !allowed.count(other)) problems += file_name + " includes room " + other + "\n";
  }
  return problems;
}

std::string read(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

bool isSource(const fs::path& path) {
  return path.extension() == ".h" || path.extension() == ".cpp";
}

TEST(Includes, EveryRoomKeepsToTheTable) {
  int files = 0;
  const fs::path library = fs::path(RASTERSLAM_SOURCE_DIR) / "libslam";
  for (const auto& entry : fs::recursive_directory_iterator(library)) {
    if (!isSource(entry.path())) continue;
    ++files;
    const auto relative = fs::relative(entry.path(), library);
    const std::string room = relative.begin()->string();
    ASSERT_TRUE(kMayInclude.count(room)) << "room " << room << " is not in the table";
    EXPECT_EQ(problemsOf(relative.string(), room, read(entry.path())), "");
  }
  EXPECT_GT(files, 40);  // the walk found the library
}

std::string missingIncludes(const std::string& file_name, const std::string& text) {
  static const std::regex kOurs(R"re(#\s*include\s*"((?:libslam|tests|apps|benchmarks|datasets)/[^"]+)")re");
  std::string missing;
  for (std::sregex_iterator it(text.begin(), text.end(), kOurs), end; it != end; ++it)
    if (!fs::exists(fs::path(RASTERSLAM_SOURCE_DIR) / (*it)[1].str()))
      missing += file_name + " includes " + (*it)[1].str() + ", which is no file\n";
  return missing;
}

// Also in what the usual build leaves out: benchmarks, fuzzers, examples.
TEST(Includes, EveryIncludeOfOursNamesAFile) {
  const fs::path root = RASTERSLAM_SOURCE_DIR;
  for (const char* folder : {"apps", "benchmarks", "datasets", "libslam", "tests"})
    for (const auto& entry : fs::recursive_directory_iterator(root / folder))
      if (isSource(entry.path())) {
        EXPECT_EQ(missingIncludes(fs::relative(entry.path(), root).string(), read(entry.path())), "");
      }
  EXPECT_NE(missingIncludes("x.cpp", "#include \"libslam/core/nowhere.h\"\n"), "");
}

TEST(Includes, TheTableHoldsTheTruthWall) {
  for (const std::string robot_side :
       {"gridmap",   "scanmatch", "sparse",      "posegraph",  "certified", "obstacles", "safety",
        "paths",     "goals",     "choices",     "strategies", "navigate",  "mrptnav",   "odometry",
        "wheels",    "keyframes", "uncertainty", "tracking",   "loops",     "bundle",    "graph",
        "particles", "builders",  "methods",     "mapping"})
    for (const std::string truth_side :
         {"world",  "rays",     "buildings", "drafting", "check",   "movers",  "sim",    "metrics",
          "oracle", "draw",     "pictures",  "report",   "process", "truth",   "record", "results",
          "run",    "sessions", "score",     "explore",  "teams",   "reach",   "sweep",  "summary",
          "study",  "learn",    "pages",     "objects",  "bags",    "rawlogs", "logs",   "edit"})
      EXPECT_FALSE(kMayInclude.at(robot_side).count(truth_side)) << robot_side << " reaches " << truth_side;
}

// Each arrow leads to a room whose own arrows are already drawn: no room can reach itself.
TEST(Includes, TheTableHasNoCircle) {
  std::set<std::string> placed;
  for (bool grows = true; grows;) {
    grows = false;
    for (const auto& [room, allowed] : kMayInclude)
      if (std::includes(placed.begin(), placed.end(), allowed.begin(), allowed.end()))
        grows |= placed.insert(room).second;
  }
  for (const auto& [room, allowed] : kMayInclude) EXPECT_TRUE(placed.count(room)) << room;
}

TEST(Includes, AViolationIsSeen) {
  EXPECT_EQ(problemsOf("x.cpp", "mapping", "#include \"libslam/world/plan.h\"\n"),
            "x.cpp includes room world\n");
  EXPECT_EQ(problemsOf("x.cpp", "mapping", "#include \"libslam/core/pose2.h\"\n"), "");
}

// A room's CMake target must not link what its includes may not name, or the linker would open a door in the
// wall.
TEST(Includes, RoomsLinkOnlyWhatTheyMayInclude) {
  static const std::regex kRooms(R"re(ROOMS([a-z_\s]*))re"), kAlias(R"re((?:^|[^a-z])slam::([a-z]+))re");
  for (const auto& [room, allowed] : kMayInclude) {
    const std::string text = read(fs::path(RASTERSLAM_SOURCE_DIR) / "libslam" / room / "CMakeLists.txt");
    ASSERT_FALSE(text.empty()) << room;
    std::set<std::string> linked;
    std::smatch match;
    if (std::regex_search(text, match, kRooms)) {
      std::istringstream words(match[1]);
      for (std::string word; words >> word;) linked.insert(word);
    }
    for (std::sregex_iterator it(text.begin(), text.end(), kAlias), end; it != end; ++it)
      linked.insert((*it)[1]);
    if (linked.erase("base") > 0) linked.insert("core");  // the part of core that needs nothing from outside
    for (const auto& other : linked)
      EXPECT_TRUE(other == room || allowed.count(other)) << room << " links " << other;
  }
}

}  // namespace
