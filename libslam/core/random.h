#pragma once
#include <cstdint>
#include <string_view>

namespace slam::core {

/// 64 bits that look random, and the next state: splitmix64 (Steele, Lea and Flood, OOPSLA 2014). For what
/// draws so much that a RandomStream would take too long.
inline std::uint64_t splitmix64(std::uint64_t& state) {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// An independent, reproducible stream of random numbers: xoshiro256** (Blackman and Vigna, ACM TOMS 47(4),
/// 2021), its state filled by splitmix64() from (seed, name). The same seed and name give the same numbers on
/// every machine, compiler and build type; different names give unrelated numbers. One stream per consumer
/// ("lidar", "odometry", "strategy", "particle 17"), constructed fresh: no globals, no sharing between
/// threads.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view name);

  /// 64 uniform bits.
  std::uint64_t bits();
  /// Uniform in [0, 1), a multiple of 2^-53.
  double uniform();
  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform over 0 .. count-1, without bias. REQUIRES count > 0 (ContractError).
  std::uint64_t below(std::uint64_t count);
  /// Normal with mean 0 and standard deviation 1: the polar method (Marsaglia and Bray, 1964), ours because
  /// std::normal_distribution differs between libraries.
  double normal();
  /// Normal with mean 0. sigma = 0 still consumes the stream, so that switching a noise off moves nothing
  /// else.
  double normal(double sigma) { return sigma * normal(); }
  /// True with the given probability.
  bool chance(double probability) { return uniform() < probability; }

 private:
  std::uint64_t state_[4];
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace slam::core
