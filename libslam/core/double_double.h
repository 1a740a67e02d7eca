#pragma once
#include <cfloat>
#include <cstdint>
#include <cstring>

// Neither x87's longer registers nor -ffast-math, which would take the exact sums apart.
static_assert(FLT_EVAL_METHOD == 0, "expected arithmetic in doubles (on 32-bit x86: -msse2 -mfpmath=sse)");
#if defined(__FAST_MATH__)
#error "expected no -ffast-math"
#endif

namespace slam::core {

/// A number as the unrounded sum of two doubles, |low| at most half a unit in the last place of `high`: some
/// 106 bits. The operations are exact where they say so, with IEEE rounding to nearest and no fused
/// multiply-add. Source: T. J. Dekker, A floating-point technique for extending the available precision (Num.
/// Math. 18, 1971); D. E. Knuth, The Art of Computer Programming, vol. 2, 4.2.2.
struct DoubleDouble {
  double high, low;
};

/// a + b exactly.
inline DoubleDouble twoSum(double a, double b) {
  const double sum = a + b, part = sum - a;
  return {sum, (a - (sum - part)) + (b - part)};
}

/// a + b exactly, for |a| >= |b| or a = 0.
inline DoubleDouble fastTwoSum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

/// a * b exactly, for |a|, |b| < 2^500 and a product far above underflow.
inline DoubleDouble twoProduct(double a, double b) {
  constexpr double kSplit = 0x1p27 + 1;
  const double ta = kSplit * a, tb = kSplit * b;
  const double a1 = ta - (ta - a), a2 = a - a1, b1 = tb - (tb - b), b2 = b - b1;
  const double product = a * b;
  return {product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2};
}

/// To some 2^-100 of the result.
inline DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble product = twoProduct(a.high, b.high);
  return fastTwoSum(product.high, product.low + (a.high * b.low + a.low * b.high));
}

/// To some 2^-100 of the larger one.
inline DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble sum = twoSum(a.high, b.high);
  return fastTwoSum(sum.high, sum.low + (a.low + b.low));
}

/// The 64 bits of a double: sign, 11 of the exponent, 52 of the mantissa.
inline std::uint64_t bitsOf(double x) {
  std::uint64_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}
inline double fromBits(std::uint64_t bits) {
  double x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}

/// x + this - this is x rounded to a whole number, for |x| < 2^51.
inline constexpr double kToWhole = 0x1.8p52;

}  // namespace slam::core
