/// Files of MRPT's objects whose sizes are damaged: one clear line, and no more memory than a file of a map
/// can need.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/serialization/CArchive.h>

#include <cstdint>
#include <cstring>
#include <string>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/files/memory_guard.h"
#include "libslam/mapping/key_frames.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/testing/temp_folder.h"
#include "tests/mapping/small_room.h"

namespace slam::mapping {
namespace {

template <class Number>
std::string bytesOfNumber(Number number) {
  return {reinterpret_cast<const char*>(&number), sizeof number};
}

/// An object as its file has it, unpacked, which is read as well.
template <class Object>
std::string bytesOf(const Object& object) {
  mrpt::io::CMemoryStream buffer;
  mrpt::serialization::archiveFrom(buffer) << object;
  return {static_cast<const char*>(buffer.getRawBufferData()), buffer.getTotalBytesCount()};
}

/// The first `old_bytes` of the text behind the class's name replaced.
std::string damaged(std::string text, const std::string& name, const std::string& old_bytes,
                    const std::string& new_bytes) {
  const std::size_t at = text.find(old_bytes, text.find(name));
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, old_bytes.size(), new_bytes);
}

template <class Call>
std::string errorOf(Call call) {
  try {
    call();
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(DamagedMapFiles, AGridOfImpossibleSizeIsOneLine) {
  if (!files::MemoryGuard::isKept()) GTEST_SKIP() << "this build has an allocator of its own";
  const testing::TempFolder folder;
  const mrpt::maps::COccupancyGridMap2D grid(0, 6.15F, 0, 3.85F, 0.05F);
  const std::string path = folder / "map.gridmap", name = "COccupancyGridMap2D", bytes = bytesOf(grid);
  files::writeFileAtomically(path, bytes);
  EXPECT_EQ(readGridMap(path).columns, 123);
  const std::string wide = damaged(bytes, name, bytesOfNumber(grid.getXMax()), bytesOfNumber(2500.0F));
  const std::string vast = damaged(wide, name, bytesOfNumber(grid.getYMax()), bytesOfNumber(2500.0F));
  files::writeFileAtomically(path, vast);
  EXPECT_EQ(errorOf([&] { readGridMap(path); }),
            path + ": found a grid of impossible size, expected an MRPT occupancy grid");
}

TEST(DamagedMapFiles, KeyFramesOfImpossibleNumberAreOneLine) {
  if (!files::MemoryGuard::isKept()) GTEST_SKIP() << "this build has an allocator of its own";
  const testing::TempFolder folder;
  const std::string path = folder / "map.simplemap";
  std::vector<KeyFrame> key_frames;
  key_frames.reserve(77);
  for (int i = 0; i < 77; ++i) key_frames.push_back({test::scanRoom({0, 0, 0}, i, 11), {0, 0, 0}});
  writeKeyFrames(key_frames, path);
  mrpt::maps::CSimpleMap map;
  ASSERT_TRUE(map.loadFromFile(path));
  files::writeFileAtomically(
      path, damaged(bytesOf(map), "CSimpleMap", bytesOfNumber(77U), bytesOfNumber(100'000'000U)));
  const auto config = loadMethodConfig(std::string(RASTERSLAM_SOURCE_DIR) + "/configs/methods", "graph");
  auto method = makeMapBuilder(config, "graph", 1);
  EXPECT_EQ(errorOf([&] { continueMap(method, path, core::Pose2{}, true); }),
            path + ": found key frames of impossible size, expected an MRPT simplemap");
}

// MRPT makes room for a scan's beams without a look at whether it got it, and writes there.
TEST(DamagedMapFiles, AScanOfImpossibleSizeInAKeyFrameIsOneLine) {
  if (!files::MemoryGuard::isKept()) GTEST_SKIP() << "this build has memory for it";
  const testing::TempFolder folder;
  const std::string path = folder / "map.simplemap";
  writeKeyFrames({{test::scanRoom({0, 0, 0}, 1, 1155), {0, 0, 0}}}, path);
  mrpt::maps::CSimpleMap map;
  ASSERT_TRUE(map.loadFromFile(path));
  files::writeFileAtomically(path, damaged(bytesOf(map), "CObservation2DRangeScan", bytesOfNumber(1155U),
                                           bytesOfNumber(0x3FFFFFFFU)));
  EXPECT_EQ(errorOf([&] { readKeyFrames(path); }), path + ": is no MRPT simplemap");
}

}  // namespace
}  // namespace slam::mapping
