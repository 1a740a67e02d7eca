// PNG and PDF, through cairo (cairographics.org).
#include <cairo-pdf.h>
#include <cairo.h>
#include <zlib.h>

#include <cstdint>
#include <memory>

#include "libslam/core/error.h"
#include "libslam/draw/canvas_formats.h"

namespace slam::draw {
namespace {

struct Destroy {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* context) const { cairo_destroy(context); }
  void operator()(cairo_font_options_t* options) const { cairo_font_options_destroy(options); }
};
using Surface = std::unique_ptr<cairo_surface_t, Destroy>;
using Context = std::unique_ptr<cairo_t, Destroy>;

void check(cairo_status_t status) {
  if (status == CAIRO_STATUS_NO_MEMORY) throw std::bad_alloc();
  if (status != CAIRO_STATUS_SUCCESS)
    throw core::IoError(std::string("the picture cannot be drawn: cairo: ") + cairo_status_to_string(status));
}

cairo_status_t append(void* text, const unsigned char* bytes, unsigned int length) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(bytes), length);
  return CAIRO_STATUS_SUCCESS;
}

Surface surfaceOf(const drawing::Image& image) {
  Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, image.columns, image.rows));
  check(cairo_surface_status(surface.get()));
  auto* bytes = cairo_image_surface_get_data(surface.get());
  const int stride = cairo_image_surface_get_stride(surface.get());
  auto pixel = image.pixels.begin();
  for (int y = 0; y < image.rows; ++y) {
    auto* row = reinterpret_cast<std::uint32_t*>(bytes + static_cast<std::ptrdiff_t>(y) * stride);
    for (int x = 0; x < image.columns; ++x, ++pixel)
      row[x] = static_cast<std::uint32_t>(pixel->red << 16 | pixel->green << 8 | pixel->blue);
  }
  cairo_surface_mark_dirty(surface.get());
  return surface;
}

std::string pngOf(cairo_surface_t* surface) {
  std::string bytes;
  check(cairo_surface_write_to_png_stream(surface, append, &bytes));
  return bytes;
}

/// Draws one mark after the other, in units.
class CairoWriter {
 public:
  /// scale: device's points or pixels per unit.
  CairoWriter(cairo_surface_t* surface, double scale) : context_(cairo_create(surface)), scale_(scale) {
    cairo_scale(cr(), scale, scale);
    cairo_set_line_join(cr(), CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_cap(cr(), CAIRO_LINE_CAP_ROUND);
    // Letters have the same widths at every size, as in the table that layouts use.
    const std::unique_ptr<cairo_font_options_t, Destroy> options(cairo_font_options_create());
    cairo_font_options_set_hint_style(options.get(), CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options.get(), CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_antialias(options.get(), CAIRO_ANTIALIAS_GRAY);
    cairo_set_font_options(cr(), options.get());
  }
  void finish() { check(cairo_status(cr())); }

  void operator()(const drawing::Polyline& line) {
    trace(line.points);
    set(line.colour);
    cairo_set_line_width(cr(), line.width);
    cairo_stroke(cr());
  }
  void operator()(const drawing::Polygon& polygon) {
    trace(polygon.corners);
    cairo_close_path(cr());
    set(polygon.colour);
    cairo_fill(cr());
  }
  void operator()(const drawing::Circle& circle) {
    cairo_new_path(cr());
    cairo_arc(cr(), circle.centre.x, circle.centre.y, circle.radius, 0, 2 * core::kPi);
    set(circle.colour);
    if (circle.line_width > 0) {
      cairo_close_path(cr());
      cairo_set_line_width(cr(), circle.line_width);
      cairo_stroke(cr());
    } else {
      cairo_fill(cr());
    }
  }
  void operator()(const drawing::Box& box) {
    cairo_rectangle(cr(), box.box.left, box.box.top, box.box.width, box.box.height);
    set(box.colour);
    cairo_fill(cr());
  }
  void operator()(const drawing::Image& image) {
    const auto surface = surfaceOf(image);
    cairo_save(cr());
    cairo_translate(cr(), image.box.left, image.box.top);
    const double points_per_unit = image.columns / image.box.width;
    cairo_scale(cr(), 1 / points_per_unit, 1 / points_per_unit);
    cairo_set_source_surface(cr(), surface.get(), 0, 0);
    // Reduced by averaging, so that thin walls stay; enlarged with sharp edges. A PDF keeps every point.
    const bool is_reduced = cairo_surface_get_type(cairo_get_target(cr())) == CAIRO_SURFACE_TYPE_IMAGE &&
                            scale_ < points_per_unit;
    cairo_pattern_set_filter(cairo_get_source(cr()), is_reduced ? CAIRO_FILTER_GOOD : CAIRO_FILTER_NEAREST);
    cairo_pattern_set_extend(cairo_get_source(cr()), CAIRO_EXTEND_PAD);
    cairo_rectangle(cr(), 0, 0, image.columns, image.rows);
    cairo_fill(cr());
    cairo_restore(cr());
  }
  void operator()(const drawing::Text& text) {
    cairo_select_font_face(cr(), kFontName, CAIRO_FONT_SLANT_NORMAL,
                           text.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr(), text.size);
    double shift = 0;
    if (text.align != Align::kLeft) {
      cairo_text_extents_t extents;
      cairo_text_extents(cr(), text.utf8.c_str(), &extents);
      shift = text.align == Align::kCentre ? extents.x_advance / 2 : extents.x_advance;
    }
    cairo_move_to(cr(), text.at.x - shift, text.at.y);
    set(text.colour);
    cairo_show_text(cr(), text.utf8.c_str());
    cairo_new_path(cr());
  }
  void operator()(const drawing::Clip& clip) {
    cairo_reset_clip(cr());
    cairo_rectangle(cr(), clip.box.left, clip.box.top, clip.box.width, clip.box.height);
    cairo_clip(cr());
  }
  void operator()(const drawing::LiftClip&) { cairo_reset_clip(cr()); }

 private:
  cairo_t* cr() const { return context_.get(); }
  void set(Colour c) { cairo_set_source_rgb(cr(), c.red / 255.0, c.green / 255.0, c.blue / 255.0); }
  void trace(const std::vector<Pixel>& points) {
    cairo_new_path(cr());
    for (const auto& p : points) cairo_line_to(cr(), p.x, p.y);
  }

  Context context_;
  double scale_;
};

void draw(const Canvas& canvas, cairo_surface_t* surface, double scale) {
  CairoWriter writer(surface, scale);
  writer(drawing::Box{{0, 0, canvas.width(), canvas.height()}, {255, 255, 255}});
  for (const auto& mark : canvas.marks()) std::visit(writer, mark);
  writer.finish();
}

/// A PNG that says its pixels per metre (chunk pHYs), so that it is set in its true size.
std::string withDensity(std::string png, double dpi) {
  constexpr std::size_t kAfterHeader = 33;  // signature, then IHDR
  const auto per_metre = static_cast<std::uint32_t>(std::lround(dpi / 0.0254));
  const auto bigEndian = [](std::uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xFFU);
    return bytes;
  };
  const std::string chunk = "pHYs" + bigEndian(per_metre) + bigEndian(per_metre) + '\1';
  const auto sum = crc32(0, reinterpret_cast<const Bytef*>(chunk.data()), static_cast<uInt>(chunk.size()));
  return png.insert(kAfterHeader, bigEndian(9) + chunk + bigEndian(static_cast<std::uint32_t>(sum)));
}

}  // namespace

std::string encodedPng(const drawing::Image& image) {
  return pngOf(surfaceOf(image).get());
}

std::string Canvas::toPng() const {
  const double scale = paper_.isScreen() ? 1 : paper_.width_mm / 25.4 * paper_.dpi / width_;
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24,
                                                   static_cast<int>(std::lround(width_ * scale)),
                                                   static_cast<int>(std::lround(height_ * scale))));
  check(cairo_surface_status(surface.get()));
  draw(*this, surface.get(), scale);
  return paper_.isScreen() ? pngOf(surface.get()) : withDensity(pngOf(surface.get()), paper_.dpi);
}

std::string Canvas::toPdf() const {
  constexpr double kPointsPerPixel = 0.75;  // of a screen of 96 dpi
  const double scale = paper_.isScreen() ? kPointsPerPixel : paper_.width_mm / 25.4 * 72 / width_;
  std::string bytes;
  {
    const Surface surface(
        cairo_pdf_surface_create_for_stream(append, &bytes, width_ * scale, height_ * scale));
    check(cairo_surface_status(surface.get()));
    // What every reader knows, and no objects packed away; and the clock must not show in the bytes.
    cairo_pdf_surface_restrict_to_version(surface.get(), CAIRO_PDF_VERSION_1_4);
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "2000-01-01T00:00:00Z");
    draw(*this, surface.get(), scale);
    cairo_surface_finish(surface.get());
    check(cairo_surface_status(surface.get()));
  }
  return bytes;
}

}  // namespace slam::draw
