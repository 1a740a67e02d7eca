#include "libslam/world/sector_march.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libslam/world/sector_table.h"

#if defined(__x86_64__) && defined(__GNUC__)
#define SLAM_X86_KERNELS 1
#include <immintrin.h>
#endif

namespace slam::world {
namespace {

// Codes plus one, as bytes: what ends a ray is then below what lets it go on.
constexpr int kNever = 0, kFace = 1, kAbove = 2;
static_assert((kNeverHits + 1) % 256 == kNever && kWall + 1 == kFace && kWallAbove + 1 == kAbove);

// The row of a column in float, fv + (k - fu) * m, errs from its value in double by less than 4 * 2^-24 of itself
// and 2^-23 of a cell: each of fu, fv, k - fu, m and the result is rounded once, by half a unit in the last place
// (2^-24 of itself). Twice that is allowed for.
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
    beams.slope[i] = static_cast<float>(slope < kSteepest ? slope : kSteepest);
    beams.octant[i] = (along_x >= along_y ? 4 : 0) | (x < 0 ? 2 : 0) | (y < 0 ? 1 : 0);
  }
}

// As RayEntry::distance().
SLAM_INLINE void measureRanges(const double* __restrict major, const double* __restrict minor,
                               const float* __restrict hit_u, const float* __restrict above, int count,
                               double origin_u, double origin_v, double resolution_m, double limit_m,
                               float* __restrict ranges_m) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (int i = 0; i < count; ++i) {
    const double u = hit_u[i], line = above[i];
    const double ahead = u - origin_u;
    const double nearest = (ahead > 0 ? ahead : 0) / major[i];
    const double farthest = (u + 1 - origin_u) / major[i];
    const double entry = (line - origin_v) / minor[i];
    const double not_before = entry < nearest ? nearest : entry;
    const double within = farthest < not_before ? farthest : not_before;
    const double range_m = resolution_m * (line > -1e9 ? within : nearest);
    ranges_m[i] = range_m <= limit_m ? static_cast<float>(range_m) : kInfinity;
  }
}

void aimPortable(const double* cosines, const double* sines, int count, double cosine, double sine,
                 AimedBeams& beams) {
  aimBeams(cosines, sines, count, cosine, sine, beams);
}

void measurePortable(const double* major, const double* minor, const float* hit_u, const float* above,
                     int count, double origin_u, double origin_v, double resolution_m, double limit_m,
                     float* ranges_m) {
  measureRanges(major, minor, hit_u, above, count, origin_u, origin_v, resolution_m, limit_m, ranges_m);
}

void passPortable(OctantMarch& octant) {
  int kept = 0, ends = octant.ends;
  for (int i = 0; i < octant.rays; ++i) {
    const float slope = octant.slope[i];
    const std::uint32_t cell = octant.cell[i];
    const int column = static_cast<int>(cell >> 16);
    const float row = octant.origin_v + (static_cast<float>(column) - octant.origin_u) * slope;
    int v = static_cast<int>(row);
    const float within = row - static_cast<float>(v), next = within + slope;
    v = std::min(v, octant.end_row);
    const int code = (octant.codes[column * octant.stride + v] + 1) & 255;
    const float error = row * kRowError + kFixedError;
    const bool is_below_wall = code == kAbove;
    const bool ambiguous =
        (std::abs(within - 0.5F) + error > 0.5F) | (is_below_wall & (std::abs(next - 1) < error));
    const bool has_ended =
        ambiguous | (code < kAbove) | (is_below_wall & (next >= 1)) | (column > octant.last_column);
    // Written either way and counted or not: a branch would be mispredicted once per ray.
    octant.ended_cell[ends] = cell;
    octant.ended_how[ends] = static_cast<std::uint32_t>(v << 8 | code) | (ambiguous ? kAmbiguous : 0);
    ends += has_ended;
    octant.slope[kept] = slope;
    octant.cell[kept] = cell + (static_cast<std::uint32_t>(std::max(code - 2, 1)) << 16);
    kept += !has_ended;
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

const ScanKernel kPortableKernel = {aimPortable, marchPortable, measurePortable};

#ifdef SLAM_X86_KERNELS

#define SLAM_AVX2 __attribute__((target("avx2,fma,popcnt")))
#define SLAM_AVX512 __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,popcnt")))

namespace {

SLAM_AVX2 void aimAvx2(const double* cosines, const double* sines, int count, double cosine, double sine,
                       AimedBeams& beams) {
  aimBeams(cosines, sines, count, cosine, sine, beams);
}

SLAM_AVX2 void measureAvx2(const double* major, const double* minor, const float* hit_u, const float* above,
                           int count, double origin_u, double origin_v, double resolution_m, double limit_m,
                           float* ranges_m) {
  measureRanges(major, minor, hit_u, above, count, origin_u, origin_v, resolution_m, limit_m, ranges_m);
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

SLAM_AVX2 inline void passAvx2(OctantMarch& octant) {
  const __m256 origin_u = _mm256_set1_ps(octant.origin_u), origin_v = _mm256_set1_ps(octant.origin_v);
  const __m256i end_row = _mm256_set1_epi32(octant.end_row);
  const __m256i last_column = _mm256_set1_epi32(octant.last_column);
  // Row and column are 16 bits each of a lane: one instruction multiplies both and adds.
  const __m256i strides = _mm256_set1_epi32(octant.stride << 16 | 1);
  const __m256 half = _mm256_set1_ps(0.5F), one = _mm256_set1_ps(1);
  const __m256 sign = _mm256_set1_ps(-0.0F);
  const __m256i lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  const int count = octant.rays;
  int kept = 0, ends = octant.ends;
  for (int i = 0; i < count; i += 8) {
    const __m256 slope = _mm256_loadu_ps(octant.slope + i);
    const __m256i cell = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(octant.cell + i));
    const __m256i column = _mm256_srli_epi32(cell, 16);
    const __m256 row = _mm256_fmadd_ps(_mm256_sub_ps(_mm256_cvtepi32_ps(column), origin_u), slope, origin_v);
    const __m256i whole = _mm256_cvttps_epi32(row);
    const __m256 within = _mm256_sub_ps(row, _mm256_cvtepi32_ps(whole)), next = _mm256_add_ps(within, slope);
    const __m256i v = _mm256_min_epi32(whole, end_row);
    const __m256i index = _mm256_madd_epi16(_mm256_blend_epi16(cell, v, 0x55), strides);
    const __m256i exists = _mm256_cmpgt_epi32(_mm256_set1_epi32(count - i), lanes);
    const __m256i bytes = _mm256_mask_i32gather_epi32(
        _mm256_setzero_si256(), reinterpret_cast<const int*>(octant.codes), index, exists, 1);
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
        _mm256_cmpgt_epi32(_mm256_set1_epi32(kAbove), code), _mm256_cmpgt_epi32(column, last_column)));
    const __m256 enters_above = _mm256_and_ps(is_below_wall, _mm256_cmp_ps(next, one, _CMP_GE_OQ));
    const int has_ended = _mm256_movemask_ps(_mm256_or_ps(_mm256_or_ps(ambiguous, stops), enters_above));
    const int existing = _mm256_movemask_ps(_mm256_castsi256_ps(exists));
    const int ending = has_ended & existing, going_on = ~has_ended & existing;

    const __m256i how = _mm256_or_si256(
        _mm256_or_si256(_mm256_slli_epi32(v, 8), code),
        _mm256_and_si256(_mm256_castps_si256(ambiguous), _mm256_set1_epi32(static_cast<int>(kAmbiguous))));
    const __m256i end_order = packOrder(ending);
    storePacked(octant.ended_cell + ends, cell, end_order);
    storePacked(octant.ended_how + ends, how, end_order);
    ends += __builtin_popcount(static_cast<unsigned>(ending));
    const __m256i skip = _mm256_max_epi32(_mm256_sub_epi32(code, _mm256_set1_epi32(2)), _mm256_set1_epi32(1));
    const __m256i keep_order = packOrder(going_on);
    _mm256_storeu_ps(octant.slope + kept, _mm256_permutevar8x32_ps(slope, keep_order));
    storePacked(octant.cell + kept, _mm256_add_epi32(cell, _mm256_slli_epi32(skip, 16)), keep_order);
    kept += __builtin_popcount(static_cast<unsigned>(going_on));
  }
  octant.rays = kept;
  octant.ends = ends;
}

SLAM_AVX2 void marchAvx2(OctantMarch* octants, int count) {
  while (anyRay(octants, count))
    for (int i = 0; i < count; ++i) passAvx2(octants[i]);
}

SLAM_AVX512 void aimAvx512(const double* cosines, const double* sines, int count, double cosine, double sine,
                           AimedBeams& beams) {
  aimBeams(cosines, sines, count, cosine, sine, beams);
}

SLAM_AVX512 void measureAvx512(const double* major, const double* minor, const float* hit_u,
                               const float* above, int count, double origin_u, double origin_v,
                               double resolution_m, double limit_m, float* ranges_m) {
  measureRanges(major, minor, hit_u, above, count, origin_u, origin_v, resolution_m, limit_m, ranges_m);
}

SLAM_AVX512 inline void passAvx512(OctantMarch& octant) {
  const __m512 origin_u = _mm512_set1_ps(octant.origin_u), origin_v = _mm512_set1_ps(octant.origin_v);
  const __m512i end_row = _mm512_set1_epi32(octant.end_row);
  const __m512i last_column = _mm512_set1_epi32(octant.last_column);
  const __m512i strides = _mm512_set1_epi32(octant.stride << 16 | 1);
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
    const __m512i index = _mm512_madd_epi16(_mm512_mask_blend_epi16(0x55555555U, cell, v), strides);
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
    const __m512i how =
        _mm512_mask_or_epi32(row_code, ambiguous, row_code, _mm512_set1_epi32(static_cast<int>(kAmbiguous)));
    // Packed in a register and stored whole: a store that packs is many times slower on some processors.
    _mm512_storeu_si512(octant.ended_cell + ends, _mm512_maskz_compress_epi32(ending, cell));
    _mm512_storeu_si512(octant.ended_how + ends, _mm512_maskz_compress_epi32(ending, how));
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
}

}  // namespace

const ScanKernel kAvx2Kernel = {aimAvx2, marchAvx2, measureAvx2};
const ScanKernel kAvx512Kernel = {aimAvx512, marchAvx512, measureAvx512};

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
