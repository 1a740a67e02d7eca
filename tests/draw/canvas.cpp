#include "libslam/draw/canvas.h"

#include <cairo.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/resources/file_hash.h"
#include "libslam/testing/temp_folder.h"

namespace slam::draw {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using testing::TempFolder;

/// Every kind of mark but a raster, whose PNG zlib packs.
Canvas everything(const Paper& paper = {}) {
  Canvas canvas(200, 100, paper);
  canvas.box({10, 10, 50, 20}, kSkyBlue);
  canvas.frame({10, 10, 50, 20}, kBlue, 1.5);
  canvas.clipTo({0, 0, 100, 100});
  canvas.polyline({{0, 50}, {50, 60}, {std::nan(""), 0}, {80, 50}, {150, 60}}, kVermillion, 2);
  canvas.liftClip();
  canvas.fillPolygon({{150, 10}, {190, 10}, {170, 40}}, kGreen);
  canvas.disc({120, 80}, 5, kPurple);
  canvas.circle({140, 80}, 5, kOrange, 1);
  canvas.text({100, 95}, "Málaga < 1 m & \xFF", kTextSize, {40, 40, 40}, Align::kCentre, true);
  return canvas;
}

cv::Mat decoded(const std::string& png) {
  return cv::imdecode(std::vector<unsigned char>(png.begin(), png.end()), cv::IMREAD_COLOR);
}

TEST(LabelColours, AMethodHasItsOwnWhateverStandsBesideIt) {
  const auto same = [](Colour a, Colour b) {
    return a.red == b.red && a.green == b.green && a.blue == b.blue;
  };
  const auto alone = labelColours({"graph"}), among = labelColours({"mine", "naive", "particles", "graph"});
  EXPECT_TRUE(same(alone[0], kBlue));
  EXPECT_TRUE(same(among[3], kBlue));
  EXPECT_TRUE(same(among[2], kVermillion));
  EXPECT_TRUE(same(among[0], kGreen));  // the first that is free
  const auto variants = labelColours({"graph", "graph graph.keyframe_m=0.5", "icp", "icp_exact"});
  for (std::size_t i = 0; i < variants.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) EXPECT_FALSE(same(variants[i], variants[k])) << i << " " << k;
  EXPECT_TRUE(same(labelColours({"a", "b", "c", "d", "e", "f", "g", "h", "i"})[8], lineColours()[0]));
}

TEST(Canvas, AsSvgHasTheSameBytesOnEveryMachine) {
  EXPECT_EQ(resources::sha256(everything().toSvg()),
            "8704ce64984acec8a3f122916de744f24a21481c5f0531c24adb84e209c4bf3c");
}

TEST(Canvas, AsSvgIsWhatWasDrawn) {
  const auto svg = everything().toSvg();
  EXPECT_THAT(svg, HasSubstr("width=\"200px\" height=\"100px\" viewBox=\"0 0 200 100\""));
  EXPECT_THAT(svg, HasSubstr("<rect x=\"10\" y=\"10\" width=\"50\" height=\"20\" fill=\"#56b4e9\"/>"));
  // Two lines, for the point between them is nowhere.
  EXPECT_THAT(svg, HasSubstr("d=\"M0 50 50 60\""));
  EXPECT_THAT(svg, HasSubstr("d=\"M80 50 150 60\""));
  EXPECT_THAT(svg, HasSubstr("<clipPath id=\"clip1\"><rect x=\"0\" y=\"0\" width=\"100\" height=\"100\"/>"));
  EXPECT_THAT(svg, HasSubstr(">Málaga &lt; 1 m &amp; \xEF\xBF\xBD</text>"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, EndsWith("</svg>\n"));
}

TEST(Canvas, OnPaperHasTheWidthAskedForInEveryFormat) {
  Paper paper;
  paper.width_mm = 85, paper.dpi = 254;  // ten pixels per millimetre
  const auto canvas = everything(paper);
  EXPECT_THAT(canvas.toSvg(), HasSubstr("width=\"85mm\" height=\"42.5mm\""));
  const auto png = canvas.toPng();
  EXPECT_EQ(decoded(png).size(), cv::Size(850, 425));
  EXPECT_NE(png.find(std::string("pHYs\0\0\x27\x10\0\0\x27\x10\1", 13)),
            std::string::npos);  // 10000 per metre
  EXPECT_NE(canvas.toPdf().find("/MediaBox [ 0 0 240.944882 120.472441 ]"),
            std::string::npos);  // 85 mm in points
}

TEST(Canvas, OnPaperHasTextOfTheSizeAskedFor) {
  Paper paper;
  paper.width_mm = 170, paper.font_pt = 8;
  const double point_per_unit = 170 / 25.4 * 72 / paper.unitsWide();
  EXPECT_NEAR(kTextSize * point_per_unit, 8, 1e-9);
  EXPECT_TRUE(Paper().isScreen());
}

TEST(Canvas, HasTheSameBytesAgain) {
  for (const double width_mm : {0.0, 85.0}) {
    Paper paper;
    paper.width_mm = width_mm;
    EXPECT_EQ(everything(paper).toPng(), everything(paper).toPng());
    EXPECT_EQ(everything(paper).toPdf(), everything(paper).toPdf());
  }
  // Two documents at two moments differ in nothing: the date is always the same.
  EXPECT_NE(everything().toPdf().find("/CreationDate (20000101000000Z)"), std::string::npos);
}

TEST(Canvas, AsPngHasItsColoursWhereTheyWereDrawn) {
  const auto image = decoded(everything().toPng());
  ASSERT_EQ(image.size(), cv::Size(200, 100));
  const auto isColour = [&](int x, int y, Colour c) {
    return image.at<cv::Vec3b>(y, x) == cv::Vec3b(c.blue, c.green, c.red);
  };
  EXPECT_TRUE(isColour(30, 20, kSkyBlue));
  EXPECT_TRUE(isColour(170, 20, kGreen));
  EXPECT_TRUE(isColour(120, 80, kPurple));
  EXPECT_TRUE(isColour(140, 80, {255, 255, 255}));
  EXPECT_TRUE(isColour(140, 57, {255, 255, 255}));  // beyond the clip
}

TEST(Canvas, PaintsARasterPointByPoint) {
  Paper paper;
  paper.width_mm = 20, paper.dpi = 254;
  Canvas canvas(10, 10, paper);
  canvas.paint({2, 2, 6, 6}, [](Pixel p) { return p.x < 5 ? kBlue : kVermillion; });
  const auto image = decoded(canvas.toPng());  // 20 pixels per unit, sharp edges
  const auto at = [&](int x, int y) { return image.at<cv::Vec3b>(y, x); };
  EXPECT_EQ(at(99, 100), cv::Vec3b(kBlue.blue, kBlue.green, kBlue.red));
  EXPECT_EQ(at(101, 100), cv::Vec3b(kVermillion.blue, kVermillion.green, kVermillion.red));
  EXPECT_EQ(at(38, 100), cv::Vec3b(255, 255, 255));
  EXPECT_EQ(at(100, 162), cv::Vec3b(255, 255, 255));
  const auto svg = canvas.toSvg();
  EXPECT_THAT(svg, HasSubstr("<image x=\"2\" y=\"2\" width=\"6\" height=\"6\""));
  EXPECT_THAT(svg, HasSubstr("href=\"data:image/png;base64,"));
  canvas.paint({2, 2, 0, 6}, [](Pixel) { return kBlue; });  // no area: nothing
  EXPECT_EQ(canvas.toSvg(), svg);
}

TEST(Canvas, KnowsTheWidthsOfTheFont) {
  EXPECT_DOUBLE_EQ(Canvas::textWidth("A", 1000), 667);
  EXPECT_DOUBLE_EQ(Canvas::textWidth("il", 1000, true), 556);
  cairo_surface_t* surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, 1, 1);
  cairo_t* context = cairo_create(surface);
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(context, options);
  cairo_set_font_size(context, 1000);
  bool is_liberation = true;
  for (const bool bold : {false, true}) {
    cairo_select_font_face(context, "Liberation Sans", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    for (char c = ' '; c < 0x7F; ++c) {
      const std::string letter(1, c);
      cairo_text_extents_t extents;
      cairo_text_extents(context, letter.c_str(), &extents);
      // Where the font is not installed fontconfig gives another; its A tells.
      if (letter == "'" && std::abs(extents.x_advance - (bold ? 237.8 : 190.9)) > 0.5) is_liberation = false;
      if (is_liberation) {
        EXPECT_NEAR(Canvas::textWidth(letter, 1000, bold), extents.x_advance, 0.6) << letter << bold;
      }
    }
  }
  cairo_font_options_destroy(options);
  cairo_destroy(context);
  cairo_surface_destroy(surface);
  if (!is_liberation) GTEST_SKIP() << "Liberation Sans is not installed";
}

TEST(Canvas, CutsTextAtALetter) {
  EXPECT_EQ(Canvas::fitText("short", 10, 100), "short");
  const auto cut = Canvas::fitText("éééééééééé", 10, 40);  // 6 units each, the dots 8.34
  EXPECT_EQ(cut, "ééééé...");
  EXPECT_EQ(Canvas::fitText("two\nlines", 10, 100), "two lines");
  EXPECT_EQ(Canvas::fitText("abc", 10, 1), "...");
}

TEST(Canvas, IsSavedByItsExtension) {
  const TempFolder folder;
  for (const std::string name : {"a.png", "a.svg", "a.pdf"}) everything().save(folder / name);
  EXPECT_THAT(files::readTextFile(folder / "a.png"), StartsWith("\x89PNG"));
  EXPECT_THAT(files::readTextFile(folder / "a.svg"), StartsWith("<?xml"));
  EXPECT_THAT(files::readTextFile(folder / "a.pdf"), StartsWith("%PDF"));
  for (const std::string name : {"a.jpg", "a", "a.PNG2"}) {
    EXPECT_THROW(everything().save(folder / name), core::InputError) << name;
    EXPECT_FALSE(std::filesystem::exists(folder / name));
  }
  EXPECT_THROW(everything().save(folder / "none/a.svg"), core::IoError);
}

}  // namespace
}  // namespace slam::draw
