#include "libslam/draw/canvas.h"
#include "libslam/draw/canvas_formats.h"
#include "libslam/draw/page_text.h"
#include "libslam/files/parameters.h"

namespace slam::draw {
namespace {

/// To a hundredth of a unit.
std::string number(double value) {
  return files::formatNumber(std::round(value * 100) / 100 + 0.0);
}

std::string attribute(const char* name, double value) {
  return std::string(" ") + name + "=\"" + number(value) + "\"";
}

std::string attribute(const char* name, Colour colour) {
  return std::string(" ") + name + "=\"" + cssColour(colour) + "\"";
}

std::string rect(const PixelBox& box) {
  return attribute("x", box.left) + attribute("y", box.top) + attribute("width", box.width) +
         attribute("height", box.height);
}

std::string outline(const std::vector<Pixel>& points) {
  std::string text;
  for (const auto& p : points) text += (text.empty() ? "M" : " ") + number(p.x) + " " + number(p.y);
  return text;
}

/// Writes one mark after the other.
class SvgWriter {
 public:
  std::string take() {
    closeClip();
    return std::move(body_);
  }

  void operator()(const drawing::Polyline& line) {
    body_ += "<path fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\"" +
             attribute("stroke", line.colour) + attribute("stroke-width", line.width) + " d=\"" +
             outline(line.points) + "\"/>\n";
  }
  void operator()(const drawing::Polygon& polygon) {
    body_ += "<path" + attribute("fill", polygon.colour) + " d=\"" + outline(polygon.corners) + "z\"/>\n";
  }
  void operator()(const drawing::Circle& circle) {
    const bool filled = circle.line_width <= 0;
    body_ += "<circle" + attribute("cx", circle.centre.x) + attribute("cy", circle.centre.y) +
             attribute("r", circle.radius) +
             (filled ? attribute("fill", circle.colour)
                     : " fill=\"none\"" + attribute("stroke", circle.colour) +
                           attribute("stroke-width", circle.line_width)) +
             "/>\n";
  }
  void operator()(const drawing::Box& box) {
    body_ += "<rect" + rect(box.box) + attribute("fill", box.colour) + "/>\n";
  }
  void operator()(const drawing::Image& image) {
    // Two words for one thing: browsers know "pixelated", older viewers "optimizeSpeed".
    body_ +=
        "<image" + rect(image.box) +
        " preserveAspectRatio=\"none\" image-rendering=\"optimizeSpeed\" style=\"image-rendering:pixelated\" "
        "xlink:href=\"" +
        dataUri("image/png", encodedPng(image)) + "\"/>\n";
  }
  void operator()(const drawing::Text& text) {
    const char* anchor = text.align == Align::kLeft     ? ""
                         : text.align == Align::kCentre ? " text-anchor=\"middle\""
                                                        : " text-anchor=\"end\"";
    body_ += "<text" + attribute("x", text.at.x) + attribute("y", text.at.y) +
             attribute("font-size", text.size) + anchor + (text.bold ? " font-weight=\"bold\"" : "") +
             attribute("fill", text.colour) + ">" + htmlText(text.utf8) + "</text>\n";
  }
  void operator()(const drawing::Clip& clip) {
    closeClip();
    const std::string id = "clip" + std::to_string(++clips_);
    body_ += "<clipPath id=\"" + id + "\"><rect" + rect(clip.box) + "/></clipPath>\n<g clip-path=\"url(#" +
             id + ")\">\n";
    is_clipped_ = true;
  }
  void operator()(const drawing::LiftClip&) { closeClip(); }

 private:
  void closeClip() {
    if (is_clipped_) body_ += "</g>\n";
    is_clipped_ = false;
  }

  std::string body_;
  int clips_ = 0;
  bool is_clipped_ = false;
};

}  // namespace

std::string Canvas::toSvg() const {
  SvgWriter writer;
  for (const auto& mark : marks_) std::visit(writer, mark);
  const std::string unit = paper_.isScreen() ? "px" : "mm";
  const double width = paper_.isScreen() ? width_ : paper_.width_mm;
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=\"" +
         number(width) + unit + "\" height=\"" + number(width * height_ / width_) + unit +
         "\" viewBox=\"0 0 " + number(width_) + " " + number(height_) + "\" font-family=\"" + kFontName +
         ", Arial, Helvetica, sans-serif\" xml:space=\"preserve\">\n<rect width=\"100%\" height=\"100%\" "
         "fill=\"#ffffff\"/>\n" +
         writer.take() + "</svg>\n";
}

std::string cssColour(Colour colour) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", colour.red, colour.green, colour.blue);
  return text;
}

}  // namespace slam::draw
