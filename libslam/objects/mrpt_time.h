#pragma once
#include <cstdint>

namespace slam::objects {

/// MRPT counts time in ticks of 100 ns since 1601-01-01 (mrpt::Clock::time_point); 0 stands for "no stamp".
/// We use seconds since the Unix epoch in a double.
///
/// Seconds -> ticks -> seconds gives back the same double for stamps after 1987 (there a double is coarser
/// than a tick, 2.4e-7 s since 2004), and is off by at most half a tick before. For the same reason ticks ->
/// seconds -> ticks may be off by one tick for today's stamps. Rounds to the nearest, where
/// mrpt::Clock::fromDouble cuts off.
inline constexpr std::int64_t kNoStamp = 0;

/// REQUIRES a finite time from 1601 to the year 10000 (ContractError).
std::int64_t mrptTicks(double time_s);
double secondsFromMrptTicks(std::int64_t ticks);

/// Nanoseconds since the Unix epoch (ROS). Exact for whole ticks, else to the nearest tick.
std::int64_t mrptTicksFromUnixNanoseconds(std::int64_t time_ns);
/// Exact. REQUIRES a year from 1678 to 2262 (ContractError).
std::int64_t unixNanosecondsFromMrptTicks(std::int64_t ticks);

}  // namespace slam::objects
