#pragma once
#include <cstdint>
#include <string>
#include <vector>

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
  /// Only where asked for and where any pixel is coloured: red, green and blue to 5, 6 and 5 bits.
  std::vector<std::uint16_t> colours;
};

/// Reads bmp, png, pgm (P2, P5) or jpg, told apart by content, not by suffix; 8 or 16 bits, gray, colour,
/// palette, with or without alpha. The file is checked for completeness before it is decoded, because
/// decoders return half pictures with no more than a warning. Errors (InputError with the path): missing, a
/// folder, none of these formats, truncated or damaged, no pixel, larger than kMaxPlanSide or kMaxPlanCells.
Picture readPicture(const std::string& path, bool with_colours = false);

/// An 8-bit gray picture, row 0 at the top, as the bytes of a PNG file.
std::string encodePng(int columns, int rows, const std::vector<std::uint8_t>& gray);

}  // namespace slam::world
