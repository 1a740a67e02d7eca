#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libslam/files/files.h"
#include "libslam/logs/log_writer.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::EndsWith;
using ::testing::HasSubstr;

/// Scans of a wall ahead, 0.2 s apart, while the robot goes 2 cm each time.
std::string writeLog(const testing::TempFolder& folder, const std::string& name, int scans) {
  logs::LogWriter writer(folder / name, rawlogs::RawlogForm::kActionFrame);
  logs::LogEntry entry;
  entry.scan.step_rad = core::degToRad(1);
  entry.scan.first_angle_rad = core::degToRad(-45);
  entry.scan.max_range_m = 30;
  for (int i = 0; i < scans; ++i) {
    entry.scan.time_s = 1'700'000'000 + 0.2 * i;
    entry.scan.ranges_m.clear();
    for (size_t beam = 0; beam <= 90; ++beam)
      entry.scan.ranges_m.push_back(static_cast<float>((5 - 0.02 * i) / std::cos(entry.scan.angle(beam))));
    entry.T_previous_robot = {i > 0 ? 0.02 : 0.0, 0, 0};
    entry.T_odom_robot = {0.02 * i, 0, 0};
    entry.has_odometry = true;
    writer.write(entry);
  }
  writer.close();
  return folder / name;
}

TEST(CheckCommand, SaysWhatALogIsLikeInLinesOf80Columns) {
  const testing::TempFolder folder;
  writeLog(folder, "a.rawlog", 30);
  const auto result = rasterslam("check a.rawlog", folder.path());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("stream  CObservation2DRangeScan    'LASER'"));
  EXPECT_THAT(result.out, HasSubstr("note    lidar      'LASER': 30 scans of 91 beams over 90.00 deg"));
  EXPECT_THAT(result.out, EndsWith("\nusable\n"));
  std::istringstream lines(result.out);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80U) << line;
}

TEST(CheckCommand, GivesTheSameAsJson) {
  const testing::TempFolder folder;
  writeLog(folder, "a.rawlog", 30);
  const auto result = rasterslam("check a.rawlog -q --json", folder.path());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto object = json::parse(result.out);
  EXPECT_EQ(object["format"], "MRPT rawlog");
  EXPECT_EQ(object["usable"], true);
  EXPECT_EQ(object["ranges"]["scans"], 30);
  EXPECT_EQ(object["ranges"]["no_return_value"], nullptr);
  EXPECT_EQ(object["odometry"][0]["stream"], "actions");
  EXPECT_EQ(object["odometry"][0]["clock_offset_s"], nullptr) << "it never turns";
  EXPECT_EQ(object["streams"].size(), 2U);
  for (const auto& finding : object["findings"]) EXPECT_EQ(finding.size(), 4U);
}

TEST(CheckCommand, ItsExitCodeTellsALogThatCannotBeUsed) {
  const testing::TempFolder folder;
  const std::string path = writeLog(folder, "a.rawlog", 30);
  const std::string bytes = files::readTextFile(path);
  files::writeFileAtomically(folder / "half.rawlog", std::string_view(bytes).substr(0, bytes.size() / 2));
  const auto half = rasterslam("check half.rawlog", folder.path());
  EXPECT_EQ(half.exit_code, 3);
  EXPECT_THAT(half.out, HasSubstr("error   damage     half.rawlog: truncated"));
  EXPECT_THAT(half.out, EndsWith("\nnot usable as it is\n"));
  const auto missing = rasterslam("check nothing.rawlog --json", folder.path());
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_THAT(json::parse(missing.out)["error"].get<std::string>(), HasSubstr("nothing.rawlog"));
  EXPECT_EQ(rasterslam("check a.rawlog --label FRONT", folder.path()).exit_code, 3);
}

TEST(EditCommands, CutSalvageMergeAndFilterWorkTogether) {
  const testing::TempFolder folder;
  writeLog(folder, "a.rawlog", 30);
  const auto first = rasterslam("cut a.rawlog --to 3 -o b.rawlog", folder.path());
  EXPECT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(first.out, "60 objects: 30 as they were, 0 changed, 30 dropped\n  b.rawlog\n");
  const auto second = rasterslam("cut a.rawlog --from @1700000003 -o c.rawlog -q --json", folder.path());
  EXPECT_EQ(json::parse(second.out)["unchanged"], 30);
  const auto whole = rasterslam("merge b.rawlog c.rawlog -o d.rawlog", folder.path());
  EXPECT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_EQ(files::readTextFile(folder / "d.rawlog"), files::readTextFile(folder / "a.rawlog"));
  const auto thin = rasterslam("filter a.rawlog --every 10 --mount 0.1,0,90 -o e.rawlog", folder.path());
  EXPECT_THAT(thin.out, HasSubstr("60 objects: 1 as they were, 5 changed, 54 dropped\n"
                                  "2 actions took up the motion of dropped steps\n"));
  const auto info = json::parse(rasterslam("info e.rawlog --json", folder.path()).out);
  EXPECT_EQ(info["scans"], 3);
  EXPECT_NEAR(info["odometry_length_m"].get<double>(), 0.4, 1e-9);
  EXPECT_EQ(info["mount"][0], 0.1);
}

TEST(EditCommands, ArgmaxIsToldTheCommandsByTheOperationLogAsLongAsAllScansAreThere) {
  const testing::TempFolder folder;
  writeLog(folder, "a.rawlog", 30);
  const auto driven = [&](const std::string& flags) {
    const auto filtered = rasterslam(
        "filter a.rawlog " + flags + " --odometry argmax -o b.rawlog -q --overwrite", folder.path());
    EXPECT_EQ(filtered.exit_code, 0) << filtered.err;
    return json::parse(rasterslam("info b.rawlog --json", folder.path()).out)["odometry_length_m"]
        .get<double>();
  };
  // The wall ahead comes nearer by 2 cm at each scan; the wheels say that this is a move.
  EXPECT_NEAR(driven(""), 0.58, 0.02);
  files::writeFileAtomically(folder / "a.operations.txt", "m 0 0.58 0 29\n");
  EXPECT_NEAR(driven(""), 0.58, 0.02);
  // Told that it only turned, it does not move, whatever the wheels say.
  files::writeFileAtomically(folder / "a.operations.txt", "t 0 0 29\n");
  EXPECT_EQ(driven(""), 0);
  // Of every third scan the operation log says nothing.
  EXPECT_NEAR(driven("--every 3"), 0.54, 0.02);
}

TEST(EditCommands, FilterPutsOdometryFromTheScansInPlaceOfTheLogs) {
  const testing::TempFolder folder;
  writeLog(folder, "a.rawlog", 30);
  const auto plain = rasterslam("filter a.rawlog --odometry correlation -o b.rawlog", folder.path());
  EXPECT_EQ(plain.exit_code, 0) << plain.err;
  EXPECT_THAT(plain.out, HasSubstr("correlation odometry of 30 scans of 'LASER', "));
  EXPECT_THAT(plain.out, HasSubstr("30 movements of the log's own odometry left out, 60 objects written"));
  // After the other edits: of every third scan.
  const auto thin = rasterslam(
      "filter a.rawlog --every 3 --odometry plicp --form observation --json -o c.rawlog -q", folder.path());
  EXPECT_EQ(thin.exit_code, 0) << thin.err;
  const auto object = json::parse(thin.out);
  EXPECT_EQ(object["odometry"], "plicp");
  EXPECT_EQ(object["motions"], 10);
  EXPECT_THAT(rasterslam("info c.rawlog", folder.path()).out,
              HasSubstr("CObservationOdometry 'ODOMETRY': 10"));
  size_t files = 0;
  for (const auto& entry : fs::directory_iterator(folder.path())) files += entry.is_regular_file();
  EXPECT_EQ(files, 3U) << "nothing half-written is left";
  EXPECT_EQ(rasterslam("filter a.rawlog --odometry plicp -o b.rawlog", folder.path()).exit_code, 3);
}

TEST(EditCommands, ReplaceNothingUnasked) {
  const testing::TempFolder folder;
  writeLog(folder, "a.rawlog", 5);
  const auto refused = rasterslam("filter a.rawlog --every 2 -o a.rawlog", folder.path());
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, HasSubstr("a.rawlog: exists; give --overwrite to replace it"));
  EXPECT_EQ(rasterslam("filter a.rawlog --every 2 -o a.rawlog --overwrite -q", folder.path()).exit_code, 0);
  EXPECT_EQ(json::parse(rasterslam("info a.rawlog --json", folder.path()).out)["scans"], 3);
}

TEST(EditCommands, SayWhatTheyCannotUnderstand) {
  const testing::TempFolder folder;
  writeLog(folder, "a.rawlog", 5);
  for (const auto& [arguments, words] : std::map<std::string, std::string>{
           {"cut a.rawlog -o b.rawlog", "expected one of them"},
           {"cut a.rawlog --from noon -o b.rawlog", "--from: found 'noon', expected seconds after"},
           {"filter a.rawlog --mount 1,2 -o b.rawlog", "--mount: found '1,2', expected X,Y,DEG"},
           {"filter a.rawlog --mount 1,2,x -o b.rawlog", "--mount: found 'x', expected X,Y,DEG"},
           {"filter a.rawlog --shift LASER -o b.rawlog", "--shift: found 'LASER', expected LABEL=SECONDS"},
           {"filter a.rawlog --shift FRONT=1 -o b.rawlog", "no observation with the sensor label 'FRONT'"},
           {"filter a.rawlog --odometry wheels -o b.rawlog",
            "--odometry: found 'wheels', expected one of argmax, "},
           {"filter a.rawlog --odometry plicp --form frames -o b.rawlog",
            "--form: found 'frames', expected action"},
           {"filter a.rawlog --form action -o b.rawlog", "--form: goes with --odometry"},
           {"merge a.rawlog nothing.rawlog -o b.rawlog", "nothing.rawlog"}}) {
    const auto result = rasterslam(arguments, folder.path());
    EXPECT_EQ(result.exit_code, 3) << arguments;
    EXPECT_THAT(result.err, HasSubstr(words)) << arguments;
    EXPECT_FALSE(fs::exists(folder / "b.rawlog")) << arguments;
    EXPECT_THAT(testing::leftoversIn(folder.path()), ::testing::IsEmpty()) << arguments;
  }
}

TEST(InfoCommand, ListsEveryStream) {
  const testing::TempFolder folder;
  writeLog(folder, "a.rawlog", 30);
  EXPECT_THAT(rasterslam("info a.rawlog", folder.path()).out,
              HasSubstr("stream      CObservation2DRangeScan 'LASER': 30, 5.00 Hz\n"));
  const auto streams = json::parse(rasterslam("info a.rawlog --json", folder.path()).out)["streams"];
  ASSERT_EQ(streams.size(), 2U);
  EXPECT_EQ(streams[0]["kind"], "CActionCollection");
  EXPECT_EQ(streams[1]["count"], 30);
  EXPECT_NEAR(streams[1]["rate_hz"].get<double>(), 5, 1e-6);
}

TEST(Cut, KeepsTruthAndPlan) {
  const testing::TempFolder folder;
  const auto run = [&](const std::string& arguments) { return rasterslam(arguments, folder.path()); };
  ASSERT_EQ(run("simulate flat -o whole.rawlog --duration 12 -q --set lidar.beams=91").exit_code, 0);
  const auto cut = run("cut whole.rawlog --from 4 --to 9 -o part.rawlog");
  ASSERT_EQ(cut.exit_code, 0) << cut.err;
  EXPECT_THAT(cut.out, HasSubstr("part.gt.tum"));
  const auto scored =
      nlohmann::json::parse(run("compare part.rawlog --methods naive_wheel -o cmp --json -q").out);
  EXPECT_LT(scored["scores"]["rows"][0]["ate_final_m"].get<double>(), 0.2);
  EXPECT_TRUE(scored["scores"]["rows"][0]["wall_f1"].is_number()) << "the plan was found";
  const auto truth = files::readTextFile(folder / "part.gt.tum");
  EXPECT_EQ(std::count(truth.begin(), truth.end(), '\n'), 1 + 25) << "a heading, and 5 s at 5 Hz";
  fs::remove(folder / "part.rawlog");
  EXPECT_THAT(run("cut whole.rawlog --from 4 -o part.rawlog").err, HasSubstr("part.gt.tum"));
  EXPECT_FALSE(fs::exists(folder / "part.rawlog"));
}

}  // namespace
}  // namespace slam::apps
