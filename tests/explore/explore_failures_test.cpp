// Explorations that fail, and those that are refused before they begin.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/explore/explore.h"
#include "libslam/files/files.h"
#include "libslam/resources/resources.h"
#include "libslam/results/journal_file.h"
#include "libslam/testing/temp_folder.h"
#include "tests/explore/two_rooms.h"

namespace slam::explore {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST(Explore, AMethodThatFailsIsARowOrAnErrorAndLeavesNoFolder) {
  const testing::TempFolder folder;
  const std::string icp = files::readTextFile(resources::configsFolder() + "/methods/icp.ini");
  // A limit that the first map breaks stands for a method that fails.
  const std::string resolution = "resolution_m = 0.05";
  files::writeFileAtomically(folder / "cramped.ini",
                             std::string(icp).replace(icp.find(resolution), resolution.size(),
                                                      "resolution_m = 0.02\nmax_map_cells = 10000"));
  auto wanted = request(folder, twoRooms(), {quickConfig("quadrant", 20)}, folder / "cramped.ini");
  EXPECT_THROW(run(wanted), core::MethodError);
  EXPECT_FALSE(fs::exists(folder / "out"));
  EXPECT_THAT(testing::leftoversIn(folder.path()), ::testing::IsEmpty());
}

/// Stands for a method that fails when it has taken in so many scans.
class FailsAfter : public record::StepObserver {
 public:
  explicit FailsAfter(int scans) : left_(scans) {}
  void onStep(const record::Step&) override {
    if (--left_ == 0) throw core::MethodError("broken on purpose");
  }

 private:
  int left_;
};

TEST(Explore, AMethodThatFailsOnTheWayKeepsWhatItHadMapped) {
  const testing::TempFolder folder;
  FailsAfter observer(20);
  auto wanted = request(folder, twoRooms(), {quickConfig("quadrant", 20)}, "icp");
  wanted.observer = &observer;
  const auto result = run(wanted);
  EXPECT_EQ(result.failed, 1);
  ASSERT_EQ(result.runs.size(), 1U);
  EXPECT_THAT(result.runs[0].end_detail, HasSubstr("at scan 20 (3.8 s): broken on purpose"));
  EXPECT_THAT(result.scores.notes, ::testing::Contains(HasSubstr("failed: at scan 20")));
  const auto partial = results::loadRun(folder / "out");
  EXPECT_EQ(partial.manifest.results.at("status"), "incomplete");
  EXPECT_EQ(partial.estimate.size(), 20U);
  EXPECT_EQ(results::readJournal(folder / "out/journal.csv").back().event, core::JournalEvent::kFailed);
  EXPECT_TRUE(fs::exists(folder / "out/run.rawlog"));
  EXPECT_TRUE(fs::exists(folder / "out/map.simplemap"));
}

TEST(Explore, RefusesWhatCannotBe) {
  const testing::TempFolder folder;
  const auto refusal = [&](const ExploreRequest& wanted) {
    try {
      run(wanted);
    } catch (const core::InputError& error) {
      EXPECT_FALSE(fs::exists(wanted.output)) << error.what();
      EXPECT_THAT(testing::leftoversIn(folder.path()), ::testing::IsEmpty()) << error.what();
      return std::string(error.what());
    }
    return std::string("no error");
  };
  const auto with = [&](const std::vector<std::string>& settings, const std::string& slam = "icp") {
    return request(folder, twoRooms(), {quickConfig("quadrant", 5, settings)}, slam);
  };
  EXPECT_THAT(refusal(with({"simulation.start=0.05 0.05 0"})), HasSubstr("start"));
  EXPECT_THAT(refusal(with({"simulation.start=-3 2 0"})), HasSubstr("start"));
  EXPECT_THAT(refusal(with({"simulation.start=nowhere"})), HasSubstr("expected auto or x_m,y_m,yaw_deg"));
  EXPECT_THAT(refusal(with({"robot.side_m=4"})), HasSubstr("no free place for a robot of side 4 m"));
  EXPECT_THAT(refusal(with({}, "icq")), HasSubstr("did you mean 'icp'?"));
  auto twice = with({});
  twice.strategies.push_back(twice.strategies.front());
  EXPECT_THAT(refusal(twice), HasSubstr("strategy 'quadrant' is named twice"));
  EXPECT_THROW(quickConfig("quadrant", 5, {"exploration.stuk_s=4"}), core::InputError);
}

TEST(Record, AStrategyThatNeedsAMapIsSentToExplore) {
  const testing::TempFolder folder;
  const auto config = quickConfig("nearest_frontier", 5).record;
  EXPECT_THROW(record::record(twoRooms(), config, 1, folder / "run.rawlog", {}, core::silentProgress()),
               core::InputError);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

}  // namespace
}  // namespace slam::explore
