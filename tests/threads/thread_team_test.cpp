#include "libslam/threads/thread_team.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <stdexcept>
#include <thread>
#include <vector>

#include "libslam/core/error.h"

namespace slam::threads {
namespace {

TEST(ThreadTeam, DoesEveryJobOnceWithAnyNumberOfThreads) {
  for (const int threads : {1, 2, 5}) {
    ThreadTeam team(threads);
    for (const size_t count : {0U, 1U, 3U, 100U}) {
      std::vector<int> done(count, 0);
      team.forEach(count, [&](size_t i) { ++done[i]; });
      EXPECT_EQ(done, std::vector<int>(count, 1));
    }
  }
}

TEST(ThreadTeam, KnowsWhatItsThreadsTook) {
  ThreadTeam alone(1), two(2);
  const auto work = [](size_t) {
    double sum = 0;
    for (int i = 0; i < 300000; ++i) sum += 1.0 / (i + 1);
    EXPECT_GT(sum, 1);
  };
  alone.forEach(20, work);
  EXPECT_EQ(alone.threadSeconds(), 0);
  // Whether the other thread comes to do a job is the system's affair.
  std::atomic<bool> has_other_begun{false};
  const auto caller = std::this_thread::get_id();
  two.forEach(20, [&](size_t i) {
    has_other_begun = has_other_begun || std::this_thread::get_id() != caller;
    while (!has_other_begun) std::this_thread::yield();
    work(i);
  });
  const double first = two.threadSeconds();
  EXPECT_GT(first, 0);
  two.forEach(20, work);
  EXPECT_GE(two.threadSeconds(), first);
}

TEST(ThreadTeam, ThrowsTheErrorOfTheFirstJobAndGoesOnWorking) {
  for (const int threads : {1, 4}) {
    ThreadTeam team(threads);
    std::vector<int> done(50, 0);
    try {
      team.forEach(50, [&](size_t i) {
        ++done[i];
        if (i % 20 == 7) throw std::runtime_error(std::to_string(i));
      });
      FAIL();
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "7");
    }
    EXPECT_EQ(done, std::vector<int>(50, 1));
    team.forEach(50, [&](size_t i) { ++done[i]; });
    EXPECT_EQ(done, std::vector<int>(50, 2));
  }
}

TEST(ThreadTeam, ThrowsTheErrorOfTheFirstJobAlsoWhenAnotherFailsBefore) {
  ThreadTeam team(2);
  for (int round = 0; round < 50; ++round) {
    std::atomic<bool> has_other_begun{false};
    try {
      team.forEach(2, [&](size_t i) {
        has_other_begun = has_other_begun || i == 1;
        while (!has_other_begun) std::this_thread::yield();
        throw std::runtime_error(std::to_string(i));
      });
      FAIL();
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "0");
    }
  }
}

#if !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)  // with which no limit on addresses is kept
/// As in a container whose number of threads is limited; what ended the program before.
TEST(ThreadTeamDeathTest, WorksWithTheThreadsThatThereAre) {
  const auto doJobs = [] {
    rlimit limit{};
    getrlimit(RLIMIT_AS, &limit);
    limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, rlim_t{1} << 30);  // stacks of 8 MiB for some 100
    setrlimit(RLIMIT_AS, &limit);
    ThreadTeam team(1000);
    std::atomic<int> done{0};
    team.forEach(2000, [&](size_t) { ++done; });
    return done == 2000;
  };
  EXPECT_EXIT(std::exit(doJobs() ? 0 : 1), ::testing::ExitedWithCode(0), "");
}
#endif

TEST(ThreadTeam, NeedsAThread) {
  EXPECT_THROW(ThreadTeam{0}, core::ContractError);
}

}  // namespace
}  // namespace slam::threads
