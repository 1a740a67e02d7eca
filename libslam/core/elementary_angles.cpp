#include <cmath>
#include <cstdint>
#include <utility>

#include "libslam/core/double_double.h"
#include "libslam/core/elementary.h"
#include "libslam/core/numbers.h"

namespace slam::core {
namespace {

// pi/2 and pi to 106 bits, pi/2 in parts of 33 bits (times a whole number below 2^20 they are exact), and
// what remains.
constexpr DoubleDouble kHalfPi = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};
constexpr DoubleDouble kWholePi = {0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53};
constexpr double kHalfPi1 = 0x1.921fb54400000p+0, kHalfPi2 = 0x1.0b4611a600000p-34,
                 kHalfPi3 = 0x1.3198a2e000000p-69, kHalfPi4 = 0x1.b839a252049c1p-104;
constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;

// An angle less whole quarter turns: in [-pi/4, pi/4] and a little beyond, and how many quarters (mod 4).
struct Reduced {
  DoubleDouble rest;
  unsigned quarter;
};

// The bits of 2/pi behind the point, after a word of zeros.
constexpr std::uint64_t kTwoOverPiBits[] = {0,
                                            0xa2f9836e4e441529,
                                            0xfc2757d1f534ddc0,
                                            0xdb6295993c439041,
                                            0xfe5163abdebbc561,
                                            0xb7246e3a424dd2e0,
                                            0x06492eea09d1921c,
                                            0xfe1deb1cb129a73e,
                                            0xe88235f52ebb4484,
                                            0xe99c7026b45f7e41,
                                            0x3991d639835339f4,
                                            0x9c845f8bbdf9283b,
                                            0x1ff897ffde05980f,
                                            0xef2f118b5a0a6d1f,
                                            0x6d367ecf27cb09b7,
                                            0x4f463f669e5fea2d,
                                            0x7527bac7ebe5f17b,
                                            0x3d0739f78a5292ea,
                                            0x6bfb5fb11f8d5d08,
                                            0x56033046fc7b6bab,
                                            0xf0cfbc209af4361d};

std::uint64_t wordOfTwoOverPi(int first_bit) {
  const int at = first_bit + 64, word = at / 64, shift = at % 64;
  return shift == 0 ? kTwoOverPiBits[word]
                    : kTwoOverPiBits[word] << shift | kTwoOverPiBits[word + 1] >> (64 - shift);
}

// Payne and Hanek: x = m 2^e with a whole m; bits of 2/pi that give whole turns are left out, 192 others are
// multiplied by m. The top two bits of the product are quarters, the rest is the fraction of a quarter.
Reduced reduceLarge(double x) {
  __extension__ using Wide = unsigned __int128;
  const std::uint64_t bits = bitsOf(x) & ~(std::uint64_t{1} << 63);
  const std::uint64_t mantissa = (bits & ((std::uint64_t{1} << 52) - 1)) | std::uint64_t{1} << 52;
  const int first = static_cast<int>(bits >> 52) - 1075 - 2;
  std::uint64_t words[3];  // the highest first
  Wide carry = 0;
  for (int i = 2; i >= 0; --i) {
    carry += static_cast<Wide>(mantissa) * wordOfTwoOverPi(first + 64 * i);
    words[i] = static_cast<std::uint64_t>(carry);
    carry >>= 64;
  }
  auto quarter = static_cast<unsigned>(words[0] >> 62);
  words[0] &= ~(std::uint64_t{3} << 62);
  bool negative = false;
  if (words[0] >> 61 != 0) {  // beyond half a quarter: one more, and what is missing to it
    ++quarter, negative = true;
    words[2] = ~words[2] + 1;
    words[1] = ~words[1] + (words[2] == 0);
    words[0] = (~words[0] + (words[2] == 0 && words[1] == 0)) & ~(std::uint64_t{3} << 62);
  }
  DoubleDouble fraction = {0, 0};
  double scale = 0x1p-30;
  for (const std::uint64_t word : words)
    for (const std::uint64_t half : {word >> 32, word & 0xffffffff}) {
      const DoubleDouble sum = twoSum(fraction.high, static_cast<double>(half) * scale);
      fraction = {sum.high, fraction.low + sum.low};
      scale *= 0x1p-32;
    }
  DoubleDouble rest = kHalfPi * fastTwoSum(fraction.high, fraction.low);
  if (negative) rest = {-rest.high, -rest.low};
  if (x < 0) return {{-rest.high, -rest.low}, (4 - quarter) & 3};
  return {rest, quarter & 3};
}

// Cody and Waite in three parts, a fourth where they cancel: there the second part may outweigh the
// difference, too.
Reduced reduce(double x) {
  const double whole = x * kTwoOverPi + kToWhole, n = whole - kToWhole;
  const double first = x - n * kHalfPi1, second = n * kHalfPi2, high = first - second;
  const auto quarter = static_cast<unsigned>(bitsOf(whole)) & 3;
  if (std::abs(high) > 0x1p-10 || n == 0)
    return {fastTwoSum(high, ((first - high) - second) - n * kHalfPi3), quarter};
  const DoubleDouble exact = twoSum(first, -second);
  const DoubleDouble closer = twoSum(exact.high, -n * kHalfPi3);
  return {fastTwoSum(closer.high, (closer.low + exact.low) - n * kHalfPi4), quarter};
}

// |x| <= pi/4 and a little beyond.
double sineOf(const DoubleDouble& x) {
  const double z = x.high * x.high, zz = z * z;
  const double p = (-0x1.5555555555555p-3 + z * 0x1.1111111110bb2p-7) +
                   zz * ((-0x1.a01a019e83a9ep-13 + z * 0x1.71de379688c12p-19) +
                         zz * (-0x1.ae600b015927bp-26 + z * 0x1.5e0b197af9741p-33));
  return x.high + (x.high * z * p + x.low * (1 - 0.5 * z));
}

double cosineOf(const DoubleDouble& x) {
  const double z = x.high * x.high, zz = z * z, half = 0.5 * z, near = 1 - half;
  const double p = (0x1.5555555555555p-5 - z * 0x1.6c16c16c16967p-10) +
                   zz * ((0x1.a01a019f4eaf9p-16 - z * 0x1.27e4fa17d9624p-22) +
                         zz * (0x1.1eeb68e88cbb9p-29 - z * 0x1.907da2e9cd397p-37));
  return near + (((1 - near) - half) + (zz * p - x.high * x.low));
}

// atan(i / 16).
constexpr DoubleDouble kArcs[] = {
    {0x0.0p+0, 0x0.0p+0},
    {0x1.ff55bb72cfdeap-5, -0x1.c934d86d23f1dp-60},
    {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
    {0x1.7b97b4bce5b02p-3, 0x1.347b0b4f881cap-58},
    {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
    {0x1.362773707ebccp-2, -0x1.963a544b672d8p-57},
    {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
    {0x1.a64eec3cc23fdp-2, -0x1.24dec1b50b7ffp-56},
    {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
    {0x1.0657e94db30d0p-1, -0x1.d5b495f6349e6p-56},
    {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
    {0x1.345f01cce37bbp-1, 0x1.1021137c71102p-55},
    {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
    {0x1.5d58987169b18p-1, 0x1.0028e4bc5e7cap-57},
    {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
    {0x1.819d0b7158a4dp-1, -0x1.bf76229d3b917p-56},
    {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55},
};

// atan(small / large) for 0 <= small <= large, both far from overflow: tan(a - b) of the nearest arc of the
// table, whose product with `large` is exact in two parts.
DoubleDouble arcOf(double small, double large) {
  const double step = (16 * (small / large) + kToWhole) - kToWhole, c = step / 16;
  const double top = fromBits(bitsOf(large) & 0xfffffffff8000000), bottom = large - top;
  const double u = ((small - c * top) - c * bottom) / (large + c * small), z = u * u;
  const double p = -0x1.5555555555555p-2 +
                   z * (0x1.99999999998a4p-3 +
                        z * (-0x1.24924922a6e06p-3 + z * (0x1.c71c46c60ce88p-4 - z * 0x1.73986d264648ap-4)));
  const DoubleDouble& arc = kArcs[static_cast<int>(step)];
  const DoubleDouble sum = twoSum(arc.high, u);
  return {sum.high, sum.low + (arc.low + u * z * p)};
}

}  // namespace

// Without branches for the four quarters, which a processor would guess wrongly half of the time.
SinCos sinCos(double angle_rad) {
  const double size = std::abs(angle_rad);
  if (!(size < kInfinity)) return {kNaN, kNaN};
  if (size < 0x1p-27) return {angle_rad, 1};  // keeps -0, too
  const Reduced reduced = size < 0x1p20 ? reduce(angle_rad) : reduceLarge(angle_rad);
  const std::uint64_t s = bitsOf(sineOf(reduced.rest)), c = bitsOf(cosineOf(reduced.rest)),
                      quarter = reduced.quarter;
  const std::uint64_t swapped = (s ^ c) & (0 - (quarter & 1));
  return {fromBits(s ^ swapped ^ ((quarter & 2) << 62)), fromBits(c ^ swapped ^ (((quarter + 1) & 2) << 62))};
}

double sin(double angle_rad) {
  return sinCos(angle_rad).sine;
}

double cos(double angle_rad) {
  return sinCos(angle_rad).cosine;
}

double tan(double angle_rad) {
  const auto [s, c] = sinCos(angle_rad);
  return s / c;
}

double atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return kNaN;
  double a = std::abs(x), b = std::abs(y);
  const bool steep = b > a;
  double large = steep ? b : a, small = steep ? a : b;
  if (!(large < 0x1p1000 && large > 0x1p-900)) {
    if (large == kInfinity) {
      small = small == kInfinity ? 1 : 0, large = 1;
    } else if (large == 0) {
      large = 1;
    } else {
      const double scale = large > 1 ? 0x1p-100 : 0x1p150;
      small *= scale, large *= scale;
    }
  }
  // The arc itself, or a quarter or half turn less or more.
  static constexpr DoubleDouble kFrom[] = {{0, 0}, kWholePi, kHalfPi, kHalfPi};
  const bool left = std::signbit(x);
  const DoubleDouble arc = arcOf(small, large), &from = kFrom[2 * steep + left];
  const double sign = steep == left ? 1 : -1;
  const DoubleDouble sum = fastTwoSum(from.high, sign * arc.high);
  return std::copysign(sum.high + (sum.low + (from.low + sign * arc.low)), y);
}

double atan(double x) {
  return atan2(x, 1);
}

double asin(double x) {
  return std::abs(x) <= 1 ? atan2(x, std::sqrt((1 - x) * (1 + x))) : kNaN;
}

double acos(double x) {
  return std::abs(x) <= 1 ? atan2(std::sqrt((1 - x) * (1 + x)), x) : kNaN;
}

}  // namespace slam::core
