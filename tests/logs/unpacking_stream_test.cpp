#include "libslam/rawlogs/unpacking_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/logs/carmen_fixtures.h"
#include "tests/logs/log_fixtures.h"

namespace slam::logs {
namespace {

struct Packing {
  std::string name;
  std::function<std::string(const std::string&)> pack;
};

/// Any text, longer than what a stream unpacks at once.
std::string longText() {
  std::string text;
  for (int i = 0; i < 20000; ++i) text += "line " + std::to_string(i * 7919) + "\n";
  return text;
}

struct Unpacked {
  std::string content;
  rawlogs::UnpackingStream::Failure failure;
};
Unpacked unpackAll(const std::string& bytes) {
  static const testing::TempFolder folder;
  writeBytes(bytes, folder / "a");
  rawlogs::UnpackingStream stream(folder / "a");
  Unpacked result;
  for (std::string piece; !(piece = stream.take()).empty();) result.content += piece;
  result.failure = stream.failure();
  return result;
}

class Packed : public ::testing::TestWithParam<Packing> {};
INSTANTIATE_TEST_SUITE_P(Each, Packed,
                         ::testing::Values(Packing{"gzip", gzip}, Packing{"bzip2", bzip2}, Packing{"xz", xz}),
                         [](const auto& packing) { return packing.param.name; });

TEST_P(Packed, GivesTheContent) {
  const auto result = unpackAll(GetParam().pack(longText()));
  EXPECT_TRUE(result.content == longText());
  EXPECT_EQ(result.failure, rawlogs::UnpackingStream::Failure::kNone);
}

TEST_P(Packed, SeveralMembersAreOneContent) {
  const auto& pack = GetParam().pack;
  const auto result = unpackAll(pack("one, ") + pack("") + pack(longText()) + pack("three"));
  EXPECT_TRUE(result.content == "one, " + longText() + "three");
  EXPECT_EQ(result.failure, rawlogs::UnpackingStream::Failure::kNone);
}

TEST_P(Packed, TellsACutFromTheEndWhereverItFalls) {
  const std::string text = longText().substr(0, 700), packed = GetParam().pack(text);
  size_t before = 0;
  for (size_t size = 6; size < packed.size(); ++size) {
    const auto result = unpackAll(packed.substr(0, size));
    ASSERT_EQ(result.failure, rawlogs::UnpackingStream::Failure::kTruncated) << "cut at " << size;
    ASSERT_EQ(text.compare(0, result.content.size(), result.content), 0);
    ASSERT_GE(result.content.size(), before);
    before = result.content.size();
  }
  // A cut in the second of two members as well.
  EXPECT_EQ(unpackAll(packed + packed.substr(0, packed.size() - 3)).failure,
            rawlogs::UnpackingStream::Failure::kTruncated);
}

TEST_P(Packed, TellsFlippedBitsInTheData) {
  const std::string text = longText().substr(0, 700), packed = GetParam().pack(text);
  size_t unnoticed = 0;
  for (size_t i = 6; i < packed.size(); ++i) {
    std::string flipped = packed;
    flipped[i] = static_cast<char>(flipped[i] ^ 0x10);
    const auto result = unpackAll(flipped);
    if (result.failure != rawlogs::UnpackingStream::Failure::kNone) continue;
    ASSERT_TRUE(result.content == text) << "byte " << i;
    ++unnoticed;
  }
  // gzip's header holds bytes that nobody checks: time of writing, level, system.
  EXPECT_LE(unnoticed, 6U);
}

TEST_P(Packed, GarbageBehindTheLastMemberIsDamage) {
  const auto result = unpackAll(GetParam().pack("content") + "garbage, longer than a header");
  EXPECT_EQ(result.content, "content");
  EXPECT_EQ(result.failure, rawlogs::UnpackingStream::Failure::kDamaged);
}

TEST(UnpackingStream, TakesPaddingOfZerosBetweenXzStreams) {
  const std::string padding(8, '\0');
  const auto result = unpackAll(xz("one ") + padding + xz("two") + padding);
  EXPECT_EQ(result.content, "one two");
  EXPECT_EQ(result.failure, rawlogs::UnpackingStream::Failure::kNone);
}

TEST(UnpackingStream, GivesAFileThatIsNotPackedAsItIs) {
  EXPECT_TRUE(unpackAll(longText()).content == longText());
  EXPECT_EQ(unpackAll("").content, "");
  EXPECT_EQ(unpackAll("BZ").content, "BZ");
}

TEST(UnpackingStream, GivesLinesAcrossItsPieces) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "a", bzip2(longText() + "\n\nno newline"));
  rawlogs::UnpackingStream stream(folder / "a");
  std::string joined;
  rawlogs::UnpackingStream::Line line;
  while (stream.takeLine(line, 100)) joined += std::string(line.text) + (line.is_whole ? "\n" : "!");
  EXPECT_TRUE(joined == longText() + "\n\nno newline!");
}

TEST(UnpackingStream, CutsALineThatIsTooLong) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "a", "abcdefg\nhi\n");
  rawlogs::UnpackingStream stream(folder / "a");
  rawlogs::UnpackingStream::Line line;
  std::vector<std::pair<std::string, bool>> lines;
  while (stream.takeLine(line, 3)) lines.emplace_back(line.text, line.is_whole);
  EXPECT_THAT(lines, ::testing::ElementsAre(std::make_pair("abc", false), std::make_pair("def", false),
                                            std::make_pair("g", true), std::make_pair("hi", true)));
}

}  // namespace
}  // namespace slam::logs
