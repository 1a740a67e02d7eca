#include "libslam/oracle/moats.h"
#include "libslam/core/numbers.h"

#include <algorithm>
#include <numeric>

namespace slam::oracle {
namespace {

using core::kInfinity;
constexpr double kTight = 1e-9;

/// Grows the y of all sets that still may, at one pace, joins sets when the way between them is paid for, and
/// stops those whose area is.
class Growth {
 public:
  Growth(const Places& places, double lambda) : places_(places), count_(places.area.size()) {
    set_of_.resize(count_);
    std::iota(set_of_.begin(), set_of_.end(), std::size_t{0});
    load_.assign(count_, 0);
    grows_.assign(count_, 1);
    left_.resize(count_);
    for (std::size_t i = 0; i < count_; ++i) left_[i] = lambda * places.area[i] / 2;
  }

  /// 2 sum y - the largest load.
  double value() {
    while (step()) {
    }
    const double most = count_ ? *std::max_element(load_.begin(), load_.end()) : 0;
    return 2 * total_ - most;
  }

 private:
  double rate(std::size_t i) const { return grows_[set_of_[i]] ? 1 : 0; }

  bool step() {
    double wait = kInfinity;
    std::size_t a = count_, b = count_;  // what is joined; b = count_: with the start
    std::size_t spent = count_;
    for (std::size_t set = 0; set < count_; ++set)
      if (grows_[set] && left_[set] < wait) wait = left_[set], spent = set;
    for (std::size_t i = 0; i < count_; ++i) {
      if (rate(i) == 0) continue;
      if (const double slack = places_.from_start[i] - load_[i]; slack < wait)
        wait = slack, a = i, b = count_, spent = count_;
      for (std::size_t j = 0; j < count_; ++j) {
        if (set_of_[i] == set_of_[j]) continue;
        const double slack = (places_.between[i][j] - load_[i] - load_[j]) / (rate(i) + rate(j));
        if (slack < wait) wait = slack, a = i, b = j, spent = count_;
      }
    }
    if (wait == kInfinity) return false;
    wait = std::max(0.0, wait);
    for (std::size_t i = 0; i < count_; ++i)
      if (rate(i) > 0) load_[i] += wait;
    for (std::size_t set = 0; set < count_; ++set)
      if (grows_[set]) left_[set] -= wait, total_ += wait;
    if (spent < count_) {
      grows_[spent] = 0;
    } else if (b == count_) {
      grows_[set_of_[a]] = 0;  // the start is in none
    } else {
      join(set_of_[a], set_of_[b]);
    }
    return true;
  }

  void join(std::size_t to, std::size_t from) {
    // With one that has met the start, or that has nothing left itself, the sum of what is left decides.
    const bool meets_start = isHome(to) || isHome(from);
    left_[to] += left_[from];
    grows_[from] = 0;
    grows_[to] = !meets_start && left_[to] > kTight;
    for (auto& set : set_of_)
      if (set == from) set = to;
    if (meets_start) home_.push_back(to);
  }
  bool isHome(std::size_t set) const {
    if (std::find(home_.begin(), home_.end(), set) != home_.end()) return true;
    for (std::size_t i = 0; i < count_; ++i)
      if (set_of_[i] == set && places_.from_start[i] - load_[i] <= kTight) return true;
    return false;
  }

  const Places& places_;
  std::size_t count_;
  std::vector<std::size_t> set_of_;
  std::vector<double> load_, left_;  ///< per group; per set, what its area still pays for
  std::vector<char> grows_;
  std::vector<std::size_t> home_;  ///< sets that have met the start
  double total_ = 0;
};

}  // namespace

double moatBound(const Places& places, double spare) {
  double best = 0;
  const double area = std::accumulate(places.area.begin(), places.area.end(), 0.0);
  if (!(area > spare)) return best;
  // From a metre to ten million for all of the area.
  double lambda = 1 / area;
  for (int i = 0; i < 56; ++i, lambda *= 4.0 / 3)
    best = std::max(best, Growth(places, lambda).value() - lambda * spare);
  return best;
}

}  // namespace slam::oracle
