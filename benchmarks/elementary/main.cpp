// What the library's own elementary functions cost beside the C library's, over the same arguments: one row
// for each, with the ratio. CPU time, the best of several turns that alternate, so that other work on the
// machine counts little.
//   build/release/benchmarks/rasterslam_elementary_bench
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <vector>

#include "libslam/core/elementary.h"
#include "libslam/core/random.h"

namespace {
using namespace slam;

constexpr int kArguments = 4096, kTurns = 200;

double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

template <class Call>
double nanoseconds(const std::vector<double>& x, const std::vector<double>& y, Call call) {
  double sum = 0;
  const double begin_s = cpuSeconds();
  for (int i = 0; i < kArguments; ++i)
    sum += call(x[static_cast<std::size_t>(i)], y[static_cast<std::size_t>(i)]);
  const double end_s = cpuSeconds();
  if (sum == 1234.5) std::puts("");  // what is computed must be needed
  return 1e9 * (end_s - begin_s) / kArguments;
}

template <class Ours, class Theirs>
void row(const char* name, double low, double high, Ours ours, Theirs theirs) {
  core::RandomStream random(1, name);
  std::vector<double> x, y;
  for (int i = 0; i < kArguments; ++i) {
    x.push_back(random.uniform(low, high));
    y.push_back(random.uniform(low, high));
  }
  double ours_ns = std::numeric_limits<double>::infinity(), theirs_ns = ours_ns;
  for (int i = 0; i < kTurns; ++i) {
    ours_ns = std::min(ours_ns, nanoseconds(x, y, ours));
    theirs_ns = std::min(theirs_ns, nanoseconds(x, y, theirs));
  }
  std::printf("%-14s %8g %8g %8.1f %8.1f %8.2f\n", name, low, high, ours_ns, theirs_ns, ours_ns / theirs_ns);
}

}  // namespace

#define RASTERSLAM_ROW(name, low, high)                                 \
  row(                                                                  \
      #name, low, high, [](double x, double) { return core::name(x); }, \
      [](double x, double) { return std::name(x); })
#define RASTERSLAM_ROW2(name, low, high)                                     \
  row(                                                                       \
      #name, low, high, [](double x, double y) { return core::name(x, y); }, \
      [](double x, double y) { return std::name(x, y); })

int main() {
  std::printf("%-14s %8s %8s %8s %8s %8s\n", "function", "from", "to", "ours ns", "libm ns", "ratio");
  RASTERSLAM_ROW(sin, -3.2, 3.2);
  RASTERSLAM_ROW(cos, -3.2, 3.2);
  row(
      "sin and cos", -3.2, 3.2,
      [](double x, double) {
        const auto both = core::sinCos(x);
        return both.sine + both.cosine;
      },
      [](double x, double) { return std::sin(x) + std::cos(x); });
  RASTERSLAM_ROW(sin, -1e9, 1e9);
  RASTERSLAM_ROW(tan, -1.5, 1.5);
  RASTERSLAM_ROW(asin, -1, 1);
  RASTERSLAM_ROW(acos, -1, 1);
  RASTERSLAM_ROW(atan, -5, 5);
  RASTERSLAM_ROW2(atan2, -5, 5);
  RASTERSLAM_ROW2(hypot, -5, 5);
  RASTERSLAM_ROW(exp, -5, 5);
  RASTERSLAM_ROW(exp2, -5, 5);
  RASTERSLAM_ROW(log, 0.01, 10);
  RASTERSLAM_ROW(log2, 0.01, 10);
  RASTERSLAM_ROW(log10, 0.01, 10);
  RASTERSLAM_ROW(log1p, 0.01, 10);
  RASTERSLAM_ROW2(pow, 0.1, 5);
  RASTERSLAM_ROW(cbrt, -5, 5);
}
