#include "libslam/resources/manifest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libslam/files/files.h"

namespace slam::resources {
namespace {

TEST(Version, IsTheOneThatTheCitationNames) {
  EXPECT_THAT(files::readTextFile(RASTERSLAM_SOURCE_DIR "/CITATION.cff"),
              ::testing::HasSubstr("\nversion: " + versionText() + "\n"));
}

}  // namespace
}  // namespace slam::resources
