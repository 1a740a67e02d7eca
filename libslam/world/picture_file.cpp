#include "libslam/world/picture_file.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string_view>

#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
#include "libslam/world/bmp_file.h"
#include "libslam/world/picture_bytes.h"

namespace slam::world {

void requireSensibleSize(const Bytes& file, std::int64_t columns, std::int64_t rows) {
  const std::string found = std::to_string(columns) + " x " + std::to_string(rows) + " pixels";
  if (columns <= 0 || rows <= 0) throw file.error("the picture has " + found + ", expected at least one");
  if (columns > kMaxPlanSide || rows > kMaxPlanSide || columns * rows > kMaxPlanCells)
    throw file.error(
        "the picture has " + found + ", expected at most " + std::to_string(kMaxPlanSide) +
        " on a side and 2^28 in all (to simulate in takes some 13 bytes a pixel: " +
        files::formatNumber(std::round(static_cast<double>(columns) * static_cast<double>(rows) * 13e-9)) +
        " GB)");
}

namespace {

/// PNG (ISO/IEC 15948, section 5): signature, then chunks of length, type, data, CRC; IHDR first, IEND last.
void requireWholePng(const Bytes& file) {
  bool has_data = false;
  for (size_t at = 8;;) {
    if (at + 12 > file.size())
      throw file.truncated("a PNG ends with an IEND chunk, this one at byte " + std::to_string(file.size()));
    const std::uint32_t length = file.bigEndian(at, 4);
    const std::string_view type = file.text(at + 4, 4);
    if (length > file.size() - at - 12)
      throw file.truncated("a PNG chunk at byte " + std::to_string(at) + " needs " + std::to_string(length) +
                           " bytes, the file has " + std::to_string(file.size() - at - 12));
    const auto* checked = reinterpret_cast<const Bytef*>(file.data() + at + 4);
    if (crc32(0, checked, length + 4) != file.bigEndian(at + 8 + length, 4))
      throw file.damaged("wrong checksum of the PNG chunk at byte " + std::to_string(at));
    if (at == 8) {
      if (type != "IHDR" || length != 13) throw file.damaged("a PNG begins with an IHDR chunk");
      requireSensibleSize(file, file.bigEndian(16, 4), file.bigEndian(20, 4));
    }
    has_data = has_data || type == "IDAT";
    if (type == "IEND") break;
    at += 12 + static_cast<size_t>(length);
  }
  if (!has_data) throw file.damaged("a PNG without an IDAT chunk");
}

/// JPEG (ITU-T T.81, annex B): markers FF xx with a length, entropy-coded data after SOS, EOI at the end.
void requireWholeJpeg(const Bytes& file) {
  bool has_size = false;
  for (size_t at = 2; true;) {
    if (file.byte(at) != 0xFF) throw file.damaged("expected a JPEG marker at byte " + std::to_string(at));
    const std::uint32_t marker = file.byte(at + 1);
    if (marker == 0xFF) {  // fill byte
      ++at;
      continue;
    }
    if (marker == 0xD9) break;
    const bool is_frame_header =
        marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (is_frame_header) {
      requireSensibleSize(file, file.bigEndian(at + 7, 2), file.bigEndian(at + 5, 2));
      has_size = true;
    }
    at += 2 + static_cast<size_t>(file.bigEndian(at + 2, 2));
    if (marker != 0xDA) continue;
    // Inside entropy-coded data FF is followed by 00 (a data byte FF) or D0 .. D7 (restart).
    const auto isData = [&](std::uint32_t next) { return next == 0 || (next >= 0xD0 && next <= 0xD7); };
    while (file.byte(at) != 0xFF || isData(file.byte(at + 1))) ++at;
  }
  if (!has_size) throw file.damaged("a JPEG without a frame header");
}

/// The fields of a PGM header: numbers between white space and comments.
class PgmReader {
 public:
  explicit PgmReader(const Bytes& file) : file_(file) {}

  std::uint32_t number(const char* what) {
    skipBlanks();
    std::uint32_t value = 0;
    size_t digits = 0;
    for (; at_ < file_.size() && isDigit(file_.byte(at_)); ++at_, ++digits) {
      value = value * 10 + (file_.byte(at_) - '0');
      if (value > 100000000) throw file_.damaged(std::string("the PGM's ") + what + " is too large");
    }
    if (digits == 0 && at_ >= file_.size())
      throw file_.truncated(std::string("the PGM ends before its ") + what);
    if (digits == 0)
      throw file_.damaged(std::string("expected the PGM's ") + what + " at byte " + std::to_string(at_));
    return value;
  }
  size_t position() const { return at_; }

 private:
  static bool isDigit(std::uint32_t c) { return c >= '0' && c <= '9'; }
  void skipBlanks() {
    for (; at_ < file_.size(); ++at_) {
      const std::uint32_t c = file_.byte(at_);
      if (c == '#')
        while (at_ < file_.size() && file_.byte(at_) != '\n') ++at_;
      else if (c != ' ' && (c < '\t' || c > '\r'))
        return;
    }
  }

  const Bytes& file_;
  size_t at_ = 2;
};

/// Netpbm's PGM, plain (P2) and raw (P5). Decoded here: what the general decoders do with a maximum other
/// than 255 differs between them, and a map's thresholds depend on it.
Picture readPgm(const Bytes& file) {
  PgmReader header(file);
  Picture picture;
  const std::uint32_t columns = header.number("width"), rows = header.number("height");
  const std::uint32_t maximum = header.number("maximum");
  requireSensibleSize(file, columns, rows);
  if (maximum < 1 || maximum > 65535)
    throw file.damaged("the PGM's maximum is " + std::to_string(maximum) + ", expected 1 to 65535");
  picture.columns = static_cast<int>(columns);
  picture.rows = static_cast<int>(rows);
  const size_t pixels = static_cast<size_t>(columns) * rows;
  const int bytes = maximum > 255 ? 2 : 1;
  const bool is_plain = file.startsWith("P2");
  const size_t first = header.position() + 1;  // one white space ends a raw header
  if (!is_plain && file.size() < first + pixels * bytes)
    throw file.truncated("the PGM needs " + std::to_string(first + pixels * bytes) + " bytes, the file has " +
                         std::to_string(file.size()));
  picture.gray.reserve(pixels);
  for (size_t i = 0; i < pixels; ++i) {
    const std::uint32_t value = is_plain ? header.number("pixels") : file.bigEndian(first + i * bytes, bytes);
    if (value > maximum)
      throw file.damaged("pixel " + std::to_string(i) + " of the PGM is " + std::to_string(value) +
                         ", above its maximum " + std::to_string(maximum));
    picture.gray.push_back(
        static_cast<std::uint16_t>((std::uint64_t{value} * 65535 + maximum / 2) / maximum));
  }
  return picture;
}

/// T: the channel type. Gray is the mean of the colours (map_server), not a weighted luminance.
template <class T>
Picture fromDecoded(const cv::Mat& image) {
  constexpr std::uint64_t kMaximum = std::numeric_limits<T>::max();
  const int channels = image.channels();
  const int colours = channels >= 3 ? 3 : 1;
  const bool has_alpha = channels == 2 || channels == 4;
  Picture picture;
  picture.columns = image.cols;
  picture.rows = image.rows;
  picture.gray.reserve(image.total());
  if (has_alpha) picture.opaque.reserve(image.total());
  for (int row = 0; row < image.rows; ++row) {
    const T* pixel = image.ptr<T>(row);
    for (int column = 0; column < image.cols; ++column, pixel += channels) {
      std::uint64_t sum = 0;
      for (int c = 0; c < colours; ++c) sum += pixel[c];
      const std::uint64_t whole = kMaximum * colours;
      picture.gray.push_back(static_cast<std::uint16_t>((sum * 65535 + whole / 2) / whole));
      if (has_alpha) picture.opaque.push_back(pixel[colours] == kMaximum);
    }
  }
  if (std::all_of(picture.opaque.begin(), picture.opaque.end(), [](auto o) { return o == 1; }))
    picture.opaque.clear();
  return picture;
}

/// T: the channel type. OpenCV's channels are blue, green, red.
template <class T>
ColourPicture coloursFromDecoded(const cv::Mat& image) {
  const int channels = image.channels();
  const int last_colour = channels >= 3 ? 2 : 0;
  const auto upperBits = [](T value) { return static_cast<std::uint8_t>(value >> (8 * (sizeof(T) - 1))); };
  ColourPicture picture;
  picture.columns = image.cols;
  picture.rows = image.rows;
  picture.pixels.reserve(image.total());
  for (int row = 0; row < image.rows; ++row) {
    const T* pixel = image.ptr<T>(row);
    for (int column = 0; column < image.cols; ++column, pixel += channels)
      picture.pixels.push_back(
          {upperBits(pixel[last_colour]), upperBits(pixel[last_colour / 2]), upperBits(pixel[0])});
  }
  return picture;
}

cv::Mat decode(const Bytes& file) {
  if (auto pixels = decodeBmp32(file)) return *pixels;
  cv::Mat image;
  try {
    const cv::Mat encoded(1, static_cast<int>(file.size()), CV_8U, const_cast<char*>(file.data()));
    image = cv::imdecode(encoded, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) throw file.damaged("it cannot be decoded");
  if (image.depth() != CV_8U && image.depth() != CV_16U)
    throw file.error("the picture's channels are neither 8 nor 16 bits wide");
  return image;
}

Picture fromDecodedOfAnyDepth(const cv::Mat& image) {
  if (image.depth() == CV_16U) return fromDecoded<std::uint16_t>(image);
  return fromDecoded<std::uint8_t>(image);
}

bool isPgm(const Bytes& file) {
  return file.startsWith("P5") || file.startsWith("P2");
}

/// Of any format but PGM, which its own reader checks.
void requireWhole(const Bytes& file) {
  if (file.size() == 0) throw file.error("is empty, expected a picture (bmp, png, pgm, jpg)");
  if (isPgm(file)) return;
  if (file.startsWith("\x89PNG\r\n\x1a\n"))
    requireWholePng(file);
  else if (file.startsWith("\xFF\xD8"))
    requireWholeJpeg(file);
  else if (file.startsWith("BM"))
    requireWholeBmp(file);
  else
    throw file.error("is not a picture that can be read (bmp, png, pgm, jpg)");
}

template <class Pixel>
std::string encodeMat(int columns, int rows, int type, const std::vector<Pixel>& pixels) {
  const cv::Mat image(rows, columns, type, const_cast<Pixel*>(pixels.data()));
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 9});
  return {bytes.begin(), bytes.end()};
}

}  // namespace

Picture readPicture(const std::string& path) {
  const std::string content = files::readTextFile(path);
  const Bytes file(path, content);
  requireWhole(file);
  return isPgm(file) ? readPgm(file) : fromDecodedOfAnyDepth(decode(file));
}

ColourPicture readColourPicture(const std::string& path) {
  const std::string content = files::readTextFile(path);
  const Bytes file(path, content);
  requireWhole(file);
  if (isPgm(file)) {
    const Picture gray = readPgm(file);
    ColourPicture picture{gray.columns, gray.rows, {}, {}};
    for (const std::uint16_t value : gray.gray) {
      const auto level = static_cast<std::uint8_t>(value >> 8);
      picture.pixels.push_back({level, level, level});
    }
    return picture;
  }
  const cv::Mat image = decode(file);
  ColourPicture picture = image.depth() == CV_16U ? coloursFromDecoded<std::uint16_t>(image)
                                                  : coloursFromDecoded<std::uint8_t>(image);
  picture.opaque = fromDecodedOfAnyDepth(image).opaque;
  return picture;
}

std::string encodePng(int columns, int rows, const std::vector<std::uint8_t>& gray) {
  return encodeMat(columns, rows, CV_8UC1, gray);
}

std::string encodePng(int columns, int rows, const std::vector<Colour>& pixels) {
  std::vector<std::uint8_t> channels;
  channels.reserve(3 * pixels.size());
  for (const Colour& pixel : pixels) channels.insert(channels.end(), {pixel.blue, pixel.green, pixel.red});
  return encodeMat(columns, rows, CV_8UC3, channels);
}

}  // namespace slam::world
