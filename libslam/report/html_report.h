#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/draw/canvas.h"
#include "libslam/lidar/scan.h"
#include "libslam/metrics/map_score.h"
#include "libslam/pictures/journal_picture.h"
#include "libslam/report/page_chart.h"
#include "libslam/report/page_table.h"
#include "libslam/table/table.h"
#include "libslam/world/plan.h"

namespace slam::report {

/// One method on one log, for the page. World frame (map frame where there is no truth).
struct ReportRun {
  std::string method;
  std::string failure;                ///< why there are no figures, or where the robot was lost; ""
  std::string summary;                ///< a sentence on how well it did
  std::optional<world::CellMap> map;  ///< the last good state of a method that failed; none: it left nothing
  core::Pose2 T_world_map;
  core::Trajectory path;    ///< the final one
  core::Trajectory online;  ///< as it was given at the time, where that differs; else empty
  std::vector<double>
      error_m;  ///< of each pose of path, NaN where no truth is near in time; empty without truth
  std::vector<double> nees, nees_final;  ///< pose by pose, see results::poseNees(); may be empty
  std::vector<double> scan_time_s,
      scan_ms;                            ///< computing time scan by scan, since the first scan; may be empty
  std::vector<core::JournalLine> events;  ///< in the map frame
  std::size_t replay = 0;                 ///< index into ReportPage::replays: its log, truth and plan
};

/// A picture that another command drew.
struct ReportPicture {
  std::string caption, png;
};

/// A file inside the page.
struct ReportDownload {
  std::string name, what, media_type, bytes;
};

/// Where a strategy wanted to go from a moment on.
struct ReportGoal {
  double time_s = 0;   ///< since the first scan
  core::Point2 place;  ///< as the runs' paths; NaN: none
};

/// Something that happened to the robot, whatever the methods made of it.
struct ReportMoment {
  double time_s = 0;  ///< since the first scan
  std::string what, detail;
  core::Point2 place;  ///< as the runs' paths; NaN: none
};

/// A robot on its way: what its runs are laid on, and what the player shows.
struct ReportReplay {
  std::string name;                 ///< to choose by, where there are several
  core::Trajectory truth;           ///< may be empty
  std::optional<world::Plan> plan;  ///< the true one
  std::optional<metrics::SeenMask> seen;
  std::vector<lidar::Scan> scans;       ///< those shown, in time; may be empty
  std::size_t scan_count = 0;           ///< in the log
  std::vector<std::string> operations;  ///< the one before each of `scans`, "" where none; may be empty
  std::vector<ReportGoal> goals;
  std::vector<ReportMoment> moments;
};

/// All that the page shows.
struct ReportPage {
  std::string title, subtitle;
  std::vector<std::string> verdict;   ///< sentences, the most important first
  std::vector<std::string> missing;   ///< what could not be found, and what that leaves out
  std::vector<std::string> left_out;  ///< what this page has not, for its size
  std::vector<table::Table> tables;   ///< in this order
  std::vector<PageChart> charts;
  std::vector<ReportRun> runs;        ///< the best first
  std::vector<ReportReplay> replays;  ///< their scans together at most kMostReplayed
  std::vector<ReportPicture> pictures;
  std::vector<ReportDownload> downloads;
  std::vector<std::pair<std::string, std::string>> facts;  ///< how to make it again: name, value
  Meanings column_meanings;  ///< of the tables, by key or title; what is not in it has no tooltip
  Meanings event_meanings;   ///< of events and moments
};
inline constexpr std::size_t kMostReplayed = 2000;      ///< scans
inline constexpr std::size_t kMostTableRows = 300;      ///< the first ones of a table
inline constexpr std::size_t kMostReplayedBeams = 181;  ///< of a scan; of more every n-th is kept
inline constexpr std::size_t kMostListedEvents =
    300;  ///< of a run or a replay; evenly chosen among more, which the page says
inline constexpr std::size_t kMostDownloadBytes = 1
                                                  << 20;  ///< in all; what comes after is named and left out

/// The page as one HTML file that needs neither network nor server. Tables, pictures and plots need no
/// script; the player, sorting, filtering and zooming do (page/, whose bundle is checked in). Everything from
/// outside is escaped. The same page gives the same bytes. Scans, beams and long lists are thinned to the
/// bounds above, and the page says so. Errors: ContractError where lists of a run differ in length.
std::string toHtml(const ReportPage& page);

/// Of the page's runs, by their methods (labelColours()).
std::vector<draw::Colour> runColours(const ReportPage& page);

}  // namespace slam::report
