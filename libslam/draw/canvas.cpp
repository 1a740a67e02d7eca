#include "libslam/draw/canvas.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <optional>

#include "libslam/core/error.h"
#include "libslam/draw/page_text.h"
#include "libslam/files/files.h"

namespace slam::draw {
namespace {

/// Advances of the letters from U+0020 to U+007E in thousandths of the size: those of Helvetica, which
/// Liberation Sans and Arial share.
constexpr std::array<short, 95> kRegular = {
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333,  278, 278, 556, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667,
    611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667,  611, 722, 667, 944, 667,
    667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278,  556, 556, 222, 222, 500,
    222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500,  500, 334, 260, 334, 584};
constexpr std::array<short, 95> kBold = {
    278, 333, 474, 556, 556, 889, 722, 238, 333, 333, 389, 584, 278, 333, 278, 278, 556, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 333, 333, 584, 584, 584, 611, 975, 722, 722, 722, 722, 667,
    611, 778, 722, 278, 556, 722, 611, 833, 722, 778, 667, 778, 722, 667, 611, 722, 667, 944, 667,
    667, 611, 333, 278, 333, 584, 556, 333, 556, 611, 556, 611, 556, 333, 611, 611, 278, 278, 556,
    278, 889, 611, 611, 611, 611, 389, 556, 333, 611, 556, 778, 556, 556, 500, 389, 280, 389, 584};
constexpr int kOtherLetter = 600;  // few letters beyond ASCII are wider

bool isFinite(Pixel p) {
  return std::isfinite(p.x) && std::isfinite(p.y);
}

/// Far points are pulled in to where no format overflows; lines still leave the sheet in the same direction,
/// nearly.
Pixel reachable(Pixel p) {
  constexpr double kFar = 1e5;
  return {std::clamp(p.x, -kFar, kFar), std::clamp(p.y, -kFar, kFar)};
}

}  // namespace

const std::vector<Colour>& lineColours() {
  static const std::vector<Colour> colours = {kBlue,   kVermillion, kGreen,  kPurple,
                                              kOrange, kSkyBlue,    kYellow, Colour{0, 0, 0}};
  return colours;
}

std::vector<Colour> labelColours(const std::vector<std::string>& labels) {
  static const std::map<std::string, size_t> kOwn = {
      {"graph", 0},     {"particles", 1},   {"rbpf_exact", 2}, {"icp", 3},
      {"icp_exact", 3}, {"rbpf", 4},        {"naive_flow", 5}, {"naive_correlation", 6},
      {"naive", 7},     {"naive_wheel", 7}, {"naive_blind", 7}};
  const auto& palette = lineColours();
  std::vector<std::optional<size_t>> chosen(labels.size());
  std::vector<bool> taken(palette.size());
  for (size_t i = 0; i < labels.size(); ++i) {
    const auto own = kOwn.find(labels[i].substr(0, labels[i].find_first_of(" ,")));
    if (own == kOwn.end() || taken[own->second]) continue;
    chosen[i] = own->second;
    taken[own->second] = true;
  }
  std::vector<Colour> colours;
  for (size_t i = 0; i < labels.size(); ++i) {
    if (!chosen[i]) {
      const auto free = std::find(taken.begin(), taken.end(), false);
      chosen[i] = free == taken.end() ? i % palette.size() : static_cast<size_t>(free - taken.begin());
      taken[*chosen[i]] = true;
    }
    colours.push_back(palette[*chosen[i]]);
  }
  return colours;
}

double Paper::unitsWide() const {
  constexpr double kPointsPerMillimetre = 72 / 25.4;
  return width_mm * kPointsPerMillimetre * kTextSize / font_pt;
}

void requirePicturePath(const std::string& path) {
  const auto extension = std::filesystem::path(path).extension();
  if (extension != ".png" && extension != ".svg" && extension != ".pdf")
    throw core::InputError(path + ": found extension '" + extension.string() +
                           "', expected .png, .svg or .pdf");
}

void Canvas::clipTo(const PixelBox& box) {
  marks_.emplace_back(drawing::Clip{box});
}

void Canvas::liftClip() {
  marks_.emplace_back(drawing::LiftClip{});
}

void Canvas::polyline(const std::vector<Pixel>& points, Colour colour, double line_width) {
  drawing::Polyline run{{}, colour, line_width};
  const auto finishRun = [&] {
    if (run.points.size() > 1) marks_.emplace_back(run);
    run.points.clear();
  };
  for (const auto& p : points) {
    if (isFinite(p))
      run.points.push_back(reachable(p));
    else
      finishRun();
  }
  finishRun();
}

void Canvas::fillPolygon(const std::vector<Pixel>& corners, Colour colour) {
  drawing::Polygon polygon{{}, colour};
  for (const auto& p : corners)
    if (isFinite(p)) polygon.corners.push_back(reachable(p));
  if (polygon.corners.size() > 2) marks_.emplace_back(std::move(polygon));
}

void Canvas::disc(Pixel centre, double radius, Colour colour) {
  circle(centre, radius, colour, 0);
}

void Canvas::circle(Pixel centre, double radius, Colour colour, double line_width) {
  if (isFinite(centre)) marks_.emplace_back(drawing::Circle{reachable(centre), radius, colour, line_width});
}

void Canvas::box(const PixelBox& box, Colour colour) {
  marks_.emplace_back(drawing::Box{box, colour});
}

void Canvas::frame(const PixelBox& box, Colour colour, double line_width) {
  const double right = box.left + box.width, bottom = box.top + box.height;
  polyline({{box.left, box.top}, {right, box.top}, {right, bottom}, {box.left, bottom}, {box.left, box.top}},
           colour, line_width);
}

double Canvas::textWidth(const std::string& utf8, double size, bool bold) {
  int width = 0;
  for (const char c : utf8) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= ' ' && byte < 0x7F)
      width += (bold ? kBold : kRegular)[byte - ' '];
    else if ((byte & 0xC0) != 0x80)  // the others belong to the letter before
      width += kOtherLetter;
  }
  return size * width / 1000;
}

std::string Canvas::fitText(const std::string& utf8, double size, double max_width, bool bold) {
  std::string fitted = plainText(utf8);
  if (textWidth(fitted, size, bold) <= max_width) return fitted;
  const auto dropLetter = [&] {
    while (!fitted.empty() && (fitted.back() & 0xC0) == 0x80) fitted.pop_back();
    if (!fitted.empty()) fitted.pop_back();
  };
  while (!fitted.empty() && textWidth(fitted + "...", size, bold) > max_width) dropLetter();
  return fitted + "...";
}

void Canvas::text(Pixel at, const std::string& utf8, double size, Colour colour, Align align, bool bold) {
  if (isFinite(at) && !utf8.empty())
    marks_.emplace_back(drawing::Text{at, plainText(utf8), size, colour, align, bold});
}

void Canvas::save(const std::string& path) const {
  requirePicturePath(path);
  const auto extension = std::filesystem::path(path).extension();
  files::writeFileAtomically(path, extension == ".png" ? toPng() : extension == ".svg" ? toSvg() : toPdf());
}

}  // namespace slam::draw
