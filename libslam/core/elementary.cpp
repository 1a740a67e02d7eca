#include "libslam/core/elementary.h"

#include <cmath>
#include <cstdint>

#include "libslam/core/double_double.h"
#include "libslam/core/elementary_tables.h"
#include "libslam/core/numbers.h"

namespace slam::core {
namespace {

// ln 2 in two parts, of which the first is a multiple of 2^-42; ln 2 / 128 so that 2^17 times the first part
// is exact.
constexpr double kLn2High = 0x1.62e42fefa3800p-1, kLn2Low = 0x1.ef35793c76730p-45;
constexpr double kStepHigh = 0x1.62e42fefa0000p-8, kStepLow = 0x1.cf79abc9e3b3ap-47,
                 kOverStep = 0x1.71547652b82fep+7;

// 2^(steps / 128) e^r, for |r| <= ln(2) / 256 and a little beyond.
double powerOf(std::int64_t steps, double r) {
  const DoubleDouble& row = kPowersOfTwo[steps & 127];
  const double z = r * r;
  const double p = r + z * ((0x1.ffffffffffd5dp-2 + r * 0x1.5555555555494p-3) +
                            z * (0x1.55555d8caa4edp-5 + r * 0x1.111115c2f8786p-7));
  const double y = row.high + (row.low + row.high * p);
  const std::int64_t power = steps >> 7;
  if (power > -1022 && power < 1024) return y * fromBits(static_cast<std::uint64_t>(power + 1023) << 52);
  const std::int64_t rest = power > 0 ? 1 : -1000;  // by two steps, and one rounding at the end
  return y * fromBits(static_cast<std::uint64_t>(power - rest + 1023) << 52) *
         fromBits(static_cast<std::uint64_t>(rest + 1023) << 52);
}

// e^(high + low), for |low| far below |high|.
double expOf(double high, double low) {
  if (!(high <= 709.79)) return high > 0 ? kInfinity : high;  // beyond the largest number; NaN stays
  if (high < -745.14) return 0;
  const double k = (high * kOverStep + kToWhole) - kToWhole;
  return powerOf(static_cast<std::int64_t>(k), (high - k * kStepHigh) - (k * kStepLow - low));
}

// x = 2^k m with m in [lowest, 2 lowest), for a positive finite x.
struct Parted {
  double k, m;
};

Parted part(double x, double lowest) {
  double k = 0;
  if (x < 0x1p-1022) x *= 0x1p54, k = -54;
  const std::uint64_t bits = bitsOf(x);
  const auto power = static_cast<std::int64_t>(bits - bitsOf(lowest)) >> 52;
  return {k + static_cast<double>(power), fromBits(bits - (static_cast<std::uint64_t>(power) << 52))};
}

// x = 2^k / inverse (1 + r + rest), with a row of the table, |r| <= 2^-7, and r + rest exact: the inverse has
// ten bits.
struct NearOne {
  double k, r, rest;
  const LogRow& row;
};

NearOne nearOne(double x) {
  const auto [k, m] = part(x, 0.6875);
  const LogRow& row = kLogs[(bitsOf(m) - bitsOf(0.6875)) >> 45];
  const double top = fromBits(bitsOf(m) & 0xffffffffffe00000);
  const double high = top * row.inverse - 1, low = (m - top) * row.inverse, r = high + low;
  return {k, r, low - (r - high), row};
}

// (ln(1 + r) - r + r^2 / 2) / r^3.
double logTail(double r) {
  const double z = r * r;
  return (0x1.55555555555abp-2 + r * -0x1.000000000004dp-2) +
         z * ((0x1.99999988a4530p-3 + r * -0x1.55555546122dbp-3) +
              z * (0x1.2499695bbe45dp-3 + r * -0x1.000669cbcd663p-3));
}

bool logIsSpecial(double x, double* value) {
  if (x > 0 && x < kInfinity) return false;
  *value = x == 0 ? -kInfinity : x > 0 ? x : x < 0 ? kNaN : x;
  return true;
}

// ln of a positive finite number, to some 2^-66.
DoubleDouble logOf(double x) {
  const auto [k, r, rest, row] = nearOne(x);
  const double top = (r * 0x1p27 + r) - r * 0x1p27;  // 26 bits, whose square is exact
  const DoubleDouble first = fastTwoSum(k * kLn2High + row.log.high, r);
  const DoubleDouble second = fastTwoSum(first.high, -0.5 * top * top);
  const double low = (first.low + (row.log.low + k * kLn2Low + rest)) +
                     (second.low - 0.5 * (r - top) * (r + top)) + r * r * r * logTail(r);
  return fastTwoSum(second.high, low);
}

// factor (from + ln(1 + r + rest)), unrounded, for a factor whose first part has 26 bits.
DoubleDouble timesLog(const DoubleDouble& from, const NearOne& near, const DoubleDouble& factor) {
  const double r = near.r;
  const DoubleDouble sum = fastTwoSum(from.high, r);
  const double top = fromBits(bitsOf(sum.high) & 0xfffffffff8000000);
  const double rest = (sum.high - top) + (sum.low + (from.low + near.rest) + r * r * (r * logTail(r) - 0.5));
  return {top * factor.high, top * factor.low + rest * (factor.high + factor.low)};
}

}  // namespace

double exp(double x) {
  return expOf(x, 0);
}

double exp2(double x) {
  if (!(std::abs(x) < 1100)) return x > 0 ? kInfinity : x < 0 ? 0 : x;
  const double k = (x * 128 + kToWhole) - kToWhole, r = (x - k / 128) * 0x1.62e42fefa39efp-1;
  if (k >= 1024 * 128) return kInfinity;
  return k < -1076 * 128 ? 0 : powerOf(static_cast<std::int64_t>(k), r);
}

double log(double x) {
  double special;
  if (logIsSpecial(x, &special)) return special;
  const auto [k, r, rest, row] = nearOne(x);
  const DoubleDouble sum = fastTwoSum(k * kLn2High + row.log.high, r);
  return sum.high + (sum.low + (row.log.low + k * kLn2Low + rest) + r * r * (r * logTail(r) - 0.5));
}

double log1p(double x) {
  const double y = 1 + x;
  if (!(y > 0 && y < kInfinity)) return y == 0 ? -kInfinity : y > 0 ? y : kNaN;
  if (y == 1) return x;
  const double lost = x > 1 ? 1 - (y - x) : x - (y - 1);  // what the sum rounded away
  return log(y) + lost / y;
}

double log2(double x) {
  double special;
  if (logIsSpecial(x, &special)) return special;
  const NearOne near = nearOne(x);
  const DoubleDouble y = timesLog(near.row.log, near, {0x1.7154760000000p+0, 0x1.4ae0bf85ddf44p-26});
  const DoubleDouble sum = fastTwoSum(near.k, y.high);
  return sum.high + (sum.low + y.low);
}

double log10(double x) {
  double special;
  if (logIsSpecial(x, &special)) return special;
  const NearOne near = nearOne(x);
  const DoubleDouble from = {near.k * kLn2High + near.row.log.high, near.k * kLn2Low + near.row.log.low};
  const DoubleDouble y = timesLog(from, near, {0x1.bcb7b10000000p-2, 0x1.49b9438ca9aaep-28});
  return y.high + y.low;
}

double pow(double x, double y) {
  if (x == 1 || y == 0) return 1;
  if (std::isnan(x) || std::isnan(y)) return kNaN;
  const bool whole = std::abs(y) >= 0x1p53 || y == std::floor(y);
  const bool odd = whole && std::abs(y) < 0x1p53 && std::fmod(y, 2) != 0;
  const double sign = odd && std::signbit(x) ? -1 : 1, base = std::abs(x);
  if (base == 0) return sign * (y > 0 ? 0 : kInfinity);
  if (base == kInfinity) return sign * (y > 0 ? kInfinity : 0);
  if (x < 0 && !whole) return kNaN;
  if (base == 1) return sign;
  if (std::abs(y) > 0x1p70) return (base > 1) == (y > 0) ? kInfinity : 0;
  const DoubleDouble power = logOf(base) * DoubleDouble{y, 0};
  return sign * expOf(power.high, power.low);
}

double powerOfTen(int n) {
  double power = 1;
  for (int i = 0; i < std::abs(n) && i < 400; ++i) power *= 10;  // exact up to 10^22
  return n < 0 ? 1 / power : power;
}

double cbrt(double x) {
  static constexpr double kRoots[] = {1, 0x1.428a2f98d728bp+0, 0x1.965fea53d6e3dp+0};  // of 1, 2 and 4
  if (!(std::abs(x) > 0 && std::abs(x) < kInfinity)) return x;
  const auto [k, m] = part(std::abs(x), 0x1.6a09e667f3bcdp-1);
  const int power = static_cast<int>(k) + 1200, third = power / 3, over = power - 3 * third;
  const double wanted = m * static_cast<double>(1 << over);
  double root = kRoots[over] *
                (0x1.ce003fbcb2fffp-2 +
                 m * (0x1.d02f4c3d0351bp-1 +
                      m * (-0x1.137579f6ddf6ep-1 + m * (0x1.bf13e4375d96ep-3 - m * 0x1.37e57aff277f6p-5))));
  const double about = root * root * root;
  root *= (about + 2 * wanted) / (2 * about + wanted);  // a step of Halley's
  const DoubleDouble cube = twoProduct(root, root) * DoubleDouble{root, 0};
  root -= ((cube.high - wanted) + cube.low) / (3 * root * root);  // a step of Newton's
  return std::copysign(root * fromBits(static_cast<std::uint64_t>(third - 400 + 1023) << 52), x);
}

double hypot(double x, double y) {
  const double a = std::abs(x), b = std::abs(y), larger = a > b ? a : b;
  if (larger < 0x1p500 && larger > 0x1p-450) return std::sqrt(a * a + b * b);
  if (a == kInfinity || b == kInfinity) return kInfinity;
  if (!(larger > 0) && !std::isnan(a) && !std::isnan(b)) return 0;
  const double scale = larger < 1 ? 0x1p600 : 0x1p-600;
  return std::sqrt((a * scale) * (a * scale) + (b * scale) * (b * scale)) / scale;
}

}  // namespace slam::core
