#pragma once
#include <opencv2/core.hpp>
#include <vector>

namespace slam::drafting {

/// A word or figure found in ink.
struct Word {
  cv::Rect box;
  int glyphs = 0;
  int height = 0;  ///< of a typical glyph, pixels
};

struct Lettering {
  std::vector<Word> words;
  cv::Mat ink;  ///< 255 on their strokes
};

/// Text, across and upright: at least three pieces of ink in a row, alike in height and close together, that
/// differ in shape and are not convex as furniture and pillars are; and beside such words shorter ones of the
/// same height. Letters that run together count when they have the many strokes of a word. No piece that
/// touches a wall is ever text.
Lettering findLettering(const cv::Mat& ink);

}  // namespace slam::drafting
