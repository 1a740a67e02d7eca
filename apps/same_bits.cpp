// MRPT's and OpenCV's libraries call the C library's elementary functions, which gives one version or another
// by what the processor can do, and other ones from release to release. What a program itself defines comes
// before what its libraries do: with these, all that runs in it has the same bits on every machine
// (libslam/core/elementary.h). Not here: erf(), cabs(), sinh() and the like, which nothing calls that decides
// a byte of ours.
#include "libslam/core/elementary.h"

namespace core = slam::core;

#define RASTERSLAM_SAME_BITS extern "C" __attribute__((visibility("default")))

#define RASTERSLAM_ONE(name)                                       \
  RASTERSLAM_SAME_BITS double name(double x) {                     \
    return core::name(x);                                          \
  }                                                                \
  RASTERSLAM_SAME_BITS float name##f(float x) {                    \
    return static_cast<float>(core::name(static_cast<double>(x))); \
  }

#define RASTERSLAM_TWO(name)                                                               \
  RASTERSLAM_SAME_BITS double name(double x, double y) {                                   \
    return core::name(x, y);                                                               \
  }                                                                                        \
  RASTERSLAM_SAME_BITS float name##f(float x, float y) {                                   \
    return static_cast<float>(core::name(static_cast<double>(x), static_cast<double>(y))); \
  }

RASTERSLAM_ONE(sin)
RASTERSLAM_ONE(cos)
RASTERSLAM_ONE(tan)
RASTERSLAM_ONE(asin)
RASTERSLAM_ONE(acos)
RASTERSLAM_ONE(atan)
RASTERSLAM_ONE(exp)
RASTERSLAM_ONE(exp2)
RASTERSLAM_ONE(log)
RASTERSLAM_ONE(log2)
RASTERSLAM_ONE(log10)
RASTERSLAM_ONE(log1p)
RASTERSLAM_ONE(cbrt)
RASTERSLAM_TWO(atan2)
RASTERSLAM_TWO(hypot)
RASTERSLAM_TWO(pow)

RASTERSLAM_SAME_BITS void sincos(double x, double* sine, double* cosine) {
  const auto both = core::sinCos(x);
  *sine = both.sine;
  *cosine = both.cosine;
}

RASTERSLAM_SAME_BITS void sincosf(float x, float* sine, float* cosine) {
  const auto both = core::sinCos(static_cast<double>(x));
  *sine = static_cast<float>(both.sine);
  *cosine = static_cast<float>(both.cosine);
}
