// What holds for every format of logs, also for the next one.
#include "libslam/logs/log_format.h"

#include <gtest/gtest.h>

#include <set>

#include "libslam/files/files.h"
#include "libslam/testing/temp_folder.h"
#include "tests/logs/ros_fixtures.h"

namespace slam::logs {
namespace {

using mrpt::obs::CObservation2DRangeScan;

class EveryFormat : public ::testing::TestWithParam<LogFormatInfo> {
 protected:
  std::string write(const std::vector<Object>& objects) {
    const std::string path = folder_ / ("log" + GetParam().suffixes.front());
    const auto sink = createLog(path, GetParam().format);
    writeAll(objects, *sink);
    return path;
  }
  testing::TempFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(Logs, EveryFormat, ::testing::ValuesIn(logFormats()),
                         [](const auto& format) { return std::string(format.param.word); });

TEST_P(EveryFormat, IsKnownByWhatItBeginsWithAndByThatAlone) {
  const std::string path = write(drive(30));
  EXPECT_EQ(detectLogFormat(path), GetParam().format);
  const std::string start = files::readTextFile(path).substr(0, 1 << 16);
  // A rawlog may be packed.
  if (GetParam().format == LogFormat::kRawlog) return;
  for (const auto& other : logFormats())
    EXPECT_EQ(other.looksLike(start), other.format == GetParam().format) << other.name;
}

TEST_P(EveryFormat, GivesBackItsScansInOrder) {
  const auto written = drive(30);
  const auto source = openLog(write(written));
  const auto found = only<CObservation2DRangeScan>(readAll(*source));
  ASSERT_EQ(found.size(), 30U);
  for (size_t i = 0; i < found.size(); ++i) {
    const auto& expected = dynamic_cast<const CObservation2DRangeScan&>(*written[3 * i + 2]);
    ASSERT_EQ(found[i]->getScanSize(), expected.getScanSize()) << i;
    EXPECT_NEAR(static_cast<double>((found[i]->timestamp - expected.timestamp).count()), 0, 10'000) << i;
  }
}

TEST_P(EveryFormat, WritesTheSameBytesAgainAndNothingWithoutBeingClosed) {
  const std::string first = files::readTextFile(write(drive(3)));
  EXPECT_EQ(files::readTextFile(write(drive(3))), first);
  const std::string other = folder_ / ("open" + GetParam().suffixes.front());
  createLog(other, GetParam().format)->write(*drive(1)[2]);
  EXPECT_EQ(
      std::distance(std::filesystem::directory_iterator(folder_ / ""), std::filesystem::directory_iterator()),
      1);
}

TEST(LogFormats, HaveWordsAndSuffixesOfTheirOwn) {
  std::set<std::string> words, suffixes;
  size_t suffix_count = 0;
  for (const auto& format : logFormats()) {
    words.insert(format.word);
    suffixes.insert(format.suffixes.begin(), format.suffixes.end());
    suffix_count += format.suffixes.size();
    EXPECT_STREQ(formatName(format.format), format.name);
  }
  EXPECT_EQ(words.size(), logFormats().size());
  EXPECT_EQ(suffixes.size(), suffix_count);
}

}  // namespace
}  // namespace slam::logs
