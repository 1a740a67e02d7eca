#include "libslam/pages/cost_chart.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <numeric>

#include "libslam/core/error.h"
#include "libslam/metrics/statistics.h"

namespace slam::pages {
namespace {

constexpr std::size_t kPieces = 100, kFewestInAPiece = 10;
constexpr std::size_t kMany = 10000;  ///< more scans are counted in thousands

void addLines(const report::ReportRun& run, const std::string& label, double unit, draw::Chart& chart) {
  const std::size_t scans = run.scan_ms.size();
  const std::size_t pieces = std::clamp<std::size_t>(scans / kFewestInAPiece, 1, kPieces);
  draw::Curve mean{label + ", mean", {}}, high{label + ", 99 %", {}};
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    const auto at = [&](std::size_t i) { return static_cast<std::ptrdiff_t>(i * scans / pieces); };
    const std::vector<double> ms(run.scan_ms.begin() + at(piece), run.scan_ms.begin() + at(piece + 1));
    const double scan = static_cast<double>(at(piece) + at(piece + 1)) / 2 / unit;
    mean.points.push_back(
        {scan, std::accumulate(ms.begin(), ms.end(), 0.0) / static_cast<double>(ms.size())});
    high.points.push_back({scan, metrics::quantile(ms, 0.99)});
  }
  chart.curves.push_back(std::move(high));
  chart.curves.push_back(std::move(mean));
}

std::string nameOf(const std::string& folder) {
  const std::filesystem::path path = std::filesystem::path(folder).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

}  // namespace

draw::Chart costChart(const std::vector<report::ReportPage>& pages, const std::vector<std::string>& folders,
                      bool is_log) {
  if (pages.size() != folders.size()) throw core::ContractError("costChart: expected a folder for each page");
  std::size_t most = 0;
  for (const auto& page : pages)
    for (const auto& run : page.runs) most = std::max(most, run.scan_ms.size());
  draw::Chart chart{most > kMany ? "scan (thousands)" : "scan", "CPU time a scan (ms)", {}};
  chart.y_log = is_log;
  for (std::size_t i = 0; i < pages.size(); ++i)
    for (const auto& run : pages[i].runs)
      if (!run.scan_ms.empty())
        addLines(run, run.method + (pages.size() > 1 ? " " + nameOf(folders[i]) : ""),
                 most > kMany ? 1000 : 1, chart);
  if (chart.curves.empty())
    throw core::InputError(folders.front() +
                           ": has no times to draw, expected a run of a method of ours or of MRPT's");
  return chart;
}

}  // namespace slam::pages
