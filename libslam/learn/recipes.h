#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libslam/core/progress.h"
#include "libslam/learn/lesson.h"
#include "libslam/record/record.h"
#include "libslam/resources/manifest.h"
#include "libslam/world/plan.h"

namespace slam::learn {

/// What is known of a student's material: "answer" is the right number where the answer is one, the others
/// are what wrong ways lead to, and what the question tells. NaN where there is none.
using Figures = std::map<std::string, double>;

/// Where a recipe works.
struct Place {
  const Lesson& lesson;
  std::uint64_t student;
  std::string folder;  ///< existing; gets the student's files
  core::Progress& progress;

  std::uint64_t seed() const { return seedOf(lesson, student); }
  std::string file(const std::string& name) const { return folder + "/" + name; }
  std::string log() const { return file("run.rawlog"); }
  /// The student's own building: sections [world] (kind) and [building] of the lesson; saved under that name,
  /// and its picture. The usual name is where a log's plan is looked for (manifest()).
  world::Plan makePlan(const std::string& name = "run.plan.yaml") const;
  /// For the log's recording.
  resources::Manifest manifest() const;
  /// Of the lesson's sections of a simulation.
  record::RecordConfig recordConfig() const;
};

/// Makes the files of a student's material and says what the check has to know. The same lesson and student:
/// the same bytes and figures.
using Recipe = Figures (*)(const Place&);

Figures standingLidar(const Place& place);    ///< readings of a lidar that stands
Figures headingDrift(const Place& place);     ///< a log whose wheels drift
Figures scanDifference(const Place& place);   ///< turns and moves, and how the original robot measured them
Figures badWheels(const Place& place);        ///< a log of poor wheels, for a method of the student's
Figures gridCell(const Place& place);         ///< what one cell of a grid got from some scans
Figures particleWeights(const Place& place);  ///< particles and their likelihoods
Figures poseGraph(const Place& place);        ///< a pose graph with a false loop
Figures matcherErrors(const Place& place);    ///< errors of a scan matcher and the covariances that it states
Figures onlyPlan(const Place& place);         ///< a building to explore
Figures claimedMethods(const Place& place);   ///< a building, and a claim about two methods

/// Errors: InputError for a name that is none.
Recipe recipeOf(const std::string& name);

/// Writes lines of numbers below a line with their names; 9 significant digits.
void writeNumbers(const std::string& path, const std::vector<std::string>& names,
                  const std::vector<std::vector<double>>& rows);

}  // namespace slam::learn
