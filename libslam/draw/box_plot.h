#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "libslam/draw/canvas.h"

namespace slam::draw {

/// The values of one box: those of a method over the seeds.
struct BoxSample {
  std::string label;           ///< gives the colour, the same in every chart
  std::vector<double> values;  ///< in any order; what is not finite is left out
  std::size_t failed = 0;      ///< runs without a value, told under the box
};

/// Box plots under one title (of what: a world).
struct BoxChart {
  std::string title;
  std::vector<BoxSample> samples;  ///< from the left
};

/// The quartiles of a sample (linear between the order statistics: type 7 of Hyndman and Fan, The American
/// Statistician 50(4), 1996), how far the whiskers reach (the last value within 1.5 times the box's length of
/// it: Tukey, Exploratory Data Analysis, 1977), and what lies beyond.
struct BoxFigures {
  double low = 0, lower_quartile = 0, median = 0, upper_quartile = 0, high = 0;
  std::vector<double> beyond;
};
/// REQUIRES a finite value (ContractError).
BoxFigures boxFigures(std::vector<double> values);

/// All charts with one axis of values, logarithmic where that is asked for and every value is above 0; of
/// fewer than five values dots alone, without a box. How many values there are stands below each box. Under
/// the rules of the pictures in picture.h. REQUIRES 1 to 24 charts with a sample each (ContractError).
void drawBoxes(const std::vector<BoxChart>& charts, const std::string& y_title, bool is_log,
               const std::string& title, const std::string& file, const Paper& paper = {});

}  // namespace slam::draw
