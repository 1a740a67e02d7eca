#include "libslam/record/truth_files.h"

#include <gtest/gtest.h>

#include "libslam/core/files.h"
#include "libslam/core/file_hash.h"
#include "libslam/core/manifest.h"
#include "libslam/testing/temp_folder.h"

namespace slam::record {
namespace {

// A drive by a person's commands has their file among its inputs; in the order of the names it may come
// before the plan.
TEST(FindPlan, TakesAPlanAmongTheInputsAndNothingElse) {
  const testing::TempFolder folder;
  core::Manifest manifest;
  for (const char* name : {"a_commands.txt", "plan.yaml"}) {
    core::writeFileAtomically(folder / name, name);
    manifest.inputs[folder / name] = core::fileSha256(folder / name);
  }
  core::writeManifest(manifest, folder / "run.manifest.json");
  EXPECT_EQ(findPlan(folder / "run.rawlog"), folder / "plan.yaml");
  core::writeFileAtomically(folder / "plan.yaml", "another one");
  EXPECT_EQ(findPlan(folder / "run.rawlog"), "");
}

}  // namespace
}  // namespace slam::record
