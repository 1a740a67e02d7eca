#include <gtest/gtest.h>

#include "libslam/core/error.h"
#include "libslam/particles/particle_filter.h"
#include "tests/particles/ring.h"

namespace slam::particles {
namespace {

using namespace ring_drive;

// Fox 2003, equation 7 worked by hand: 2 bins: (1 / 0.1) (1 - 2/9 + sqrt(2/9) 2.3263)^3 = 65.86; 101 bins:
// (100 / 0.1) (1 - 2/900 + sqrt(2/900) 2.3263)^3 = 1358.2. The exact quantiles of chi-square, 6.635 and
// 135.81, give 66.35 and 1358.1.
TEST(KldParticles, FollowTheBoundOfFox) {
  EXPECT_EQ(kldParticles(1, 0.05), 1U);
  EXPECT_EQ(kldParticles(2, 0.05), 66U);
  EXPECT_EQ(kldParticles(101, 0.05), 1359U);
  EXPECT_LT(kldParticles(101, 0.1), kldParticles(101, 0.05));
  for (size_t bins = 1; bins < 50; ++bins) EXPECT_LT(kldParticles(bins, 0.1), kldParticles(bins + 1, 0.1));
  EXPECT_THROW(kldParticles(0, 0.1), core::ContractError);
  EXPECT_THROW(kldParticles(3, 0), core::ContractError);
}

TEST(ParticleFilter, KldSamplingStaysBetweenItsBoundsAndFollowsTheSpread) {
  auto kld = options(20);
  kld.sampling = "kld", kld.least_count = 5, kld.most_count = 40;
  auto fine = kld, coarse = kld;
  fine.kld_bin_m = 0.001, fine.kld_bin_rad = 0.0005;
  coarse.kld_bin_m = 10, coarse.kld_bin_rad = 1;
  ParticleFilter many(fine, 1), few(coarse, 1);
  for (size_t i = 0; i < 200; ++i) {
    for (auto* filter : {&many, &few}) {
      filter->update(ring().scans[i], motionOf(ring().wheels[i]));
      EXPECT_GE(filter->particles(), 5);
      EXPECT_LE(filter->particles(), 40);
    }
  }
  EXPECT_EQ(few.particles(), 5);
  EXPECT_GT(many.particles(), 20);
  EXPECT_EQ(many.path().size(), 200U);
}

TEST(ParticleFilter, KldSamplingGivesTheSameBytesWithAnyNumberOfThreads) {
  auto one = options(20, 1);
  one.sampling = "kld", one.least_count = 5, one.most_count = 40;
  auto four = one;
  four.threads = 4;
  ParticleFilter single(one, 3), parallel(four, 3);
  EXPECT_TRUE(sameBytes(run(single, 150), run(parallel, 150)));
  EXPECT_EQ(single.particles(), parallel.particles());
  EXPECT_TRUE(sameBytes(single.path(), parallel.path()));
}

}  // namespace
}  // namespace slam::particles
