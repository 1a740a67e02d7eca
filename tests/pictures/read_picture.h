#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "libslam/pictures/picture.h"

namespace slam::pictures {

inline cv::Mat load(const std::string& path) {
  cv::Mat image = cv::imread(path, cv::IMREAD_COLOR);
  EXPECT_FALSE(image.empty()) << path;
  EXPECT_GE(image.cols, 600);
  EXPECT_LE(std::max(image.cols, image.rows), 2000);
  return image;
}

inline bool isColour(const cv::Vec3b& pixel, draw::Colour colour) {
  return pixel[0] == colour.blue && pixel[1] == colour.green && pixel[2] == colour.red;
}

inline int countOf(const cv::Mat& image, draw::Colour colour) {
  int count = 0;
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) count += isColour(image.at<cv::Vec3b>(y, x), colour);
  return count;
}

}  // namespace slam::pictures
