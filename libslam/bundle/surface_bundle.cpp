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
      pulls_(static_cast<std::size_t>(map.size()), Vector3d::Zero()) {
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
  const core::Point2& mean = shared.mean;
  Piece& piece = pieceFor(shared.seen.size());
  Surface surface{piece.seen.size(), piece.seen.size() + shared.seen.size(), {-ay, ax}, 0, 0, 0};
  std::vector<Line> lines;
  double middle_m = 0;
  for (const PointsInCell* s : shared.seen) {
    const double x = s->x / s->n, y = s->y / s->n, off_m = ax * (y - mean.y) - ay * (x - mean.x);
    const double hold = 1 / (1 + off_m * off_m / (shared.variance * kBundleKernel * kBundleKernel));
    const double points_err = map_.keyframe(s->keyframe).inherited.points_err;
    const double weight = s->n * hold * hold / (shared.variance * point_variance_ * points_err * points_err);
    const double xx = s->xx / s->n - x * x, xy = s->xy / s->n - x * y, yy = s->yy / s->n - y * y;
    const double spread2 = std::max(ax * ax * xx + 2 * ax * ay * xy + ay * ay * yy, 0.0),
                 rise = ax * ay * (yy - xx) + (ax * ax - ay * ay) * xy,
                 along_m = ax * (x - mean.x) + ay * (y - mean.y);
    piece.seen.push_back(
        {s->keyframe, static_cast<float>(weight), static_cast<float>(along_m), static_cast<float>(spread2)});
    lines.push_back({off_m, spread2 > 0 ? rise / spread2 : 0});
    surface.weight += weight, middle_m += weight * along_m;
  }
  middle_m /= surface.weight;
  surface.lever_m = ax * (shared.centre.x + mean.x) + ay * (shared.centre.y + mean.y) + middle_m;
  for (std::size_t i = surface.begin; i < surface.end; ++i) {
    Seen& seen = piece.seen[i];
    seen.along_m -= static_cast<float>(middle_m);
    surface.rotation += static_cast<double>(seen.weight) * (seen.along_m * seen.along_m + seen.spread2);
  }
  const Line common = lineOf(surface, piece, [&](std::size_t i) { return lines[i - surface.begin]; });
  for (std::size_t i = surface.begin; i < surface.end; ++i) {
    const Seen& seen = piece.seen[i];
    const Line& line = lines[i - surface.begin];
    const Line off{line.off_m - common.off_m - common.slope * seen.along_m, line.slope - common.slope};
    of(pulls_, seen.keyframe) += pullOf(surface, seen, off);
    chi2_ += seen.weight * (off.off_m * off.off_m + seen.spread2 * off.slope * off.slope);
  }
  piece.surfaces.push_back(surface);
}

void SurfaceBundle::collectTies() {
  const auto& edges = map_.graph().edges();
  std::vector<char> is_odometry(edges.size(), 0);
  by_odometry_.assign(static_cast<std::size_t>(map_.size()), Matrix3d::Zero());
  for (int k = 1; k < map_.size(); ++k) {
    const auto edge = static_cast<std::size_t>(map_.keyframe(k).odometry_edge);
    is_odometry[edge] = 1;
    addTie(edges[edge], 1, true);
    by_odometry_[static_cast<std::size_t>(k)] =
        scanmatch::turned(edges[edge].information, -map_.pose(k).phi) /
        (scanmatch::kInformationScale * point_variance_);
  }
  weighOdometry();
  for (const auto& loop : map_.loopEdges()) addTie(edges[loop.edge], loop.share, true);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!edges[i].on || is_odometry[i] || edges[i].kind != posegraph::EdgeKind::kOdometry) continue;
    const bool surfaces_tell = map_.mayBeMatchedTo(edges[i].from) && map_.mayBeMatchedTo(edges[i].to);
    addTie(edges[i], 1 / point_variance_, !surfaces_tell);
  }
  for (const Tie& tie : ties_)
    if (tie.is_measured) chi2_ += tie.off.dot(tie.information * tie.off);
}

/// Between parts that have no known place in one another nothing is measured.
void SurfaceBundle::addTie(const posegraph::Edge& edge, double share, bool is_measured) {
  if (map_.componentOf(edge.from) != map_.componentOf(edge.to)) return;
  const core::Pose2 &T_from = map_.pose(edge.from), &T = map_.pose(edge.to),
                    expected = T_from * edge.T_from_to;
  ties_.push_back({edge.from,
                   edge.to,
                   share * scanmatch::turned(edge.information, -T.phi),
                   {T.x - expected.x, T.y - expected.y, core::angleDifference(T.phi, expected.phi)},
                   is_measured});
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
