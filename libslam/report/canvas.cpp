#include "libslam/report/canvas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "libslam/core/error.h"
#include "libslam/core/files.h"

namespace slam::report {
namespace {

constexpr int kShift = 4;  // OpenCV takes coordinates in sixteenths
// Hershey's capitals are 21 units tall and the descender 7 more at scale 1.
constexpr double kFontUnits = 28;

cv::Scalar scalar(Colour c) {
  return {double(c.blue), double(c.green), double(c.red)};
}

int thickness(double pixels) {
  return std::max(1, static_cast<int>(std::lround(pixels * Canvas::kSubpixels)));
}

int fontFace(bool bold) {
  return bold ? cv::FONT_HERSHEY_DUPLEX : cv::FONT_HERSHEY_SIMPLEX;
}

double fontScale(double size) {
  return size * Canvas::kSubpixels / kFontUnits;
}

int strokeWidth(double size, bool bold) {
  return std::max(1, static_cast<int>(std::lround(size * Canvas::kSubpixels * (bold ? 0.085 : 0.07))));
}

/// The letters of U+00C0 to U+00FF without their accents; a blank where there is no likeness.
constexpr const char* kLatin1Letters = "AAAAAAACEEEEIIIIDNOOOOOxOUUUUY saaaaaaaceeeeiiiidnooooo ouuuuy y";

std::string asAscii(const std::string& utf8) {
  std::string ascii;
  for (size_t i = 0; i < utf8.size(); ++i) {
    const auto byte = static_cast<unsigned char>(utf8[i]);
    if (byte < 0x80) {
      ascii += byte < ' ' ? ' ' : utf8[i];
      continue;
    }
    if ((byte & 0xC0) == 0x80) continue;  // belongs to the letter before
    const bool is_latin1_letter = byte == 0xC3 && i + 1 < utf8.size();
    const char letter =
        is_latin1_letter ? kLatin1Letters[static_cast<unsigned char>(utf8[i + 1]) & 0x3F] : ' ';
    ascii += letter == ' ' ? '?' : letter;
  }
  return ascii;
}

}  // namespace

const std::vector<Colour>& lineColours() {
  static const std::vector<Colour> colours = {kBlue,   kVermillion, kGreen,  kPurple,
                                              kOrange, kSkyBlue,    kYellow, Colour{0, 0, 0}};
  return colours;
}

struct Canvas::Sheet {
  cv::Mat whole;
  cv::Rect clip;

  cv::Mat target() { return whole(clip); }
  /// In OpenCV's fixed point, relative to the clip. Far points are pulled in to where they do not overflow.
  cv::Point fixedPoint(Pixel p) const {
    const auto fixed = [](double v) {
      return static_cast<int>(std::lround(std::clamp(v, -1e6, 1e6) * (1 << kShift)));
    };
    // A pixel's centre has the whole-numbered coordinate in OpenCV and the half one here.
    return {fixed(p.x * kSubpixels - 0.5 - clip.x), fixed(p.y * kSubpixels - 0.5 - clip.y)};
  }
};

Canvas::Canvas(int width, int height) : width_(width), height_(height), sheet_(std::make_unique<Sheet>()) {
  sheet_->whole = cv::Mat(height * kSubpixels, width * kSubpixels, CV_8UC3, cv::Scalar(255, 255, 255));
  liftClip();
}

Canvas::~Canvas() = default;

void Canvas::clipTo(const PixelBox& box) {
  const cv::Point corner(subpixel(box.left), subpixel(box.top));
  const cv::Point opposite(subpixel(box.left + box.width), subpixel(box.top + box.height));
  sheet_->clip = cv::Rect(corner, opposite) & cv::Rect({0, 0}, sheet_->whole.size());
}

void Canvas::liftClip() {
  sheet_->clip = cv::Rect({0, 0}, sheet_->whole.size());
}

void Canvas::polyline(const std::vector<Pixel>& points, Colour colour, double line_width) {
  auto target = sheet_->target();
  std::vector<cv::Point> run;
  const auto finishRun = [&] {
    if (run.size() > 1)
      cv::polylines(target, run, false, scalar(colour), thickness(line_width), cv::LINE_AA, kShift);
    run.clear();
  };
  for (const auto& p : points) {
    if (std::isfinite(p.x) && std::isfinite(p.y))
      run.push_back(sheet_->fixedPoint(p));
    else
      finishRun();
  }
  finishRun();
}

void Canvas::fillPolygon(const std::vector<Pixel>& corners, Colour colour) {
  std::vector<cv::Point> outline;
  for (const auto& p : corners)
    if (std::isfinite(p.x) && std::isfinite(p.y)) outline.push_back(sheet_->fixedPoint(p));
  auto target = sheet_->target();
  if (outline.size() > 2)
    cv::fillPoly(target, std::vector<std::vector<cv::Point>>{outline}, scalar(colour), cv::LINE_AA, kShift);
}

void Canvas::disc(Pixel centre, double radius, Colour colour) {
  if (!std::isfinite(centre.x) || !std::isfinite(centre.y)) return;
  auto target = sheet_->target();
  const int fixed_radius = static_cast<int>(std::lround(radius * kSubpixels * (1 << kShift)));
  cv::circle(target, sheet_->fixedPoint(centre), fixed_radius, scalar(colour), cv::FILLED, cv::LINE_AA,
             kShift);
}

void Canvas::circle(Pixel centre, double radius, Colour colour, double line_width) {
  if (!std::isfinite(centre.x) || !std::isfinite(centre.y)) return;
  auto target = sheet_->target();
  const int fixed_radius = static_cast<int>(std::lround(radius * kSubpixels * (1 << kShift)));
  cv::circle(target, sheet_->fixedPoint(centre), fixed_radius, scalar(colour), thickness(line_width),
             cv::LINE_AA, kShift);
}

void Canvas::box(const PixelBox& box, Colour colour) {
  paint(box, [colour](Pixel) { return colour; });
}

void Canvas::frame(const PixelBox& box, Colour colour, double line_width) {
  const double right = box.left + box.width, bottom = box.top + box.height;
  polyline({{box.left, box.top}, {right, box.top}, {right, bottom}, {box.left, bottom}, {box.left, box.top}},
           colour, line_width);
}

void Canvas::setSubpixel(int x, int y, Colour colour) {
  if (sheet_->clip.contains({x, y}))
    sheet_->whole.at<cv::Vec3b>(y, x) = cv::Vec3b(colour.blue, colour.green, colour.red);
}

double Canvas::textWidth(const std::string& utf8, double size, bool bold) {
  const auto extent =
      cv::getTextSize(asAscii(utf8), fontFace(bold), fontScale(size), strokeWidth(size, bold), nullptr);
  return static_cast<double>(extent.width) / kSubpixels;
}

std::string Canvas::fitText(const std::string& utf8, double size, double max_width, bool bold) {
  std::string fitted = asAscii(utf8);
  if (textWidth(fitted, size, bold) <= max_width) return fitted;
  while (!fitted.empty() && textWidth(fitted + "...", size, bold) > max_width) fitted.pop_back();
  return fitted + "...";
}

void Canvas::text(Pixel at, const std::string& utf8, double size, Colour colour, Align align, bool bold) {
  const double text_width = textWidth(utf8, size, bold);
  const double shift = align == Align::kLeft ? 0 : align == Align::kCentre ? text_width / 2 : text_width;
  const cv::Point origin(static_cast<int>(std::lround((at.x - shift) * kSubpixels)) - sheet_->clip.x,
                         static_cast<int>(std::lround(at.y * kSubpixels)) - sheet_->clip.y);
  auto target = sheet_->target();
  cv::putText(target, asAscii(utf8), origin, fontFace(bold), fontScale(size), scalar(colour),
              strokeWidth(size, bold), cv::LINE_AA);
}

std::string Canvas::toPng() const {
  cv::Mat averaged;
  cv::resize(sheet_->whole, averaged, cv::Size(width_, height_), 0, 0, cv::INTER_AREA);
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", averaged, bytes, {cv::IMWRITE_PNG_COMPRESSION, 6}))
    throw core::IoError("a picture cannot be encoded as PNG");
  return {bytes.begin(), bytes.end()};
}

void Canvas::savePng(const std::string& path) const {
  core::writeFileAtomically(path, toPng());
}

}  // namespace slam::report
