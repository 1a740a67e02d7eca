#pragma once
#include <string>
#include <vector>

#include "libslam/core/progress.h"
#include "libslam/report/html_report.h"
#include "libslam/resources/manifest.h"

namespace slam::pages {

// Pieces of gatherReport(): what the pages of all kinds of folder need, and one function per kind.

/// "" where the manifest has no such result.
std::string resultOf(const resources::Manifest& manifest, const std::string& key);
/// "Sweep: NAME" with the folder's own name.
std::string pageTitle(const std::string& folder, const std::string& what);

/// A table that toMarkdown() wrote, as people saw it; one that toJson() wrote, with its numbers. Errors:
/// InputError with the path.
table::Table readMarkdownTable(const std::string& path);
table::Table readJsonTable(const std::string& path);
/// The text of such a table's cell, "" where it holds a number.
std::string textIn(const table::CellValue& cell);

/// Each only where the file is there.
void addPicture(report::ReportPage& page, const std::string& path, const std::string& caption);
void addDownload(report::ReportPage& page, const std::string& path, const std::string& name,
                 const std::string& what, const std::string& media_type);
/// The tables that comparisons and explorations write.
void addTableDownloads(const std::string& folder, report::ReportPage& page);

/// Fills in the scans, evenly chosen so that there are at most `most`, with the operations that led to them
/// and the collisions on the way, as record() wrote them beside the log.
void readReplay(const std::string& log_path, std::size_t most, core::Progress& progress,
                report::ReportReplay& replay);
/// Where a strategy wanted to go, and why, from the exploration.csv and decisions.csv of its folder.
void addGoals(const std::string& folder, const core::Pose2& T_world_map, report::ReportReplay& replay);

/// explore() with several runs; reachGoal(); bench() and stress().
bool isExplorations(const std::string& folder);
bool isNavigation(const std::string& folder);
bool isSweep(const std::string& folder);  ///< errors: InputError for one without tables
void fillExplorations(const std::string& folder, core::Progress& progress, report::ReportPage& page);
void fillNavigation(const std::string& folder, const resources::Manifest& manifest, report::ReportPage& page);
void fillSweep(const std::string& folder, const resources::Manifest& manifest, core::Progress& progress,
               report::ReportPage& page);
/// Curves of explored share over path and over time: `folders[i]` holds the exploration.csv of the line
/// called `labels[i]`.
void addCoverage(const std::vector<std::string>& folders, const std::vector<std::string>& labels,
                 report::ReportPage& page);

/// A run of buildMap() on a log that lies with its truth, as the page shows it: page.runs gets it under
/// `name`, page.replays[replay] the truth and the plan.
void addRun(const std::string& folder, const std::string& log_path, const std::string& name,
            std::size_t replay, report::ReportPage& page);

/// A page has the replays of so many logs at most, for its size.
inline constexpr std::size_t kMostReplays = 6;

}  // namespace slam::pages
