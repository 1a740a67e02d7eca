#include "libslam/loops/loop_closer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"

namespace slam::loops {
namespace {

using core::Pose2;

/// Travel to the next search, by the last one's window; never so far that two searches share no scan.
constexpr double kPausePerReach = 0.1, kRivalPause = 2;
/// Keyframes nearer to each other count as this far apart.
constexpr double kLeastDistance_m = 0.1;
/// 95 of 100 right loops have no larger innovation (chi-square, three degrees of freedom). How many times as
/// far others are followed, at most; and those that only a path allows for which is overconfident, up to so
/// many times GraphOptions::loop_innovation, as many times as their innovation is larger: it takes 8 scans
/// at least that all fit.
constexpr double kLikelyInnovation = 7.8, kMostUnlikely = 4, kOverconfident = 2;
/// Beyond that, what claims the same as such a loop is wrong as well: it moves the robot to the same place.
constexpr double kSameClaim_m = 1, kSameClaim_rad = 0.2;

}  // namespace

/// Whether keyframe k by itself fits the old map where the hypothesis puts it; the hypothesis moves on to k
/// then. What of the scan lies beyond the old map neither fits nor fails.
void LoopCloser::confirm(keyframes::Hypothesis& hypothesis, int k) const {
  const Pose2 expected =
      hypothesis.T_map_robot * core::between(map_->pose(hypothesis.keyframe), map_->pose(k));
  std::vector<int> around;
  for (const int old : map_->keyframesAround(hypothesis.old_keyframe, core::position(expected),
                                             options_->map_path_m, options_->map_radius_m)) {
    const bool is_old =
        old < k && map_->keyframe(k).path_m - map_->keyframe(old).path_m > options_->map_path_m / 2;
    if (is_old && static_cast<int>(around.size()) < options_->map_keyframes) around.push_back(old);
  }
  if (around.empty()) {
    hypothesis.says[k] = {0, 1};
    ++hypothesis.failures;
    return;
  }
  const keyframes::LevelMaps& maps = map_->mapOf(around, core::position(expected));
  const auto& points = map_->keyframe(k).points;
  const auto viewers = keyframes::firstOf(around, keyframes::kViewers);
  const auto matched = keyframes::match(points, maps, expected, keyframes::followedTo(expected), 0, false);
  const double conflict = map_->meanConflict(viewers, matched.T_map_robot, points);
  const double unknown =
      1 -
      std::min(map_->toldBy(keyframes::firstOf(around, keyframes::kAskedViewers), points, expected).telling,
               1.0);
  const bool is_there =
      conflict < options_->loop_conflict && keyframes::isFollowed(matched.T_map_robot, expected);
  hypothesis.says[k] = {is_there ? keyframes::kNatsPerScan * (matched.score - conflict) : 0, unknown};
  const double least = map_->adapted(options_->loop_confirm_score);
  if (!is_there || matched.score < least) {
    hypothesis.failures += !is_there || matched.score + unknown < least;
    return;
  }
  hypothesis.evidence += keyframes::distinctness(points, maps, matched);
  map_->addLoopEdges(hypothesis.edges, around, k, matched.T_map_robot, maps.fine);
  hypothesis.keyframe = k, hypothesis.old_keyframe = around.front();
  hypothesis.T_map_robot = matched.T_map_robot;
  ++hypothesis.confirmations;
}

/// As it was when it was asked for first.
double LoopCloser::innovationOf(keyframes::Hypothesis& place, LoopJudge& judge) const {
  if (!(place.innovation >= 0)) place.innovation = judge.innovation(place);
  return place.innovation;
}

/// How many times as far as a likely place one is followed until it is accepted, and by as many more scans.
double LoopCloser::timesAsFar(double innovation) const {
  const bool may_be_right =
      innovation > options_->loop_innovation && innovation <= kOverconfident * options_->loop_innovation;
  return may_be_right ? innovation / kLikelyInnovation
                      : std::min(innovation / kLikelyInnovation, kMostUnlikely);
}

/// Whether a place was followed for long enough that it would be known if another one were as good: the
/// longer, the less likely the way between makes it.
bool LoopCloser::isFollowedEnough(keyframes::Hypothesis& place, LoopJudge& judge) const {
  const double followed_m = map_->path_m() - place.begun_m;
  if (followed_m < options_->loop_confirm_m) return false;
  const bool is_joined = map_->componentOf(place.keyframe) == map_->componentOf(place.old_keyframe);
  if (is_joined) {
    const double unlikely = timesAsFar(innovationOf(place, judge));
    // In a log with few scans a place is soon followed far.
    if (followed_m < options_->loop_confirm_m * unlikely ||
        place.confirmations < options_->loop_confirmations * unlikely)
      return false;
  }
  // So much farther on the robot is well within the map, wherever it came to it.
  return judge.isBest(
      place, hypotheses_,
      followed_m < options_->map_radius_m ? LoopJudge::Beyond::kCounts : LoopJudge::Beyond::kIsNoRival);
}

/// Whether scans enough say that a place is the right one, and that it is unlike its neighbours.
bool LoopCloser::isConfirmed(const keyframes::Hypothesis& place) const {
  return place.confirmations >= options_->loop_confirmations && place.evidence >= options_->loop_distinctness;
}

/// The loop of a place that was followed for long enough, if there is one.
std::optional<LoopCloser::Accepted> LoopCloser::acceptConfirmed() {
  LoopJudge of_places = judge();
  const auto confirmed =
      std::find_if(hypotheses_.begin(), hypotheses_.end(), [&](keyframes::Hypothesis& one) {
        return isConfirmed(one) && isCompared(one) && isFollowedEnough(one, of_places);
      });
  if (confirmed == hypotheses_.end()) return std::nullopt;
  const keyframes::Hypothesis loop = *confirmed;
  hypotheses_.clear();
  return accept(loop, of_places);
}

std::optional<LoopCloser::Accepted> LoopCloser::closeLoops() {
  if (isClosing()) return std::nullopt;
  const int k = map_->lastKeyframe();
  for (size_t i = 0; i < hypotheses_.size();) {
    keyframes::Hypothesis& hypothesis = hypotheses_[i];
    confirm(hypothesis, k);
    if (hypothesis.failures > keyframes::kMostFailures) {
      map_->note(core::JournalEvent::kDropped, hypothesis.confirmations, hypothesis.old_keyframe);
      hypotheses_.erase(hypotheses_.begin() + static_cast<long>(i));
    } else {
      ++i;
    }
  }
  if (const auto accepted = acceptConfirmed()) return accepted;
  if (search_.isUnderWay()) return std::nullopt;
  // A wide search is dear, and what it would find is still there some metres on.
  const double pause_m = std::max(options_->loop_every_m,
                                  std::min(kPausePerReach * search_.reach_m(), options_->loop_path_m / 2));
  // While a place is followed only a rival is still looked for.
  if (map_->path_m() - searched_m_ < (hypotheses_.empty() ? 1 : kRivalPause) * pause_m) return std::nullopt;
  searched_m_ = map_->path_m();
  int first = k;
  while (first > 0 && k - first < keyframes::kMostQueryKeyframes &&
         map_->path_m() - map_->keyframe(first - 1).path_m < options_->loop_path_m)
    --first;
  search_.begin(k, first, k);
  return std::nullopt;
}

std::optional<LoopCloser::Accepted> LoopCloser::continueSearching() {
  const auto accepted = continueSearching(workOfScan());
  scan_m_ = map_->path_m() - scanned_m_;
  scanned_m_ = map_->path_m();
  return accepted;
}

/// A scan that comes far from the one before has the work of as many as keyframes lie between: how late a
/// loop is counts in metres.
double LoopCloser::workOfScan() const {
  const double scans = std::max(1.0, scan_m_ / std::max(options_->keyframe_distance_m, kLeastDistance_m));
  return std::floor(scans * keyframes::kWorkPerUnit * options_->loop_work);
}

std::optional<LoopCloser::Accepted> LoopCloser::completeSearching() {
  return continueSearching(std::numeric_limits<double>::infinity());
}

std::optional<LoopCloser::Accepted> LoopCloser::continueSearching(double work) {
  if (!search_.isUnderWay()) return std::nullopt;
  const auto isKnown = [&](const Pose2& T_map_robot) { return isFollowing(search_.keyframe(), T_map_robot); };
  search_.advance(work, isKnown);
  for (keyframes::Hypothesis& found : search_.take()) follow(found);
  // What was found early may have been confirmed meanwhile.
  return search_.isUnderWay() ? std::nullopt : acceptConfirmed();
}

/// Whether a hypothesis that is followed has the keyframe there.
bool LoopCloser::isFollowing(int keyframe, const Pose2& T_map_robot) const {
  return std::any_of(hypotheses_.begin(), hypotheses_.end(), [&](const keyframes::Hypothesis& known) {
    const Pose2 expected =
        known.T_map_robot * core::between(map_->pose(known.keyframe), map_->pose(keyframe));
    return core::distance(expected, T_map_robot) < 0.5 &&
           std::abs(core::angleDifference(expected.phi, T_map_robot.phi)) < 0.1;
  });
}

/// Whether the search that found a place has looked for others, too.
bool LoopCloser::isCompared(const keyframes::Hypothesis& place) const {
  return !search_.isUnderWay() || place.begun_m < map_->keyframe(search_.keyframe()).path_m;
}

bool LoopCloser::isWhereExpected() {
  constexpr int kLeast = 2;  // one scan may fit by chance
  LoopJudge of_places = judge();
  return std::any_of(hypotheses_.begin(), hypotheses_.end(), [&](keyframes::Hypothesis& place) {
    return place.confirmations >= kLeast &&
           place.keyframe + keyframes::kMostFailures >= map_->lastKeyframe() &&
           map_->componentOf(place.keyframe) == map_->componentOf(place.old_keyframe) &&
           innovationOf(place, of_places) <= kLikelyInnovation;
  });
}

/// A hypothesis about one of the newest keyframes joins those that are followed, unless one of them says the
/// same.
void LoopCloser::follow(keyframes::Hypothesis& found) {
  if (isFollowing(found.keyframe, found.T_map_robot)) return;
  confirm(found, found.keyframe);
  if (found.failures > 0) return;
  for (int k = found.keyframe + 1; k <= map_->lastKeyframe(); ++k) confirm(found, k);
  if (found.failures <= keyframes::kMostFailures) hypotheses_.push_back(found);
}

void LoopCloser::searchRemainingLoops(int first_searched, const std::function<void()>& moved,
                                      core::Progress& progress) {
  hypotheses_.clear();
  search_.giveUp();
  const int n = map_->size();
  double searched_m = -1e9;
  for (int k = first_searched; k < n; ++k) {
    const double at_m = map_->keyframe(k).path_m;
    if (at_m - searched_m < 2 * options_->loop_every_m) continue;
    progress.update(static_cast<double>(k - first_searched) / (n - first_searched),
                    map_->keyframe(k).seen.time_s - map_->keyframe(first_searched).seen.time_s);
    searched_m = at_m;
    int first = k, last = k;
    while (first > 0 && at_m - map_->keyframe(first - 1).path_m < options_->loop_path_m / 2) --first;
    while (last + 1 < n && map_->keyframe(last + 1).path_m - at_m < options_->loop_path_m / 2) ++last;
    search_.begin(k, first, last);
    // Where keyframes lie far apart these are too few to confirm a place.
    first = std::max(std::min(first, k - options_->loop_confirmations), 0);
    last = std::min(std::max(last, k + options_->loop_confirmations), n - 1);
    search_.advance(std::numeric_limits<double>::infinity(), [](const Pose2&) { return false; });
    std::vector<keyframes::Hypothesis> places = search_.take();
    for (keyframes::Hypothesis& forth : places) {
      keyframes::Hypothesis back = forth;
      for (int i = k; i <= last; ++i) confirm(forth, i);
      for (int i = k - 1; i >= first; --i) confirm(back, i);
      forth.confirmations += back.confirmations, forth.evidence += back.evidence;
      forth.says.merge(back.says);
      forth.edges.insert(forth.edges.end(), back.edges.begin(), back.edges.end());
    }
    LoopJudge of_places = judge();
    const auto best = std::find_if(places.begin(), places.end(), [&](const keyframes::Hypothesis& one) {
      return isConfirmed(one) && 2 * one.confirmations >= last - first + 1 &&
             of_places.isBest(one, places, LoopJudge::Beyond::kIsNoRival);
    });
    if (best == places.end() || !accept(*best, of_places)) continue;
    completeClosing();
    moved();
  }
}

/// The innovation of a loop that what was measured on the way rules out; nothing where it allows for it.
std::optional<double> LoopCloser::ruledOutBy(const keyframes::Hypothesis& loop, LoopJudge& judge) {
  if (map_->componentOf(loop.keyframe) != map_->componentOf(loop.old_keyframe)) return std::nullopt;
  const double own = judge.innovation(loop), before = ruledOutBefore(loop), off = std::max(own, before);
  if (off <= kLikelyInnovation) return std::nullopt;
  const bool is_sure = loop.confirmations >= options_->loop_confirmations * off / kLikelyInnovation;
  const double most = (is_sure ? kOverconfident : 1) * options_->loop_innovation;
  if (before == 0 && own > kOverconfident * options_->loop_innovation)
    ruled_out_.push_back({shiftOf(loop), own});
  if (off > most || isKnownHere(loop, off)) return off;
  return std::nullopt;
}

/// How a loop moves the newest part of the map: who moves it likewise elsewhere claims the same.
Pose2 LoopCloser::shiftOf(const keyframes::Hypothesis& loop) const {
  return loop.T_map_robot * core::inverse(map_->pose(loop.keyframe));
}

/// The innovation with which a loop that claims the same was ruled out since the keyframes moved last; 0:
/// none was. A wrong place is found again and again, and somewhere the way to it is less sure.
double LoopCloser::ruledOutBefore(const keyframes::Hypothesis& loop) const {
  double most = 0;
  for (const auto& [shift, innovation] : ruled_out_) {
    const Pose2 there = shift * map_->pose(loop.keyframe);
    if (core::distance(there, loop.T_map_robot) < kSameClaim_m &&
        std::abs(core::angleDifference(there.phi, loop.T_map_robot.phi)) < kSameClaim_rad)
      most = std::max(most, innovation);
  }
  return most;
}

/// Whether the robot may as well be where it is tracked: what an earlier pass drew there explains the scans
/// that speak for the loop, which the way between has in another place. Buildings have corridors that look
/// the same.
bool LoopCloser::isKnownHere(const keyframes::Hypothesis& loop, double innovation) const {
  double ahead = -innovation / 2;
  size_t known = 0;
  for (const auto& [k, said] : loop.says) {
    const Pose2& T = map_->pose(k);
    std::vector<int> before;
    for (const int old :
         map_->keyframesAround(k, core::position(T), options_->map_path_m, options_->map_radius_m))
      if (old < k && map_->keyframe(k).path_m - map_->keyframe(old).path_m > options_->map_path_m)
        before.push_back(old);
    if (before.empty()) continue;
    ++known;
    const keyframes::LevelMaps& maps =
        map_->mapOf(keyframes::firstOf(std::move(before), options_->map_keyframes), core::position(T));
    const auto matched =
        keyframes::match(map_->keyframe(k).points, maps, T, keyframes::followedTo(T), 0, false);
    ahead += said.nats - keyframes::kNatsPerScan * matched.score;
  }
  return 2 * known > loop.says.size() && ahead < kAheadOfRival;
}

std::optional<LoopCloser::Accepted> LoopCloser::accept(const keyframes::Hypothesis& loop) {
  LoopJudge as_it_stands = judge();
  return accept(loop, as_it_stands);
}

std::optional<LoopCloser::Accepted> LoopCloser::accept(const keyframes::Hypothesis& loop, LoopJudge& judge) {
  const int k = loop.keyframe, old = loop.old_keyframe;
  map_->note(core::JournalEvent::kConfirmed, loop.confirmations, old,
             "distinct by " + std::to_string(loop.evidence));
  if (const auto off = ruledOutBy(loop, judge)) {
    map_->note(core::JournalEvent::kRejected, *off, old);
    return std::nullopt;
  }
  const double way_m = map_->pathTo(std::max(k, old))[static_cast<size_t>(std::min(k, old))];
  const int component = map_->componentOf(k), old_component = map_->componentOf(old);
  const bool joins = component != old_component;
  // The one that holds the map's origin stays.
  const bool old_moves = joins && component == 0;
  if (joins) {
    const Pose2 T_map_part = loop.T_map_robot * core::inverse(map_->pose(k));
    const Pose2 T = old_moves ? core::inverse(T_map_part) : T_map_part;
    for (int i = 0; i < map_->size(); ++i)
      if (map_->componentOf(i) == (old_moves ? old_component : component))
        map_->graph().setPose(i, T * map_->pose(i));
    map_->links().measure(map_->graph().poses());
    map_->countRevision();
    ruled_out_.clear();
  }
  map_->addLoop(loop.edges);
  map_->note(core::JournalEvent::kAccepted, way_m, old);
  if (joins) {
    const bool was_cut_off = map_->isCutOff(map_->lastKeyframe());
    map_->joinComponents(component, old_component);
    const bool is_back = was_cut_off && !map_->isCutOff(map_->lastKeyframe());
    map_->note(is_back ? core::JournalEvent::kRecovered : core::JournalEvent::kJoined,
               is_back ? loop.evidence : way_m, old);
  }
  beginClosing(loop, joins);
  return Accepted{old, k, joins};
}

void LoopCloser::forget() {
  searched_m_ = scanned_m_ = map_->path_m();
  hypotheses_.clear();
  search_.giveUp();
}

LoopJudge LoopCloser::judge() const {
  return LoopJudge(map_->graph().poses(), map_->keyframes(), [this](int a, int b) {
    return keyframes::wayCovariance(map_->errorsOf(a), map_->pose(a), map_->errorsOf(b), map_->pose(b));
  });
}

}  // namespace slam::loops
