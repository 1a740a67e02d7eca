#include "libslam/process/worker.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
#include <iostream>
#include <thread>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/process/measured_process.h"
#include "libslam/testing/temp_folder.h"

namespace slam::process {
namespace {
using ::testing::HasSubstr;

WorkerResult resultOf(Worker worker) {
  while (worker.read()) {
  }
  return worker.wait();
}

class WorkerCopy : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!hasOneThread())
      GTEST_SKIP() << "tests before this one have left threads; by ctest each has its process";
  }
  testing::TempFolder folder_;
};

TEST_F(WorkerCopy, ACopyOfThisProcessSaysWhatItPrintsAndReturns) {
  std::cout << "";  // what waits in a buffer here is not the child's to write
  int changed = 1;
  const auto result = resultOf(Worker(
      [&] {
        changed = 2;
        std::cout << "out";
        std::cerr << "err";
        return 7;
      },
      folder_ / "stderr.txt"));
  EXPECT_EQ(result.exit_code, 7);
  EXPECT_FALSE(result.killed);
  EXPECT_EQ(result.out, "out");
  EXPECT_EQ(files::readTextFile(folder_ / "stderr.txt"), "err");
  EXPECT_EQ(changed, 1);
}

TEST_F(WorkerCopy, WhatACopyThrowsIsItsExitCodeAndALineOfJson) {
  const auto codeOf = [&](const auto& error) {
    return resultOf(Worker([&]() -> int { throw error; }, folder_ / "stderr.txt")).exit_code;
  };
  EXPECT_EQ(codeOf(core::IoError("x")), 1);
  EXPECT_EQ(codeOf(core::InputError("x")), 3);
  EXPECT_EQ(codeOf(core::MethodError("x")), 4);
  EXPECT_EQ(codeOf(core::Interrupted()), 130);
  const auto result = resultOf(Worker([]() -> int { throw core::IoError("full"); }, folder_ / "stderr.txt"));
  EXPECT_THAT(result.out, HasSubstr("\"error\":\"full\""));
}

TEST_F(WorkerCopy, ACopyHasTheFilesThatAProgramWouldHave) {
  const int own = open("/dev/null", O_RDONLY | O_CLOEXEC), shared = open("/dev/null", O_RDONLY);
  const auto isOpen = [](int file) { return fcntl(file, F_GETFD) >= 0; };
  const auto result = resultOf(
      Worker([&] { return (isOpen(own) ? 1 : 0) + (isOpen(shared) ? 2 : 0); }, folder_ / "stderr.txt"));
  EXPECT_EQ(result.exit_code, 2);
  close(own);
  close(shared);
}

TEST_F(WorkerCopy, ASignalShows) {
  const auto result = resultOf(Worker([]() -> int { std::abort(); }, folder_ / "stderr.txt"));
  EXPECT_TRUE(result.killed);
  EXPECT_EQ(result.exit_code, 128 + SIGABRT);
}

TEST_F(WorkerCopy, AProcessOfSeveralThreadsIsNotCopied) {
  EXPECT_TRUE(hasOneThread());
  std::promise<void> end;
  std::thread other([&] { end.get_future().wait(); });
  EXPECT_FALSE(hasOneThread());
  EXPECT_THROW(Worker([] { return 0; }, folder_ / "stderr.txt"), core::ContractError);
  end.set_value();
  other.join();
}

/// What a line of the shell does that says so into the pipe `line_out`, then waits for a minute, and would
/// say that it survived.
std::string sayAndWait(const std::string& line_out) {
  return "(echo started; sleep 60; echo survived) > '" + line_out + "'";
}

/// A pipe with a name, of which this test holds the reading end: it ends when no process is left that could
/// write.
class Witness {
 public:
  explicit Witness(const std::string& path) : path_(path) { EXPECT_EQ(mkfifo(path.c_str(), 0600), 0); }
  void waitForStart() {
    in_.open(path_);
    std::string said;
    ASSERT_TRUE(std::getline(in_, said));
  }
  std::string rest() { return std::string(std::istreambuf_iterator<char>(in_), {}); }

 private:
  std::string path_;
  std::ifstream in_;
};

// A child of the shell's, as scripts have them; a session of its own; a daemon, whose parents are gone.
const char* const kWaysToLive[] = {"%; true", "setsid sh -c \"%\"; true", "setsid sh -c \"% &\" & sleep 60"};

std::string lived(std::string way, const std::string& line_out) {
  return way.replace(way.find('%'), 1, sayAndWait(line_out));
}

TEST_F(WorkerCopy, TheProgramThatItMeasuresEndsWithIt) {
  for (const std::string way : kWaysToLive) {
    const std::string line_out = folder_ / ("line_out" + std::to_string(way.size()));
    Witness witness(line_out);
    Worker worker(
        [&] {
          runMeasured(lived(way, line_out), folder_.path(), {1000, 1000}, core::silentProgress());
          return 0;
        },
        folder_ / "stderr.txt");
    witness.waitForStart();
    worker.signal(SIGKILL);
    EXPECT_EQ(witness.rest(), "") << way;
    EXPECT_TRUE(worker.wait().killed);
  }
}

TEST_F(WorkerCopy, WhatAProgramLeavesBehindEndsWithIt) {
  const std::string line_out = folder_ / "line_out", started = folder_ / "started";
  Witness witness(line_out);
  std::thread reader([&] { witness.waitForStart(); });
  // The shell ends as soon as the daemon runs.
  mkfifo(started.c_str(), 0600);
  const auto outcome =
      runMeasured("setsid sh -c \"(echo started; echo now > '" + started + "'; sleep 60; echo survived) > '" +
                      line_out + "' &\"; read word < '" + started + "'; echo ended",
                  folder_.path(), {1000, 1000}, core::silentProgress());
  reader.join();
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.printed, "ended\n");
  EXPECT_EQ(witness.rest(), "");
}

TEST_F(WorkerCopy, WhatDetachesItselfIsCounted) {
  const std::string greedy = "awk 'BEGIN { while (1) a[i++] = i }'";
  EXPECT_THAT(
      runMeasured("setsid " + greedy + " & sleep 60", folder_.path(), {1000, 60}, core::silentProgress())
          .limit,
      HasSubstr("more than 60 MB"));
  EXPECT_GT(runMeasured("setsid sh -c 'i=0; while [ $i -lt 20000 ]; do i=$((i+1)); done'", folder_.path(),
                        {1000, 1000}, core::silentProgress())
                .cpu_s,
            0);
}

TEST_F(WorkerCopy, NoFileGrowsBeyondItsLimit) {
  const auto outcome = runMeasured("yes > big", folder_.path(), {1000, 1000, 0.5}, core::silentProgress());
  EXPECT_EQ(outcome.limit, "it wrote a file of more than 0.5 MB");
  EXPECT_EQ(std::filesystem::file_size(folder_ / "big"), 1U << 19);
}

TEST_F(WorkerCopy, WhatIsPrintedWithoutEndTakesNoMemory) {
  const auto outcome = runMeasured("echo begin; yes | head -c 40000000; echo the end", folder_.path(),
                                   {1000, 1000}, core::silentProgress());
  EXPECT_EQ(outcome.printed.size(),
            2 * (std::size_t{1} << 18) + std::string("\n[39475726 bytes left out]\n").size());
  EXPECT_THAT(outcome.printed, HasSubstr("\n[39475726 bytes left out]\n"));
  EXPECT_EQ(outcome.printed.substr(0, 8), "begin\ny\n");
  EXPECT_EQ(outcome.printed.substr(outcome.printed.size() - 10), "y\nthe end\n");
}

}  // namespace
}  // namespace slam::process
