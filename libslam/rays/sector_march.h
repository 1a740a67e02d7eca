#pragma once
#include <cstdint>

namespace slam::rays {

/// Beams of a scan that are cast together: bounds what the casters keep on the stack.
constexpr int kMarchBlock = 1024;
/// Numbers that a march may write behind the last ray of an octant.
constexpr int kMarchPadding = 16;

/// The beams of one block, in the axes of the plan.
struct AimedBeams {
  double major[kMarchBlock], minor[kMarchBlock];  ///< of the unit vector, both >= 0
  double slope[kMarchBlock];                      ///< raySlope()
  std::int32_t octant[kMarchBlock];               ///< Octant::index()
};

/// Where a ray ended, columns and rows counted from the origin's cell: column * 2^16, plus row + 1 where it
/// came into the cell above that row instead of through the column's near face.
using Hit = std::uint32_t;
constexpr Hit kNoHit = 0xFFFFFFFF;
/// A march may compute in float with an error bound. A ray that came so near to a grid line that the bound
/// does not tell its row ends with this, and has to be cast again in double; few do.
constexpr Hit kAmbiguousHit = 0xFFFFFFFE;

/// Rays of one octant from one origin, and those that have ended. A ray is on the near face of its column.
/// The arrays have room for all rays and kMarchPadding more.
struct OctantMarch {
  const std::uint8_t* codes;      ///< of the octant, as SectorTable has them
  std::int32_t tiles;             ///< along the minor axis
  std::int32_t first_u, first_v;  ///< the origin's cell
  std::int32_t end_row;           ///< the first row outside
  std::int32_t last_column;       ///< what is hit beyond is out of range
  double origin_u, origin_v;      ///< within the cell

  int rays;
  std::uint32_t* cell;  ///< column * 2^16 + the beam's number in the block
  float* slope;         ///< for the wide marches
  std::int64_t *row,
      *rise;  ///< for the portable one: where the ray is on that face, and the slope, times 2^40

  int ends;
  std::uint32_t* ended_cell;
  Hit* ended_hit;
  bool any_ambiguous;
};

/// Lines in growing coordinates (see GrowingAxis) to turn hits into ranges.
struct HitFrame {
  double origin_u, origin_v;  ///< of the ray
  double cell_u, cell_v;      ///< of its cell
  double resolution_m, limit_m;
};

/// The parts of a scan's cast that are worth a processor's widest registers. The ranges are the same bits.
struct ScanKernel {
  /// Turns `count` beams by (cosine, sine).
  void (*aim)(const double* cosines, const double* sines, int count, double cosine, double sine,
              AimedBeams& beams);
  /// Adds beams begin .. end-1 of the block, at the near face of `column`.
  void (*begin)(OctantMarch& octant, const AimedBeams& beams, int begin, int end, int column);
  /// Advances every ray to its end, one look-up each per pass through all octants: the rays look at
  /// independent cells, so their waiting times overlap as they cannot in a loop over one ray.
  void (*march)(OctantMarch* octants, int count);
  /// Ranges in metres of `count` beams of one octant; of ambiguous hits, anything.
  void (*measure)(const double* major, const double* minor, const Hit* hits, int count, const HitFrame& frame,
                  float* ranges_m);
};

extern const ScanKernel kPortableKernel, kAvx2Kernel, kAvx512Kernel;
/// Of the processor that runs this.
bool hasAvx2();
bool hasAvx512();

}  // namespace slam::rays
