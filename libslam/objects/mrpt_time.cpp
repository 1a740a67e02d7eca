#include "libslam/objects/mrpt_time.h"

#include <cmath>
#include <limits>

#include "libslam/core/error.h"
#include "libslam/files/parameters.h"

namespace slam::objects {
namespace {

constexpr std::int64_t kTicksPerSecond = 10'000'000;
constexpr std::int64_t kNanosecondsPerTick = 100;
// From 1601-01-01 to 1970-01-01: 134774 days.
constexpr std::int64_t kUnixEpoch_s = 134'774LL * 86'400LL;
constexpr std::int64_t kUnixEpochTicks = kUnixEpoch_s * kTicksPerSecond;
constexpr double kYear10000_s = 253'402'300'800.0;

}  // namespace

std::int64_t mrptTicks(double time_s) {
  const double earliest_s = -static_cast<double>(kUnixEpoch_s);
  if (!(time_s > earliest_s && time_s < kYear10000_s))
    throw core::ContractError("a stamp of " + files::formatNumber(time_s) +
                              " s is outside the years 1601 to 9999");
  // Whole seconds and the rest apart: their product with 10^7 at once would not fit into a double's 53 bits.
  const double whole_s = std::floor(time_s);
  const double rest_s = time_s - whole_s;
  return kUnixEpochTicks + static_cast<std::int64_t>(whole_s) * kTicksPerSecond +
         std::llround(rest_s * static_cast<double>(kTicksPerSecond));
}

double secondsFromMrptTicks(std::int64_t ticks) {
  const std::int64_t since_epoch = ticks - kUnixEpochTicks;
  const std::int64_t whole_s = since_epoch / kTicksPerSecond;
  return static_cast<double>(whole_s) +
         static_cast<double>(since_epoch % kTicksPerSecond) / static_cast<double>(kTicksPerSecond);
}

std::int64_t mrptTicksFromUnixNanoseconds(std::int64_t time_ns) {
  std::int64_t ticks = time_ns / kNanosecondsPerTick, rest = time_ns % kNanosecondsPerTick;
  if (rest < 0) --ticks, rest += kNanosecondsPerTick;
  return kUnixEpochTicks + ticks + (2 * rest >= kNanosecondsPerTick ? 1 : 0);
}

std::int64_t unixNanosecondsFromMrptTicks(std::int64_t ticks) {
  constexpr std::int64_t kFurthest = std::numeric_limits<std::int64_t>::max() / kNanosecondsPerTick;
  if (ticks < kUnixEpochTicks - kFurthest || ticks > kUnixEpochTicks + kFurthest)
    throw core::ContractError("a stamp outside the years 1678 to 2262");
  return (ticks - kUnixEpochTicks) * kNanosecondsPerTick;
}

}  // namespace slam::objects
