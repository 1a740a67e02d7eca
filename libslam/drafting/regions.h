#pragma once
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace slam::drafting {

/// Connected sets of a mask; label 0 is the background.
struct Regions {
  cv::Mat labels;  ///< CV_32S
  int count = 0;   ///< with the background
  cv::Mat stats, centroids;
  int area(int label) const { return stats.at<int>(label, cv::CC_STAT_AREA); }
  cv::Rect box(int label) const;
  cv::Point anyPixel(int label) const;  ///< the first in reading order
};
Regions regionsOf(const cv::Mat& mask, int connectivity);

/// 255 where the label's entry in `chosen` is not 0. Cost: one pass.
cv::Mat maskOf(const Regions& regions, const std::vector<char>& chosen);
/// Labels that occur under the mask.
std::vector<char> labelsUnder(const Regions& regions, const cv::Mat& mask);
/// Free cells 4-connected with the edge of the picture.
cv::Mat reachedFromEdge(const cv::Mat& free);

/// A disc-shaped brush; dilating with it reaches `radius` pixels.
cv::Mat disc(double radius);
/// Cells at most `radius` from a marked one, by the exact distance between centres.
cv::Mat grown(const cv::Mat& mask, double radius);
/// Ink that stays when a disc of this diameter must fit within: the thick strokes.
cv::Mat thickStrokes(const cv::Mat& ink, double diameter);
/// Distance of each marked cell's centre to the nearest centre of one that is not; the picture's edge counts
/// as not marked when `edge_counts`. CV_32F.
cv::Mat clearance(const cv::Mat& mask, bool edge_counts);

}  // namespace slam::drafting
