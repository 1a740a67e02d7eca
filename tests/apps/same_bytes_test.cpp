/// The same bytes on machines of other kinds: the C library and OpenCV are told that the processor cannot do
/// what it can.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>

#include "libslam/files/files.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;

/// For glibc (before 2.33 the names end in _Usable; those that it does not know are passed over), and for
/// OpenCV.
const std::string kPlain =
    "GLIBC_TUNABLES=glibc.cpu.hwcaps="
    "-AVX2,-AVX512F,-FMA,-FMA4,-AVX2_Usable,-AVX512F_Usable,-FMA_Usable,-FMA4_Usable "
    "OPENCV_CPU_DISABLE=AVX2,FMA3 ";

/// Everything in a folder but what was measured by the clock, by path.
std::map<std::string, std::string> contents(const std::string& folder) {
  static const std::set<std::string> kDiffers = {"manifest.json", "timing.csv", "cost.csv", "cost.json",
                                                 "run.manifest.json"};
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && !kDiffers.count(entry.path().filename().string()))
      files[fs::relative(entry.path(), folder).string()] = files::readTextFile(entry.path().string());
  return files;
}

void expectSameBytes(const std::string& command) {
  const testing::TempFolder folder;
  const auto run = [&](const std::string& environment, const std::string& name) {
    fs::create_directory(folder / name);
    const auto done = testing::runCommand("cd '" + (folder / name) + "' && " + environment +
                                          "'" RASTERSLAM_PROGRAM "' " + command);
    EXPECT_EQ(done.exit_code, 0) << command << ": " << done.err;
    return contents(folder / name);
  };
  const auto usual = run("", "usual"), plain = run(kPlain, "plain");
  EXPECT_FALSE(usual.empty());
  ASSERT_EQ(usual.size(), plain.size());
  for (const auto& [path, bytes] : usual) EXPECT_TRUE(bytes == plain.at(path)) << command << ": " << path;
}

TEST(SameBytes, OfLogsOnProcessorsWithoutFusedMultiplyAdd) {
  expectSameBytes("simulate office_loop --duration 20 --seed 4 -o run.rawlog -q");
  expectSameBytes("simulate flat --sensor camera --duration 5 --seed 5 -o run.rawlog -q");
}

TEST(SameBytes, OfMapsAndScoresOnProcessorsWithoutFusedMultiplyAdd) {
  expectSameBytes("compare flat --duration 10 --seed 4 --methods naive,icp,rbpf,particles,graph -o out -q");
}

TEST(SameBytes, OfExplorationsOnProcessorsWithoutFusedMultiplyAdd) {
  expectSameBytes("explore flat --duration 20 --seed 4 -o out -q");
}

}  // namespace
}  // namespace slam::apps
