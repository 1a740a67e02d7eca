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
    {"robot", {"core"}},
    {"objects", {"core", "robot"}},
    {"bags", {"core", "robot", "objects"}},
    {"logs", {"core", "robot", "objects", "bags"}},
    {"stats", {"core"}},
    {"table", {"core"}},
    // the truth's side
    {"world", {"core"}},
    {"buildings", {"core", "world"}},
    {"check", {"core", "world"}},
    {"sim", {"core", "robot", "world"}},
    {"mrptworld", {"core", "world"}},
    {"metrics", {"core", "world"}},
    {"oracle", {"core", "world", "metrics"}},
    {"draw", {"core", "world", "metrics"}},
    {"pictures", {"core", "robot", "world", "check", "metrics", "draw"}},
    {"report", {"core", "robot", "world", "metrics", "table", "draw", "pictures"}},
    {"viewer", {"core", "robot", "gridmap", "world", "draw"}},
    // the robot's side
    {"gridmap", {"core", "robot"}},
    {"scanmatch", {"core", "robot", "gridmap"}},
    {"sparse", {"core"}},
    {"posegraph", {"core", "sparse"}},
    {"obstacles", {"core", "robot"}},
    {"paths", {"core", "robot", "gridmap", "obstacles"}},
    {"goals", {"core", "robot", "obstacles", "paths"}},
    {"navigate", {"core", "robot", "gridmap", "obstacles", "paths", "goals"}},
    {"mrptnav", {"core", "robot", "gridmap", "paths", "goals", "navigate"}},
    {"odometry", {"core", "robot"}},
    {"graph", {"core", "robot", "gridmap", "odometry", "posegraph", "scanmatch"}},
    {"particles", {"core", "robot", "gridmap", "graph", "scanmatch"}},
    {"builders", {"core", "robot", "gridmap", "graph", "particles"}},
    {"methods", {"core", "robot", "gridmap", "odometry", "graph", "particles", "builders"}},
    {"mapping",
     {"core", "robot", "gridmap", "odometry", "posegraph", "scanmatch", "graph", "builders", "methods"}},
    // reads logs and matches their scans; nobody's estimate
    {"doctor", {"core", "robot", "objects", "logs", "odometry"}},
    // both: from the floor up; each may include those that stand above it here and nothing below
    {"process", {"core"}},
    {"record",
     {"core", "robot", "world", "buildings", "logs", "sim", "odometry", "mapping", "paths", "navigate"}},
    {"run",
     {"core", "stats", "robot", "gridmap", "world", "objects", "logs", "sim", "odometry", "graph", "mapping",
      "metrics", "draw", "viewer", "process", "record"}},
    {"sessions",
     {"core", "robot", "world", "logs", "graph", "mapping", "table", "pictures", "report", "run"}},
    {"score",
     {"core", "stats", "world", "logs", "sim", "mapping", "metrics", "table", "pictures", "process", "record",
      "run"}},
    {"explore", {"core",      "robot",    "world",    "logs",    "sim",     "gridmap", "mapping",
                 "obstacles", "goals",    "navigate", "mrptnav", "metrics", "oracle",  "table",
                 "draw",      "pictures", "process",  "record",  "run",     "score"}},
    {"sweep", {"core", "logs", "mapping", "table", "process", "record", "run", "score"}},
    {"study", {"core", "stats", "buildings", "mapping", "table", "draw", "score", "sweep"}},
    {"learn", {"core",    "stats",    "robot",     "gridmap", "world",    "buildings", "logs",
               "sim",     "odometry", "posegraph", "mapping", "navigate", "metrics",   "table",
               "process", "record",   "run",       "score",   "explore",  "sweep",     "study"}},
    {"pages",
     {"core", "world", "logs", "sim", "metrics", "table", "draw", "pictures", "report", "record", "run",
      "score", "study"}},
    {"live",
     {"core", "robot", "gridmap", "logs", "world", "sim", "metrics", "obstacles", "navigate", "graph",
      "mapping", "record", "run", "score", "viewer"}},
    {"plugin", {"core", "robot", "objects", "logs", "world", "sim", "navigate", "mapping", "record", "run"}},
    {"testing", {"core", "robot", "posegraph", "world"}},
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

TEST(Includes, TheTableHoldsTheTruthWall) {
  for (const std::string robot_side :
       {"gridmap", "scanmatch", "sparse", "posegraph", "obstacles", "paths", "goals", "navigate", "mrptnav",
        "odometry", "graph", "particles", "builders", "methods", "mapping"})
    for (const std::string truth_side :
         {"world",  "buildings", "check",  "sim",     "metrics",  "oracle", "draw",    "pictures",
          "report", "process",   "record", "run",     "sessions", "score",  "explore", "sweep",
          "study",  "learn",     "pages",  "objects", "bags",     "logs"})
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
