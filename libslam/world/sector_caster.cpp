#include "libslam/world/sector_caster.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libslam/world/ray_walk.h"
#include "libslam/world/sector_march.h"

namespace slam::world {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The code of a free cell below a free cell whose successors have codes with this minimum.
inline std::uint8_t codeBefore(std::uint8_t successors) {
  const std::uint8_t code =
      std::max(successors, kWallAbove);  // the next column has to be looked at either way
  return static_cast<std::uint8_t>(code + (code < kLongestSkip));
}

/// The codes of one column of `size` cells from its walls (size + 1 of them, the last outside) and from the
/// codes of the column after it (size + 1 as well).
void fillColumn(const std::uint8_t* __restrict wall, const std::uint8_t* __restrict next, int size,
                std::uint8_t* __restrict codes) {
  for (int v = 0; v < size; ++v) {
    const std::uint8_t free_code = codeBefore(std::min(next[v], next[v + 1]));
    const std::uint8_t below_wall = wall[v + 1] != 0 ? kWallAbove : free_code;
    codes[v] = wall[v] != 0 ? kWall : below_wall;
  }
  codes[size] = kNeverHits;
}

/// Walls of the plan, 1 or 0, with the minor axis contiguous.
std::vector<std::uint8_t> wallsOf(const Plan& plan, bool x_is_major) {
  constexpr int kBlock = 64;  // a transposition by blocks keeps both sides in the cache
  const size_t columns = static_cast<size_t>(plan.columns), rows = static_cast<size_t>(plan.rows);
  std::vector<std::uint8_t> walls(columns * rows);
  if (!x_is_major) {
    std::transform(plan.cells.begin(), plan.cells.end(), walls.begin(),
                   [](Cell cell) { return static_cast<std::uint8_t>(cell == Cell::kOccupied); });
    return walls;
  }
  for (size_t row = 0; row < rows; row += kBlock)
    for (size_t column = 0; column < columns; column += kBlock)
      for (size_t r = row; r < std::min(rows, row + kBlock); ++r)
        for (size_t c = column; c < std::min(columns, column + kBlock); ++c)
          walls[c * rows + r] = plan.cells[r * columns + c] == Cell::kOccupied;
  return walls;
}

/// One octant; `walls` has `size_u` lines of `size_v`.
void fillOctant(const std::vector<std::uint8_t>& walls, int size_u, int size_v, bool u_falls, bool v_falls,
                std::uint8_t* codes) {
  const size_t stride = static_cast<size_t>(size_v) + 1;
  std::fill_n(codes + static_cast<size_t>(size_u) * stride, stride, kNeverHits);
  std::vector<std::uint8_t> wall(stride, 0);
  for (int u = size_u - 1; u >= 0; --u) {
    const std::uint8_t* line = walls.data() + static_cast<size_t>(u_falls ? size_u - 1 - u : u) * size_v;
    if (v_falls)
      std::reverse_copy(line, line + size_v, wall.begin());
    else
      std::copy(line, line + size_v, wall.begin());
    std::uint8_t* column = codes + static_cast<size_t>(u) * stride;
    fillColumn(wall.data(), column + stride, size_v, column);
  }
}

/// std::floor for what fits an int, without a call where the processor has no such instruction.
inline int floorToInt(double x) {
  const int truncated = static_cast<int>(x);
  return truncated - (truncated > x);
}

/// The beams of one octant from one origin, until they are cast.
struct OctantBeams {
  GrowingAxis major, minor;
  SectorView view;
  int count = 0;
  int first_beam = 0;
  double major_direction[kMarchBlock], minor_direction[kMarchBlock];
};

SectorView viewOf(const GrowingAxis& major, const GrowingAxis& minor, const std::uint8_t* codes) {
  const std::ptrdiff_t stride = minor.end - minor.begin + 1;
  // Cell (0, 0) of a mirrored axis is the cell outside that every table has.
  return {codes - major.begin * stride - minor.begin, stride, minor.end, major.origin, minor.origin};
}

/// The first look-up of all beams is one: that of the origin's cell, whose row is not the row of its face.
void lookAtOrigin(const OctantBeams& beams, MarchingRays& rays, EndedRays& ended) {
  const int u = floorToInt(beams.view.origin_u), v = floorToInt(beams.view.origin_v);
  const int code = beams.view.codes[u * beams.view.stride + v];
  rays.count = ended.count = 0;
  GrowingAxis major = beams.major, minor = beams.minor;
  for (int i = 0; i < beams.count; ++i) {
    major.direction = beams.major_direction[i];
    minor.direction = beams.minor_direction[i];
    const double slope = raySlope(major, minor);
    if (code == kWall || code == kNeverHits ||
        (code == kWallAbove && rowAt(major, minor, slope, u + 1) >= v + 1)) {
      ended.u[ended.count] = u;
      ended.v[ended.count] = v;
      ended.code[ended.count] = code;
      ended.beam[ended.count++] = i;
    } else {
      rays.slope[rays.count] = slope;
      rays.u[rays.count] = u + std::max(code - 1, 1);
      rays.beam[rays.count++] = i;
    }
  }
}

double distanceInCells(const OctantBeams& beams, const EndedRays& ended, int i) {
  if (ended.code[i] == kNeverHits) return kInfinity;
  const int beam = static_cast<int>(ended.beam[i]), u = static_cast<int>(ended.u[i]);
  GrowingAxis major = beams.major, minor = beams.minor;
  major.direction = beams.major_direction[beam];
  minor.direction = beams.minor_direction[beam];
  const bool enters_above = ended.code[i] == kWallAbove;
  return RayEntry(major, minor, u, enters_above ? static_cast<int>(ended.v[i]) + 1 : u, enters_above)
      .distance();
}

}  // namespace

SectorCaster::SectorCaster(const Plan& plan, Instructions instructions)
    : uses_avx2_(instructions == Instructions::kFastest && processorHasAvx2()) {
  frame_.columns = plan.columns;
  frame_.rows = plan.rows;
  frame_.resolution_m = plan.resolution_m;
  frame_.T_world_plan = plan.T_world_plan;
  const size_t octant_size = (static_cast<size_t>(plan.columns) + 1) * (static_cast<size_t>(plan.rows) + 1);
  codes_.resize(8 * octant_size + kCodePadding);
  std::uint8_t* codes = codes_.data();
  for (const bool x_is_major : {false, true}) {
    const std::vector<std::uint8_t> walls = wallsOf(plan, x_is_major);
    const int size_u = x_is_major ? plan.columns : plan.rows, size_v = x_is_major ? plan.rows : plan.columns;
    for (const bool x_falls : {false, true})
      for (const bool y_falls : {false, true}) {
        fillOctant(walls, size_u, size_v, x_is_major ? x_falls : y_falls, x_is_major ? y_falls : x_falls,
                   codes);
        codes += octant_size;
      }
  }
}

const std::uint8_t* SectorCaster::octantTable(bool x_is_major, bool x_falls, bool y_falls) const {
  return codes_.data() +
         codes_.size() / 8 * ((x_is_major ? 4U : 0U) + (x_falls ? 2U : 0U) + (y_falls ? 1U : 0U));
}

double SectorCaster::castRayInCells(const core::Point2& origin, const core::Point2& direction) const {
  if (!isFiniteRay(origin, direction)) return kInfinity;
  const GrowingAxis x = growingAxis(origin.x, direction.x, frame_.columns, 0);
  const GrowingAxis y = growingAxis(origin.y, direction.y, frame_.rows, 0);
  const bool x_is_major = x.direction >= y.direction;
  const GrowingAxis& major = x_is_major ? x : y;
  const GrowingAxis& minor = x_is_major ? y : x;
  if (!major.contains(major.origin) || !minor.contains(minor.origin)) return kInfinity;

  const std::ptrdiff_t stride = minor.end - minor.begin + 1;
  const std::uint8_t* codes = octantTable(x_is_major, x.begin < 0, y.begin < 0);
  const double slope = raySlope(major, minor);
  int u = floorToInt(major.origin), v = floorToInt(minor.origin);
  while (true) {
    const std::uint8_t code = codes[(u - major.begin) * stride + (v - minor.begin)];
    if (code == kWall) return RayEntry(major, minor, u, u, false).distance();
    if (code == kNeverHits) return kInfinity;
    u += std::max(code - 1, 1);
    const int row = floorToInt(rowAt(major, minor, slope, u));
    if (code == kWallAbove && row > v) return RayEntry(major, minor, u - 1, v + 1, true).distance();
    v = std::min(row, minor.end);
  }
}

double SectorCaster::castRay(const core::Point2& origin_world, double angle_rad, double max_range_m) const {
  const core::Point2 origin = worldToCells(frame_, origin_world);
  return castInMetres(frame_, angle_rad, max_range_m, [&](const core::Point2& direction, double) {
    return castRayInCells(origin, direction);
  });
}

void SectorCaster::castScan(const core::Pose2& T_world_lidar, double first_angle_rad, double step_rad,
                            int beams, double max_range_m, std::vector<float>& out_ranges_m) const {
  out_ranges_m.resize(beams > 0 ? static_cast<size_t>(beams) : 0);
  const core::Point2 origin = worldToCells(frame_, core::position(T_world_lidar));
  const double limit_m = max_range_m > 0 ? max_range_m : kInfinity;
  std::fill(out_ranges_m.begin(), out_ranges_m.end(), std::numeric_limits<float>::infinity());

  OctantBeams batch;
  int octant = -1;
  const auto castBatch = [&] {
    if (batch.count == 0) return;
    MarchingRays rays;
    EndedRays ended;
    lookAtOrigin(batch, rays, ended);
    while (rays.count > 0)
      uses_avx2_ ? marchAvx2(batch.view, rays, ended) : marchPortable(batch.view, rays, ended);
    for (int i = 0; i < ended.count; ++i) {
      const double distance_m = frame_.resolution_m * distanceInCells(batch, ended, i);
      if (distance_m <= limit_m)
        out_ranges_m[static_cast<size_t>(batch.first_beam + static_cast<int>(ended.beam[i]))] =
            static_cast<float>(distance_m);
    }
    batch.count = 0;
  };
  for (int i = 0; i < beams; ++i) {
    const double angle_rad = T_world_lidar.phi + first_angle_rad + i * step_rad;
    const core::Point2 direction = rayDirection(frame_, angle_rad);
    if (!isFiniteRay(origin, direction)) {
      castBatch();
      octant = -1;
      continue;
    }
    const bool x_falls = !(direction.x >= 0), y_falls = !(direction.y >= 0);
    const double along_x = std::abs(direction.x), along_y = std::abs(direction.y);
    const bool x_is_major = along_x >= along_y;
    const int beam_octant = (x_is_major ? 4 : 0) + (x_falls ? 2 : 0) + (y_falls ? 1 : 0);
    if (beam_octant != octant || batch.count == kMarchBlock) {
      castBatch();
      octant = beam_octant;
      batch.first_beam = i;
      const GrowingAxis x = growingAxis(origin.x, direction.x, frame_.columns, 0);
      const GrowingAxis y = growingAxis(origin.y, direction.y, frame_.rows, 0);
      batch.major = x_is_major ? x : y;
      batch.minor = x_is_major ? y : x;
      batch.view = viewOf(batch.major, batch.minor, octantTable(x_is_major, x_falls, y_falls));
    }
    if (!batch.major.contains(batch.major.origin) || !batch.minor.contains(batch.minor.origin)) {
      batch.first_beam = i + 1;
      continue;
    }
    batch.major_direction[batch.count] = x_is_major ? along_x : along_y;
    batch.minor_direction[batch.count++] = x_is_major ? along_y : along_x;
  }
  castBatch();
}

}  // namespace slam::world
