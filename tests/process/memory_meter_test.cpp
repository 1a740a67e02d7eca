#include "libslam/process/memory_meter.h"

#include <gtest/gtest.h>

#include <vector>

namespace slam::process {
namespace {

constexpr size_t kBytes = size_t{96} << 20;
constexpr double kMost_mb = 24, kLeast_mb = 72;

/// Memory that is looked into, so that no compiler leaves it out, as clang does a vector that nobody reads.
void takeAndGiveBack() {
  const std::vector<char> meanwhile(kBytes, 1);
  const volatile char* const seen = meanwhile.data();
  for (std::size_t i = 0; i < kBytes; i += 1024) ASSERT_EQ(seen[i], 1);
}

TEST(MemoryMeter, CountsWhatComesAfterItWasMade) {
  const std::vector<char> before(kBytes, 1);
  const MemoryMeter memory;
  EXPECT_LT(memory.peakMb(), kMost_mb);
  takeAndGiveBack();
  EXPECT_GT(memory.peakMb(), kLeast_mb) << "the peak, not what is left";
}

TEST(MemoryMeter, LeavesOutWhatItIsTold) {
  MemoryMeter memory;
  std::vector<char> left_out;
  memory.leaveOut([&] { left_out.assign(kBytes, 1); });
  EXPECT_LT(memory.peakMb(), kMost_mb);
  takeAndGiveBack();
  EXPECT_GT(memory.peakMb(), kLeast_mb);
  EXPECT_LT(memory.peakMb(), kLeast_mb + 2 * kMost_mb);
}

}  // namespace
}  // namespace slam::process
