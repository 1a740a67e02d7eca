#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <filesystem>

#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"
#include "tests/logs/ros_fixtures.h"

// Damaged bags of every container: what comes out is objects, then the proper end or one line.

namespace slam::logs {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Reading {
  size_t objects = 0;
  std::string error;
};

/// Anything but an InputError leaves the test by way of the exception.
Reading readDamaged(const Container& container, const std::string& path) {
  Reading reading;
  try {
    const auto source = container.open(path);
    while (source->next()) ++reading.objects;
    source->skipped();
  } catch (const core::InputError& error) {
    reading.error = error.what();
    EXPECT_THAT(reading.error, StartsWith(path + ": "));
    EXPECT_EQ(reading.error.find('\n'), std::string::npos) << reading.error;
  }
  return reading;
}

size_t peakMemoryMb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<size_t>(usage.ru_maxrss) / 1024;
}

class DamagedBag : public ::testing::TestWithParam<Container> {
 protected:
  std::string path() const { return folder_ / GetParam().file; }
  std::string wholeBag(int moments) {
    writeAll(drive(moments), *GetParam().create(path()));
    return readBytes(path());
  }
  Reading readBytesAsBag(const std::string& bytes) {
    writeBytes(bytes, path());
    return readDamaged(GetParam(), path());
  }

  testing::TempFolder folder_;
};

std::vector<Container> singleFiles() {
  auto all = containers();
  all.erase(std::remove_if(all.begin(), all.end(),
                           [](const Container& container) { return std::string(container.file) == "log"; }),
            all.end());
  return all;
}
INSTANTIATE_TEST_SUITE_P(Each, DamagedBag, ::testing::ValuesIn(singleFiles()),
                         [](const auto& parameter) { return parameter.param.name; });

TEST_P(DamagedBag, CutAnywhereSaysSoAfterItsGoodObjects) {
  constexpr int kMoments = 4000;
  const auto bytes = wholeBag(kMoments);
  size_t most = 0;
  for (size_t part = 0; part < 20; ++part) {
    const auto reading = readBytesAsBag(bytes.substr(0, bytes.size() * part / 20));
    EXPECT_NE(reading.error, "") << part;
    most = std::max(most, reading.objects);
  }
  EXPECT_GT(most, 3U * kMoments / 2);
  // One byte less than whole is cut, too.
  EXPECT_NE(readBytesAsBag(bytes.substr(0, bytes.size() - 1)).error, "");
}

TEST_P(DamagedBag, WithAFlippedByteCrashesNothingAndTakesNoMemory) {
  const auto bytes = wholeBag(40);
  [[maybe_unused]] const size_t before_mb = peakMemoryMb();
  for (const char flip : {'\xFF', '\x01', '\x80'}) {
    for (size_t at = 0; at < bytes.size(); at += 1 + bytes.size() / 700) {
      auto damaged = bytes;
      damaged[at] = static_cast<char>(damaged[at] ^ flip);
      readBytesAsBag(damaged);
    }
  }
#if !defined(__SANITIZE_ADDRESS__)  // which keeps what was freed
  EXPECT_LT(peakMemoryMb(), before_mb + 100);
#endif
}

TEST_P(DamagedBag, OfNothingOrOtherThingsIsRefused) {
  EXPECT_THAT(readBytesAsBag("").error, HasSubstr(": is empty"));
  EXPECT_NE(readBytesAsBag(std::string(5000, 'x')).error, "");
  EXPECT_THAT(testing::errorOf([&] { GetParam().open(folder_ / "gone"); }), HasSubstr("gone: no such file"));
  std::filesystem::create_directory(folder_ / "folder");
  EXPECT_THAT(testing::errorOf([&] { GetParam().open(folder_ / "folder"); }), HasSubstr("is a folder"));
}

TEST_P(DamagedBag, IsToldApartByItsFirstBytes) {
  const auto start = wholeBag(1).substr(0, 16);
  const std::string name = GetParam().name;
  EXPECT_EQ(bags::looksLikeRos1Bag(start), name == "Ros1Bag");
  EXPECT_EQ(bags::looksLikeRos2Db3(start), name == "Ros2Db3");
  EXPECT_EQ(bags::looksLikeMcap(start), name.substr(0, 4) == "Mcap");
  EXPECT_FALSE(bags::looksLikeRos1Bag("") || bags::looksLikeRos2Db3("") || bags::looksLikeMcap(""));
}

}  // namespace
}  // namespace slam::logs
