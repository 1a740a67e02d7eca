#include "libslam/core/random.h"

#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"

namespace slam::core {
namespace {

std::uint64_t rotateLeft(std::uint64_t x, int k) {
  return (x << k) | (x >> (64 - k));
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::string_view name) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a of the name
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  std::uint64_t x = seed;
  const std::uint64_t mixed_seed = splitmix64(x);
  x = mixed_seed ^ hash;
  for (auto& word : state_) word = splitmix64(x);
}

std::uint64_t RandomStream::bits() {
  const std::uint64_t result = rotateLeft(state_[1] * 5, 7) * 9;
  const std::uint64_t t = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= t;
  state_[3] = rotateLeft(state_[3], 45);
  return result;
}

double RandomStream::uniform() {
  return static_cast<double>(bits() >> 11) * 0x1.0p-53;
}

std::uint64_t RandomStream::below(std::uint64_t count) {
  if (count == 0) throw ContractError("RandomStream::below: count must be positive");
  const std::uint64_t limit = UINT64_MAX - UINT64_MAX % count;  // the largest multiple of count
  std::uint64_t draw;
  do draw = bits();
  while (draw >= limit);
  return draw % count;
}

double RandomStream::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  double u, v, s;
  do {
    u = 2 * uniform() - 1;
    v = 2 * uniform() - 1;
    s = u * u + v * v;
  } while (s >= 1 || s == 0);
  const double factor = std::sqrt(-2 * core::log(s) / s);
  spare_ = v * factor;
  has_spare_ = true;
  return u * factor;
}

}  // namespace slam::core
