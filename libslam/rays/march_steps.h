#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

#include "libslam/rays/sector_march.h"
#include "libslam/rays/sector_table.h"

#if defined(__x86_64__) && defined(__GNUC__)
#define SLAM_X86_KERNELS 1
#endif

namespace slam::rays {

// What the marches for all processors share: compiled into each for its own.

// Codes plus one, as bytes: what ends a ray is then below what lets it go on.
constexpr int kNever = 0, kFace = 1, kAbove = 2;
static_assert((kNeverHits + 1) % 256 == kNever && kWall + 1 == kFace && kWallAbove + 1 == kAbove);

// The row of a column in float, fv + (k - fu) * m, errs from its value in double by less than 4 * 2^-24 of
// itself and 2^-23 of a cell: each of fu, fv, k - fu, m and the result is rounded once, by half a unit in the
// last place (2^-24 of itself). Twice that is allowed for.
constexpr float kRowError = 0x1.0p-21F, kFixedError = 2 * kRowError;
#define SLAM_INLINE inline __attribute__((always_inline))

// As walkRay() has it: the loops below are compiled for each processor, without a fused product anywhere.
SLAM_INLINE void aimBeams(const double* __restrict cosines, const double* __restrict sines, int count,
                          double cosine, double sine, AimedBeams& beams) {
  constexpr double kSteepest = 1.0 - 0x1.0p-36;
  for (int i = 0; i < count; ++i) {
    const double x = cosine * cosines[i] - sine * sines[i], y = sine * cosines[i] + cosine * sines[i];
    const double along_x = std::abs(x), along_y = std::abs(y);
    const double major = along_x >= along_y ? along_x : along_y,
                 minor = along_x >= along_y ? along_y : along_x;
    const double slope = minor / major;
    beams.major[i] = major;
    beams.minor[i] = minor;
    beams.slope[i] = slope < kSteepest ? slope : kSteepest;
    beams.octant[i] = (along_x >= along_y ? 4 : 0) | (x < 0 ? 2 : 0) | (y < 0 ? 1 : 0);
  }
}

SLAM_INLINE void beginInFloat(OctantMarch& octant, const AimedBeams& beams, int begin, int end, int column) {
  float* __restrict slope = octant.slope + octant.rays;
  std::uint32_t* __restrict cell = octant.cell + octant.rays;
  const double* __restrict exact_slope = beams.slope + begin;
  const int first = column << 16 | begin, count = end - begin;
  for (int i = 0; i < count; ++i) slope[i] = static_cast<float>(exact_slope[i]);
  for (int i = 0; i < count; ++i) cell[i] = static_cast<std::uint32_t>(first + i);
  octant.rays += count;
}

/// The wide marches note how a ray ended as row * 2^8 + code + 1 and this flag; here that becomes a hit.
constexpr int kAmbiguousEnd = 1 << 30;
SLAM_INLINE void finishEnds(OctantMarch& octant) {
  const std::uint32_t* __restrict cell = octant.ended_cell;
  Hit* __restrict ended = octant.ended_hit;
  const int ends = octant.ends;
  int ambiguous = 0;
  for (int i = 0; i < ends; ++i) {
    const Hit how = ended[i], code = how & 255, face = cell[i] & 0xFFFF0000;
    const Hit above = face | (((how >> 8) & 0xFFFF) + 1);
    const Hit at_wall = code == kFace ? face : kNoHit;
    const Hit certain = code == kAbove ? above : at_wall;
    ended[i] = (how & kAmbiguousEnd) != 0 ? kAmbiguousHit : certain;
    ambiguous |= static_cast<int>(how & kAmbiguousEnd);
  }
  octant.any_ambiguous = ambiguous != 0;
}

// As RayEntry::distance(), which bounds what it finds by two more quotients. Here they are spared where a
// product shows that they change nothing: but for entries within rounding of a corner, everywhere.
SLAM_INLINE void measureHits(const double* __restrict major, const double* __restrict minor,
                             const Hit* __restrict hits, int count, const HitFrame& frame,
                             float* __restrict ranges_m) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr double kDoubt = 1e-9;  // of a cell; coordinates below 2^15 are good to 1e-11
  const double origin_u = frame.origin_u, origin_v = frame.origin_v, cell_u = frame.cell_u,
               cell_v = frame.cell_v;
  const double resolution_m = frame.resolution_m, limit_m = frame.limit_m;
  int doubtful = 0;
  for (int i = 0; i < count; ++i) {
    const int row = static_cast<int>(hits[i] & 0xFFFF);
    const double u = cell_u + static_cast<int>(hits[i] >> 16);
    const double ahead = u - origin_u > 0 ? u - origin_u : 0;
    const double rise = cell_v + row - origin_v;
    const bool is_above = row != 0;
    const double distance = (is_above ? rise : ahead) / (is_above ? minor[i] : major[i]);
    const double along = distance * major[i];
    const bool is_certain = (along > ahead + kDoubt) & (along < u + 1 - origin_u - kDoubt);
    doubtful |= static_cast<int>(is_above) & static_cast<int>(!is_certain);
    const double range_m = resolution_m * distance;
    ranges_m[i] =
        ((range_m <= limit_m) & (hits[i] < kAmbiguousHit)) ? static_cast<float>(range_m) : kInfinity;
  }
  if (doubtful == 0) return;
  for (int i = 0; i < count; ++i) {
    const int row = static_cast<int>(hits[i] & 0xFFFF);
    if (row == 0 || hits[i] >= kAmbiguousHit) continue;
    const double u = cell_u + static_cast<int>(hits[i] >> 16);
    const double nearest = std::max(0.0, u - origin_u) / major[i], farthest = (u + 1 - origin_u) / major[i];
    const double entry = (cell_v + row - origin_v) / minor[i];
    const double range_m = resolution_m * std::min(std::max(entry, nearest), farthest);
    ranges_m[i] = range_m <= limit_m ? static_cast<float>(range_m) : kInfinity;
  }
}

SLAM_INLINE bool anyRay(const OctantMarch* octants, int count) {
  int rays = 0;
  for (int i = 0; i < count; ++i) rays |= octants[i].rays;
  return rays != 0;
}

}  // namespace slam::rays
