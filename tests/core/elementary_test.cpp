#include "libslam/core/elementary.h"
#include "libslam/core/numbers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/core/random.h"

namespace slam::core {
namespace {

using core::kInfinity;
constexpr int kDraws = 100000;

using Function = double (*)(double);
using Function2 = double (*)(double, double);
using Reference = long double (*)(long double);
using Reference2 = long double (*)(long double, long double);

/// Units in the last place of the double nearest to `wanted`, which x87's extended precision gives to 64
/// bits.
double ulpsOff(double found, long double wanted) {
  const auto nearest = static_cast<double>(wanted);
  if (found == nearest || (std::isnan(found) && std::isnan(nearest))) return 0;
  if (!std::isfinite(found) || !std::isfinite(nearest)) return kInfinity;
  const int exponent = nearest == 0 ? -1074 : std::max(std::ilogb(nearest) - 52, -1074);
  return static_cast<double>(std::fabs(found - wanted) / std::ldexp(1.0L, exponent));
}

/// A finite number of any size and sign, all exponents alike.
double anyNumber(RandomStream& random) {
  for (;;) {
    const std::uint64_t bits = random.bits();
    double x;
    std::memcpy(&x, &bits, sizeof x);
    if (std::isfinite(x)) return x;
  }
}

template <class Draw>
double worst(Function function, Reference reference, Draw draw) {
  double ulps = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = draw();
    ulps = std::max(ulps, ulpsOff(function(x), reference(x)));
  }
  return ulps;
}

template <class DrawX, class DrawY>
double worst(Function2 function, Reference2 reference, DrawX draw_x, DrawY draw_y) {
  double ulps = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = draw_x(), y = draw_y();
    ulps = std::max(ulps, ulpsOff(function(x, y), reference(x, y)));
  }
  return ulps;
}

class Elementary : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::numeric_limits<long double>::digits < 64) GTEST_SKIP() << "long double is no better here";
  }
  double within(double low, double high) { return random_.uniform(low, high); }
  RandomStream random_{1, "arguments"};
};

// The largest errors over 2 000 000 arguments of each kind, in units: 0.88 for sine and cosine, 2.3 for the
// tangent, 1.06 for atan2, 1.01 for atan, 2.3 for asin, 1.5 for acos, 0.507 for exp, exp2, log, log2, log10
// and cbrt, 1.0 for log1p, 0.71 for pow, 1.16 for hypot.
TEST_F(Elementary, SinesAreGoodToOneUlpAtAnyAngle) {
  const auto usual = [&] { return within(-10, 10); };
  const auto large = [&] { return within(-1e6, 1e6); };
  const auto any = [&] { return anyNumber(random_); };
  const auto at_quarters = [&] {
    return std::round(within(-6e5, 6e5)) * (kPi / 2);
  };  // where most bits cancel
  EXPECT_LT(worst(sin, std::sin, usual), 1);
  EXPECT_LT(worst(cos, std::cos, usual), 1);
  EXPECT_LT(worst(tan, std::tan, usual), 2.5);
  EXPECT_LT(worst(sin, std::sin, large), 1);
  EXPECT_LT(worst(cos, std::cos, large), 1);
  EXPECT_LT(worst(sin, std::sin, any), 1);
  EXPECT_LT(worst(cos, std::cos, any), 1);
  EXPECT_LT(worst(sin, std::sin, at_quarters), 1);
  EXPECT_LT(worst(cos, std::cos, at_quarters), 1);
}

TEST_F(Elementary, ArcsAreGoodToAboutOneUlp) {
  const auto usual = [&] { return within(-10, 10); };
  const auto any = [&] { return anyNumber(random_); };
  const auto unit = [&] { return within(-1, 1); };
  EXPECT_LT(worst(atan2, std::atan2, usual, usual), 1.25);
  EXPECT_LT(worst(atan2, std::atan2, any, any), 1.25);
  EXPECT_LT(worst(atan, std::atan, any), 1.25);
  EXPECT_LT(worst(asin, std::asin, unit), 2.5);
  EXPECT_LT(worst(acos, std::acos, unit), 2.5);
}

TEST_F(Elementary, ExponentialsAndLogarithmsAreGoodToOneUlp) {
  const auto any = [&] { return std::abs(anyNumber(random_)); };
  const auto near_one = [&] { return within(0.5, 2); };
  EXPECT_LT(worst(exp, std::exp, [&] { return within(-708, 709); }), 0.6);
  EXPECT_LT(worst(exp, std::exp, [&] { return within(-2, 2); }), 0.6);
  EXPECT_LT(worst(exp2, std::exp2, [&] { return within(-1020, 1023); }), 0.6);
  EXPECT_LT(worst(log, std::log, any), 0.6);
  EXPECT_LT(worst(log, std::log, near_one), 0.6);
  EXPECT_LT(worst(log2, std::log2, any), 0.6);
  EXPECT_LT(worst(log2, std::log2, near_one), 0.6);
  EXPECT_LT(worst(log2, std::log2, [&] { return 1 + within(-1e-9, 1e-9); }), 0.6);
  EXPECT_LT(worst(log10, std::log10, near_one), 0.6);
  EXPECT_LT(worst(log1p, std::log1p, [&] { return within(-1, 3); }), 1.25);
  EXPECT_LT(worst(log1p, std::log1p, [&] { return within(-1e-9, 1e-9); }), 1.25);
  EXPECT_LT(worst(
                pow, std::pow, [&] { return within(0, 10); }, [&] { return within(-300, 300); }),
            1);
  EXPECT_LT(worst(cbrt, std::cbrt, [&] { return anyNumber(random_); }), 0.6);
}

TEST_F(Elementary, LengthsAreGoodToAboutOneUlpWithoutOverflow) {
  const auto usual = [&] { return within(-10, 10); };
  const auto any = [&] { return anyNumber(random_); };
  EXPECT_LT(worst(hypot, std::hypot, usual, usual), 1.25);
  EXPECT_LT(worst(hypot, std::hypot, any, any), 1.25);
}

TEST(ElementaryValues, PowersOfTwoAndTenAreExact) {
  for (int n = -1074; n < 1024; ++n) {
    EXPECT_EQ(log2(std::ldexp(1.0, n)), n);
    EXPECT_EQ(exp2(n), std::ldexp(1.0, n));
  }
  for (int n = -22; n <= 22; ++n) EXPECT_EQ(powerOfTen(n), std::stod("1e" + std::to_string(n)));
  for (int n = -307; n <= 308; ++n) EXPECT_EQ(log10(std::stod("1e" + std::to_string(n))), n);
}

/// The same number, or nearly, with the same sign of a zero; or both NaN.
void expectAlike(double found, long double wanted, const char* what, double x, double y = 0) {
  if (std::isnan(wanted)) {
    EXPECT_TRUE(std::isnan(found)) << what << ' ' << x << ' ' << y;
    return;
  }
  EXPECT_DOUBLE_EQ(found, static_cast<double>(wanted)) << what << ' ' << x << ' ' << y;
  EXPECT_EQ(std::signbit(found), std::signbit(wanted)) << what << ' ' << x << ' ' << y;
}

// Against the functions of long double: those of double are ours in this program (apps/same_bits.cpp).
TEST(ElementaryValues, ZerosInfinitiesAndNoNumbersAreThoseOfC) {
  using Wide = long double;
  const double special[] = {
      0.0,   -0.0,   1,       -1,      2,        -2,       3,         -3,
      0.5,   -0.5,   2.5,     -2.5,    NAN,      3e7,      9e15,      -9007199254740991.0,
      1e300, 5e-324, -5e-324, 1.7e308, -1.7e308, 2.3e-308, kInfinity, -kInfinity};
  for (const double x : special) {
    expectAlike(sin(x), std::sin(Wide{x}), "sin", x);
    expectAlike(cos(x), std::cos(Wide{x}), "cos", x);
    expectAlike(tan(x), std::tan(Wide{x}), "tan", x);
    expectAlike(asin(x), std::asin(Wide{x}), "asin", x);
    expectAlike(acos(x), std::acos(Wide{x}), "acos", x);
    expectAlike(atan(x), std::atan(Wide{x}), "atan", x);
    expectAlike(exp(x), std::exp(Wide{x}), "exp", x);
    expectAlike(exp2(x), std::exp2(Wide{x}), "exp2", x);
    expectAlike(log(x), std::log(Wide{x}), "log", x);
    expectAlike(log2(x), std::log2(Wide{x}), "log2", x);
    expectAlike(log10(x), std::log10(Wide{x}), "log10", x);
    expectAlike(log1p(x), std::log1p(Wide{x}), "log1p", x);
    expectAlike(cbrt(x), std::cbrt(Wide{x}), "cbrt", x);
    for (const double y : special) {
      expectAlike(atan2(x, y), std::atan2(Wide{x}, Wide{y}), "atan2", x, y);
      expectAlike(hypot(x, y), std::hypot(Wide{x}, Wide{y}), "hypot", x, y);
      expectAlike(pow(x, y), std::pow(Wide{x}, Wide{y}), "pow", x, y);
    }
  }
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
// MRPT and OpenCV, too, call ours in a program of ours: apps/same_bits.cpp. The C library's differ at some
// arguments in a hundred.
TEST(ElementaryValues, AreThoseOfTheWholeProgram) {
  RandomStream random(4, "arguments");
  for (int i = 0; i < 2000; ++i) {
    const volatile double x = random.uniform(0, 10), y = random.uniform(-3, 3);
    EXPECT_EQ(std::sin(x), sin(x));
    EXPECT_EQ(std::cos(x), cos(x));
    EXPECT_EQ(std::tan(x), tan(x));
    EXPECT_EQ(std::exp(x), exp(x));
    EXPECT_EQ(std::log(x), log(x));
    EXPECT_EQ(std::log10(x), log10(x));
    EXPECT_EQ(std::atan2(y, x), atan2(y, x));
    EXPECT_EQ(std::hypot(x, y), hypot(x, y));
    EXPECT_EQ(std::pow(x, y), pow(x, y));
    EXPECT_EQ(std::asin(x / 10), asin(x / 10));
    EXPECT_EQ(std::acos(x / 10), acos(x / 10));
  }
}
#endif

// Eigen and the compiler itself sum in another order, or fuse, where they may use what not every x86-64
// processor can do.
TEST(ElementaryValues, TheCompilerIsTakenForTheLeastProcessor) {
#if defined(__AVX__) || defined(__FMA__) || defined(__SSE3__) || defined(__FAST_MATH__)
  FAIL() << "expected a build without -march=native and -ffast-math: its results are not those of other "
            "machines";
#endif
}

TEST(ElementaryValues, RootsOfCubesAreExact) {
  for (int n = -1000; n <= 1000; ++n) EXPECT_EQ(cbrt(1.0 * n * n * n), n);
}

// They are made for rounding to nearest. Another mode, which a caller may have set, costs digits; no table is
// left.
TEST(ElementaryValues, OtherRoundingModesCostDigitsOnly) {
  RandomStream random(5, "arguments");
  std::vector<double> arguments;
  arguments.reserve(20000);
  for (int i = 0; i < 20000; ++i)
    arguments.push_back(i % 2 == 0 ? anyNumber(random) : random.uniform(-10, 10));
  const Function functions[] = {sin, cos, atan, exp, exp2, log, log2, log10, log1p, cbrt};
  const int usual_mode = std::fegetround();
  for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO})
    for (const auto function : functions)
      for (const double x : arguments) {
        const double usual = function(x);
        std::fesetround(mode);
        const double other = function(x);
        std::fesetround(usual_mode);
        if (!std::isfinite(usual) || !std::isfinite(other)) continue;
        ASSERT_NEAR(other, usual, 1e-9 * std::max(1.0, std::abs(usual))) << x << " mode " << mode;
      }
}

TEST(ElementaryValues, BothAtOnceAreTheSameBits) {
  RandomStream random(2, "angles");
  for (int i = 0; i < kDraws; ++i) {
    const double angle_rad = anyNumber(random);
    const auto [sine, cosine] = sinCos(angle_rad);
    EXPECT_EQ(sine, sin(angle_rad));
    EXPECT_EQ(cosine, cos(angle_rad));
  }
}

// One hash for every processor, compiler, build type and C library: FNV-1a over the bits of what the
// functions give.
TEST(ElementaryValues, TheBitsAreTheSameOnEveryMachine) {
  RandomStream random(3, "arguments");
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  const auto add = [&](double value) {
    std::uint64_t bits = 0;
    if (!std::isnan(value)) std::memcpy(&bits, &value, sizeof bits);
    hash = (hash ^ bits) * 0x100000001b3ULL;
  };
  for (int i = 0; i < kDraws; ++i) {
    const double x = i % 2 == 0 ? anyNumber(random) : random.uniform(-10, 10), y = random.uniform(-10, 10);
    for (const double value : {sin(x), cos(x), tan(x), atan(x), exp(x), exp2(x)}) add(value);
    for (const double value : {log(x), log2(x), log10(x), log1p(x), asin(x), acos(x)}) add(value);
    for (const double value : {atan2(y, x), hypot(x, y), pow(x, y), cbrt(x)}) add(value);
  }
  EXPECT_EQ(hash, 1152282773538620813U);
}

}  // namespace
}  // namespace slam::core
