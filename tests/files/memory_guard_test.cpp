#include "libslam/files/memory_guard.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <new>

namespace slam::files {
namespace {

constexpr std::uint64_t kMiB = 1 << 20;

rlim_t limit() {
  rlimit now{};
  getrlimit(RLIMIT_AS, &now);
  return now.rlim_cur;
}

// By a call that no compiler may leave out, as clang does a vector's that nobody looks into.
bool canTake(std::uint64_t bytes) {
  try {
    ::operator delete(::operator new(bytes));
    return true;
  } catch (const std::bad_alloc&) {
    return false;
  }
}

TEST(MemoryGuard, RefusesWhatIsBeyondItsHeadroomAndIsLifted) {
  if (!MemoryGuard::isKept()) GTEST_SKIP() << "this build has an allocator of its own";
  const rlim_t before = limit();
  {
    const MemoryGuard guard(64 * kMiB);
    EXPECT_TRUE(canTake(16 * kMiB));
    EXPECT_FALSE(canTake(256 * kMiB));
    {
      const MemoryGuard wider(512 * kMiB);
      EXPECT_TRUE(canTake(256 * kMiB));
    }
    EXPECT_NE(limit(), before);  // one lives yet
  }
  EXPECT_EQ(limit(), before);
  EXPECT_TRUE(canTake(256 * kMiB));
}

TEST(MemoryGuard, ALimitThatIsLowerStays) {
  rlimit before{};
  getrlimit(RLIMIT_AS, &before);
  rlimit low = before;
  low.rlim_cur = std::uint64_t{1} << 46;
  if (setrlimit(RLIMIT_AS, &low) != 0) GTEST_SKIP() << "a lower limit is set already";
  {
    const MemoryGuard guard(std::uint64_t{1} << 60);
    EXPECT_EQ(limit(), low.rlim_cur);
  }
  EXPECT_EQ(limit(), low.rlim_cur);
  setrlimit(RLIMIT_AS, &before);
}

}  // namespace
}  // namespace slam::files
