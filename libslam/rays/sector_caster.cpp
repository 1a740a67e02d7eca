#include "libslam/rays/sector_caster.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/rays/ray_walk.h"
#include "libslam/threads/thread_team.h"

namespace slam::rays {
namespace {

using core::kInfinity;

/// std::floor for what fits an int, without a call where the processor has no such instruction.
inline int floorToInt(double x) {
  const int truncated = static_cast<int>(x);
  return truncated - (truncated > x);
}

Octant octantOf(const core::Point2& direction) {
  return {std::abs(direction.x) >= std::abs(direction.y), !(direction.x >= 0), !(direction.y >= 0)};
}

Octant octantAt(int index) {
  return {(index & 4) != 0, (index & 2) != 0, (index & 1) != 0};
}

/// An octant from one origin: axes that grow along its rays, and its codes.
struct OctantView {
  GrowingAxis major, minor;
  int tiles;
  const std::uint8_t* codes;

  OctantView(const SectorTable& table, const Octant& octant, const core::Point2& origin) {
    const GrowingAxis x = growingAxis(origin.x, octant.x_falls ? -1.0 : 1.0, table.columns(), 0);
    const GrowingAxis y = growingAxis(origin.y, octant.y_falls ? -1.0 : 1.0, table.rows(), 0);
    major = octant.x_is_major ? x : y;
    minor = octant.x_is_major ? y : x;
    tiles = table.tiles(octant);
    codes = table.codes(octant);
  }
  std::uint8_t codeAt(int u, int v) const {
    return codes[SectorTable::offsetOf(tiles, u - major.begin, v - minor.begin)];
  }
  bool contains() const { return major.contains(major.origin) && minor.contains(minor.origin); }
};

const ScanKernel* kernelFor(Instructions instructions) {
  if (!isSupported(instructions))
    throw core::ContractError("SectorCaster: the processor lacks the instructions");
  if (instructions == Instructions::kPortable) return &kPortableKernel;
  const bool widest =
      instructions == Instructions::kAvx512 || (instructions == Instructions::kFastest && hasAvx512());
  if (widest) return &kAvx512Kernel;
  return hasAvx2() ? &kAvx2Kernel : &kPortableKernel;
}

/// The end of the run of equal octants that starts at `begin`.
int endOfRun(const std::int32_t* octant, int begin, int count) {
  constexpr int kStep = 16;
  int end = begin + 1;
  while (end + kStep <= count) {
    std::int32_t differences = 0;
    for (int i = 0; i < kStep; ++i) differences |= octant[end + i] ^ octant[begin];
    if (differences != 0) break;
    end += kStep;
  }
  while (end < count && octant[end] == octant[begin]) ++end;
  return end;
}

/// Casts up to kMarchBlock beams of a scan from one origin.
class BlockCast {
 public:
  BlockCast(const SectorTable& table, const ScanKernel& kernel, const core::Point2& origin,
            double resolution_m, double limit_m)
      : table_(table), kernel_(kernel), origin_(origin), resolution_m_(resolution_m), limit_m_(limit_m) {}

  void cast(const double* cosines, const double* sines, int count, const Rotation& turn, float* ranges_m) {
    kernel_.aim(cosines, sines, count, turn.cosine, turn.sine, beams_);
    findRuns(count);
    layOut();
    for (int i = 0; i < runs_; ++i) start(run_[i]);
    kernel_.march(marches_, octants_);
    for (int i = 0; i < octants_; ++i) readEnds(marches_[i]);
    for (int i = 0; i < runs_; ++i) measure(run_[i], ranges_m);
  }
  /// Calls cast_again(beam) for the beams whose ranges are not known.
  template <class CastAgain>
  void resolve(int count, CastAgain cast_again) const {
    bool any = false;
    for (int i = 0; i < octants_; ++i) any |= marches_[i].any_ambiguous;
    if (!any) return;
    for (int beam = 0; beam < count; ++beam)
      if (hit_[beam] == kAmbiguousHit) cast_again(beam);
  }

 private:
  /// Consecutive beams of one octant.
  struct Run {
    int begin, end, slot;
  };

  void findRuns(int count) {
    runs_ = 0;
    for (int begin = 0; begin < count; begin = run_[runs_++].end)
      run_[runs_] = {begin, endOfRun(beams_.octant, begin, count), 0};
  }

  /// A march for every octant that has beams, and room for them.
  void layOut() {
    int beams_of[8] = {}, slot_of[8];
    for (int i = 0; i < runs_; ++i) beams_of[beams_.octant[run_[i].begin]] += run_[i].end - run_[i].begin;
    octants_ = 0;
    int room = 0;
    for (int index = 0; index < 8; ++index) {
      if (beams_of[index] == 0) continue;
      const OctantView view(table_, octantAt(index), origin_);
      // On the map's border an origin is inside for some directions and outside for others.
      const bool inside = view.contains();
      const int u = inside ? floorToInt(view.major.origin) : 0,
                v = inside ? floorToInt(view.minor.origin) : 0;
      frames_[octants_] = {view.major.origin, view.minor.origin, double(u),
                           double(v),         resolution_m_,     limit_m_};
      OctantMarch& march = marches_[octants_];
      first_code_[octants_] = inside ? view.codeAt(u, v) : kNeverHits;
      march.codes = view.codes;
      march.tiles = view.tiles;
      march.first_u = u - view.major.begin;
      march.first_v = v - view.minor.begin;
      march.end_row = view.minor.end - v;
      // Two columns more than the range needs: rounding must not end a march before the last hit within
      // range.
      march.last_column = static_cast<std::int32_t>(std::min(limit_m_ / resolution_m_, 1e6)) + 2;
      march.origin_u = view.major.origin - u;
      march.origin_v = view.minor.origin - v;
      march.rays = march.ends = 0;
      march.any_ambiguous = false;
      march.cell = cell_ + room;
      march.slope = slope_ + room;
      march.row = row_ + room;
      march.rise = rise_ + room;
      march.ended_cell = ended_cell_ + room;
      march.ended_hit = ended_hit_ + room;
      slot_of[index] = octants_++;
      room += beams_of[index] + kMarchPadding;
    }
    for (int i = 0; i < runs_; ++i) run_[i].slot = slot_of[beams_.octant[run_[i].begin]];
  }

  /// The first look-up of all beams is one: that of the origin's cell, whose row is not the row of its face.
  void start(const Run& run) {
    OctantMarch& march = marches_[run.slot];
    const std::uint8_t code = first_code_[run.slot];
    if (code == kWall || code == kNeverHits) {
      std::fill(hit_ + run.begin, hit_ + run.end, code == kWall ? Hit{0} : kNoHit);
      return;
    }
    if (code != kWallAbove) {
      kernel_.begin(march, beams_, run.begin, run.end, code - 1);
      return;
    }
    const HitFrame& frame = frames_[run.slot];
    for (int beam = run.begin; beam < run.end; ++beam) {
      const GrowingAxis major{frame.origin_u, beams_.major[beam], 0, 0, 0, 0};
      const GrowingAxis minor{frame.origin_v, beams_.minor[beam], 0, 0, 0, 0};
      const int next_u = static_cast<int>(frame.cell_u) + 1;
      if (rowAt(major, minor, raySlope(major, minor), next_u) >= frame.cell_v + 1)
        hit_[beam] = 1;  // above row 0 of column 0
      else
        kernel_.begin(march, beams_, beam, beam + 1, 1);
    }
  }

  void readEnds(const OctantMarch& march) {
    for (int i = 0; i < march.ends; ++i) hit_[march.ended_cell[i] & 0xFFFF] = march.ended_hit[i];
  }

  void measure(const Run& run, float* ranges_m) const {
    kernel_.measure(beams_.major + run.begin, beams_.minor + run.begin, hit_ + run.begin, run.end - run.begin,
                    frames_[run.slot], ranges_m + run.begin);
  }

  static constexpr int kRoom = kMarchBlock + 8 * kMarchPadding;

  const SectorTable& table_;
  const ScanKernel& kernel_;
  const core::Point2 origin_;
  const double resolution_m_, limit_m_;
  int runs_ = 0, octants_ = 0;
  // What is written before it is read is not set to anything.
  AimedBeams beams_;
  Run run_[kMarchBlock];
  OctantMarch marches_[8];
  HitFrame frames_[8];
  std::uint8_t first_code_[8];  ///< of the origin's cell
  std::uint32_t cell_[kRoom], ended_cell_[kRoom];
  float slope_[kRoom];
  std::int64_t row_[kRoom], rise_[kRoom];
  Hit ended_hit_[kRoom], hit_[kMarchBlock];
};

}  // namespace

bool isSupported(Instructions instructions) {
  if (instructions == Instructions::kAvx2) return hasAvx2();
  if (instructions == Instructions::kAvx512) return hasAvx512();
  return true;
}

SectorCaster::SectorCaster(const world::CellMap& map, Instructions instructions)
    : kernel_(kernelFor(instructions)), table_(map) {
  frame_.columns = map.columns;
  frame_.rows = map.rows;
  frame_.resolution_m = map.resolution_m;
  frame_.T_frame_raster = map.T_frame_raster;
}

double SectorCaster::castRayInCells(const core::Point2& origin, const core::Point2& direction) const {
  if (!isFiniteRay(origin, direction)) return kInfinity;
  const Octant octant = octantOf(direction);
  OctantView view(table_, octant, origin);
  if (!view.contains()) return kInfinity;
  GrowingAxis &major = view.major, &minor = view.minor;
  major.direction = std::abs(octant.x_is_major ? direction.x : direction.y);
  minor.direction = std::abs(octant.x_is_major ? direction.y : direction.x);

  const double slope = raySlope(major, minor);
  int u = floorToInt(major.origin), v = floorToInt(minor.origin);
  while (true) {
    const std::uint8_t code = view.codeAt(u, v);
    if (code == kWall) return RayEntry(major, minor, u, u, false).distance();
    if (code == kNeverHits) return kInfinity;
    u += std::max(code - 1, 1);
    const int row = floorToInt(rowAt(major, minor, slope, u));
    if (code == kWallAbove && row > v) return RayEntry(major, minor, u - 1, v + 1, true).distance();
    v = std::min(row, minor.end);
  }
}

double SectorCaster::castRay(const core::Point2& origin_world, double angle_rad, double max_range_m) const {
  const core::Point2 origin = world::pointToCells(frame_, origin_world);
  return castInMetres(
      frame_, rayDirection(frame_, angle_rad), max_range_m,
      [&](const core::Point2& direction, double) { return castRayInCells(origin, direction); });
}

void SectorCaster::castScan(const core::Pose2& T_world_lidar, const BeamTable& beams, double max_range_m,
                            std::vector<float>& out_ranges_m) const {
  out_ranges_m.resize(static_cast<size_t>(beams.size()));
  castBeams(T_world_lidar, beams, 0, beams.size(), max_range_m, out_ranges_m.data());
}

void SectorCaster::castBeams(const core::Pose2& T_world_lidar, const BeamTable& beams, int first, int count,
                             double max_range_m, float* out_ranges_m) const {
  const core::Point2 origin = world::pointToCells(frame_, core::position(T_world_lidar));
  const Rotation turn(T_world_lidar.phi - frame_.T_frame_raster.phi);
  if (!isFiniteRay(origin, {turn.cosine, turn.sine})) {
    std::fill_n(out_ranges_m, count, std::numeric_limits<float>::infinity());
    return;
  }
  const double* cosines = beams.cosines() + first;
  const double* sines = beams.sines() + first;
  const auto castOne = [&](int beam) {
    const core::Point2 direction = turn * core::Point2{cosines[beam], sines[beam]};
    out_ranges_m[beam] =
        static_cast<float>(castInMetres(frame_, direction, max_range_m, [&](const core::Point2& d, double) {
          return castRayInCells(origin, d);
        }));
  };
  const double limit_m = max_range_m > 0 ? max_range_m : kInfinity;
  const int blocks = (count + kMarchBlock - 1) / kMarchBlock;
  for (int i = 0, done = 0; i < blocks; ++i) {
    BlockCast block(table_, *kernel_, origin, frame_.resolution_m, limit_m);
    const int size = (count - done) / (blocks - i);  // even blocks
    block.cast(cosines + done, sines + done, size, turn, out_ranges_m + done);
    block.resolve(size, [&](int beam) { castOne(done + beam); });
    done += size;
  }
}

void SectorCaster::castScans(const std::vector<core::Pose2>& T_world_lidars, const BeamTable& beams,
                             double max_range_m, int threads, std::vector<float>& out_ranges_m) const {
  const size_t scans = T_world_lidars.size(), size = static_cast<size_t>(beams.size());
  out_ranges_m.resize(scans * size);
  const auto castFrom = [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      castBeams(T_world_lidars[i], beams, 0, beams.size(), max_range_m, out_ranges_m.data() + i * size);
  };
  const size_t workers =
      std::clamp<size_t>(static_cast<size_t>(std::max(threads, 1)), 1, std::max<size_t>(scans, 1));
  threads::ThreadTeam(static_cast<int>(workers)).forEach(workers, [&](size_t w) {
    castFrom(scans * w / workers, scans * (w + 1) / workers);
  });
}

}  // namespace slam::rays
