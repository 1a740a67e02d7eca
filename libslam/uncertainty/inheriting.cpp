#include "libslam/uncertainty/inheriting.h"

#include <algorithm>
#include <cmath>

#include "libslam/keyframes/matching.h"
#include "libslam/scanmatch/information.h"

namespace slam::uncertainty {

void Inheriting::carryOn(const PoseError& match, const Eigen::Matrix3d& since,
                         const Eigen::Matrix3d& odometry) {
  gain_ = match.stays * since * gain_ * since.transpose() + match.gain;
  own_ = scanmatch::withoutNegatives(
             match.stays * (since * own_ * since.transpose() + odometry) * match.stays.transpose(),
             keyframes::kLeastShare, 0) +
         match.noise;
  const double of_points = (match.noise - match.beyond).topLeftCorner<2, 2>().trace();
  points_err_ = of_points > 0 ? std::sqrt(match.noise.topLeftCorner<2, 2>().trace() / of_points) : 1;
}

keyframes::Inheritance Inheriting::of(const scanmatch::MatchEvidence& evidence) const {
  keyframes::Inheritance result;
  result.gain = gain_;
  result.before = before_;
  result.own = own_;
  result.points_err = points_err_;
  for (const auto& view : evidence.by_view)
    result.views.push_back({view.view, scanmatch::withoutNegatives(view.information, 0, 0)});
  const auto ofPosition = [](const keyframes::Inheritance::View& view) {
    return view.information.matrix().topLeftCorner<2, 2>().trace();
  };
  const size_t most = std::min<size_t>(result.views.size(), keyframes::Inheritance::kMostViews);
  std::partial_sort(result.views.begin(), result.views.begin() + static_cast<std::ptrdiff_t>(most),
                    result.views.end(), [&](const auto& a, const auto& b) {
                      const double of_a = ofPosition(a), of_b = ofPosition(b);
                      return of_a != of_b ? of_a > of_b : a.keyframe < b.keyframe;
                    });
  result.views.resize(most);
  result.views.shrink_to_fit();
  return result;
}

}  // namespace slam::uncertainty
