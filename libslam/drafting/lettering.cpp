#include "libslam/drafting/lettering.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "libslam/core/middle_value.h"
#include "libslam/drafting/regions.h"

namespace slam::drafting {
namespace {

constexpr int kLeastHeight = 5;
/// A letter with its holes filled covers less of its hull than this; furniture more.
constexpr double kConvex = 0.86;

struct Glyph {
  int label = 0;
  cv::Rect box;
  int area = 0;
  bool is_written = false;  ///< not convex
  bool is_word = false;     ///< letters that run together
};

int strokesAcross(const cv::Mat& piece) {
  int most = 0;
  for (const double height : {0.35, 0.5, 0.65}) {
    const auto* row = piece.ptr<std::uint8_t>(static_cast<int>(height * piece.rows));
    int strokes = 0;
    for (int x = 0; x < piece.cols; ++x) strokes += row[x] && (x == 0 || !row[x - 1]);
    most = std::max(most, strokes);
  }
  return most;
}

double convexity(const cv::Mat& piece) {
  // Enlarged, so that the contour through pixel centres loses little of small letters.
  cv::Mat large;
  cv::copyMakeBorder(piece, large, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::resize(large, large, {}, 3, 3, cv::INTER_NEAREST);
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(large, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  std::vector<cv::Point> hull;
  double filled = 0;
  std::vector<cv::Point> all;
  for (const auto& contour : contours) {
    filled += cv::contourArea(contour);
    all.insert(all.end(), contour.begin(), contour.end());
  }
  cv::convexHull(all, hull);
  const double area = cv::contourArea(hull);
  return area > 0 ? filled / area : 1;
}

std::vector<Glyph> glyphsOf(const Regions& pieces, int most_height) {
  std::vector<Glyph> glyphs;
  for (int label = 1; label < pieces.count; ++label) {
    Glyph glyph;
    glyph.label = label;
    glyph.box = pieces.box(label);
    glyph.area = pieces.area(label);
    const bool is_letter_sized = glyph.box.height >= kLeastHeight && glyph.box.height <= most_height &&
                                 glyph.box.width <= 12 * glyph.box.height &&
                                 glyph.box.width <= 8 * most_height;
    if (!is_letter_sized) continue;
    const cv::Mat piece = pieces.labels(glyph.box) == label;
    glyph.is_written = glyph.box.width >= 3 && convexity(piece) < kConvex;
    const bool is_broad = glyph.box.width > 1.6 * glyph.box.height;
    const int strokes = is_broad && glyph.is_written ? strokesAcross(piece) : 0;
    glyph.is_word = strokes >= 4;
    if (is_broad && strokes < 3) continue;
    glyphs.push_back(glyph);
  }
  std::sort(glyphs.begin(), glyphs.end(), [](const Glyph& a, const Glyph& b) {
    return a.box.x != b.box.x ? a.box.x < b.box.x : a.box.y < b.box.y;
  });
  return glyphs;
}

bool standTogether(const Glyph& a, const Glyph& b) {
  const int low = std::min(a.box.height, b.box.height), high = std::max(a.box.height, b.box.height);
  const int overlap = std::min(a.box.br().y, b.box.br().y) - std::max(a.box.y, b.box.y);
  const int gap = b.box.x - a.box.br().x;
  return high <= 2.2 * low && overlap >= 0.5 * low && gap <= 1.1 * high;
}

std::vector<std::vector<size_t>> rowsOf(const std::vector<Glyph>& glyphs, int most_height) {
  std::vector<size_t> leader(glyphs.size());
  std::iota(leader.begin(), leader.end(), size_t{0});
  const auto find = [&](size_t i) {
    while (leader[i] != i) i = leader[i] = leader[leader[i]];
    return i;
  };
  for (size_t i = 0; i < glyphs.size(); ++i)
    for (size_t j = i + 1; j < glyphs.size() && glyphs[j].box.x <= glyphs[i].box.br().x + most_height; ++j)
      if (standTogether(glyphs[i], glyphs[j])) leader[find(j)] = find(i);
  std::vector<std::vector<size_t>> rows(glyphs.size());
  for (size_t i = 0; i < glyphs.size(); ++i) rows[find(i)].push_back(i);
  rows.erase(std::remove_if(rows.begin(), rows.end(), [](const auto& row) { return row.empty(); }),
             rows.end());
  return rows;
}

/// Rows of chairs and shelves repeat one shape, words do not.
bool areAllAlike(const std::vector<Glyph>& glyphs, const std::vector<size_t>& row) {
  const Glyph& first = glyphs[row.front()];
  return std::all_of(row.begin(), row.end(), [&](size_t i) {
    const Glyph& g = glyphs[i];
    return std::abs(g.box.width - first.box.width) <= 1 && std::abs(g.box.height - first.box.height) <= 1 &&
           std::abs(g.area - first.area) <= 0.12 * first.area + 1;
  });
}

Word wordOf(const std::vector<Glyph>& glyphs, const std::vector<size_t>& row) {
  Word word;
  std::vector<int> heights;
  for (const size_t i : row) {
    word.box |= glyphs[i].box;
    heights.push_back(glyphs[i].box.height);
  }
  word.height = core::middleValue(std::move(heights));
  word.glyphs = static_cast<int>(row.size());
  return word;
}

Lettering acrossOnly(const cv::Mat& ink) {
  const int most_height = std::clamp(std::max(ink.cols, ink.rows) / 25, 24, 120);
  const Regions pieces = regionsOf(ink, 8);
  const std::vector<Glyph> glyphs = glyphsOf(pieces, most_height);
  Lettering found;
  std::vector<char> chosen(static_cast<size_t>(pieces.count), 0);
  std::vector<std::vector<size_t>> short_rows;
  const auto accept = [&](const std::vector<size_t>& row) {
    found.words.push_back(wordOf(glyphs, row));
    for (const size_t i : row) chosen[static_cast<size_t>(glyphs[i].label)] = 1;
  };
  for (const auto& row : rowsOf(glyphs, most_height)) {
    int written = 0, words = 0;
    for (const size_t i : row) written += glyphs[i].is_written, words += glyphs[i].is_word;
    if ((row.size() >= 3 && 2 * written >= static_cast<int>(row.size()) && written >= 2 &&
         !areAllAlike(glyphs, row)) ||
        (row.size() == 2 && words == 2) || (row.size() == 2 && words == 1 && written == 2))
      accept(row);
    else if (written > 0)
      short_rows.push_back(row);
  }
  std::vector<int> heights;
  for (const Word& word : found.words) heights.push_back(word.height);
  for (const auto& row : short_rows) {
    const Word word = wordOf(glyphs, row);
    const bool has_known_height = std::any_of(heights.begin(), heights.end(), [&](int height) {
      return std::abs(word.height - height) <= std::max(1.0, 0.2 * height);
    });
    const bool is_word = row.size() == 1 && glyphs[row.front()].is_word;
    if (has_known_height && (is_word || (row.size() >= 2 && !areAllAlike(glyphs, row)))) accept(row);
  }
  // Dots, commas and strokes that are too small for a glyph of their own.
  for (const Word& word : found.words) {
    const int margin = std::max(1, word.height / 3);
    const cv::Rect around(word.box.x - margin, word.box.y - margin, word.box.width + 2 * margin,
                          word.box.height + 2 * margin);
    for (int label = 1; label < pieces.count; ++label) {
      const cv::Rect box = pieces.box(label);
      if ((box & around) == box && box.height <= 1.3 * word.height) chosen[static_cast<size_t>(label)] = 1;
    }
  }
  found.ink = maskOf(pieces, chosen);
  return found;
}

}  // namespace

Lettering findLettering(const cv::Mat& ink) {
  Lettering across = acrossOnly(ink);
  const cv::Mat turned = (ink & ~across.ink).t();
  const Lettering upright = acrossOnly(turned);
  across.ink |= upright.ink.t();
  for (const Word& word : upright.words)
    across.words.push_back(
        {{word.box.y, word.box.x, word.box.height, word.box.width}, word.glyphs, word.height});
  return across;
}

}  // namespace slam::drafting
