#include "libslam/calibration/stamp_tally.h"

#include <algorithm>

namespace slam::calibration {
namespace {

constexpr std::size_t kMostStreams = 256;
constexpr std::size_t kMostKept = 4096, kMostNamed = 5;
constexpr double kShortestGap_s = 1, kPeriodsInGap = 10;

bool isLonger(const Gap& a, const Gap& b) {
  return a.length_s > b.length_s;
}

}  // namespace

void StampTally::add(std::optional<double> time_s) {
  ++sums_.count;
  if (!time_s) {
    ++sums_.unstamped;
    return;
  }
  if (!last_s_) sums_.first_s = sums_.last_s = *time_s;
  sums_.first_s = std::min(sums_.first_s, *time_s);
  sums_.last_s = std::max(sums_.last_s, *time_s);
  if (last_s_) {
    const double step_s = *time_s - *last_s_;
    if (step_s == 0) ++sums_.repeated;
    if (step_s > 0) periods_s_.add(step_s);
    if (step_s < 0) {
      ++sums_.backward;
      if (-step_s > sums_.largest_backward_s)
        sums_.largest_backward_s = -step_s, sums_.backward_at_s = *last_s_;
    }
    if (step_s > kShortestGap_s) {
      longest_.push_back({*last_s_, step_s});
      std::push_heap(longest_.begin(), longest_.end(), isLonger);
      if (longest_.size() > kMostKept) {
        std::pop_heap(longest_.begin(), longest_.end(), isLonger);
        longest_.pop_back();
      }
    }
  }
  last_s_ = time_s;
}

StreamFigures StampTally::figures() const {
  StreamFigures figures = sums_;
  figures.median_period_s = periods_s_.median();
  const auto stamped = static_cast<double>(sums_.count - sums_.unstamped);
  if (stamped > 1) figures.mean_period_s = (sums_.last_s - sums_.first_s) / (stamped - 1);
  const double period_s = std::max(figures.median_period_s, figures.mean_period_s);
  for (const Gap& gap : longest_)
    if (gap.length_s > kPeriodsInGap * period_s) figures.gaps.push_back(gap);
  figures.gap_count = figures.gaps.size();
  std::sort(figures.gaps.begin(), figures.gaps.end(), [](const Gap& a, const Gap& b) {
    return a.length_s != b.length_s ? a.length_s > b.length_s : a.from_s < b.from_s;
  });
  if (figures.gaps.size() > kMostNamed) figures.gaps.resize(kMostNamed);
  return figures;
}

void StreamTallies::add(const std::string& kind, const std::string& label, std::optional<double> time_s) {
  auto found = tallies_.find({kind, label});
  if (found == tallies_.end()) {
    const bool has_room = tallies_.size() < kMostStreams;
    found = tallies_
                .try_emplace(has_room ? std::pair(kind, label)
                                      : std::pair<std::string, std::string>("others", ""))
                .first;
  }
  found->second.add(time_s);
}

std::vector<StreamFigures> StreamTallies::figures() const {
  std::vector<StreamFigures> all;
  for (const auto& [key, tally] : tallies_) {
    all.push_back(tally.figures());
    all.back().kind = key.first;
    all.back().label = key.second;
  }
  return all;
}

}  // namespace slam::calibration
