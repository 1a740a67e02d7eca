#include "libslam/learn/recipes.h"

#include <cstdio>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/record/generated_world.h"

namespace slam::learn {
namespace {

struct Entry {
  const char* name;
  Recipe recipe;
};
constexpr Entry kRecipes[] = {{"standing_lidar", standingLidar},
                              {"heading_drift", headingDrift},
                              {"scan_difference", scanDifference},
                              {"bad_wheels", badWheels},
                              {"grid_cell", gridCell},
                              {"particle_weights", particleWeights},
                              {"pose_graph", poseGraph},
                              {"matcher_errors", matcherErrors},
                              {"only_plan", onlyPlan},
                              {"claimed_methods", claimedMethods}};

files::IniFile sectionsOf(const files::IniFile& ini, const std::vector<std::string>& names) {
  files::IniFile result;
  for (const auto& name : names)
    if (const auto section = ini.sections().find(name); section != ini.sections().end())
      for (const auto& [key, entry] : section->second) result.set(name, key, entry.value, entry.origin);
  return result;
}

}  // namespace

Recipe recipeOf(const std::string& name) {
  std::vector<std::string> names;
  for (const auto& known : kRecipes) {
    if (name == known.name) return known.recipe;
    names.emplace_back(known.name);
  }
  throw core::InputError("section [lesson], key 'recipe': found '" + name + "', expected a recipe" +
                         core::didYouMean(name, names));
}

world::Plan Place::makePlan(const std::string& name) const {
  const auto* kind = lesson.ini.find("world", "kind");
  auto plan =
      record::generateWorld(kind ? kind->value : "flat", sectionsOf(lesson.ini, {"building"}), seed()).plan;
  plan.name = "plan";
  world::savePlan(plan, file(name));
  return plan;
}

resources::Manifest Place::manifest() const {
  resources::Manifest manifest;
  manifest.files["run.plan.yaml"] = "the plan that the robot drove in";
  return manifest;
}

record::RecordConfig Place::recordConfig() const {
  return record::readRecordConfig(
      sectionsOf(lesson.ini, {"robot", "lidar", "odometry", "strategy", "living", "simulation"}));
}

void writeNumbers(const std::string& path, const std::vector<std::string>& names,
                  const std::vector<std::vector<double>>& rows) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) text += (i ? "," : "") + names[i];
  text += '\n';
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      char number[40];
      std::snprintf(number, sizeof number, "%s%.9g", i ? "," : "", row[i]);
      text += number;
    }
    text += '\n';
  }
  files::writeFileAtomically(path, text);
}

}  // namespace slam::learn
