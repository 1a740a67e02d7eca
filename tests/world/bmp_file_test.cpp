#include "libslam/world/bmp_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <vector>

#include "libslam/check/plan_check.h"
#include "libslam/core/error.h"
#include "libslam/testing/temp_folder.h"
#include "libslam/world/picture_file.h"
#include "libslam/world/plan.h"

namespace slam::world {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr std::uint32_t kOrange = 0xFFFFA500, kClear = 0x00000000, kVeiled = 0xFEFFA500;

std::string littleEndian(std::uint32_t value, int bytes = 4) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i) & 0xFF);
  return text;
}

/// A BMP of 32 bits a pixel, by hand: the fields that matter, pixels in the order in which they are stored.
struct DrawnBmp {
  int columns = 0, rows = 0;  ///< rows < 0: top down
  std::vector<std::uint32_t> stored;
  std::uint32_t header = 40, compression = 0;
  std::vector<std::uint32_t> masks{};  ///< red, green, blue, and alpha where it has a place

  std::string bytes() const {
    std::string dib = littleEndian(header) + littleEndian(static_cast<std::uint32_t>(columns)) +
                      littleEndian(static_cast<std::uint32_t>(rows)) + littleEndian(1, 2) +
                      littleEndian(32, 2) + littleEndian(compression) + std::string(20, '\0');
    for (const auto mask : masks) dib += littleEndian(mask);
    if (dib.size() < header) dib.resize(header, '\0');
    std::string pixels;
    for (const auto pixel : stored) pixels += littleEndian(pixel);
    const auto begin = static_cast<std::uint32_t>(14 + dib.size());
    return "BM" + littleEndian(begin + static_cast<std::uint32_t>(pixels.size())) + littleEndian(0) +
           littleEndian(begin) + dib + pixels;
  }
};

/// 3 x 2, top row "wall, free, wall", bottom row "free, veiled, free".
const DrawnBmp kBottomUp{3, 2, {kClear, kVeiled, kClear, kOrange, kClear, kOrange}};

class Bmps : public ::testing::Test {
 protected:
  std::string write(const std::string& content) {
    std::ofstream(folder_ / "a.bmp", std::ios::binary) << content;
    return folder_ / "a.bmp";
  }
  /// Top row first.
  std::string drawing(const std::string& content) {
    const Plan plan = loadPlan(write(content));
    std::string text;
    for (int row = plan.rows; row-- > 0; text += row > 0 ? "/" : "")
      for (int column = 0; column < plan.columns; ++column)
        text += plan.at(column, row) == Cell::kOccupied ? '#'
                : plan.at(column, row) == Cell::kFree   ? '.'
                                                        : '?';
    return text;
  }
  std::string errorOf(const std::string& content) {
    const std::string path = write(content);
    try {
      readPicture(path);
    } catch (const core::InputError& e) {
      const std::string message = e.what();
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_THAT(message, StartsWith(path + ": "));
      return message.substr(path.size() + 2);
    }
    return "";
  }

  testing::TempFolder folder_;
};

TEST_F(Bmps, OfThirtyTwoBitsTakeAlpha255ForAnObstacleWhateverItsColour) {
  // Walls in opaque orange on a transparent ground, as System.Drawing saves a bitmap. Orange is brighter than
  // the threshold, so that by brightness there would be no wall at all.
  EXPECT_EQ(drawing(kBottomUp.bytes()), "#.#/...") << "alpha 254 is free";
}

TEST_F(Bmps, StoredTopDownAreNotUpsideDown) {
  DrawnBmp bmp = kBottomUp;
  bmp.rows = -2;
  EXPECT_EQ(drawing(bmp.bytes()), ".../#.#");
}

TEST_F(Bmps, WhoseAlphaIsZeroEverywhereGoByBrightness) {
  const DrawnBmp bmp{3, 1, {0x00FFFFFF, 0x00000000, 0x00FFFFFF}};
  EXPECT_EQ(drawing(bmp.bytes()), ".#.");
  EXPECT_TRUE(readPicture(write(bmp.bytes())).opaque.empty());
}

TEST_F(Bmps, WhoseAlphaIs255EverywhereGoByBrightness) {
  EXPECT_EQ(drawing(DrawnBmp{3, 1, {0xFFFFFFFF, 0xFF000000, 0xFFFFFFFF}}.bytes()), ".#.");
}

TEST_F(Bmps, WithMasksHaveTheirChannelsWhereTheMasksSay) {
  // Red in the lowest byte and alpha next to it, which no other picture has.
  const std::vector<std::uint32_t> masks{0x000000FF, 0xFF000000, 0x00FF0000, 0x0000FF00};
  const std::vector<std::uint32_t> stored{0x030201FF & 0xFFFF00FF, 0x0302FF01};
  for (const std::uint32_t header : {56U, 108U, 124U}) {
    const auto picture = readColourPicture(write(DrawnBmp{2, 1, stored, header, 3, masks}.bytes()));
    EXPECT_EQ(picture.opaque, (std::vector<std::uint8_t>{0, 1})) << header;
    EXPECT_EQ(picture.pixels[1], (Colour{1, 3, 2})) << header;
  }
  const auto after_header = readColourPicture(write(DrawnBmp{2, 1, stored, 40, 6, masks}.bytes()));
  EXPECT_EQ(after_header.opaque, (std::vector<std::uint8_t>{0, 1}));
}

TEST_F(Bmps, WithColourMasksAndNoPlaceForAlphaTakeTheBitsLeftOver) {
  DrawnBmp bmp = kBottomUp;
  bmp.compression = 3, bmp.masks = {0xFF0000, 0xFF00, 0xFF};
  EXPECT_EQ(drawing(bmp.bytes()), "#.#/...");
  bmp.header = 52;
  EXPECT_EQ(drawing(bmp.bytes()), "#.#/...");
}

TEST_F(Bmps, WhoseMaskForAlphaIsZeroHaveNone) {
  const DrawnBmp bmp{3, 1, {0x12FFFFFF, 0x34000000, 0x56FFFFFF}, 108, 3, {0xFF0000, 0xFF00, 0xFF, 0}};
  EXPECT_EQ(drawing(bmp.bytes()), ".#.");
}

TEST_F(Bmps, WithTenBitsAColourAreScaledToEight) {
  // 2 bits of alpha: 3 is opaque, 2 is not. 512 of 1023 is 127.6 of 255.
  const std::vector<std::uint32_t> masks{0x3FF00000, 0x000FFC00, 0x000003FF, 0xC0000000};
  const DrawnBmp bmp{2, 1, {0xC0000000U | 1023U << 20 | 512U << 10, 0x80000000U}, 108, 3, masks};
  const auto picture = readColourPicture(write(bmp.bytes()));
  EXPECT_EQ(picture.pixels[0], (Colour{255, 128, 0}));
  EXPECT_EQ(picture.opaque, (std::vector<std::uint8_t>{1, 0}));
}

TEST_F(Bmps, CutShortAnywhereAreRefusedInOneLine) {
  DrawnBmp bmp = kBottomUp;
  bmp.header = 108, bmp.compression = 3, bmp.masks = {0xFF0000, 0xFF00, 0xFF, 0xFF000000};
  const std::string whole = bmp.bytes();
  for (size_t size = 2; size < whole.size(); ++size)
    EXPECT_THAT(errorOf(whole.substr(0, size)), StartsWith("the picture is truncated: ")) << size;
  EXPECT_EQ(errorOf(whole), "");
}

TEST_F(Bmps, ThatLieInTheirHeaderAreRefusedInOneLine) {
  const std::string whole = kBottomUp.bytes();
  const auto with = [&](size_t at, std::uint32_t value) {
    return errorOf(std::string(whole).replace(at, 4, littleEndian(value)));
  };
  EXPECT_THAT(with(10, 0xFFFFFFF0), StartsWith("the picture is truncated: needs 4294967304 bytes"));
  EXPECT_EQ(with(10, 20), "the picture is damaged: its pixels begin at byte 20, within its header of 54");
  EXPECT_THAT(with(14, 0xFFFFFFFF), HasSubstr("within its header of 4294967309"));
  EXPECT_THAT(with(18, 0x7FFFFFFF), HasSubstr("expected at most 32768 on a side"));
  EXPECT_THAT(with(18, 0x80000000), HasSubstr("expected at least one"));
  EXPECT_THAT(with(22, 0x80000000), HasSubstr("expected at most 32768 on a side"));
  EXPECT_THAT(errorOf(std::string(whole).replace(18, 8, littleEndian(0x7FFFFFFF) + littleEndian(0x7FFFFFFF))),
              HasSubstr("at most 32768 on a side"))
      << "and counts no pixels beyond 64 bits";
  EXPECT_THAT(with(22, 0), HasSubstr("expected at least one"));
  EXPECT_EQ(with(30, 4),
            "the picture is damaged: a BMP of 32 bits a pixel with compression 4, expected 0, 3 or 6");
}

TEST_F(Bmps, WithMasksThatMakeNoChannelsAreRefusedInOneLine) {
  const auto with = [&](const std::vector<std::uint32_t>& masks) {
    return errorOf(DrawnBmp{1, 1, {1}, 108, 3, masks}.bytes());
  };
  EXPECT_EQ(with({0xF0F000, 0xFF, 0, 0}),
            "the picture is damaged: the bits of the BMP's mask for red do not adjoin");
  EXPECT_EQ(with({0xFF, 0xFF00, 0xFF, 0}), "the picture is damaged: the masks of the BMP's channels overlap");
  EXPECT_EQ(with({0xFF, 0xFF00, 0xFF0000, 0xFFFF0000}),
            "the picture is damaged: the masks of the BMP's channels overlap");
  EXPECT_EQ(with({0xFFFFFFFF, 0, 0, 0}), "") << "one channel of all bits is odd and no harm";
}

TEST_F(Bmps, CheckedSayThatTransparencyIsReadAndNotBrightness) {
  const auto check = check::checkPlan(write(kBottomUp.bytes()), {});
  for (const auto& finding : check.findings)
    if (finding.key == "colours") {
      EXPECT_EQ(finding.text,
                "33 % of the pixels are coloured; only transparency is read: yellow counts as wall");
      return;
    }
  ADD_FAILURE() << "no word of colours";
}

}  // namespace
}  // namespace slam::world
