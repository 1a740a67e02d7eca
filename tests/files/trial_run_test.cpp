#include "libslam/files/trial_run.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>

namespace slam::files {
namespace {

TEST(TrialRun, SurvivesEveryStepBeforeTheCrash) {
  TrialRun trial([](const TrialRun::Tell& tell) {
    tell(1), tell(2), tell(3);
    std::raise(SIGSEGV);
  });
  EXPECT_TRUE(trial.survives(0));
  EXPECT_TRUE(trial.survives(2));
  EXPECT_FALSE(trial.survives(3));
  EXPECT_TRUE(trial.survives(1)) << "asked anew";
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "a copy that has ended is buried";
}

TEST(TrialRun, SurvivesAllWhereTheWorkEndsOrThrows) {
  EXPECT_TRUE(TrialRun([](const TrialRun::Tell&) {}).survives(1000));
  EXPECT_TRUE(TrialRun([](const TrialRun::Tell&) { throw std::runtime_error("as here"); }).survives(1000));
}

TEST(TrialRun, LeavesNoCopyBehindThatStillWorks) {
  {
    TrialRun trial([](const TrialRun::Tell& tell) {
      tell(1);
      for (;;) pause();
    });
    EXPECT_TRUE(trial.survives(0));
    EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), 0) << "it lives";
  }
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
}

TEST(TrialRun, WhatIsTriedIsDoneHereOnlyWhenItDidNotCrash) {
  int done = 0;
  doTried([&done] { ++done; });
  EXPECT_EQ(done, 1);
  const auto parent = getpid();
  EXPECT_THROW(doTried([&done, parent] {
                 ++done;
                 if (getpid() != parent) std::abort();
               }),
               std::runtime_error);
  EXPECT_EQ(done, 1);
}

}  // namespace
}  // namespace slam::files
