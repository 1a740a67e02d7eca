#pragma once
#include <cstdint>

namespace slam::world {

/// Beams of a scan that are cast together: bounds what the casters keep on the stack.
constexpr int kMarchBlock = 2048;
/// Numbers that a march may write behind the last ray of an octant.
constexpr int kMarchPadding = 16;

/// The beams of one block seen from one origin, in the axes of the plan.
struct AimedBeams {
  double major[kMarchBlock], minor[kMarchBlock];  ///< of the unit vector, both >= 0
  float slope[kMarchBlock];                       ///< as raySlope()
  std::int32_t octant[kMarchBlock];               ///< Octant::index()
};

/// Rays of one octant from one origin, and those that have ended. Columns and rows count from the origin's cell.
/// A ray is on the near face of its column. `cell` is the column times 2^16 plus the beam's number in the block.
struct OctantMarch {
  const std::uint8_t*
      codes;  ///< of the origin's cell; the cell `row` up and `column` on is at column * stride + row
  std::int32_t stride;
  std::int32_t end_row;      ///< the first row outside
  std::int32_t last_column;  ///< what is hit beyond is out of range
  float origin_u, origin_v;  ///< within the cell

  int rays;
  float* slope;
  std::uint32_t* cell;

  int ends;
  std::uint32_t* ended_cell;
  std::uint32_t* ended_how;  ///< row * 2^8 + the code + 1 (as a byte), and kAmbiguous
};

/// The march computes in float with an error bound. A ray that came so near to a grid line that the bound does not
/// tell its row ends with this flag, and has to be cast again in double: some in ten thousand.
constexpr std::uint32_t kAmbiguous = 1U << 31;

/// The parts of a scan's cast that are worth a processor's widest registers. The results are the same bits.
struct ScanKernel {
  /// Turns `count` beams by (cosine, sine).
  void (*aim)(const double* cosines, const double* sines, int count, double cosine, double sine,
              AimedBeams& beams);
  /// Advances every ray to its end, one look-up each per pass through all octants: the rays look at independent
  /// cells, so their waiting times overlap as they cannot in a loop over one ray.
  void (*march)(OctantMarch* octants, int count);
  /// Ranges in metres of consecutive beams of one octant from the lines that they ended on: hit_u the column
  /// (infinity: none), above the row whose near face was crossed in that column, or a negative number where the
  /// column's own face was. Origin in growing coordinates (see GrowingAxis).
  void (*measure)(const double* major, const double* minor, const float* hit_u, const float* above, int count,
                  double origin_u, double origin_v, double resolution_m, double limit_m, float* ranges_m);
};

extern const ScanKernel kPortableKernel, kAvx2Kernel, kAvx512Kernel;
/// Of the processor that runs this.
bool hasAvx2();
bool hasAvx512();

}  // namespace slam::world
