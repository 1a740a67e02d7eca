#include "libslam/scanmatch/surfel_matcher.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/scanmatch/point_beside.h"

namespace slam::scanmatch {
namespace {

struct System {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  double weight_sum = 0;
  int outside = 0;  ///< points beyond the map's window
};

System accumulate(const std::vector<PatchPoint>& points, const SurfelMap& map, const core::Pose2& T,
                  double kernel) {
  const AtPose at_pose(map, T, kernel);
  double hxx = 0, hxy = 0, hyy = 0, hxt = 0, hyt = 0, htt = 0, gx = 0, gy = 0, gt = 0, weights = 0;
  int outside = 0;
  for (const auto& point : points) {
    const Beside b = at_pose.beside(point);
    if (!b.surfel) {
      outside += at_pose.isOutside(b);
      continue;
    }
    const double rx = b.rx, ry = b.ry, w = b.w;
    weights += w;
    // J = [1 0 -ry; 0 1 rx]
    const double told = w * b.share;
    const double lxx = told * b.surfel->xx, lxy = told * b.surfel->xy, lyy = told * b.surfel->yy;
    const double jx = -lxx * ry + lxy * rx, jy = -lxy * ry + lyy * rx;
    hxx += lxx, hxy += lxy, hyy += lyy;
    hxt += jx, hyt += jy, htt += -ry * jx + rx * jy;
    const double wax = w * b.ax, way = w * b.ay;
    gx += wax, gy += way, gt += -ry * wax + rx * way;
  }
  System system;
  system.H << hxx, hxy, hxt, hxy, hyy, hyt, hxt, hyt, htt;
  system.g << gx, gy, gt;
  system.weight_sum = weights, system.outside = outside;
  return system;
}

}  // namespace

MatchResult alignToSurfels(const std::vector<PatchPoint>& points, const SurfelMap& map,
                           const core::Pose2& T_start, const PosePrior& prior, const MatchOptions& options) {
  MatchResult result;
  result.T_map_robot = T_start;
  result.posterior_information = prior.information;
  if (points.empty()) return result;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    core::Pose2& T = result.T_map_robot;
    const System system = accumulate(points, map, T, options.kernel);
    result.information = options.information_scale * system.H;
    result.score = system.weight_sum / countedPoints(points.size(), system.outside);
    const Eigen::Vector3d from_prior(T.x - prior.mean.x, T.y - prior.mean.y,
                                     core::angleDifference(T.phi, prior.mean.phi));
    Eigen::Matrix3d held = prior.information;
    if (options.prior_kernel > 0) {
      const double k2 = options.prior_kernel * options.prior_kernel;
      const double away = from_prior.head<2>().dot(held.topLeftCorner<2, 2>() * from_prior.head<2>());
      const double w_xy = 1 / (1 + away / k2),
                   w_turn = 1 / (1 + from_prior.z() * held(2, 2) * from_prior.z() / k2);
      const Eigen::Vector3d root(w_xy, w_xy, w_turn);
      held = root.asDiagonal() * held * root.asDiagonal();
    }
    const Eigen::Matrix3d H = result.information + held;
    result.posterior_information = H;
    const Eigen::Vector3d g = options.information_scale * system.g + held * from_prior;
    const Eigen::LDLT<Eigen::Matrix3d> solver(H + 1e-9 * Eigen::Matrix3d::Identity());
    const Eigen::Vector3d step = solver.solve(-g);
    if (!step.allFinite()) break;
    T = {T.x + step.x(), T.y + step.y(), core::wrapToPi(T.phi + step.z())};
    if (step.head<2>().squaredNorm() < options.still_m * options.still_m &&
        std::abs(step.z()) < options.still_rad)
      break;
  }
  return result;
}

namespace {

/// Six numbers of a view's information, which is symmetric.
struct Told {
  int view;
  double xx = 0, xy = 0, yy = 0, xt = 0, yt = 0, tt = 0;
};

/// What a point's robust pull falls by with its distance, which it holds the less firmly for: its weight is
/// 1 / (1 + q / k^2)^2. Of one that is pulled less the farther it is off nothing is left of that direction.
Eigen::Matrix3d fallOf(const Beside& b, double inverse_kernel2) {
  constexpr double kNothing = 1e-12;
  const double steepness =
      std::min(4 * inverse_kernel2 * b.w * std::sqrt(b.w), b.w / std::max(b.q, kNothing));
  const Eigen::Vector3d pull(b.ax, b.ay, -b.ry * b.ax + b.rx * b.ay);
  return steepness * pull * pull.transpose();
}

}  // namespace

MatchEvidence evidenceOf(const std::vector<PatchPoint>& points, const SurfelMap& map, const core::Pose2& T,
                         double kernel, Walls walls) {
  MatchEvidence evidence;
  const AtPose at_pose(map, T, kernel);
  const double inverse_kernel2 = 1 / (kernel * kernel);
  std::array<double, MatchEvidence::kLags> before{};  // the newest first
  std::vector<Told> told;                             // by views in the order that they come
  size_t last = 0;                                    // of these
  for (const auto& point : points) {
    const Beside b = at_pose.beside(point);
    double residual = 0;
    if (const Surfel* surfel = b.surfel; surfel && (b.share == 1 || walls == Walls::kAll)) {
      const int view = map.firstViewOf(*surfel);
      if (last == told.size() || told[last].view != view) {
        last = 0;
        while (last < told.size() && told[last].view != view) ++last;
        if (last == told.size()) told.push_back({view});
      }
      double xx = surfel->xx, xy = surfel->xy, yy = surfel->yy;
      if (const double feigned = map.feignedBy(*surfel); feigned > 0) {
        const double share = feigned / (xx + yy);
        xx += share * xx - feigned, xy += share * xy, yy += share * yy - feigned;
      }
      const double counts = b.w * b.share;
      xx *= counts, xy *= counts, yy *= counts;
      // J = [1 0 -ry; 0 1 rx]
      const double xt = -xx * b.ry + xy * b.rx, yt = -xy * b.ry + yy * b.rx;
      Told& one = told[last];
      one.xx += xx, one.xy += xy, one.yy += yy;
      one.xt += xt, one.yt += yt, one.tt += -b.ry * xt + b.rx * yt;
      const Eigen::Matrix3d falls = fallOf(b, inverse_kernel2);
      evidence.beyond_slope += falls;
      one.xx -= falls(0, 0), one.xy -= falls(0, 1), one.yy -= falls(1, 1);
      one.xt -= falls(0, 2), one.yt -= falls(1, 2), one.tt -= falls(2, 2);
      const double trace = surfel->xx + surfel->yy;
      const double det =
          static_cast<double>(surfel->xx) * surfel->yy - static_cast<double>(surfel->xy) * surfel->xy;
      evidence.squared += b.w * b.q;
      evidence.pulled += b.w * b.w * b.q;
      evidence.dimensions += b.w * trace * trace / (trace * trace - 2 * det);
      residual = std::sqrt(b.w * b.q) * (b.nx * b.dx + b.ny * b.dy < 0 ? -1 : 1);
    }
    for (size_t lag = 0; lag < before.size(); ++lag) evidence.lagged[lag] += residual * before[lag];
    std::rotate(before.begin(), before.end() - 1, before.end());
    before[0] = residual;
  }
  std::sort(told.begin(), told.end(), [](const Told& a, const Told& b) { return a.view < b.view; });
  for (const Told& one : told) {
    ViewInformation& by_view = evidence.by_view.emplace_back();
    by_view.view = one.view;
    by_view.information << one.xx, one.xy, one.xt, one.xy, one.yy, one.yt, one.xt, one.yt, one.tt;
  }
  return evidence;
}

Eigen::Matrix3d MatchEvidence::slope() const {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const auto& one : by_view) sum += one.information;
  return sum;
}

double surfelScore(const std::vector<PatchPoint>& points, const SurfelMap& map,
                   const core::Pose2& T_map_robot, double kernel, int stride, double least) {
  constexpr size_t kAtOnce = 8;
  constexpr double kRounding = 1e-9;
  const auto [s, c] = core::sinCos(T_map_robot.phi);
  const double tx = T_map_robot.x - map.origin().x, ty = T_map_robot.y - map.origin().y;
  const double inverse_kernel2 = 1 / (kernel * kernel);
  double sum = 0;
  const size_t step = static_cast<size_t>(stride), all = (points.size() + step - 1) / step;
  size_t count = 0;
  int outside = 0;
  for (size_t i = 0; i < points.size(); i += step) {
    if (count % kAtOnce == 0) {
      const double most = (sum + static_cast<double>(all - count)) / countedPoints(all, outside);
      if (most < least - kRounding) return 0;
    }
    ++count;
    const auto& p = points[i];
    const double x = tx + c * p.x - s * p.y, y = ty + s * p.x + c * p.y;
    const auto [surfel, share] =
        map.facing(x, y, -(s * p.along_x + c * p.along_y), c * p.along_x - s * p.along_y);
    if (!surfel) {
      outside += !map.covers(x, y);
      continue;
    }
    const double dx = x - surfel->x, dy = y - surfel->y;
    const double q = share * (surfel->xx * dx * dx + 2 * surfel->xy * dx * dy + surfel->yy * dy * dy);
    const double root = 1 / (1 + q * inverse_kernel2);
    sum += root * root;
  }
  return count ? sum / countedPoints(count, outside) : 0;
}

}  // namespace slam::scanmatch
