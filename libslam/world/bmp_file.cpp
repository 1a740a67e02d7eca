#include "libslam/world/bmp_file.h"

#include <array>
#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <string>

namespace slam::world {
namespace {

// BITMAPINFOHEADER::biCompression.
constexpr std::uint32_t kRgb = 0, kRunLength8 = 1, kRunLength4 = 2, kBitFields = 3, kAlphaBitFields = 6;
constexpr std::uint32_t kOs2Header = 12;  ///< BITMAPCOREHEADER, whose sizes have 16 bits
constexpr std::uint32_t kInfoHeader = 40, kOs2LongHeader = 64;
constexpr std::uint32_t kHeaderWithAlphaMask = 56;  ///< and all longer ones
constexpr size_t kFileHeader = 14, kMasksAt = kFileHeader + kInfoHeader;

struct BmpHeader {
  std::uint32_t size, pixels_at, bits, compression;
  std::int32_t columns, rows;  ///< rows < 0: stored top down
  std::int64_t height() const { return std::abs(static_cast<std::int64_t>(rows)); }
  std::int64_t rowBytes() const { return (static_cast<std::int64_t>(columns) * bits + 31) / 32 * 4; }
};

BmpHeader readHeader(const Bytes& file) {
  const std::uint32_t size = file.littleEndian(kFileHeader, 4);
  const bool is_os2 = size == kOs2Header;
  const auto side = [&](size_t long_at, size_t short_at) {
    return static_cast<std::int32_t>(is_os2 ? file.littleEndian(short_at, 2) : file.littleEndian(long_at, 4));
  };
  return {size,
          file.littleEndian(10, 4),
          is_os2 ? file.littleEndian(24, 2) : file.littleEndian(28, 2),
          is_os2 ? kRgb : file.littleEndian(30, 4),
          side(18, 18),
          side(22, 20)};
}

/// The bits of a pixel that make one channel; those of a mask adjoin.
class Channel {
 public:
  Channel() = default;
  Channel(const Bytes& file, std::uint32_t mask, const char* name) {
    if (mask == 0) return;
    while ((mask >> shift_ & 1) == 0) ++shift_;
    maximum_ = mask >> shift_;
    if ((std::uint64_t{maximum_} & (std::uint64_t{maximum_} + 1)) != 0)
      throw file.damaged(std::string("the bits of the BMP's mask for ") + name + " do not adjoin");
  }
  std::uint8_t rounded(std::uint32_t pixel) const { return scaled(pixel, maximum_ / 2); }
  /// 255 at the maximum only.
  std::uint8_t roundedDown(std::uint32_t pixel) const { return scaled(pixel, 0); }

 private:
  std::uint8_t scaled(std::uint32_t pixel, std::uint64_t bias) const {
    if (maximum_ == 0) return 0;
    return static_cast<std::uint8_t>((std::uint64_t{pixel >> shift_ & maximum_} * 255 + bias) / maximum_);
  }

  std::uint32_t maximum_ = 0;
  int shift_ = 0;
};

struct Channels {
  Channel blue, green, red, alpha;
};

Channels readChannels(const Bytes& file, const BmpHeader& header) {
  const bool has_masks = header.compression == kBitFields || header.compression == kAlphaBitFields;
  const bool is_known = header.compression == kRgb || (has_masks && header.size != kOs2LongHeader);
  if (!is_known)
    throw file.damaged("a BMP of 32 bits a pixel with compression " + std::to_string(header.compression) +
                       ", expected 0, 3 or 6");
  std::uint32_t red = 0xFF0000, green = 0xFF00, blue = 0xFF;
  if (has_masks) {
    red = file.littleEndian(kMasksAt, 4);
    green = file.littleEndian(kMasksAt + 4, 4);
    blue = file.littleEndian(kMasksAt + 8, 4);
  }
  const bool has_alpha_mask =
      has_masks && (header.compression == kAlphaBitFields || header.size >= kHeaderWithAlphaMask);
  const std::uint32_t colours = red | green | blue;
  const std::uint32_t alpha = has_alpha_mask ? file.littleEndian(kMasksAt + 12, 4) : ~colours;
  if ((red & green) != 0 || ((red | green) & blue) != 0 || (colours & alpha) != 0)
    throw file.damaged("the masks of the BMP's channels overlap");
  return {Channel(file, blue, "blue"), Channel(file, green, "green"), Channel(file, red, "red"),
          Channel(file, alpha, "alpha")};
}

}  // namespace

void requireWholeBmp(const Bytes& file) {
  const BmpHeader header = readHeader(file);
  requireSensibleSize(file, header.columns, header.height());
  const bool is_run_length_coded = header.compression == kRunLength8 || header.compression == kRunLength4;
  const std::int64_t needed = is_run_length_coded ? std::int64_t{file.littleEndian(2, 4)}
                                                  : header.pixels_at + header.rowBytes() * header.height();
  if (needed > static_cast<std::int64_t>(file.size()))
    throw file.truncated("needs " + std::to_string(needed) + " bytes, the file has " +
                         std::to_string(file.size()));
}

std::optional<cv::Mat> decodeBmp32(const Bytes& file) {
  if (!file.startsWith("BM")) return std::nullopt;
  const BmpHeader header = readHeader(file);
  if (header.bits != 32 || header.size < kInfoHeader) return std::nullopt;
  const Channels channels = readChannels(file, header);
  if (header.pixels_at < kFileHeader + std::uint64_t{header.size})
    throw file.damaged("its pixels begin at byte " + std::to_string(header.pixels_at) +
                       ", within its header of " + std::to_string(kFileHeader + std::uint64_t{header.size}));
  const auto height = static_cast<int>(header.height());
  cv::Mat image(height, header.columns, CV_8UC4);
  bool has_alpha = false;
  for (int row = 0; row < height; ++row) {
    const int stored_row = header.rows < 0 ? row : height - 1 - row;
    size_t at = header.pixels_at + static_cast<size_t>(header.rowBytes()) * static_cast<size_t>(stored_row);
    auto* out = image.ptr<cv::Vec4b>(row);
    for (int column = 0; column < header.columns; ++column, at += 4) {
      const std::uint32_t pixel = file.littleEndian(at, 4);
      out[column] = {channels.blue.rounded(pixel), channels.green.rounded(pixel), channels.red.rounded(pixel),
                     channels.alpha.roundedDown(pixel)};
      has_alpha = has_alpha || out[column][3] != 0;
    }
  }
  if (!has_alpha) cv::cvtColor(image, image, cv::COLOR_BGRA2BGR);
  return image;
}

}  // namespace slam::world
