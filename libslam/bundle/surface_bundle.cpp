#include "libslam/bundle/surface_bundle.h"

#include <algorithm>
#include <set>
#include <utility>

#include "libslam/keyframes/matching.h"
#include "libslam/scanmatch/information.h"
#include "libslam/tracking/step_variance.h"

namespace slam::bundle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Standard deviations beyond which a keyframe's points hardly count: half of what tracking allows, as poses
/// are known by now.
constexpr double kBundleKernel = keyframes::kKernel / 2;
constexpr std::size_t kSeenInPiece = 1 << 16;

}  // namespace

SurfaceBundle::SurfaceBundle(const keyframes::KeyframeMap& map, const SharedSurfaces& shared,
                             std::function<void()> often)
    : map_(map),
      often_(std::move(often)),
      point_variance_(map.pointNoise().variance()),
      pulls_(static_cast<std::size_t>(map.size()), Vector3d::Zero()),
      told_(static_cast<std::size_t>(map.size())) {
  for (int k = 0; k < map.size(); ++k) {
    const double points_err = map.keyframe(k).inherited.points_err;
    point_weights_.push_back(1 / (point_variance_ * points_err * points_err));
  }
  shared.forEach([&](const SharedSurface& surface) { addSurface(surface); });
  collectTies();
  std::set<int> components;
  for (int k = 0; k < map.size(); ++k)
    if (components.insert(map.componentOf(k)).second) held_.push_back(k);
}

SurfaceBundle::Piece& SurfaceBundle::pieceFor(std::size_t seen) {
  if (pieces_.empty() || pieces_.back().seen.size() + seen > pieces_.back().seen.capacity()) {
    often_();
    pieces_.emplace_back();
    pieces_.back().seen.reserve(std::max(seen, kSeenInPiece));
  }
  return pieces_.back();
}

/// How far each one's points lie off the line that all have in common.
void SurfaceBundle::addSurface(const SharedSurface& shared) {
  const auto& [ax, ay] = shared.direction;
  Piece& piece = pieceFor(shared.seen.size());
  const std::size_t begin = piece.seen.size();
  const auto [weight, middle_m] = addSeen(shared, piece);
  double rotation = 0;
  const double lever_m =
      ax * (shared.centre.x + shared.mean.x) + ay * (shared.centre.y + shared.mean.y) + middle_m;
  for (std::size_t i = begin; i < piece.seen.size(); ++i) {
    Seen& seen = piece.seen[i];
    seen.along_m -= static_cast<float>(middle_m);
    rotation += static_cast<double>(seen.weight) * (seen.along_m * seen.along_m + seen.spread2);
  }
  piece.surfaces.push_back(
      {begin, piece.seen.size(), {-ay, ax}, lever_m, 1 / weight, rotation > 0 ? 1 / rotation : 0});
  pull(piece.surfaces.back(), piece);
}

/// From the mean of them all; how they run goes to lines_. What they weigh, and where they are along the
/// line.
std::pair<double, double> SurfaceBundle::addSeen(const SharedSurface& shared, Piece& piece) {
  const auto& [ax, ay] = shared.direction;
  const double by_variance = 1 / shared.variance, by_kernel2 = by_variance / (kBundleKernel * kBundleKernel);
  double weights = 0, middle_m = 0;
  lines_.clear();
  for (const PointsInCell* s : shared.seen) {
    const double x = s->x / s->n, y = s->y / s->n;
    const double dx = x - shared.mean.x, dy = y - shared.mean.y, off_m = ax * dy - ay * dx;
    const double less = 1 + off_m * off_m * by_kernel2;
    const double weight =
        s->n * by_variance * point_weights_[static_cast<std::size_t>(s->keyframe)] / (less * less);
    const double xx = s->xx / s->n - x * x, xy = s->xy / s->n - x * y, yy = s->yy / s->n - y * y;
    const double spread2 = std::max(ax * ax * xx + 2 * ax * ay * xy + ay * ay * yy, 0.0),
                 rise = ax * ay * (yy - xx) + (ax * ax - ay * ay) * xy;
    const double along_m = ax * dx + ay * dy;
    piece.seen.push_back(
        {s->keyframe, static_cast<float>(weight), static_cast<float>(along_m), static_cast<float>(spread2)});
    lines_.push_back({off_m, spread2 > 0 ? rise / spread2 : 0});
    weights += weight, middle_m += weight * along_m;
  }
  return {weights, middle_m / weights};
}

/// By how far each one's line is off the one that fits them best.
void SurfaceBundle::pull(const Surface& surface, const Piece& piece) {
  const double ax = surface.across.x(), ay = surface.across.y();
  Line common{0, 0};
  for (std::size_t i = surface.begin; i < surface.end; ++i) {
    const auto& [k, weight, along_m, spread2] = piece.seen[i];
    const Line& line = lines_[i - surface.begin];
    common.off_m += weight * line.off_m;
    common.slope += weight * (along_m * line.off_m + spread2 * line.slope);
  }
  common.off_m *= surface.by_weight, common.slope *= surface.by_rotation;
  for (std::size_t i = surface.begin; i < surface.end; ++i) {
    const auto& [k, weight, along_m, spread2] = piece.seen[i];
    const Line& line = lines_[i - surface.begin];
    const double off_m = line.off_m - common.off_m - common.slope * along_m,
                 slope = line.slope - common.slope;
    const double lever_m = surface.lever_m + along_m, pull = weight * off_m, w = weight;
    of(pulls_, k) += Vector3d(pull * ax, pull * ay, pull * lever_m + w * spread2 * slope);
    chi2_ += w * (off_m * off_m + spread2 * slope * slope);
    Told& told = told_[static_cast<std::size_t>(k)];
    told.xx += w * ax * ax, told.xy += w * ax * ay, told.yy += w * ay * ay;
    told.xz += w * lever_m * ax, told.yz += w * lever_m * ay, told.zz += w * (lever_m * lever_m + spread2);
  }
}

void SurfaceBundle::collectTies() {
  const auto& edges = map_.graph().edges();
  std::vector<char> is_odometry(edges.size(), 0);
  by_odometry_.assign(static_cast<std::size_t>(map_.size()), Matrix3d::Zero());
  for (int k = 1; k < map_.size(); ++k) {
    const auto edge = static_cast<std::size_t>(map_.keyframe(k).odometry_edge);
    is_odometry[edge] = 1;
    addTie(edges[edge], 1);
    by_odometry_[static_cast<std::size_t>(k)] =
        scanmatch::turned(edges[edge].information, -map_.pose(k).phi) /
        (scanmatch::kInformationScale * point_variance_);
  }
  weighOdometry();
  for (const auto& loop : map_.loopEdges()) addTie(edges[loop.edge], loop.share);
  // By a match: where surfaces tell more of it, it is not counted again.
  for (const bool surfaces_tell : {false, true}) {
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (!edges[i].on || is_odometry[i] || edges[i].kind != posegraph::EdgeKind::kOdometry) continue;
      if ((map_.mayBeMatchedTo(edges[i].from) && map_.mayBeMatchedTo(edges[i].to)) == surfaces_tell)
        addTie(edges[i], 1 / point_variance_);
    }
    if (!surfaces_tell) measured_ = ties_.size();
  }
  for (std::size_t i = 0; i < measured_; ++i) chi2_ += ties_[i].off.dot(ties_[i].information * ties_[i].off);
}

/// Between parts that have no known place in one another nothing is measured.
void SurfaceBundle::addTie(const posegraph::Edge& edge, double share) {
  if (map_.componentOf(edge.from) != map_.componentOf(edge.to)) return;
  const core::Pose2 &T_from = map_.pose(edge.from), &T = map_.pose(edge.to),
                    expected = T_from * edge.T_from_to;
  ties_.push_back({edge.from,
                   edge.to,
                   share * scanmatch::turned(edge.information, -T.phi),
                   {T.x - expected.x, T.y - expected.y, core::angleDifference(T.phi, expected.phi)}});
}

/// Where surfaces hold a step's end, its error shows: odometry counts as it errs, and not as was assumed.
void SurfaceBundle::weighOdometry() {
  const auto told = toldBySurfaces();
  tracking::StepVariance variance;
  for (const Tie& tie : ties_) {
    const Matrix3d& of_end = told[static_cast<std::size_t>(tie.to)];
    variance.add(tie.off, scanmatch::covarianceOf(of_end + tie.information) * of_end,
                 scanmatch::covarianceOf(tie.information), Matrix3d::Zero(), Matrix3d::Zero());
  }
  for (Tie& tie : ties_)
    tie.information = scanmatch::covarianceOf(variance.of(scanmatch::covarianceOf(tie.information)));
}

}  // namespace slam::bundle
