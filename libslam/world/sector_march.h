#pragma once
#include <cstddef>
#include <cstdint>

namespace slam::world {

/// What a table says of a ray in cell (u, v), where it came in through the face u or began. A code n from 2 to
/// 254 means that columns u to u + n - 2 are free (or outside) for every ray of the octant and that column
/// u + n - 1 exists.
constexpr std::uint8_t kWall = 0, kWallAbove = 1, kLongestSkip = 254, kNeverHits = 255;

/// Bytes that a march may read, and not use, behind the last code.
constexpr std::size_t kCodePadding = 3;

/// One octant seen from one origin, in the growing coordinates of castRay().
struct SectorView {
  const std::uint8_t* codes;  ///< of cell (0, 0), which need not exist: cell (u, v) is codes[u * stride + v]
  std::ptrdiff_t stride;
  int end_v;  ///< the first row outside
  double origin_u, origin_v;
};

constexpr int kMarchBlock = 256, kMarchPadding = 4;

/// Rays of one octant on the near face of column u. All numbers are whole but the slopes; as doubles they go
/// through one kind of register.
struct MarchingRays {
  int count = 0;
  double slope[kMarchBlock + kMarchPadding], u[kMarchBlock + kMarchPadding],
      beam[kMarchBlock + kMarchPadding];
};

/// Where rays ended: code kWall in cell (u, v) through its face u, kWallAbove in (u, v + 1) through its face
/// v + 1, kNeverHits nowhere. In no particular order.
struct EndedRays {
  int count = 0;
  double u[kMarchBlock + kMarchPadding], v[kMarchBlock + kMarchPadding], code[kMarchBlock + kMarchPadding],
      beam[kMarchBlock + kMarchPadding];
};

/// Advances every ray by one look-up, and moves those that end there to `ended`. Rays look at independent
/// cells, so their waiting times overlap as they cannot in a loop over one ray.
void marchPortable(const SectorView& view, MarchingRays& rays, EndedRays& ended);

/// The same bits with AVX2, four rays at a time.
void marchAvx2(const SectorView& view, MarchingRays& rays, EndedRays& ended);
bool processorHasAvx2();

}  // namespace slam::world
