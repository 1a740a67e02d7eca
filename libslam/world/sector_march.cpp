#include "libslam/world/sector_march.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libslam/world/sector_table.h"

#if defined(__x86_64__) && defined(__GNUC__)
#define SLAM_X86_KERNELS 1
// GCC 12 warns about its own avx512 header (GCC bug 105593).
#pragma GCC diagnostic push
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <immintrin.h>
#pragma GCC diagnostic pop
#endif

namespace slam::world {
namespace {

// Codes plus one, as bytes: what ends a ray is then below what lets it go on.
constexpr int kNever = 0, kFace = 1, kAbove = 2;
static_assert((kNeverHits + 1) % 256 == kNever && kWall + 1 == kFace && kWallAbove + 1 == kAbove);

// The row of a column in float, fv + (k - fu) * m, errs from its value in double by less than 4 * 2^-24 of
// itself and 2^-23 of a cell: each of fu, fv, k - fu, m and the result is rounded once, by half a unit in the
// last place (2^-24 of itself). Twice that is allowed for.
constexpr float kRowError = 0x1.0p-21F, kFixedError = 2 * kRowError;
// In 2^-40 of a cell: the slope errs by half of one per column, of at most 2^15, the start and the double by
// less.
constexpr int kFixedBits = 40;
constexpr std::int64_t kFixedOne = std::int64_t{1} << kFixedBits, kFixedRowError = std::int64_t{1} << 15;

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
    ranges_m[i] = (range_m <= limit_m) & (hits[i] < kAmbiguousHit) ? static_cast<float>(range_m) : kInfinity;
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

SLAM_INLINE bool anyRay(const OctantMarch* octants, int count) {
  int rays = 0;
  for (int i = 0; i < count; ++i) rays |= octants[i].rays;
  return rays != 0;
}

void marchPortable(OctantMarch* octants, int count) {
  while (anyRay(octants, count))
    for (int i = 0; i < count; ++i) passPortable(octants[i]);
}

}  // namespace

const ScanKernel kPortableKernel = {aimPortable, beginPortable, marchPortable, measurePortable};

#ifdef SLAM_X86_KERNELS

#define SLAM_AVX2 __attribute__((target("avx2,fma,popcnt")))
#define SLAM_AVX512 __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,popcnt")))

namespace {

SLAM_AVX2 void aimAvx2(const double* cosines, const double* sines, int count, double cosine, double sine,
                       AimedBeams& beams) {
  aimBeams(cosines, sines, count, cosine, sine, beams);
}

SLAM_AVX2 void beginAvx2(OctantMarch& octant, const AimedBeams& beams, int begin, int end, int column) {
  beginInFloat(octant, beams, begin, end, column);
}

SLAM_AVX2 void measureAvx2(const double* major, const double* minor, const Hit* hits, int count,
                           const HitFrame& frame, float* ranges_m) {
  measureHits(major, minor, hits, count, frame, ranges_m);
}

/// For each set of eight lanes the order that moves them to the front.
struct PackTable {
  alignas(8) std::uint8_t order[256][8];
  constexpr PackTable() : order() {
    for (int set = 0; set < 256; ++set) {
      int to = 0;
      for (int lane = 0; lane < 8; ++lane)
        if ((set >> lane & 1) != 0) order[set][to++] = static_cast<std::uint8_t>(lane);
    }
  }
};
constexpr PackTable kPack;

SLAM_AVX2 inline __m256i packOrder(int set) {
  return _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(kPack.order[set])));
}

SLAM_AVX2 inline void storePacked(std::uint32_t* to, __m256i lanes, __m256i order) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), _mm256_permutevar8x32_epi32(lanes, order));
}

/// What one octant's passes have in common.
struct Avx2Octant {
  __m256 origin_u, origin_v;
  __m256i end_row, last_column;
  // Row and column are 16 bits each of a lane: one instruction multiplies both and adds.
  __m256i first, tile_strides, cell_strides;

  SLAM_AVX2 explicit Avx2Octant(const OctantMarch& octant)
      : origin_u(_mm256_set1_ps(static_cast<float>(octant.origin_u))),
        origin_v(_mm256_set1_ps(static_cast<float>(octant.origin_v))),
        end_row(_mm256_set1_epi32(octant.end_row)),
        last_column(_mm256_set1_epi32(octant.last_column)),
        first(_mm256_set1_epi32(octant.first_u << 16 | octant.first_v)),
        tile_strides(_mm256_set1_epi32(octant.tiles << 16 | 1)),
        cell_strides(_mm256_set1_epi32(SectorTable::kTileSide << 16 | 1)) {}

  /// SectorTable::offsetOf() the cells at the columns of `cell` and the rows `v`.
  SLAM_AVX2 SLAM_INLINE __m256i offsets(__m256i cell, __m256i v) const {
    const __m256i place = _mm256_add_epi16(_mm256_blend_epi16(cell, v, 0x55), first);
    const __m256i tile = _mm256_madd_epi16(_mm256_srli_epi16(place, 3), tile_strides);
    const __m256i within = _mm256_madd_epi16(_mm256_and_si256(place, _mm256_set1_epi16(7)), cell_strides);
    return _mm256_add_epi32(_mm256_slli_epi32(tile, 6), within);
  }
};

/// Advances rays i .. i+7, or as many of them as there are.
template <bool kAllEight>
SLAM_AVX2 SLAM_INLINE void advanceAvx2(OctantMarch& octant, const Avx2Octant& constant, int i, int& kept,
                                       int& ends) {
  const __m256 half = _mm256_set1_ps(0.5F), one = _mm256_set1_ps(1), sign = _mm256_set1_ps(-0.0F);
  const __m256 slope = _mm256_loadu_ps(octant.slope + i);
  const __m256i cell = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(octant.cell + i));
  const __m256i column = _mm256_srli_epi32(cell, 16);
  const __m256 row =
      _mm256_fmadd_ps(_mm256_sub_ps(_mm256_cvtepi32_ps(column), constant.origin_u), slope, constant.origin_v);
  const __m256i whole = _mm256_cvttps_epi32(row);
  const __m256 within = _mm256_sub_ps(row, _mm256_cvtepi32_ps(whole)), next = _mm256_add_ps(within, slope);
  const __m256i v = _mm256_min_epi32(whole, constant.end_row);
  const __m256i index = constant.offsets(cell, v);
  const auto* codes = reinterpret_cast<const int*>(octant.codes);
  int existing = 255;
  __m256i bytes;
  if constexpr (kAllEight) {
    bytes = _mm256_i32gather_epi32(codes, index, 1);
  } else {
    const __m256i lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    const __m256i exists = _mm256_cmpgt_epi32(_mm256_set1_epi32(octant.rays - i), lanes);
    existing = _mm256_movemask_ps(_mm256_castsi256_ps(exists));
    bytes = _mm256_mask_i32gather_epi32(_mm256_setzero_si256(), codes, index, exists, 1);
  }
  const __m256i code =
      _mm256_and_si256(_mm256_add_epi32(bytes, _mm256_set1_epi32(1)), _mm256_set1_epi32(255));

  const __m256 error = _mm256_fmadd_ps(row, _mm256_set1_ps(kRowError), _mm256_set1_ps(kFixedError));
  const __m256 is_below_wall = _mm256_castsi256_ps(_mm256_cmpeq_epi32(code, _mm256_set1_epi32(kAbove)));
  const __m256 from_half = _mm256_andnot_ps(sign, _mm256_sub_ps(within, half));
  const __m256 from_next = _mm256_andnot_ps(sign, _mm256_sub_ps(next, one));
  const __m256 ambiguous =
      _mm256_or_ps(_mm256_cmp_ps(_mm256_add_ps(from_half, error), half, _CMP_GT_OQ),
                   _mm256_and_ps(is_below_wall, _mm256_cmp_ps(from_next, error, _CMP_LT_OQ)));
  const __m256 stops = _mm256_castsi256_ps(_mm256_or_si256(
      _mm256_cmpgt_epi32(_mm256_set1_epi32(kAbove), code), _mm256_cmpgt_epi32(column, constant.last_column)));
  const __m256 enters_above = _mm256_and_ps(is_below_wall, _mm256_cmp_ps(next, one, _CMP_GE_OQ));
  const int has_ended = _mm256_movemask_ps(_mm256_or_ps(_mm256_or_ps(ambiguous, stops), enters_above));
  const int ending = has_ended & existing, going_on = ~has_ended & existing;

  const __m256i row_code = _mm256_or_si256(_mm256_slli_epi32(v, 8), code);
  const __m256i flag = _mm256_and_si256(_mm256_castps_si256(ambiguous), _mm256_set1_epi32(kAmbiguousEnd));
  const __m256i end_order = packOrder(ending), keep_order = packOrder(going_on);
  storePacked(octant.ended_cell + ends, cell, end_order);
  storePacked(octant.ended_hit + ends, _mm256_or_si256(row_code, flag), end_order);
  ends += __builtin_popcount(static_cast<unsigned>(ending));
  const __m256i skip = _mm256_max_epi32(_mm256_sub_epi32(code, _mm256_set1_epi32(2)), _mm256_set1_epi32(1));
  _mm256_storeu_ps(octant.slope + kept, _mm256_permutevar8x32_ps(slope, keep_order));
  storePacked(octant.cell + kept, _mm256_add_epi32(cell, _mm256_slli_epi32(skip, 16)), keep_order);
  kept += __builtin_popcount(static_cast<unsigned>(going_on));
}

SLAM_AVX2 inline void passAvx2(OctantMarch& octant) {
  const Avx2Octant constant(octant);
  int kept = 0, ends = octant.ends, i = 0;
  for (; i + 8 <= octant.rays; i += 8) advanceAvx2<true>(octant, constant, i, kept, ends);
  if (i < octant.rays) advanceAvx2<false>(octant, constant, i, kept, ends);
  octant.rays = kept;
  octant.ends = ends;
}

SLAM_AVX2 void marchAvx2(OctantMarch* octants, int count) {
  while (anyRay(octants, count))
    for (int i = 0; i < count; ++i) passAvx2(octants[i]);
  for (int i = 0; i < count; ++i) finishEnds(octants[i]);
}

SLAM_AVX512 void aimAvx512(const double* cosines, const double* sines, int count, double cosine, double sine,
                           AimedBeams& beams) {
  aimBeams(cosines, sines, count, cosine, sine, beams);
}

SLAM_AVX512 void beginAvx512(OctantMarch& octant, const AimedBeams& beams, int begin, int end, int column) {
  beginInFloat(octant, beams, begin, end, column);
}

SLAM_AVX512 void measureAvx512(const double* major, const double* minor, const Hit* hits, int count,
                               const HitFrame& frame, float* ranges_m) {
  measureHits(major, minor, hits, count, frame, ranges_m);
}

SLAM_AVX512 inline void passAvx512(OctantMarch& octant) {
  const __m512 origin_u = _mm512_set1_ps(static_cast<float>(octant.origin_u)),
               origin_v = _mm512_set1_ps(static_cast<float>(octant.origin_v));
  const __m512i end_row = _mm512_set1_epi32(octant.end_row);
  const __m512i last_column = _mm512_set1_epi32(octant.last_column);
  const __m512i first = _mm512_set1_epi32(octant.first_u << 16 | octant.first_v);
  const __m512i tile_strides = _mm512_set1_epi32(octant.tiles << 16 | 1);
  const __m512i cell_strides = _mm512_set1_epi32(SectorTable::kTileSide << 16 | 1);
  const __m512 half = _mm512_set1_ps(0.5F), one = _mm512_set1_ps(1);
  const int count = octant.rays;
  int kept = 0, ends = octant.ends;
  for (int i = 0; i < count; i += 16) {
    const auto exists = static_cast<__mmask16>(count - i >= 16 ? 0xFFFF : (1 << (count - i)) - 1);
    const __m512 slope = _mm512_loadu_ps(octant.slope + i);
    const __m512i cell = _mm512_loadu_si512(octant.cell + i);
    const __m512i column = _mm512_srli_epi32(cell, 16);
    const __m512 row = _mm512_fmadd_ps(_mm512_sub_ps(_mm512_cvtepi32_ps(column), origin_u), slope, origin_v);
    const __m512i whole = _mm512_cvttps_epi32(row);
    const __m512 within = _mm512_sub_ps(row, _mm512_cvtepi32_ps(whole)), next = _mm512_add_ps(within, slope);
    const __m512i v = _mm512_min_epi32(whole, end_row);
    const __m512i place = _mm512_add_epi16(_mm512_mask_blend_epi16(0x55555555U, cell, v), first);
    const __m512i tile = _mm512_madd_epi16(_mm512_srli_epi16(place, 3), tile_strides);
    const __m512i in_tile = _mm512_madd_epi16(_mm512_and_si512(place, _mm512_set1_epi16(7)), cell_strides);
    const __m512i index = _mm512_add_epi32(_mm512_slli_epi32(tile, 6), in_tile);
    const __m512i bytes = _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), exists, index, octant.codes, 1);
    const __m512i code =
        _mm512_and_si512(_mm512_add_epi32(bytes, _mm512_set1_epi32(1)), _mm512_set1_epi32(255));

    const __m512 error = _mm512_fmadd_ps(row, _mm512_set1_ps(kRowError), _mm512_set1_ps(kFixedError));
    const __mmask16 is_below_wall = _mm512_cmpeq_epi32_mask(code, _mm512_set1_epi32(kAbove));
    const __m512 from_half = _mm512_abs_ps(_mm512_sub_ps(within, half));
    const __m512 from_next = _mm512_abs_ps(_mm512_sub_ps(next, one));
    const __mmask16 ambiguous =
        static_cast<__mmask16>(_mm512_cmp_ps_mask(_mm512_add_ps(from_half, error), half, _CMP_GT_OQ) |
                               _mm512_mask_cmp_ps_mask(is_below_wall, from_next, error, _CMP_LT_OQ));
    const auto has_ended =
        static_cast<__mmask16>(ambiguous | _mm512_cmplt_epi32_mask(code, _mm512_set1_epi32(kAbove)) |
                               _mm512_cmpgt_epi32_mask(column, last_column) |
                               _mm512_mask_cmp_ps_mask(is_below_wall, next, one, _CMP_GE_OQ));
    const auto ending = static_cast<__mmask16>(has_ended & exists);
    const auto going_on = static_cast<__mmask16>(~has_ended & exists);

    const __m512i row_code = _mm512_or_si512(_mm512_slli_epi32(v, 8), code);
    const __m512i how = _mm512_mask_or_epi32(row_code, ambiguous, row_code, _mm512_set1_epi32(kAmbiguousEnd));
    // Packed in a register and stored whole: a store that packs is many times slower on some processors.
    _mm512_storeu_si512(octant.ended_cell + ends, _mm512_maskz_compress_epi32(ending, cell));
    _mm512_storeu_si512(octant.ended_hit + ends, _mm512_maskz_compress_epi32(ending, how));
    ends += __builtin_popcount(ending);
    const __m512i skip = _mm512_max_epi32(_mm512_sub_epi32(code, _mm512_set1_epi32(2)), _mm512_set1_epi32(1));
    const __m512i next_cell = _mm512_add_epi32(cell, _mm512_slli_epi32(skip, 16));
    _mm512_storeu_ps(octant.slope + kept, _mm512_maskz_compress_ps(going_on, slope));
    _mm512_storeu_si512(octant.cell + kept, _mm512_maskz_compress_epi32(going_on, next_cell));
    kept += __builtin_popcount(going_on);
  }
  octant.rays = kept;
  octant.ends = ends;
}

SLAM_AVX512 void marchAvx512(OctantMarch* octants, int count) {
  while (anyRay(octants, count))
    for (int i = 0; i < count; ++i) passAvx512(octants[i]);
  for (int i = 0; i < count; ++i) finishEnds(octants[i]);
}

}  // namespace

const ScanKernel kAvx2Kernel = {aimAvx2, beginAvx2, marchAvx2, measureAvx2};
const ScanKernel kAvx512Kernel = {aimAvx512, beginAvx512, marchAvx512, measureAvx512};

bool hasAvx2() {
  return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0 &&
         __builtin_cpu_supports("popcnt") != 0;
}

bool hasAvx512() {
  return hasAvx2() && __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
         __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
}

#else

const ScanKernel kAvx2Kernel = kPortableKernel, kAvx512Kernel = kPortableKernel;

bool hasAvx2() {
  return false;
}
bool hasAvx512() {
  return false;
}

#endif

}  // namespace slam::world
