#include "libslam/process/worker.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <future>
#include <iostream>
#include <thread>

#include "libslam/core/error.h"
#include "libslam/core/files.h"
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
  testing::TempFolder folder;
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
      folder / "stderr.txt"));
  EXPECT_EQ(result.exit_code, 7);
  EXPECT_FALSE(result.killed);
  EXPECT_EQ(result.out, "out");
  EXPECT_EQ(core::readTextFile(folder / "stderr.txt"), "err");
  EXPECT_EQ(changed, 1);
}

TEST_F(WorkerCopy, WhatACopyThrowsIsItsExitCodeAndALineOfJson) {
  const auto codeOf = [&](const auto& error) {
    return resultOf(Worker([&]() -> int { throw error; }, folder / "stderr.txt")).exit_code;
  };
  EXPECT_EQ(codeOf(core::IoError("x")), 1);
  EXPECT_EQ(codeOf(core::InputError("x")), 3);
  EXPECT_EQ(codeOf(core::MethodError("x")), 4);
  EXPECT_EQ(codeOf(core::Interrupted()), 130);
  const auto result = resultOf(Worker([]() -> int { throw core::IoError("full"); }, folder / "stderr.txt"));
  EXPECT_THAT(result.out, HasSubstr("\"error\":\"full\""));
}

TEST_F(WorkerCopy, ACopyHasTheFilesThatAProgramWouldHave) {
  const int own = open("/dev/null", O_RDONLY | O_CLOEXEC), shared = open("/dev/null", O_RDONLY);
  const auto isOpen = [](int file) { return fcntl(file, F_GETFD) >= 0; };
  const auto result = resultOf(
      Worker([&] { return (isOpen(own) ? 1 : 0) + (isOpen(shared) ? 2 : 0); }, folder / "stderr.txt"));
  EXPECT_EQ(result.exit_code, 2);
  close(own);
  close(shared);
}

TEST_F(WorkerCopy, ASignalShows) {
  const auto result = resultOf(Worker([]() -> int { std::abort(); }, folder / "stderr.txt"));
  EXPECT_TRUE(result.killed);
  EXPECT_EQ(result.exit_code, 128 + SIGABRT);
}

TEST_F(WorkerCopy, AProcessOfSeveralThreadsIsNotCopied) {
  EXPECT_TRUE(hasOneThread());
  std::promise<void> end;
  std::thread other([&] { end.get_future().wait(); });
  EXPECT_FALSE(hasOneThread());
  EXPECT_THROW(Worker([] { return 0; }, folder / "stderr.txt"), core::ContractError);
  end.set_value();
  other.join();
}

TEST_F(WorkerCopy, TheProgramThatItMeasuresEndsWithIt) {
  const std::string line_out = folder / "line_out";
  ASSERT_EQ(mkfifo(line_out.c_str(), 0600), 0);
  // A child of the shell's, as scripts have them, holds the other end.
  Worker worker(
      [&] {
        runMeasured("(echo started; sleep 60; echo survived) > '" + line_out + "'; true", folder.path(),
                    folder / "printed.txt", {1000, 1000}, core::silentProgress());
        return 0;
      },
      folder / "stderr.txt");
  std::ifstream in(line_out);
  std::string said;
  ASSERT_TRUE(std::getline(in, said));
  worker.signal(SIGKILL);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "");
  EXPECT_TRUE(worker.wait().killed);
}

}  // namespace
}  // namespace slam::process
