#pragma once

namespace slam::core {

/// The elementary functions, with the same bits on every machine.
///
/// The C library chooses among several versions of its own by what the processor can do (fused multiply-add
/// or not), and changes them from release to release; they differ in the last bit, and a last bit decides
/// where a robot goes. These are fixed sequences of IEEE-754 double additions, multiplications, divisions and
/// square roots, rounded to nearest and not contracted (-ffp-contract=off), so the processor, the compiler
/// and the C library have no say. All that decides a byte of a result calls them; tests/architecture holds
/// that.
///
/// Error, in units in the last place: below 0.6 for exp, log and their like, 0.9 for sin and cos, 1 for pow,
/// 1.25 for atan, atan2, hypot and log1p, 2.5 for tan, asin and acos (tests/core/elementary_test.cpp).
/// Special values (signed zeros, infinities, NaN, poles) as C99, Annex F, has them; errno is left alone. Made
/// for rounding to nearest; other modes cost digits (sin: to 1e-9). Sources: argument reduction of W. J. Cody
/// and W. Waite, Software Manual for the Elementary Functions (1980), and of M. H. Payne and R. N. Hanek,
/// Radian reduction for trigonometric functions (SIGNUM Newsletter 18, 1983); tables of P. T. P. Tang,
/// Table-driven implementation of the exponential (of the logarithm) function (ACM TOMS 15, 1989; 16, 1990);
/// double-double steps after J.-M. Muller, Elementary Functions (3rd ed., 2016), ch. 4 to 6 and 11.
/// Coefficients are minimax fits (Remez), computed with 300 bits.

struct SinCos {
  double sine, cosine;
};

double sin(double angle_rad);
double cos(double angle_rad);
/// Both at about the price of one, with the same bits as sin() and cos().
SinCos sinCos(double angle_rad);
double tan(double angle_rad);

/// Radians in [-pi/2, pi/2]; NaN beyond [-1, 1].
double asin(double x);
/// Radians in [0, pi]; NaN beyond [-1, 1].
double acos(double x);
double atan(double x);
/// Radians in [-pi, pi].
double atan2(double y, double x);

double exp(double x);
double exp2(double x);
/// Natural; -infinity at 0, NaN below.
double log(double x);
double log1p(double x);
/// log2 is exact at powers of two, log10 at powers of ten.
double log2(double x);
double log10(double x);
/// NaN for x < 0 with a y that is no whole number.
double pow(double x, double y);
/// 10^n, rounded to nearest for n in [-22, 22].
double powerOfTen(int n);
double cbrt(double x);

/// The length of (x, y), without overflow or underflow on the way.
double hypot(double x, double y);

}  // namespace slam::core
