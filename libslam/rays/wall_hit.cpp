#include "libslam/rays/wall_hit.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/rays/ray_walk.h"

namespace slam::rays {
namespace {

constexpr int kReach = 40;  // faces

struct Step {
  int x = 0, y = 0;
};
Step operator+(const Step& a, const Step& b) {
  return {a.x + b.x, a.y + b.y};
}
Step operator-(const Step& a) {
  return {-a.x, -a.y};
}
bool operator==(const Step& a, const Step& b) {
  return a.x == b.x && a.y == b.y;
}

core::Point2 asPoint(const Step& step) {
  return {static_cast<double>(step.x), static_cast<double>(step.y)};
}

world::Material materialOf(const world::Plan& plan, size_t index) {
  return plan.materials.empty() ? world::Material::kPlain : plan.materials[index];
}

/// Walks along the contour of a wall, face by face.
class Contour {
 public:
  /// At the face of `cell` with outward normal `face`, looking along `heading`.
  Contour(const world::Plan& plan, Step cell, Step face, Step heading)
      : plan_(plan), cell_(cell), face_(face), heading_(heading), material_(materialAt(cell)) {}

  const Step& heading() const { return heading_; }
  /// To the next face; false where the wall's material ends.
  bool advance() {
    const Step ahead = cell_ + heading_, over = ahead + face_;
    if (isWall(over)) {  // a concave corner
      cell_ = over;
      turnTo(face_, -heading_);
    } else if (isWall(ahead)) {
      cell_ = ahead;
    } else {  // a convex corner
      turnTo(-face_, heading_);
    }
    return materialAt(cell_) == material_;
  }

 private:
  bool isWall(const Step& cell) const {
    return plan_.contains(cell.x, cell.y) && plan_.at(cell.x, cell.y) == world::Cell::kOccupied;
  }
  world::Material materialAt(const Step& cell) const {
    return materialOf(plan_, static_cast<size_t>(cell.y) * plan_.columns + cell.x);
  }
  void turnTo(Step heading, Step face) {
    heading_ = heading;
    face_ = face;
  }

  const world::Plan& plan_;
  Step cell_, face_, heading_;
  world::Material material_;
};

/// Faces in one direction.
struct Run {
  Step heading;
  int faces;
};

/// The runs from the face that was hit on, that one in the first; headings as walked.
std::vector<Run> runsAlong(Contour contour) {
  std::vector<Run> runs = {{contour.heading(), 1}};
  for (int i = 0; i < kReach && contour.advance(); ++i) {
    if (contour.heading() == runs.back().heading)
      ++runs.back().faces;
    else
      runs.push_back({contour.heading(), 1});
  }
  return runs;
}

bool isAcross(const Run& a, const Run& b) {
  return (a.heading.x == 0) != (b.heading.x == 0);
}

/// The digital straight line around a run: runs of two headings by turns, of which one has single faces only.
class Staircase {
 public:
  /// `ahead` and `behind` begin with parts of the same run, which share the face that was hit.
  Staircase(const std::vector<Run>& ahead, std::vector<Run> behind) {
    for (Run& run : behind) run.heading = -run.heading;
    middle_ = ahead.front();
    middle_.faces += behind.front().faces - 1;
    runs_ = {middle_};
    if (middle_.faces > 1) long_ = middle_;
    bool grows_ahead = true, grows_behind = true;
    for (size_t i = 1; grows_ahead || grows_behind; ++i) {
      grows_ahead = grows_ahead && i < ahead.size() && fits(ahead[i]);
      if (grows_ahead) runs_.push_back(ahead[i]);
      grows_behind = grows_behind && i < behind.size() && fits(behind[i]);
      if (grows_behind) runs_.insert(runs_.begin(), behind[i]);
    }
    if (long_.faces == 0) long_ = middle_;
  }

  /// Along the line, in cells, as walked ahead.
  core::Point2 direction() const {
    const auto isStep = [&](const Run& run) { return isAcross(run, long_); };
    const auto first = std::find_if(runs_.begin(), runs_.end(), isStep);
    if (first == runs_.end()) return asPoint(long_.heading);
    const auto last = std::find_if(runs_.rbegin(), runs_.rend(), isStep).base() - 1;
    const bool is_lone = first == last;
    const bool is_at_end = first == runs_.begin() || first + 1 == runs_.end();
    if (is_lone && is_at_end) return asPoint(middle_.heading);
    double along = 0, across = 0;
    if (is_lone) {
      along = 0.5 * ((first - 1)->faces + (first + 1)->faces);
      across = 1;
    }
    for (auto run = first; run != last; ++run) (isStep(*run) ? across : along) += run->faces;
    return {along * long_.heading.x + across * first->heading.x,
            along * long_.heading.y + across * first->heading.y};
  }

 private:
  bool fits(const Run& run) {
    for (const Run& other : runs_) {
      const bool turns_back = !isAcross(run, other) && !(run.heading == other.heading);
      if (turns_back) return false;
    }
    if (run.faces == 1) return true;
    if (long_.faces == 0) long_ = run;
    return !isAcross(run, long_);
  }

  std::vector<Run> runs_;
  Run middle_;
  Run long_{{}, 0};  ///< any run of the heading that may have more than one face
};

}  // namespace

std::optional<WallHit> findWall(const world::Plan& plan, const core::Point2& origin_world, double angle_rad) {
  using core::kInfinity;
  std::optional<WallHit> hit;
  const world::Cell* before = nullptr;
  walkRay(plan, world::pointToCells(plan, origin_world), rayDirection(plan, angle_rad), kInfinity,
          [&](const world::Cell* cell, const RayEntry& entry) {
            const auto index = static_cast<size_t>(cell - plan.cells.data());
            const world::Material material =
                *cell == world::Cell::kOccupied ? materialOf(plan, index) : world::Material::kPlain;
            if (hit) {
              if (*cell == world::Cell::kOccupied && material == hit->material) return true;
              hit->leaves_m = entry.distance() * plan.resolution_m;
              return false;
            }
            if (*cell == world::Cell::kOccupied) {
              const auto step = before ? cell - before : 0;
              const int row_step = std::abs(step) > 1 || plan.columns == 1 ? (step > 0) - (step < 0) : 0;
              const int column_step = row_step == 0 ? static_cast<int>(step) : 0;
              hit = WallHit{entry.distance() * plan.resolution_m,
                            kInfinity,
                            static_cast<int>(index % static_cast<size_t>(plan.columns)),
                            static_cast<int>(index / static_cast<size_t>(plan.columns)),
                            -column_step,
                            -row_step,
                            material};
            }
            before = cell;
            return true;
          });
  return hit;
}

bool isPlainAt(const world::Plan& plan, const core::Point2& p_world) {
  constexpr double kNear = 1e-3;
  if (plan.materials.empty()) return true;
  const core::Point2 p = world::pointToCells(plan, p_world);
  const auto clampedTo = [](double cell, int size) {
    return static_cast<int>(std::clamp(std::floor(cell), 0.0, size - 1.0));
  };
  for (int row = clampedTo(p.y - kNear, plan.rows); row <= clampedTo(p.y + kNear, plan.rows); ++row)
    for (int column = clampedTo(p.x - kNear, plan.columns); column <= clampedTo(p.x + kNear, plan.columns);
         ++column)
      if (materialOf(plan, static_cast<size_t>(row) * plan.columns + column) != world::Material::kPlain)
        return false;
  return true;
}

Surface surfaceAt(const world::Plan& plan, const WallHit& hit) {
  const Step cell{hit.column, hit.row}, face{hit.face_x, hit.face_y}, heading{-face.y, face.x};
  if (face == Step{}) throw core::ContractError("surfaceAt: the hit has no face");
  const Staircase stairs(runsAlong({plan, cell, face, heading}), runsAlong({plan, cell, face, -heading}));
  const core::Point2 tangent = stairs.direction();
  // As walked along +90 degrees of the normal, the free side lies to the right.
  const double length = core::hypot(tangent.x, tangent.y);
  const core::Point2 normal{tangent.y / length, -tangent.x / length};
  const bool on_axis = normal.x == 0 || normal.y == 0;
  const core::Pose2 T_world_axes{0, 0, plan.T_frame_raster.phi};
  return {T_world_axes * normal, on_axis ? 0 : 1.5 * plan.resolution_m};
}

}  // namespace slam::rays
