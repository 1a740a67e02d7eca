#include "libslam/scanmatch/swept_match.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/lidar/deskew.h"
#include "libslam/scanmatch/point_beside.h"

namespace slam::scanmatch {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Symmetric, of x and y in map axes.
struct Plane {
  double xx, xy, yy;
};
/// What a wall's surfel seems to tell of where along the wall a point lies, see SurfelMap::feignedBy().
Plane feignedBy(const SurfelMap& map, const Surfel& surfel) {
  const double feigned = map.feignedBy(surfel);
  // A wall's information is that across times the square of its normal.
  const double per_trace = feigned / (static_cast<double>(surfel.xx) + surfel.yy);
  return {feigned - per_trace * surfel.xx, -per_trace * surfel.xy, feigned - per_trace * surfel.yy};
}

/// Information of pose and step; of each block, which is symmetric, xx, xy, yy, xt, yt and tt.
struct Sums {
  Vector6 pose = Vector6::Zero(), mixed = pose, step = pose;
  /// What `counts` times `told` of a point that moves by `s` of the step says, J = [1 0 -ry; 0 1 rx].
  void add(const Plane& told, double counts, double s, const Beside& b) {
    const double xx = counts * told.xx, xy = counts * told.xy, yy = counts * told.yy;
    const double xt = -xx * b.ry + xy * b.rx, yt = -xy * b.ry + yy * b.rx;
    Vector6 h;
    h << xx, xy, yy, xt, yt, -b.ry * xt + b.rx * yt;
    pose += h, mixed += s * h, step += s * s * h;
  }
  static Eigen::Matrix3d block(const Vector6& h) {
    Eigen::Matrix3d full;
    full << h(0), h(1), h(3), h(1), h(2), h(4), h(3), h(4), h(5);
    return full;
  }
  Matrix6 matrix() const {
    Matrix6 full;
    full << block(pose), block(mixed), block(mixed), block(step);
    return full;
  }
};

/// So many times what walls feign on the average. With once as much a corridor of 13 m still came out 5 to 9
/// cm short under a lidar that sees 3.5 m; with twice and four times it did not.
constexpr double kFeigned = 2;
/// Takes from what points tell what walls feign: where information H and gradient g say that it is, they say
/// so with less information. It is not just noise: a scan has more points ahead than those from farther back
/// that made the map, which holds the robot back in a bare corridor.
void takeOffFeigned(const Matrix6& feigned, Matrix6& H, Vector6& g) {
  constexpr double kNothing = 1e-12, kOpen = 1e-9;
  // In units that make metres and radians equal.
  const Vector6 unit = H.diagonal().cwiseMax(kNothing).cwiseSqrt(), per_unit = unit.cwiseInverse();
  const auto inUnits = [&](const Matrix6& M) -> Matrix6 {
    return per_unit.asDiagonal() * M * per_unit.asDiagonal();
  };
  const Eigen::SelfAdjointEigenSolver<Matrix6> rest(inUnits(H - kFeigned * feigned));
  const Matrix6 told =
      rest.eigenvectors() * rest.eigenvalues().cwiseMax(0).asDiagonal() * rest.eigenvectors().transpose();
  const Eigen::LDLT<Matrix6> all(inUnits(H) + kOpen * Matrix6::Identity());
  g = unit.cwiseProduct(told * all.solve(per_unit.cwiseProduct(g)));
  H = unit.asDiagonal() * told * unit.asDiagonal();
}

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
  Sums told, feigned;
  Eigen::Vector3d g = Eigen::Vector3d::Zero(), g_ago = g;
  for (size_t i = 0; i < points.size(); ++i) {
    const Beside b = at_pose.beside(points[i]);
    if (!b.surfel) {
      system.outside += at_pose.isOutside(b);
      continue;
    }
    system.weight_sum += b.w;
    const double s = -ago[i], counts = b.w * b.share;
    told.add({b.surfel->xx, b.surfel->xy, b.surfel->yy}, counts, s, b);
    if (map.feignedBy(*b.surfel) > 0) feigned.add(feignedBy(map, *b.surfel), counts, s, b);
    const double ax = b.w * b.ax, ay = b.w * b.ay;
    const Eigen::Vector3d r(ax, ay, -b.ry * ax + b.rx * ay);
    g += r, g_ago += s * r;
  }
  system.H = told.matrix();
  system.g << g, g_ago;
  takeOffFeigned(feigned.matrix(), system.H, system.g);
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
    match.by_step = of_pose.bottomRows<3>().transpose() * step * of_pose.bottomRows<3>();
    match.by_before = of_pose.transpose() * held * of_pose - match.by_step;
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
