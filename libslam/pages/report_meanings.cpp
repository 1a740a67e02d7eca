#include "libslam/pages/report_meanings.h"

#include "libslam/core/journal.h"
#include "libslam/score/evaluate.h"
#include "libslam/score/metric_infos.h"

namespace slam::pages {
namespace {

using report::Meanings;

/// By key or by title, as the tables have them.
const Meanings kColumns = {
    {"method", "a SLAM method: rasterslam list methods"},
    // Sweeps.
    {"runs", "how many runs the row speaks of"},
    {"failed",
     "share of the runs that ended otherwise than ok, or farther off than the suite allows, with its 95 % "
     "interval"},
    {"group", "methods that share a letter cannot be told apart on these seeds"},
    {"better", "share of the seeds on which the method beats the baseline, with its 95 % interval"},
    {"p",
     "how likely a difference like this one is by chance alone, after Holm's method; below 0.05 it counts"},
    {"more_seeds", "how many more seeds would settle the difference from the baseline, by those seen so far"},
    {"more seeds", "how many more seeds would settle the difference from the baseline, by those seen so far"},
    {"verdict", "of the poses given online: consistent where the interval of the ANEES holds 1"},
    {"verdict final", "of the final poses: consistent where the interval of the ANEES holds 1"},
    {"broken", "whether more runs fail at this value than the limit allows"},
    {"cpu_s", "CPU time of the whole process"},
    {"wall_s", "time by the clock of the whole process"},
    // Tuning.
    {"explained_share", "share of the variance of the ranks that this parameter explains, less chance"},
    {"best", "the third of the parameter's range that ranks best"},
    // Relations.
    {"translation_mean_m", "mean distance between what the path and the relation say"},
    {"translation_deviation_m", "standard deviation of these distances"},
    {"translation_max_m", "the largest of these distances"},
    {"rotation_mean_deg", "mean angle between what the path and the relation say"},
    {"rotation_deviation_deg", "standard deviation of these angles"},
    {"rotation_max_deg", "the largest of these angles"},
    {"scored", "relations whose stamps lie within the path's time"},
    {"interpolated", "of these, how many needed a pose between two stamps of the path"},
    {"anees_annotated", "ANEES of the relations, with what they err by themselves added to what is claimed"},
    {"within_95_share_annotated", "share of them within the claimed region of 95 %, with the same added"},
    {"unmatched", "relations whose stamps lie outside the path's time"},
    // Exploration.
    {"explored %",
     "share of what can be explored that was: free cells that the robot's disc can reach or see"},
    {"90 % s", "robot's time until 90 % were explored"},
    {"99 % s", "robot's time until 99 % were explored"},
    {"end s", "robot's time at the end of the run"},
    {"90 % m", "true path until 90 % were explored"},
    {"99 % m", "true path until 99 % were explored"},
    {"path m", "length of the path"},
    {"redundant %", "share of the path that adds no new area: pieces of 1 m that show less than 0.1 m2"},
    {"collisions", "commands that a wall cut short"},
    {"near", "episodes with less than 0.05 m between the robot's disc and a wall"},
    {"decisions", "how often the strategy chose a goal"},
    {"ATE m", "absolute trajectory error of the pose given online: root mean square after SE(2) alignment"},
    {"coverage_percent",
     "share of what can be explored that was: free cells that the robot's disc can reach or see"},
    {"t90_s", "robot's time until 90 % were explored"},
    {"t99_s", "robot's time until 99 % were explored"},
    {"path90_m", "true path until 90 % were explored"},
    {"path99_m", "true path until 99 % were explored"},
    {"end", "why the run ended"},
    // Drives to a goal.
    {"result", "how the drive ended, and whether that was right"},
    {"time (s)", "robot's time until the drive ended, or of the event"},
    {"path (m)", "true path driven"},
    {"shortest (m)", "the shortest way of the disc around the robot in the true plan"},
    {"ratio", "the path driven over the shortest one"},
    {"to the goal (m)", "true distance to the goal at the end"},
    {"state changes", "how often the navigator changed its state"},
    // Events.
    {"scan", "number of the scan, from 0"},
    {"value", "what it means depends on the event"},
    {"x (m)", "place, in the frame of the maps"},
    {"y (m)", "place, in the frame of the maps"},
};

/// Of a robot; those of a method: core::journalEventInfos().
const Meanings kEvents = {
    {"collision", "a wall cut a command short"},
    {"kidnapped", "the robot was carried to another place"},
    {"decision", "the strategy chose a new goal"},
    {"to goal", "the navigator drives straight to the goal"},
    {"along the boundary", "the navigator follows the boundary of an obstacle"},
    {"round the obstacle",
     "the navigator drives once round the obstacle and remembers its point nearest to the goal"},
    {"to the leave point", "the navigator goes back to the point from which it will leave the obstacle"},
    {"to the leave node", "the navigator goes to the point from which it will leave the obstacle"},
    {"reached", "the robot is at the goal"},
    {"unreachable", "the navigator found that no way leads to the goal"},
};

}  // namespace

void addMeanings(report::ReportPage& page) {
  page.column_meanings = kColumns;
  page.event_meanings = kEvents;
  for (const auto& info : core::journalEventInfos()) page.event_meanings.emplace(info.word, info.meaning);
  for (const auto& info : score::metricInfos()) {
    page.column_meanings[info.key] = info.meaning;
    page.column_meanings.emplace(info.title, info.meaning);
  }
}

}  // namespace slam::pages
