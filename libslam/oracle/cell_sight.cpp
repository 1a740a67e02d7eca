#include "libslam/oracle/cell_sight.h"

#include <limits>
#include <list>

namespace slam::oracle {
namespace {

struct Corner {
  int x, y;
};

/// A directed line; `above` and `below` as seen along it.
struct Line {
  Corner near, far;
  std::int64_t side(const Corner& p) const {
    return static_cast<std::int64_t>(far.y - near.y) * (far.x - p.x) -
           static_cast<std::int64_t>(far.y - p.y) * (far.x - near.x);
  }
  bool isBelow(const Corner& p) const { return side(p) > 0; }
  bool isBelowOrOn(const Corner& p) const { return side(p) >= 0; }
  bool isAbove(const Corner& p) const { return side(p) < 0; }
  bool isAboveOrOn(const Corner& p) const { return side(p) <= 0; }
  bool holds(const Corner& p) const { return side(p) == 0; }
};

/// The lines of sight between two obstacles: none shallower, none steeper.
struct Beam {
  Line shallow, steep;
  std::vector<Corner> below, above;  ///< corners of obstacles that bound it

  void addBelow(const Corner& p) {
    shallow.far = p;
    below.push_back(p);
    for (auto q = above.rbegin(); q != above.rend(); ++q)  // the latest first
      if (shallow.isAbove(*q)) shallow.near = *q;
  }
  void addAbove(const Corner& p) {
    steep.far = p;
    above.push_back(p);
    for (auto q = below.rbegin(); q != below.rend(); ++q)
      if (steep.isBelow(*q)) steep.near = *q;
  }
  bool isEmpty() const {
    return shallow.holds(steep.near) && shallow.holds(steep.far) &&
           (shallow.holds({0, 1}) || shallow.holds({1, 0}));
  }
};
using Beams = std::list<Beam>;

/// One quadrant: cells (x, y) with x, y >= 0 from the looking one, mirrored by dx and dy.
class Quadrant {
 public:
  Quadrant(const world::Plan& plan, int column, int row, int dx, int dy, double range_cells,
           const std::function<bool(std::size_t)>& visit)
      : plan_(plan),
        column_(column),
        row_(row),
        dx_(dx),
        dy_(dy),
        range_(range_cells > 0 ? range_cells : std::numeric_limits<double>::infinity()),
        visit_(visit) {}

  /// False when the visitor has ended it.
  bool look() {
    const int across = dx_ > 0 ? plan_.columns - 1 - column_ : column_;
    const int up = dy_ > 0 ? plan_.rows - 1 - row_ : row_;
    const int far = plan_.columns + plan_.rows + 2;
    beams_.push_back({{{0, 1}, {far, 0}}, {{1, 0}, {0, far}}, {}, {}});
    for (int i = 1; i <= across + up && !beams_.empty(); ++i) {
      auto beam = beams_.begin();
      for (int y = std::max(0, i - across); y <= std::min(i, up) && beam != beams_.end(); ++y)
        if (!enter(i - y, y, beam)) return false;
    }
    return true;
  }

 private:
  bool enter(int x, int y, Beams::iterator& beam) {
    const Corner top_left{x, y + 1}, bottom_right{x + 1, y};
    while (beam != beams_.end() && beam->steep.isBelowOrOn(bottom_right)) ++beam;
    if (beam == beams_.end() || beam->shallow.isAboveOrOn(top_left)) return true;
    const auto cell = static_cast<std::size_t>(row_ + dy_ * y) * static_cast<std::size_t>(plan_.columns) +
                      static_cast<std::size_t>(column_ + dx_ * x);
    const double gap_x = std::max(0, x - 1), gap_y = std::max(0, y - 1);
    const bool is_far = gap_x * gap_x + gap_y * gap_y > range_ * range_;
    if (!is_far && plan_.cells[cell] != world::Cell::kOccupied) return visit_(cell);
    block(top_left, bottom_right, beam);
    return true;
  }

  /// An obstacle (what lies out of range is one) takes its part of the lines.
  void block(const Corner& top_left, const Corner& bottom_right, Beams::iterator& beam) {
    const bool cuts_shallow = beam->shallow.isAbove(bottom_right), cuts_steep = beam->steep.isBelow(top_left);
    if (cuts_shallow && cuts_steep) {
      beam = beams_.erase(beam);
    } else if (cuts_shallow) {
      beam->addBelow(top_left);
      drop(beam);
    } else if (cuts_steep) {
      beam->addAbove(bottom_right);
      drop(beam);
    } else {
      auto lower = beams_.insert(beam, *beam);
      beam->addBelow(top_left);
      drop(beam);
      lower->addAbove(bottom_right);
      if (lower->isEmpty()) beams_.erase(lower);
    }
  }
  void drop(Beams::iterator& beam) {
    if (beam->isEmpty()) beam = beams_.erase(beam);
  }

  const world::Plan& plan_;
  int column_, row_, dx_, dy_;
  double range_;
  const std::function<bool(std::size_t)>& visit_;
  Beams beams_;
};

}  // namespace

void visitSeeing(const world::Plan& plan, const Block& block, double range_cells,
                 const std::function<bool(std::size_t)>& visit) {
  for (int row = block.row; row < block.row + block.side; ++row)
    for (int column = block.column; column < block.column + block.side; ++column)
      if (plan.contains(column, row) && plan.at(column, row) != world::Cell::kOccupied &&
          !visit(static_cast<std::size_t>(row) * static_cast<std::size_t>(plan.columns) +
                 static_cast<std::size_t>(column)))
        return;
  // A line that leaves the block leaves it through a cell of its rim.
  const int last = block.side - 1;
  for (int y = 0; y < block.side; ++y)
    for (int x = 0; x < block.side; ++x) {
      const int column = block.column + x, row = block.row + y;
      if ((x > 0 && x < last && y > 0 && y < last) || !plan.contains(column, row)) continue;
      for (const int dx : {1, -1})
        for (const int dy : {1, -1})
          if (!Quadrant(plan, column, row, dx, dy, range_cells, visit).look()) return;
    }
}

}  // namespace slam::oracle
