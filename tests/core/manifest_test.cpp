#include "libslam/core/manifest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libslam/core/files.h"

namespace slam::core {
namespace {

TEST(Version, IsTheOneThatTheCitationNames) {
  EXPECT_THAT(readTextFile(RASTERSLAM_SOURCE_DIR "/CITATION.cff"),
              ::testing::HasSubstr("\nversion: " + versionText() + "\n"));
}

}  // namespace
}  // namespace slam::core
