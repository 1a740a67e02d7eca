#include "libslam/scanmatch/swept_match.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/lidar/deskew.h"
#include "libslam/scanmatch/point_beside.h"

namespace slam::scanmatch {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Over the pose at the stamp and the step's rest.
struct SweptSystem {
  Matrix6 H = Matrix6::Zero();
  Vector6 g = Vector6::Zero();
  double weight_sum = 0;
  int outside = 0;
};

SweptSystem accumulate(const std::vector<PatchPoint>& points, const std::vector<float>& ago,
                       const SurfelMap& map, const core::Pose2& T, double kernel) {
  const AtPose at_pose(map, T, kernel);
  SweptSystem system;
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero(), H_ago = H, H_ago2 = H;
  Eigen::Vector3d g = Eigen::Vector3d::Zero(), g_ago = g;
  for (size_t i = 0; i < points.size(); ++i) {
    const Beside b = at_pose.beside(points[i]);
    if (!b.surfel) {
      system.outside += at_pose.isOutside(b);
      continue;
    }
    system.weight_sum += b.w;
    const double told = b.w * b.share, xx = told * b.surfel->xx, xy = told * b.surfel->xy,
                 yy = told * b.surfel->yy;
    // J = [1 0 -ry; 0 1 rx]
    const double xt = -xx * b.ry + xy * b.rx, yt = -xy * b.ry + yy * b.rx;
    Eigen::Matrix3d h;
    h << xx, xy, xt, xy, yy, yt, xt, yt, -b.ry * xt + b.rx * yt;
    const double ax = b.w * b.ax, ay = b.w * b.ay;
    const Eigen::Vector3d r(ax, ay, -b.ry * ax + b.rx * ay);
    const double s = -ago[i];
    H += h, H_ago += s * h, H_ago2 += s * s * h;
    g += r, g_ago += s * r;
  }
  system.H << H, H_ago, H_ago, H_ago2;
  system.g << g, g_ago;
  return system;
}

}  // namespace

std::vector<float> agoOf(const std::vector<PatchPoint>& points, const lidar::Scan& scan) {
  const core::Pose2 T_lidar_robot = core::inverse(scan.T_robot_lidar);
  std::vector<float> ago;
  ago.reserve(points.size());
  for (const auto& point : points) {
    const core::Point2 p = T_lidar_robot * position(point);
    // On the side of the circle where the beams are.
    const double middle_rad =
        scan.first_angle_rad + 0.5 * scan.step_rad * static_cast<double>(scan.ranges_m.size() - 1);
    const double beam =
        (middle_rad + core::angleDifference(core::atan2(p.y, p.x), middle_rad) - scan.first_angle_rad) /
        scan.step_rad;
    ago.push_back(
        static_cast<float>(lidar::measuredAgo_s(scan, scan.deskewing.sweep, beam) / scan.deskewing.period_s));
  }
  return ago;
}

std::vector<PatchPoint> sweptBy(const std::vector<PatchPoint>& points, const std::vector<float>& ago,
                                const Eigen::Vector3d& more, double phi_rad) {
  const auto [sine, cosine] = core::sinCos(phi_rad);
  const double x = cosine * more.x() + sine * more.y(), y = -sine * more.x() + cosine * more.y();
  std::vector<PatchPoint> moved;
  moved.reserve(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const double s = -ago[i];
    moved.push_back(core::Pose2{s * x, s * y, s * more.z()} * points[i]);
  }
  return moved;
}

SweptMatch alignSweptToSurfels(const std::vector<PatchPoint>& points, const std::vector<float>& ago,
                               const SurfelMap& map, const SweptMatch& start, const SweptPrior& prior,
                               const MatchOptions& options) {
  SweptMatch match;
  match.T_map_robot = start.T_map_robot, match.more = start.more;
  if (points.empty()) return match;
  const Eigen::Matrix3d& before = prior.before.information;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    core::Pose2& T = match.T_map_robot;
    const SweptSystem system =
        accumulate(sweptBy(points, ago, match.more, T.phi), ago, map, T, options.kernel);
    match.score = system.weight_sum / countedPoints(points.size(), system.outside);
    const Eigen::Vector3d from_before = Eigen::Vector3d(T.x - prior.before.mean.x, T.y - prior.before.mean.y,
                                                        core::angleDifference(T.phi, prior.before.mean.phi)) -
                                        match.more;
    const Eigen::Vector3d from_step = match.more - prior.more;
    Eigen::Matrix3d step = prior.step_information;
    if (options.prior_kernel > 0)
      step /= 1 + from_step.dot(step * from_step) / (options.prior_kernel * options.prior_kernel);
    Matrix6 held;
    held << before, -before, -before, before + step;
    Vector6 g = options.information_scale * system.g;
    g.head<3>() += before * from_before;
    g.tail<3>() += step * from_step - before * from_before;
    const Matrix6 H = options.information_scale * system.H + held;
    const Eigen::LDLT<Matrix6> solver(H + 1e-9 * Matrix6::Identity());
    const Matrix6 covariance = solver.solve(Matrix6::Identity());
    const Eigen::Matrix<double, 6, 3> of_pose = covariance.leftCols<3>();
    match.more_covariance = covariance.bottomRightCorner<3, 3>();
    match.by_points =
        options.information_scale * options.information_scale * of_pose.transpose() * system.H * of_pose;
    match.by_prior = of_pose.transpose() * held * of_pose;
    const Vector6 move = solver.solve(-g);
    if (!move.allFinite()) break;
    T = {T.x + move(0), T.y + move(1), core::wrapToPi(T.phi + move(2))};
    match.more += move.tail<3>();
    if (move.head<2>().squaredNorm() < options.still_m * options.still_m &&
        std::abs(move(2)) < options.still_rad &&
        move.segment<2>(3).squaredNorm() < options.still_m * options.still_m &&
        std::abs(move(5)) < options.still_rad)
      break;
  }
  return match;
}

}  // namespace slam::scanmatch
