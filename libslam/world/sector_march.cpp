#include "libslam/world/sector_march.h"

#include <algorithm>

#if defined(__x86_64__) && defined(__GNUC__)
#define SLAM_HAS_AVX2_TARGET 1
#include <immintrin.h>
#endif

namespace slam::world {

void marchPortable(const SectorView& view, MarchingRays& rays, EndedRays& ended) {
  int kept = 0, ends = ended.count;
  for (int i = 0; i < rays.count; ++i) {
    const double slope = rays.slope[i], beam = rays.beam[i];
    const int u = static_cast<int>(rays.u[i]);
    const double row = view.origin_v + (u - view.origin_u) * slope;
    const int truncated = static_cast<int>(row);
    const int v = std::min(truncated - (truncated > row), view.end_v);
    const int code = view.codes[u * view.stride + v];
    const bool enters_above = view.origin_v + (u + 1 - view.origin_u) * slope >= v + 1;
    const bool has_ended = static_cast<int>(code == kWall) | static_cast<int>(code == kNeverHits) |
                           (static_cast<int>(code == kWallAbove) & static_cast<int>(enters_above));
    // Written either way and counted or not: a branch would be mispredicted once per ray.
    ended.u[ends] = u;
    ended.v[ends] = v;
    ended.code[ends] = code;
    ended.beam[ends] = beam;
    ends += has_ended;
    rays.slope[kept] = slope;
    rays.u[kept] = u + std::max(code - 1, 1);
    rays.beam[kept] = beam;
    kept += !has_ended;
  }
  rays.count = kept;
  ended.count = ends;
}

#ifdef SLAM_HAS_AVX2_TARGET

namespace {

/// For each set of four lanes the order that moves them to the front, in halves of a lane.
struct PackTable {
  alignas(32) std::int32_t order[16][8];
  constexpr PackTable() : order() {
    for (int set = 0; set < 16; ++set) {
      int to = 0;
      for (int lane = 0; lane < 4; ++lane)
        if ((set >> lane & 1) != 0) {
          order[set][to++] = 2 * lane;
          order[set][to++] = 2 * lane + 1;
        }
    }
  }
};
constexpr PackTable kPack;

__attribute__((target("avx2"))) inline void storePacked(double* to, __m256d lanes, __m256i order) {
  _mm256_storeu_pd(to, _mm256_castps_pd(_mm256_permutevar8x32_ps(_mm256_castpd_ps(lanes), order)));
}

}  // namespace

bool processorHasAvx2() {
  return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("popcnt") != 0;
}

__attribute__((target("avx2,popcnt"))) void marchAvx2(const SectorView& view, MarchingRays& rays,
                                                      EndedRays& ended) {
  const int count = rays.count;
  if (count == 0) return;
  // Lanes behind the last ray repeat it, so that they look where looking is allowed.
  for (int i = count; i < count + kMarchPadding; ++i) {
    rays.slope[i] = rays.slope[count - 1];
    rays.u[i] = rays.u[count - 1];
    rays.beam[i] = 0;
  }
  const __m256d one = _mm256_set1_pd(1), origin_u = _mm256_set1_pd(view.origin_u);
  const __m256d origin_v = _mm256_set1_pd(view.origin_v), end_v = _mm256_set1_pd(view.end_v);
  const __m256d stride = _mm256_set1_pd(static_cast<double>(view.stride));
  // A whole number below 2^51 added to 1.5 * 2^52 stands in the low bits of the sum.
  const __m256d shift = _mm256_set1_pd(0x1.8p52);
  int kept = 0, ends = ended.count;
  for (int i = 0; i < count; i += 4) {
    const __m256d slope = _mm256_loadu_pd(rays.slope + i), u = _mm256_loadu_pd(rays.u + i);
    const __m256d beam = _mm256_loadu_pd(rays.beam + i), next_u = _mm256_add_pd(u, one);
    const __m256d row = _mm256_add_pd(origin_v, _mm256_mul_pd(_mm256_sub_pd(u, origin_u), slope));
    const __m256d next_row = _mm256_add_pd(origin_v, _mm256_mul_pd(_mm256_sub_pd(next_u, origin_u), slope));
    const __m256d v = _mm256_min_pd(_mm256_floor_pd(row), end_v);
    const __m256d index = _mm256_add_pd(_mm256_mul_pd(u, stride), v);
    const __m256i offset =
        _mm256_sub_epi64(_mm256_castpd_si256(_mm256_add_pd(index, shift)), _mm256_castpd_si256(shift));
    const __m128i bytes = _mm256_i64gather_epi32(reinterpret_cast<const int*>(view.codes), offset, 1);
    const __m256d code = _mm256_cvtepi32_pd(_mm_and_si128(bytes, _mm_set1_epi32(255)));

    const __m256d enters_above = _mm256_cmp_pd(next_row, _mm256_add_pd(v, one), _CMP_GE_OQ);
    const __m256d is_below_wall = _mm256_cmp_pd(code, _mm256_set1_pd(kWallAbove), _CMP_EQ_OQ);
    const __m256d stops = _mm256_or_pd(_mm256_cmp_pd(code, _mm256_set1_pd(kWall), _CMP_EQ_OQ),
                                       _mm256_cmp_pd(code, _mm256_set1_pd(kNeverHits), _CMP_EQ_OQ));
    const int has_ended = _mm256_movemask_pd(_mm256_or_pd(stops, _mm256_and_pd(enters_above, is_below_wall)));
    const int exists = count - i >= 4 ? 15 : (1 << (count - i)) - 1;
    const int ending = has_ended & exists, going_on = ~has_ended & exists;

    const __m256i end_order = _mm256_load_si256(reinterpret_cast<const __m256i*>(kPack.order[ending]));
    storePacked(ended.u + ends, u, end_order);
    storePacked(ended.v + ends, v, end_order);
    storePacked(ended.code + ends, code, end_order);
    storePacked(ended.beam + ends, beam, end_order);
    ends += __builtin_popcount(static_cast<unsigned>(ending));
    const __m256i keep_order = _mm256_load_si256(reinterpret_cast<const __m256i*>(kPack.order[going_on]));
    storePacked(rays.slope + kept, slope, keep_order);
    storePacked(rays.u + kept, _mm256_add_pd(u, _mm256_max_pd(_mm256_sub_pd(code, one), one)), keep_order);
    storePacked(rays.beam + kept, beam, keep_order);
    kept += __builtin_popcount(static_cast<unsigned>(going_on));
  }
  rays.count = kept;
  ended.count = ends;
}

#else

bool processorHasAvx2() {
  return false;
}
void marchAvx2(const SectorView& view, MarchingRays& rays, EndedRays& ended) {
  marchPortable(view, rays, ended);
}

#endif

}  // namespace slam::world
