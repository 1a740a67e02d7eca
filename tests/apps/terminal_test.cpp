#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "tests/apps/program.h"

namespace slam::apps {
namespace {
using ::testing::HasSubstr;
using ::testing::Not;

/// What a command says to a terminal of that many columns, which is both its outputs; 0 columns: one that
/// does not know.
std::string onTerminal(const std::string& arguments, int columns, const std::string& folder) {
  winsize size{};
  size.ws_col = static_cast<unsigned short>(columns), size.ws_row = 24;
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
  if (child == 0) {
    const std::string command = "cd '" + folder + "' && " + arguments;
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  std::string said;
  char buffer[4096];
  for (ssize_t got = 0; (got = read(terminal, buffer, sizeof buffer)) > 0;)
    said.append(buffer, static_cast<size_t>(got));
  int status = 0;
  waitpid(child, &status, 0);
  close(terminal);
  EXPECT_EQ(status, 0) << said;
  return said;
}

/// Letters of the longest line as the terminal shows it: a carriage return begins the line anew.
size_t widest(const std::string& said) {
  size_t most = 0, width = 0;
  for (size_t i = 0; i < said.size(); ++i) {
    if (said[i] == '\n' || said[i] == '\r') {
      width = 0;
    } else if (said.compare(i, 3, "\033[K") == 0) {
      i += 2;
    } else {
      width += (said[i] & 0xC0) != 0x80;
      most = std::max(most, width);
    }
  }
  return most;
}

class Terminal : public ::testing::Test {
 protected:
  testing::TempFolder folder_;
  const std::string program_ = "'" RASTERSLAM_PROGRAM "'";
};

TEST_F(Terminal, HasNoLineThatItWouldBreak) {
  for (const int columns : {60, 80, 132}) {
    const auto said =
        onTerminal("env -u COLUMNS TERM=xterm " + program_ +
                       " compare flat --methods naive_wheel,icp --duration 2 --overwrite -o out",
                   columns, folder_.path());
    EXPECT_LE(widest(said), static_cast<size_t>(columns)) << said;
    EXPECT_THAT(said, HasSubstr("naive_wheel"));
    EXPECT_THAT(said, HasSubstr("took"));  // a bar, to its end
    // The only sequence is that which wipes the line of the bar: no colour, with NO_COLOR or without.
    for (auto at = said.find('\033'); at != std::string::npos; at = said.find('\033', at + 1))
      EXPECT_EQ(said.compare(at, 3, "\033[K"), 0);
  }
}

TEST_F(Terminal, GetsNothingButErrorsFromAQuietCommand) {
  for (const std::string command : {"simulate flat -o run.rawlog --duration 2 -q", "check run.rawlog -q",
                                    "run naive_wheel run.rawlog -o out -q", "eval out --truth run.gt.tum -q",
                                    "compare run.rawlog --methods naive_wheel -o cmp --quiet",
                                    "report cmp -o cmp.html -q", "plot paths cmp -o paths.svg -q"}) {
    const auto done = rasterslam(command, folder_.path());
    EXPECT_EQ(done.exit_code, 0) << command;
    EXPECT_EQ(done.out + done.err, "") << command;
  }
  const auto refused = rasterslam("run naive_wheel none.rawlog -o none -q", folder_.path());
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_EQ(refused.out, "");
  EXPECT_THAT(refused.err, HasSubstr("none.rawlog"));
  // What --json and --print-config print was asked for.
  EXPECT_THAT(rasterslam("eval out --truth run.gt.tum -q --json", folder_.path()).out,
              HasSubstr("ate_rmse_m"));
  EXPECT_THAT(rasterslam("run naive_wheel run.rawlog -q --print-config", folder_.path()).out,
              HasSubstr("resolution_m"));
}

TEST_F(Terminal, ThatCanDoNothingGetsLines) {
  const auto said = onTerminal("env TERM=dumb " + program_ + " simulate flat --duration 2 -o run.rawlog", 80,
                               folder_.path());
  EXPECT_THAT(said, Not(HasSubstr("\033")));
  EXPECT_THAT(said, HasSubstr("done in"));
}

TEST_F(Terminal, ThatDoesNotKnowItsWidthIsAskedThroughTheEnvironment) {
  const std::string compare =
      program_ + " compare flat --methods naive_wheel,icp --duration 2 --overwrite -o out 2>/dev/null";
  EXPECT_LE(widest(onTerminal("env COLUMNS=56 " + compare, 0, folder_.path())), 56U);
  EXPECT_GT(widest(onTerminal("env COLUMNS=200 " + compare, 0, folder_.path())), 56U);
}

TEST_F(Terminal, IsNoMatterToAPipeOrAFile) {
  const std::string compare =
      " compare flat --methods naive_wheel,icp --duration 2 --overwrite -o out 2>/dev/null | sed -n 1,9p";
  const auto wide = testing::runCommand("cd '" + folder_.path() + "' && COLUMNS=200 " + program_ + compare);
  const auto narrow = testing::runCommand("cd '" + folder_.path() + "' && COLUMNS=50 " + program_ + compare);
  EXPECT_EQ(wide.out, narrow.out);
  EXPECT_LE(widest(wide.out), 80U);
}

TEST_F(Terminal, InfoIsBrokenAtItsWidth) {
  ASSERT_EQ(rasterslam("simulate flat -o run.rawlog --duration 2 -q", folder_.path()).exit_code, 0);
  const auto info = program_ + " info run.rawlog";
  const auto narrow = onTerminal(info, 50, folder_.path());
  EXPECT_LE(widest(narrow), 50U) << narrow;
  EXPECT_THAT(narrow, HasSubstr("\n            "));  // further lines under the first
  const auto piped = testing::runCommand("cd '" + folder_.path() + "' && " + info);
  EXPECT_LE(widest(piped.out), 80U);
  EXPECT_THAT(piped.out, HasSubstr("lidar       541 beams over 270.00 deg"));
}

}  // namespace
}  // namespace slam::apps
