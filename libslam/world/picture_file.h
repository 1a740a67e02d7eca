#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libslam/world/plan.h"

namespace slam::world {

/// The longest side of a plan, in cells. Up to here the arithmetic of castRay() is proved (see kSteepest
/// there).
inline constexpr int kMaxPlanSide = 1 << 15;
/// The most cells of a plan.
inline constexpr std::int64_t kMaxPlanCells = std::int64_t{1} << 28;

/// What a plan needs from a picture. Row-major, row 0 at the top, as pictures are.
struct Picture {
  int columns = 0, rows = 0;
  /// 0 black .. 65535 white; the mean of the colour channels. 8-bit gray g is 257 g.
  std::vector<std::uint16_t> gray;
  /// Empty when every pixel is opaque (or there is no alpha channel); else 1 = alpha at its maximum.
  std::vector<std::uint8_t> opaque;
};

/// Reads bmp, png, pgm (P2, P5) or jpg, told apart by content, not by suffix; 8 or 16 bits, gray, colour,
/// palette, with or without alpha, that of 32-bit BMPs too (decodeBmp32(): 0 everywhere means none). The file
/// is checked for completeness before it is decoded, because decoders return half pictures with no more than
/// a warning. Errors (InputError with the path): missing, a folder, none of these formats, truncated or
/// damaged, no pixel, larger than kMaxPlanSide or kMaxPlanCells.
Picture readPicture(const std::string& path);

struct Colour {
  std::uint8_t red = 0, green = 0, blue = 0;
};
inline bool operator==(const Colour& a, const Colour& b) {
  return a.red == b.red && a.green == b.green && a.blue == b.blue;
}

/// A picture for its colours. Row-major, row 0 at the top.
struct ColourPicture {
  int columns = 0, rows = 0;
  std::vector<Colour> pixels;        ///< gray pictures have three equal channels; of 16 bits the upper 8
  std::vector<std::uint8_t> opaque;  ///< as Picture's
};

/// The same files and errors as readPicture().
ColourPicture readColourPicture(const std::string& path);

/// The level of a cell in the pictures that we write: 0 occupied, 254 free, 205 unknown.
inline std::uint8_t grayOf(Cell cell) {
  return cell == Cell::kOccupied ? 0 : cell == Cell::kFree ? 254 : 205;
}

/// An 8-bit gray picture, row 0 at the top, as the bytes of a PNG file.
std::string encodePng(int columns, int rows, const std::vector<std::uint8_t>& gray);
/// The same in colour.
std::string encodePng(int columns, int rows, const std::vector<Colour>& pixels);

}  // namespace slam::world
