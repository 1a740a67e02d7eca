#include "libslam/sim/carry.h"

#include <algorithm>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/files/word_list.h"

namespace slam::sim {
namespace {

constexpr const char* kNone = "none";

using Where = CarryOrder::Where;

Where whereOf(const std::string& word) {
  const auto place = word.substr(std::min(word.size(), word.find(':')));
  return place == ":random" ? Where::kRandom : place == ":visited" ? Where::kVisited : Where::kGiven;
}

/// "60:12.5,3,90" as its four numbers; none for another form.
std::vector<double> numbersOf(const std::string& word) {
  const auto colon = word.find(':');
  if (colon == std::string::npos) return {};
  auto numbers = files::parseNumberList(word.substr(colon + 1));
  double time_s = 0;
  if (numbers.size() != 3 || !files::parseNumber(word.substr(0, colon), time_s)) return {};
  numbers.insert(numbers.begin(), time_s);
  return numbers;
}

}  // namespace

const files::ParameterTable<EventOptions>& EventOptions::table() {
  using O = EventOptions;
  static const files::ParameterTable<O> rows("events",
                                             {{"carry",
                                               &O::carry,
                                               kNone,
                                               {},
                                               "kidnapped robot: TIME_S:X_M,Y_M,HEADING_DEG in the world "
                                               "frame, or TIME_S:random, or TIME_S:visited for a "
                                               "place where it was before; several by blanks; none"}});
  return rows;
}

EventOptions::EventOptions() {
  table().setDefaults(*this);
}

std::vector<CarryOrder> parseCarries(const std::string& text, const std::string& origin) {
  std::vector<CarryOrder> carries;
  if (files::trimmed(text) == kNone) return carries;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const auto fail = [&](const std::string& expected) {
      throw core::InputError(origin + ": found '" + word + "', expected " + expected);
    };
    const auto where = whereOf(word);
    const auto numbers = numbersOf(where == Where::kGiven ? word : word.substr(0, word.find(':')) + ":0,0,0");
    if (numbers.empty())
      fail("TIME_S:X_M,Y_M,HEADING_DEG, such as 60:12.5,3,90, or TIME_S:random or TIME_S:visited");
    if (!(numbers[0] > 0)) fail("a time above 0: where the robot starts is for 'start' to say");
    carries.push_back(
        {numbers[0], {numbers[1], numbers[2], core::wrapToPi(core::degToRad(numbers[3]))}, origin, where});
  }
  if (carries.empty()) throw core::InputError(origin + ": found nothing, expected events or none");
  std::stable_sort(carries.begin(), carries.end(),
                   [](const CarryOrder& a, const CarryOrder& b) { return a.time_s < b.time_s; });
  for (size_t i = 1; i < carries.size(); ++i)
    if (carries[i].time_s == carries[i - 1].time_s)
      throw core::InputError(origin + ": found two events at " + files::formatNumber(carries[i].time_s) +
                             " s, expected one place for one time");
  return carries;
}

std::vector<CarryOrder> readCarries(const files::IniFile& config,
                                    std::vector<files::ParameterReport>* report) {
  EventOptions options;
  files::readParameters(config, EventOptions::table(), options, report);
  const auto* entry = config.find("events", "carry");
  return parseCarries(options.carry, entry ? entry->origin : "events.carry");
}

void requireBefore(const std::vector<CarryOrder>& carries, double end_s) {
  for (const auto& carry : carries)
    if (carry.time_s >= end_s)
      throw core::InputError(carry.origin + ": found an event at " + files::formatNumber(carry.time_s) +
                             " s, expected one before the end at " + files::formatNumber(end_s) + " s");
}

void DrivenPath::add(const core::Pose2& T_world_robot, const std::vector<Carry>& carries) {
  if (!has_begun_) T_world_last_ = T_world_robot, carries_ = carries.size();
  has_begun_ = true;
  for (; carries_ < carries.size(); ++carries_) {
    length_m_ += core::distance(T_world_last_, carries[carries_].T_world_from);
    T_world_last_ = carries[carries_].T_world_to;
  }
  length_m_ += core::distance(T_world_last_, T_world_robot);
  T_world_last_ = T_world_robot;
}

}  // namespace slam::sim
