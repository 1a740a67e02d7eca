#include "libslam/summary/sweep_groups.h"

#include <map>
#include <set>

#include "libslam/sweep/suite.h"

namespace slam::summary {

const std::vector<SweepAxis>& sweepAxes() {
  static const std::vector<SweepAxis> list = {
      {"world", &sweep::PlannedLog::world},       {"robot", &sweep::PlannedLog::robot},
      {"lidar", &sweep::PlannedLog::lidar},       {"odometry", &sweep::PlannedLog::odometry},
      {"strategy", &sweep::PlannedLog::strategy}, {"fault", &sweep::PlannedLog::fault}};
  return list;
}

std::vector<SweepAxis> varyingAxes(const sweep::SweepPlan& plan) {
  std::vector<SweepAxis> list;
  for (const auto& axis : sweepAxes()) {
    std::set<std::string> names;
    for (const auto& log : plan.logs) names.insert(log.*axis.member);
    if (names.size() > 1) list.push_back(axis);
  }
  return list;
}

std::string fullName(const sweep::PlannedRun& run) {
  return sweep::fullName({run.method, run.parameters, {}, {}});
}

std::vector<std::string> methodNames(const sweep::SweepPlan& plan) {
  std::vector<std::string> names;
  std::set<std::string> seen;
  for (const auto& run : plan.runs)
    if (seen.insert(fullName(run)).second) names.push_back(fullName(run));
  return names;
}

std::string settingKey(const sweep::PlannedLog& log) {
  std::string key;
  for (const auto& axis : sweepAxes()) key += log.*axis.member + '\n';
  return key;
}

std::vector<std::size_t> settingsOf(const sweep::SweepPlan& plan, const std::vector<std::size_t>& runs) {
  std::map<std::string, std::size_t> numbers;
  std::vector<std::size_t> settings;
  settings.reserve(runs.size());
  for (const auto run : runs)
    settings.push_back(
        numbers.emplace(settingKey(plan.logs[plan.runs[run].log]), numbers.size()).first->second);
  if (numbers.size() == runs.size()) settings.clear();
  return settings;
}

std::vector<SweepGroup> groupsOf(const sweep::SweepPlan& plan, const std::vector<std::string>& names) {
  std::map<std::string, std::size_t> method_index, group_index;
  for (std::size_t i = 0; i < names.size(); ++i) method_index[names[i]] = i;
  SweepGroup all;
  all.methods.resize(names.size());
  std::vector<SweepGroup> groups;
  for (std::size_t i = 0; i < plan.runs.size(); ++i) {
    const sweep::PlannedLog& log = plan.logs[plan.runs[i].log];
    const auto [it, is_new] = group_index.emplace(settingKey(log), groups.size());
    if (is_new) groups.push_back({&log, std::vector<std::vector<std::size_t>>(names.size())});
    const std::size_t method = method_index.at(fullName(plan.runs[i]));
    groups[it->second].methods[method].push_back(i);
    all.methods[method].push_back(i);
  }
  all.settings = settingsOf(plan, all.methods.front());
  if (groups.size() > 1) groups.insert(groups.begin(), std::move(all));
  return groups;
}

std::vector<table::CellValue> axisCells(const SweepGroup& group, const std::vector<SweepAxis>& axes) {
  std::vector<table::CellValue> cells;
  cells.reserve(axes.size());
  for (const auto& axis : axes) cells.emplace_back(group.log ? group.log->*axis.member : "all");
  return cells;
}

}  // namespace slam::summary
