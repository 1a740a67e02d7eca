#include "libslam/resources/gzip.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/files/files.h"
#include "libslam/testing/temp_folder.h"

namespace slam::resources {
namespace {

TEST(Gzip, AFileHasTheBytesThatMemoryHas) {
  const testing::TempFolder folder;
  core::RandomStream random(3, "bytes");
  std::string bytes(3'000'000, 'a');  // some pieces
  for (size_t i = 0; i < bytes.size(); i += 3) bytes[i] = static_cast<char>(random.uniform(0, 100));
  for (const std::string& some : {bytes, std::string("short"), std::string()}) {
    writeGzipFile(folder / "packed.gz", some);
    EXPECT_EQ(files::readTextFile(folder / "packed.gz"), gzip(some)) << some.size();
  }
}

TEST(Gzip, WhatCannotBeWrittenLeavesNothingBehind) {
  const testing::TempFolder folder;
  EXPECT_THROW(writeGzipFile(folder / "nowhere/packed.gz", "bytes"), core::IoError);
  std::filesystem::create_directory(folder / "packed.gz");
  EXPECT_THROW(writeGzipFile(folder / "packed.gz", "bytes"), core::InputError);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

}  // namespace
}  // namespace slam::resources
