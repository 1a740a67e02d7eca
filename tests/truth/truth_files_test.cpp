#include "libslam/truth/truth_files.h"

#include <gtest/gtest.h>

#include "libslam/files/files.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/manifest.h"
#include "libslam/testing/temp_folder.h"

namespace slam::truth {
namespace {

// A drive by a person's commands has their file among its inputs; in the order of the names it may come
// before the plan.
TEST(FindPlan, TakesAPlanAmongTheInputsAndNothingElse) {
  const testing::TempFolder folder;
  resources::Manifest manifest;
  for (const char* name : {"a_commands.txt", "plan.yaml"}) {
    files::writeFileAtomically(folder / name, name);
    manifest.inputs[folder / name] = resources::fileSha256(folder / name);
  }
  resources::writeManifest(manifest, folder / "run.manifest.json");
  EXPECT_EQ(findPlan(folder / "run.rawlog"), folder / "plan.yaml");
  files::writeFileAtomically(folder / "plan.yaml", "another one");
  EXPECT_EQ(findPlan(folder / "run.rawlog"), "");
}

}  // namespace
}  // namespace slam::truth
