/// What becomes of outputs when the machine, a user or another program gets in the way.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "libslam/files/files.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

long linesOf(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

class Outputs : public CommandsInAFolder {
 protected:
  static void SetUpTestSuite() { fill({"simulate flat -o run.rawlog --duration 20 --seed 2 -q"}); }
  /// A line of bash in the folder; $R is the program.
  static testing::CommandResult shell(const std::string& line) {
    return testing::runCommand("cd '" + shared_folder->path() + "' && R='" RASTERSLAM_PROGRAM "' bash -c '" +
                               line + "'");
  }
  static testing::TempFolder& folder() { return *shared_folder; }
};

TEST_F(Outputs, LeaveOthersTemporaryFilesAlone) {
  fs::create_directories(folder() / "mine.tmp");
  files::writeFileAtomically(folder() / "mine.tmp/thesis.txt", "p");
  EXPECT_EQ(run("run naive_wheel run.rawlog -o mine -q").exit_code, 0);
  EXPECT_EQ(run("run naive_wheel none.rawlog -o mine2 -q").exit_code, 3);
  EXPECT_EQ(files::readTextFile(folder() / "mine.tmp/thesis.txt"), "p");
  files::writeFileAtomically(folder() / "target", "q");
  fs::create_symlink("target", folder() / "copy.rawlog.tmp");
  EXPECT_EQ(run("convert run.rawlog copy.rawlog").exit_code, 0);
  EXPECT_EQ(files::readTextFile(folder() / "target"), "q");
  EXPECT_TRUE(fs::is_symlink(folder() / "copy.rawlog.tmp"));
}

TEST_F(Outputs, ReplaceNoDevice) {
  ASSERT_EQ(shell("mkfifo pipe").exit_code, 0);
  for (const std::string command : {"simulate flat --duration 5 -o pipe", "convert run.rawlog pipe",
                                    "run naive_wheel run.rawlog -o pipe", "plot map run.rawlog -o pipe"}) {
    const auto refused = run(command + " --overwrite");
    EXPECT_NE(refused.exit_code, 0) << command;
    EXPECT_EQ(linesOf(refused.err), 1) << command << ": " << refused.err;
    EXPECT_TRUE(fs::is_fifo(folder() / "pipe")) << command;
  }
}

TEST_F(Outputs, AreNotLostInSilenceWhenStandardOutputIsFull) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
  for (const std::string command : {"info run.rawlog", "info run.rawlog --json", "list methods",
                                    "check run.rawlog --json -q", "--help", "--version", "simulate --help"}) {
    const auto lost = shell("\"$R\" " + command + " >/dev/full");
    EXPECT_EQ(lost.exit_code, 1) << command;
    EXPECT_EQ(lost.err, "rasterslam: standard output: cannot be written: No space left on device\n")
        << command;
  }
}

TEST_F(Outputs, BlameNoMethodForAFullDisk) {
  const auto full =
      shell("ulimit -f 4; \"$R\" compare run.rawlog -o full --methods naive_wheel,naive_correlation -q");
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_EQ(linesOf(full.err.substr(full.err.rfind("rasterslam:"))), 1) << full.err;
  EXPECT_THAT(full.err, HasSubstr("File too large"));
  EXPECT_THAT(testing::leftoversIn(folder().path()), IsEmpty());
  const auto simulated = shell("ulimit -f 1; \"$R\" simulate flat -o big.rawlog --duration 20 -q");
  EXPECT_EQ(simulated.exit_code, 1);
  EXPECT_EQ(linesOf(simulated.err), 1) << simulated.err;
  EXPECT_FALSE(fs::exists(folder() / "big.rawlog"));
  EXPECT_THAT(testing::leftoversIn(folder().path()), IsEmpty());
}

TEST_F(Outputs, HaveOneWriter) {
  if (!testing::programExists("flock")) GTEST_SKIP() << "no flock(1) on this system";
  for (const std::string command :
       {"run naive_wheel run.rawlog -o shared", "compare run.rawlog -o shared --methods naive_wheel",
        "explore flat -o shared --duration 5"}) {
    const auto second = shell("touch shared.lock; flock shared.lock \"$R\" " + command);
    EXPECT_EQ(second.exit_code, 3) << command;
    EXPECT_EQ(second.err, "rasterslam: shared: another run is writing it\n") << command;
    EXPECT_FALSE(fs::exists(folder() / "shared")) << command;
  }
  fs::remove(folder() / "shared.lock");
}

TEST_F(Outputs, AreWrittenByNobodyWhenCompareWasKilled) {
  // The method's process is long; it has to end when that which measures it is killed, and the next can go on
  // at once.
  const auto killed = shell(
      "\"$R\" simulate office_loop -o long.rawlog --duration 600 --seed 3 -q >/dev/null && "
      "{ \"$R\" compare long.rawlog -o killed --methods rbpf_exact -q & compare=$!; "
      "until child=$(pgrep -P $compare); do kill -0 $compare || exit 9; done; "
      "kill -KILL $compare; timeout 100 tail --pid=$child -f /dev/null; echo $?; }");
  EXPECT_EQ(killed.out, "0\n") << killed.err;
  const auto resumed = run("compare long.rawlog -o killed --methods naive_wheel --resume -q");
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
}

TEST_F(Outputs, GoToStandardOutputWhereTheyAreOneStream) {
  ASSERT_EQ(run("run graph run.rawlog -o mapped -q").exit_code, 0);
  const std::pair<std::string, std::string> streams[] = {{"relations run.gt.tum", "relations"},
                                                         {"graph optimise mapped/graph.g2o", "g2o"},
                                                         {"plot map mapped", "png"}};
  for (const auto& [command, suffix] : streams) {
    ASSERT_EQ(run(command + " -o whole." + suffix).exit_code, 0) << command;
    for (const std::string name : {"-", "/dev/stdout"}) {
      const auto stream = shell("\"$R\" " + command + " -o " + name + " >stream");
      EXPECT_EQ(stream.exit_code, 0) << command << ": " << stream.err;
      EXPECT_EQ(files::readTextFile(folder() / "stream"),
                files::readTextFile(folder() / ("whole." + suffix)));
    }
    EXPECT_EQ(shell("\"$R\" " + command + " -o - >/dev/full").exit_code, 1) << command;
  }
  EXPECT_FALSE(fs::exists(folder() / "-"));
}

TEST_F(Outputs, AreRefusedStandardOutputWhereTheyAreNone) {
  for (const std::string command :
       {"simulate flat --duration 5 -o -", "run naive_wheel run.rawlog -o /dev/stdout",
        "convert run.rawlog -", "cut run.rawlog -o - --to 2"}) {
    const auto refused = run(command);
    EXPECT_EQ(refused.exit_code, 2) << command;
    EXPECT_EQ(linesOf(refused.err), 1) << refused.err;
    EXPECT_THAT(refused.err, HasSubstr("found standard output, expected a name")) << command;
    EXPECT_EQ(refused.out, "");
  }
  EXPECT_FALSE(fs::exists(folder() / "-"));
}

TEST_F(Outputs, OfKilledWritersAreCleanedUp) {
  // Killed as soon as the log in the making is there; the next run into it finds what is left.
  const auto killed = shell(
      "{ \"$R\" simulate office_loop -o left.rawlog --duration 2000 --seed 3 -q & pid=$!; "
      "until ls left.rawlog.rasterslam-* >/dev/null 2>&1; do kill -0 $pid || exit 9; done; kill -KILL $pid; "
      "wait $pid; "
      "ls left.rawlog.rasterslam-* | wc -l; }");
  EXPECT_EQ(killed.out, "1\n") << killed.err;
  EXPECT_EQ(run("simulate flat -o left.rawlog --duration 5 --seed 3 -q").exit_code, 0);
  EXPECT_THAT(testing::leftoversIn(folder().path()), IsEmpty());
}

// Ctrl-C reaches all that runs in the terminal: the comparison and the methods' processes.
TEST_F(Outputs, SayOnceThatTheyWereInterruptedAndHowToGoOn) {
  files::writeFileAtomically(
      folder() / "waits.ini",
      "[method]\ntype = external\ncommand = touch {here}/waiting; sleep 600; echo {output}\n");
  const auto stopped = shell(
      "setsid \"$R\" compare run.rawlog -o stopped --threads 2 --methods naive_wheel,waits.ini -q & pid=$!; "
      "until [ -e waiting ] && [ -e stopped/naive_wheel ]; do kill -0 $pid || exit 9; done; kill -INT -- "
      "-$pid; wait $pid");
  EXPECT_EQ(stopped.exit_code, 130) << stopped.err;
  EXPECT_THAT(stopped.err,
              ::testing::StartsWith("rasterslam: interrupted; go on with: rasterslam compare run.rawlog"));
  EXPECT_THAT(stopped.err, EndsWith("--resume\n"));
  EXPECT_EQ(linesOf(stopped.err), 1) << stopped.err;
}

TEST(SlurmScripts, HoldNoLineOfOthers) {
  const testing::TempFolder folder;
  files::writeFileAtomically(
      folder / "a b;echo $(id).ini",
      "[suite]\nworlds = flat\nmethods = naive_wheel\nseeds = 1\n[simulation]\nduration_s = 5\n");
  const std::string submit = "bench submit \"a b;echo \\$(id).ini\" --engine slurm --tasks 2 -q -o ";
  const auto made = rasterslam(submit + "out", folder.path());
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(files::readTextFile(folder / "out/submit/sweep.sbatch"),
              HasSubstr("--job-name=a_b_echo___id_\n"));
  for (const std::string refused : {"$'b\nreboot'", "'c\"d'"}) {
    const auto no = testing::runCommand(
        "cd '" + folder.path() +
        "' && bash -c '\"$0\" "
        "bench submit *.ini --engine slurm --tasks 2 -q -o \"$1\"' '" RASTERSLAM_PROGRAM "' " +
        refused);
    EXPECT_EQ(no.exit_code, 3) << no.err;
    EXPECT_THAT(no.err, HasSubstr("which a Slurm script cannot hold"));
  }
}

TEST(Flags, TakeNoDurationOrSeedThatIsNone) {
  for (const std::string flag : {"--duration -5", "--duration nan", "--duration inf", "--duration 5s",
                                 "--seed -1", "--seed 1.5", "--seed 99999999999999999999999"}) {
    const testing::TempFolder folder;
    for (const std::string command : {"simulate flat -o a.rawlog ", "explore flat -o a "}) {
      const auto refused = rasterslam(command + flag, folder.path());
      EXPECT_EQ(refused.exit_code, 2) << command << flag;
      EXPECT_EQ(linesOf(refused.err), 1) << command << flag << ": " << refused.err;
      EXPECT_TRUE(fs::is_empty(folder.path())) << command << flag;
    }
  }
}

}  // namespace
}  // namespace slam::apps
