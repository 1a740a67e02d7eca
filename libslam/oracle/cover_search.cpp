#include "libslam/oracle/cover_search.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>

#include "libslam/core/elementary.h"
#include "libslam/core/random.h"

namespace slam::oracle {

/// How far chance moves the choice of a view.
class Chance {
 public:
  explicit Chance(core::RandomStream& random) : random_(random) {}
  double factor() { return 1 + 0.3 * random_.uniform(); }

 private:
  core::RandomStream& random_;
};

namespace {

constexpr double kCostOfStop_m = 0.1;  // so that a view without a detour is not worth everything
constexpr std::size_t kMostRemoved = 5;
constexpr double kWarm_m = 1.0, kCold_m = 0.02;  // simulated annealing

std::size_t newIn(const SampleSet& seen, const SampleSet& cover) {
  std::size_t count = 0;
  for (std::size_t w = 0; w < seen.size(); ++w) count += std::bitset<64>(seen[w] & ~cover[w]).count();
  return count;
}

}  // namespace

CoverSearch::CoverSearch(const DriveGraph& graph, const Views& views) : graph_(graph), views_(views) {
  const std::size_t count = views.node.size();
  leg_m_.assign(count * count, 0);
  leg_seen_.resize(count * count);
  for (std::size_t a = 0; a < count; ++a) {
    ways_.push_back(graph.waysFrom(views.node[a]));
    for (std::size_t b = 0; b < count; ++b)
      leg_m_[a * count + b] = ways_.back().length_m[static_cast<std::size_t>(views.node[b])];
    ways_.back().length_m = {};
  }
}

const SampleSet& CoverSearch::legSeen(std::int32_t a, std::int32_t b) const {
  const auto from = static_cast<std::size_t>(std::min(a, b)), to = static_cast<std::size_t>(std::max(a, b));
  SampleSet& seen = leg_seen_[from * views_.node.size() + to];
  if (!seen.empty()) return seen;
  seen = views_.seen[from];
  std::int32_t last = static_cast<std::int32_t>(from);
  const auto add = [&](std::int32_t view) {
    if (view == last) return;
    last = view;
    const SampleSet& more = views_.seen[static_cast<std::size_t>(view)];
    for (std::size_t w = 0; w < seen.size(); ++w) seen[w] |= more[w];
  };
  for (const auto node : graph_.way(ways_[from], views_.node[to]))
    add(views_.near[static_cast<std::size_t>(node)]);
  add(static_cast<std::int32_t>(to));
  return seen;
}

double CoverSearch::length(const Tour& tour) const {
  double length_m = 0;
  for (std::size_t i = 1; i < tour.size(); ++i) length_m += static_cast<double>(leg(tour[i - 1], tour[i]));
  return length_m;
}

SampleSet CoverSearch::coverOf(const Tour& tour) const {
  SampleSet cover = views_.seen.front();
  for (std::size_t i = 1; i < tour.size(); ++i) {
    const SampleSet& seen = legSeen(tour[i - 1], tour[i]);
    for (std::size_t w = 0; w < cover.size(); ++w) cover[w] |= seen[w];
  }
  return cover;
}

std::size_t CoverSearch::seenBy(const Tour& tour) const {
  return countOf(coverOf(tour));
}

void CoverSearch::mend(Tour& tour, std::size_t samples, Chance& chance) const {
  SampleSet cover = coverOf(tour);
  while (countOf(cover) < samples) {
    const std::size_t missing = samples - countOf(cover);
    double most = 0;
    std::int32_t best = -1;
    std::size_t best_at = 0;
    for (std::int32_t v = 1; v < static_cast<std::int32_t>(views_.node.size()); ++v) {
      // More than what is missing is worth nothing.
      const std::size_t gain = std::min(missing, newIn(views_.seen[static_cast<std::size_t>(v)], cover));
      if (gain == 0) continue;
      float detour_m = leg(tour.back(), v);
      std::size_t at = tour.size();
      for (std::size_t i = 1; i < tour.size(); ++i) {
        const float more_m = leg(tour[i - 1], v) + leg(v, tour[i]) - leg(tour[i - 1], tour[i]);
        if (more_m < detour_m) detour_m = more_m, at = i;
      }
      const double worth =
          static_cast<double>(gain) / (static_cast<double>(detour_m) + kCostOfStop_m) * chance.factor();
      if (worth > most) most = worth, best = v, best_at = at;
    }
    if (best < 0) return;
    tour.insert(tour.begin() + static_cast<std::ptrdiff_t>(best_at), best);
    cover = coverOf(tour);
  }
}

void CoverSearch::prune(Tour& tour, std::size_t samples) const {
  while (tour.size() > 1) {
    double most_m = -1;
    std::size_t worst = 0;
    for (std::size_t i = 1; i < tour.size(); ++i) {
      const bool last = i + 1 == tour.size();
      const double saved_m =
          static_cast<double>(leg(tour[i - 1], tour[i])) +
          (last ? 0.0 : static_cast<double>(leg(tour[i], tour[i + 1]) - leg(tour[i - 1], tour[i + 1])));
      if (saved_m <= most_m) continue;
      Tour without = tour;
      without.erase(without.begin() + static_cast<std::ptrdiff_t>(i));
      if (seenBy(without) >= samples) most_m = saved_m, worst = i;
    }
    if (worst == 0) return;
    tour.erase(tour.begin() + static_cast<std::ptrdiff_t>(worst));
  }
}

/// 2-opt and Or-opt for a tour with a fixed begin and a free end, until neither helps.
void CoverSearch::shorten(Tour& tour) const {
  const std::size_t n = tour.size();
  const auto at = [&](const Tour& t, std::size_t i, std::size_t j) {
    return j < n ? static_cast<double>(leg(t[i], t[j])) : 0.0;
  };
  for (bool better = true; better;) {
    better = false;
    for (std::size_t i = 1; i + 1 < n; ++i)
      for (std::size_t j = i + 1; j < n; ++j) {
        const double saved_m =
            at(tour, i - 1, i) + at(tour, j, j + 1) - at(tour, i - 1, j) - at(tour, i, j + 1);
        if (saved_m < 1e-4) continue;
        std::reverse(tour.begin() + static_cast<std::ptrdiff_t>(i),
                     tour.begin() + static_cast<std::ptrdiff_t>(j) + 1);
        better = true;
      }
    for (std::size_t many = 1; many <= 3; ++many)
      for (std::size_t i = 1; i + many <= n; ++i) {
        Tour rest = tour;
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i),
                   rest.begin() + static_cast<std::ptrdiff_t>(i + many));
        double best_m = length(tour) - 1e-4;
        Tour best;
        for (std::size_t to = 1; to <= rest.size(); ++to)
          for (const bool turned : {false, true}) {
            Tour moved = rest;
            std::vector<std::int32_t> part(tour.begin() + static_cast<std::ptrdiff_t>(i),
                                           tour.begin() + static_cast<std::ptrdiff_t>(i + many));
            if (turned) std::reverse(part.begin(), part.end());
            moved.insert(moved.begin() + static_cast<std::ptrdiff_t>(to), part.begin(), part.end());
            const double length_m = length(moved);
            if (length_m < best_m) best_m = length_m, best = std::move(moved);
          }
        if (best.empty()) continue;
        tour = std::move(best);
        better = true;
      }
  }
}

CoverSearch::Tour CoverSearch::search(std::size_t samples, int rounds, const std::function<void()>& go_on) {
  core::RandomStream random(1, "oracle");
  Chance chance(random);
  SampleSet all(views_.seen.front().size(), 0);
  for (std::size_t v = 0; v < views_.seen.size(); ++v)
    if (std::isfinite(leg(0, static_cast<std::int32_t>(v))))
      for (std::size_t w = 0; w < all.size(); ++w) all[w] |= views_.seen[v][w];
  samples = std::min(samples, countOf(all));
  const auto settle = [&](Tour& tour) {
    mend(tour, samples, chance);
    shorten(tour);
    mend(tour, samples, chance);
    prune(tour, samples);
  };
  Tour tour = {0};
  settle(tour);
  Tour best = tour;
  double length_m = length(tour), best_m = length_m;
  for (int round = 0; round < rounds && best.size() > 1; ++round) {
    if (round % 16 == 0) go_on();
    Tour trial = tour;
    const std::size_t many = std::min<std::size_t>(1 + random.below(kMostRemoved), trial.size() - 1);
    const std::size_t first = 1 + random.below(trial.size() - many);
    trial.erase(trial.begin() + static_cast<std::ptrdiff_t>(first),
                trial.begin() + static_cast<std::ptrdiff_t>(first + many));
    settle(trial);
    const double trial_m = length(trial);
    const double heat_m = kWarm_m * core::pow(kCold_m / kWarm_m, static_cast<double>(round) / rounds);
    if (trial_m >= length_m && random.uniform() >= core::exp((length_m - trial_m) / heat_m)) continue;
    tour = trial;
    length_m = trial_m;
    if (trial_m < best_m) best = std::move(trial), best_m = trial_m;
  }
  return best;
}

std::vector<core::Point2> CoverSearch::path(const Tour& tour) const {
  std::vector<core::Point2> path;
  for (std::size_t i = 1; i < tour.size(); ++i) {
    const auto way = graph_.way(ways_[static_cast<std::size_t>(tour[i - 1])],
                                views_.node[static_cast<std::size_t>(tour[i])]);
    if (path.empty()) path.push_back(graph_.pointOf(way.front()));
    for (std::size_t here = 0; here + 1 < way.size();) {
      std::size_t next = here + 1;
      while (next + 1 < way.size() &&
             graph_.seesStraight(graph_.pointOf(way[here]), graph_.pointOf(way[next + 1])))
        ++next;
      path.push_back(graph_.pointOf(way[next]));
      here = next;
    }
  }
  if (path.empty()) path.push_back(graph_.pointOf(views_.node.front()));
  return path;
}

}  // namespace slam::oracle
