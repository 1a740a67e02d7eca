#include "libslam/rays/sector_march.h"

#include <algorithm>

#include "libslam/rays/march_steps.h"
#include "libslam/rays/sector_table.h"

namespace slam::rays {
namespace {

// In 2^-40 of a cell: the slope errs by half of one per column, of at most 2^15, the start and the double by
// less.
constexpr int kFixedBits = 40;
constexpr std::int64_t kFixedOne = std::int64_t{1} << kFixedBits, kFixedRowError = std::int64_t{1} << 15;

void aimPortable(const double* cosines, const double* sines, int count, double cosine, double sine,
                 AimedBeams& beams) {
  aimBeams(cosines, sines, count, cosine, sine, beams);
}

// Without wide registers whole numbers are faster than floats, and so exact that nearly no ray is ambiguous.
void beginPortable(OctantMarch& octant, const AimedBeams& beams, int begin, int end, int column) {
  const double from_origin = column - octant.origin_u;
  for (int beam = begin; beam < end; ++beam) {
    const double slope = beams.slope[beam];
    const int ray = octant.rays++;
    octant.cell[ray] = static_cast<std::uint32_t>(column << 16 | beam);
    octant.rise[ray] = static_cast<std::int64_t>(slope * kFixedOne);
    octant.row[ray] = static_cast<std::int64_t>((octant.origin_v + from_origin * slope) * kFixedOne);
  }
}

void measurePortable(const double* major, const double* minor, const Hit* hits, int count,
                     const HitFrame& frame, float* ranges_m) {
  measureHits(major, minor, hits, count, frame, ranges_m);
}

void passPortable(OctantMarch& octant) {
  int kept = 0, ends = octant.ends;
  for (int i = 0; i < octant.rays; ++i) {
    const std::int64_t row = octant.row[i], rise = octant.rise[i];
    const std::uint32_t cell = octant.cell[i];
    const auto column = static_cast<std::int32_t>(cell >> 16);
    const auto whole = static_cast<std::int32_t>(row >> kFixedBits);
    const std::int32_t v = std::min(whole, octant.end_row);
    const auto offset = SectorTable::offsetOf(octant.tiles, octant.first_u + column, octant.first_v + v);
    const int code = (octant.codes[offset] + 1) & 255;
    const std::int64_t within = row & (kFixedOne - 1);
    // One test for "close to the line below or above".
    const bool near_line = ((within + kFixedRowError) & (kFixedOne - 1)) < 2 * kFixedRowError;
    const std::int64_t over = within + rise - kFixedOne;
    if (code > kAbove && !near_line && column <= octant.last_column) {
      const int skip = code - 2;
      octant.row[kept] = row + skip * rise;
      octant.rise[kept] = rise;
      octant.cell[kept++] = cell + (static_cast<std::uint32_t>(skip) << 16);
    } else if (code == kAbove && over < -kFixedRowError && !near_line) {
      octant.row[kept] = row + rise;
      octant.rise[kept] = rise;
      octant.cell[kept++] = cell + (1U << 16);
    } else {
      const bool ambiguous = near_line || (code == kAbove && over < kFixedRowError);
      const Hit face = cell & 0xFFFF0000, above = face | static_cast<Hit>(v + 1);
      const Hit hit = code == kFace ? face : code == kAbove ? above : kNoHit;
      octant.ended_cell[ends] = cell;
      octant.ended_hit[ends++] = ambiguous ? kAmbiguousHit : hit;
      octant.any_ambiguous |= ambiguous;
    }
  }
  octant.rays = kept;
  octant.ends = ends;
}

void marchPortable(OctantMarch* octants, int count) {
  while (anyRay(octants, count))
    for (int i = 0; i < count; ++i) passPortable(octants[i]);
}

}  // namespace

const ScanKernel kPortableKernel = {aimPortable, beginPortable, marchPortable, measurePortable};

#ifndef SLAM_X86_KERNELS

const ScanKernel kAvx2Kernel = kPortableKernel, kAvx512Kernel = kPortableKernel;

bool hasAvx2() {
  return false;
}
bool hasAvx512() {
  return false;
}

#endif

}  // namespace slam::rays
