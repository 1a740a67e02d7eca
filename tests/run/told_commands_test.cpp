#include "libslam/run/told_commands.h"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/record/record.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/resources/resources.h"
#include "libslam/run/build_map.h"
#include "libslam/sim/operation_log.h"
#include "libslam/testing/temp_folder.h"

namespace slam::run {
namespace {

namespace fs = std::filesystem;

record::RecordConfig originalRobot(double duration_s) {
  auto config = record::readRecordConfig(
      resources::readConfigFile(resources::configsFolder() + "/lidars/thesis_360.ini"));
  config.simulation.duration_s = duration_s;
  return config;
}

class ToldCommands : public ::testing::Test {
 protected:
  void SetUp() override {
    record::record(world::loadPlan(resources::resolvePlan("flat")), originalRobot(60), 7, log_, {},
                   core::silentProgress());
  }
  MapRun run(const std::string& method, const std::string& name) {
    return buildMap(log_, mapping::loadMethodConfig(resources::configsFolder() + "/methods", method), method,
                    7, folder_ / name, false, {}, core::silentProgress());
  }
  /// Root mean square of the distances, from the true start.
  double errorOf(const MapRun& run) {
    const auto truth = logs::readTum(folder_ / "run.gt.tum");
    double sum = 0;
    for (size_t i = 0; i < truth.size(); ++i)
      sum += std::pow(core::distance(core::position(core::between(truth.front().pose, truth[i].pose)),
                                     core::position(run.estimate[i].pose)),
                      2);
    return std::sqrt(sum / static_cast<double>(truth.size()));
  }

  testing::TempFolder folder_;
  std::string log_ = folder_ / "run.rawlog", operations_ = folder_ / "run.operations.txt";
};

TEST_F(ToldCommands, ComeFromTheOperationLogAndGiveItsOwnDeadReckoning) {
  const auto naive = run("naive", "naive");
  EXPECT_EQ(naive.commands_from, "operation log");
  const auto operations = sim::parseOperations(files::readTextFile(operations_), operations_);
  const auto replayed = sim::replayOperations(operations);
  for (size_t i = 0; i < operations.size(); ++i) {
    const auto& estimate = naive.estimate.at(operations[i].scan_after).pose;
    // The rawlog's angles are floats.
    ASSERT_NEAR(core::distance(estimate, replayed[i + 1].pose), 0, 1e-3) << i;
  }
  // A minute of drive, some 20 m and as many turns, each read in whole pixels and whole degrees.
  EXPECT_LT(errorOf(naive), 1);
  EXPECT_GT(errorOf(run("naive_blind", "blind")), errorOf(naive));
}

TEST_F(ToldCommands, ComeFromTheWheelsWhereThereIsNoOperationLog) {
  fs::remove(operations_);
  const auto naive = run("naive", "naive");
  EXPECT_EQ(naive.commands_from, "wheels");
  EXPECT_LT(errorOf(naive), 1) << "as by the operation log";
  EXPECT_EQ(resources::readManifest(folder_ / "naive/manifest.json").results.at("commands_from"), "wheels");
  EXPECT_THAT(commandsNote("naive", naive.commands_from), ::testing::HasSubstr("from the wheels"));
}

TEST_F(ToldCommands, AreNotAskedForByOtherMethods) {
  EXPECT_EQ(run("naive_wheel", "wheel").commands_from, "");
  EXPECT_EQ(run("naive_blind", "blind").commands_from, "");
  EXPECT_EQ(commandsNote("naive_blind", ""), "");
  EXPECT_EQ(commandsNote("naive", "operation log"), "");
}

TEST_F(ToldCommands, RefuseTheOperationLogOfALongerLog) {
  files::writeFileAtomically(operations_, "m -1 1 0 5\nm -1 1 500 501\n");
  EXPECT_THROW(run("naive", "naive"), core::InputError);
  EXPECT_FALSE(fs::exists(folder_ / "naive"));
}

/// The operations that a drive by hand leaves: standing, both keys held, ahead, and two commands of the same
/// kind.
TEST(OperationsOfADrive, HoldMovesTurnsAndArcsAndNoRest) {
  const testing::TempFolder folder;
  const std::vector<record::Order> orders = {
      robot::Command{0, 0, 0.2},          robot::Command{0.2, 0.4, 0.2},      robot::Command{0.2, 0.4, 0.2},
      robot::Command{0, 0, 0.2},          robot::Command{0.3, 0, 0.2},        robot::Command{0.3, 0, 0.2},
      record::Order({0.3, 0, 0.2}, true), record::Order({0.3, 0, 0.2}, true), robot::Command{0, -0.5, 0.2}};
  size_t next = 0;
  const auto commander = [&](const sim::Sensed&) {
    return next < orders.size() ? std::optional<record::Order>(orders[next++]) : std::nullopt;
  };
  record::recordCommands(world::loadPlan(resources::resolvePlan("flat")), originalRobot(60), 1,
                         folder / "run.rawlog", {}, core::silentProgress(), commander);
  const auto operations =
      sim::parseOperations(files::readTextFile(folder / "run.operations.txt"), "run.operations.txt");
  const std::vector<std::tuple<char, int, int>> expected = {
      {'a', 1, 3}, {'m', 4, 6}, {'m', 6, 7}, {'m', 7, 8}, {'t', 8, 9}};
  ASSERT_EQ(operations.size(), expected.size());
  for (size_t i = 0; i < operations.size(); ++i) {
    const auto& [kind, before, after] = expected[i];
    EXPECT_EQ(operations[i].kind, kind) << i;
    EXPECT_EQ(operations[i].scan_before, before) << i;
    EXPECT_EQ(operations[i].scan_after, after) << i;
    const double step_m = kind == 'm' ? 0.06 * (after - before) : operations[i].second;
    EXPECT_NEAR(operations[i].second, step_m, 0.11) << "to two pixels";
  }
}

}  // namespace
}  // namespace slam::run
