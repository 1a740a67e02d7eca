#include "libslam/rays/march_steps.h"
#include "libslam/rays/sector_march.h"
#include "libslam/rays/sector_table.h"

#ifdef SLAM_X86_KERNELS

// GCC 12 warns about its own avx512 header (GCC bug 105593).
#pragma GCC diagnostic push
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <immintrin.h>
#pragma GCC diagnostic pop

namespace slam::rays {

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

}  // namespace slam::rays

#endif
