#include "libslam/report/html_report.h"
#include "libslam/core/numbers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/error.h"
#include "libslam/draw/page_text.h"
#include "libslam/files/files.h"
#include "libslam/report/page_bundle.h"
#include "libslam/report/page_plot.h"

namespace slam::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

using core::kNaN;

world::Plan room() {
  world::Plan plan;
  plan.columns = plan.rows = 60;
  plan.resolution_m = 0.1;
  plan.cells.assign(3600, world::Cell::kFree);
  for (size_t i = 0; i < 60; ++i) plan.cells[i] = plan.cells[3540 + i] = world::Cell::kOccupied;
  return plan;
}

lidar::Scan scan(double time_s, size_t beams) {
  lidar::Scan scan;
  scan.time_s = time_s;
  scan.first_angle_rad = -1;
  scan.step_rad = 2.0 / static_cast<double>(beams);
  scan.max_range_m = 30;
  scan.ranges_m.assign(beams, 2.5F);
  return scan;
}

core::JournalLine happened(int scan, double time_s, core::JournalEvent event, double value = 0) {
  core::JournalLine line;
  line.scan = scan, line.time_s = time_s;
  line.event = event, line.value = value;
  line.place = {1, 1};
  return line;
}

ReportPage smallPage() {
  ReportPage page;
  page.title = "Comparison: small";
  ReportReplay replay;
  replay.plan = room();
  ReportRun run;
  run.method = "graph";
  run.map = room();
  for (int i = 0; i <= 40; ++i) {
    const double time_s = 100 + i;
    replay.truth.push_back({time_s, {1 + 0.1 * i, 3, 0}});
    run.path.push_back({time_s, {1 + 0.1 * i, 3.05, 0}});
    run.error_m.push_back(0.05);
    replay.scans.push_back(scan(time_s, 31));
  }
  replay.scan_count = replay.scans.size();
  page.replays = {replay};
  page.runs = {run};
  page.tables = {{"Accuracy",
                  {{"method", "method"}, {"ate_m", "ATE m"}},
                  {{std::string("graph"), 0.05}, {std::string("lost"), kNaN}},
                  {}}};
  return page;
}

TEST(PageText, WhatHtmlWouldReadAsItsOwnIsEscaped) {
  EXPECT_EQ(draw::htmlText("<script>alert(\"a\" & 'b')</script>"),
            "&lt;script&gt;alert(&quot;a&quot; &amp; &#39;b&#39;)&lt;/script&gt;");
  EXPECT_EQ(draw::htmlText("B\xC3\xBCro \xE2\x82\xAC"), "B\xC3\xBCro \xE2\x82\xAC");
  EXPECT_EQ(draw::htmlText("a\xFF"
                           "b"),
            "a\xEF\xBF\xBD"
            "b");  // no UTF-8: U+FFFD
  EXPECT_EQ(draw::htmlText("a\nb\x01"), "a b ");
}

// RFC 4648, section 10.
TEST(PageText, Base64IsThatOfTheStandard) {
  EXPECT_EQ(draw::base64(""), "");
  EXPECT_EQ(draw::base64("f"), "Zg==");
  EXPECT_EQ(draw::base64("fo"), "Zm8=");
  EXPECT_EQ(draw::base64("foo"), "Zm9v");
  EXPECT_EQ(draw::base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(draw::base64(std::string("\xFF\x00\x80", 3)), "/wCA");
  EXPECT_EQ(draw::base64Floats({1.0}), "AACAPw==");  // 0x3F800000, lowest byte first
}

TEST(HtmlReport, NamesWithMarkupStayText) {
  auto page = smallPage();
  const std::string evil = "<script>x</script>\"'&\xC3\xA9";
  page.title = page.subtitle = evil;
  page.verdict = page.missing = {evil};
  page.runs[0].method = page.runs[0].failure = page.runs[0].summary = evil;
  page.runs[0].events = {happened(3, 3.0, core::JournalEvent::kLost, 1)};
  page.runs[0].events[0].detail = evil;
  page.runs[0].scan_time_s = {0, 1};
  page.runs[0].scan_ms = {1, 2};
  page.tables[0].caption = evil;
  page.tables[0].columns[0].title = evil;
  page.tables[0].rows[0][0] = evil;
  page.tables[0].notes = {evil};
  page.downloads = {{evil, evil, "text/csv", "a"}};
  page.pictures = {{evil, "png"}};
  page.left_out = {evil};
  page.charts = {{evil, evil, evil, evil, {{evil, {{0, 1}, {1, 2}}, {}, {}, {}, evil}}, 0, 0}};
  page.replays[0].name = evil;
  page.replays[0].operations.assign(page.replays[0].scans.size(), evil);
  page.replays[0].moments = {{1, evil, evil, {1, 1}}};
  page.facts = {{evil, evil}};
  const auto html = toHtml(page);
  EXPECT_THAT(html, Not(HasSubstr("<script>x")));
  EXPECT_THAT(html, Not(HasSubstr("\"'&\xC3\xA9")));
  EXPECT_THAT(html, HasSubstr("&lt;script&gt;x&lt;/script&gt;&quot;&#39;&amp;\xC3\xA9"));
  EXPECT_THAT(html, HasSubstr(R"(\u003cscript>x\u003c/script>)"));  // in the replay's data
}

TEST(HtmlReport, NothingIsFetchedFromElsewhere) {
  const auto html = toHtml(smallPage());
  for (const char* reference : {"src=\"http", "href=\"http", "url(", "@import", "<link"})
    EXPECT_THAT(html, Not(HasSubstr(reference)));
}

TEST(HtmlReport, TheSamePageGivesTheSameBytes) {
  EXPECT_EQ(toHtml(smallPage()), toHtml(smallPage()));
}

TEST(HtmlReport, TheBundleIsInsideUnchanged) {
  const std::string folder = std::string(RASTERSLAM_SOURCE_DIR) + "/libslam/report/page/bundle";
  EXPECT_EQ(files::readTextFile(folder + "/page.js"), kPageScript);
  EXPECT_EQ(files::readTextFile(folder + "/page.css"), kPageStyle);
  EXPECT_THAT(toHtml(smallPage()), HasSubstr(kPageScript));
}

TEST(HtmlReport, AFigureThatIsNotThereIsADashAndSortsAsNoNumber) {
  EXPECT_THAT(toHtml(smallPage()), HasSubstr("data-value=\"NaN\">-</td>"));
}

TEST(HtmlReport, AMethodThatFailedHasItsSectionAndReason) {
  auto page = smallPage();
  page.runs.emplace_back();
  page.runs.back().method = "rbpf";
  page.runs.back().failure = "killed by signal 11";
  const auto html = toHtml(page);
  EXPECT_THAT(html, HasSubstr("Failed: killed by signal 11"));
  EXPECT_THAT(html, Not(HasSubstr("map-1")));
}

TEST(HtmlReport, OfAMethodThatGotLostTheReasonAndTheLastMapAreShown) {
  auto page = smallPage();
  page.runs[0].failure = "lost at scan 12 (2.4 s)";
  const auto html = toHtml(page);
  EXPECT_THAT(html, HasSubstr("Failed: lost at scan 12 (2.4 s)"));
  EXPECT_THAT(html, HasSubstr("<use href=\"#map-0\"/>"));
}

TEST(HtmlReport, ColumnsAndEventsSayWhatTheyMean) {
  auto page = smallPage();
  EXPECT_THAT(toHtml(page), Not(HasSubstr("class=\"meanings\"")));
  page.column_meanings[page.tables[0].columns[1].key] = "how far <it> is off";
  page.event_meanings = {{"lost", "knows no more"}, {"accepted", "a loop"}, {"never", "does not happen"}};
  page.runs[0].events = {happened(1, 0.2, core::JournalEvent::kLost, 0.1),
                         happened(2, 0.4, core::JournalEvent::kLost, 0.1)};
  page.replays[0].moments = {{0.1, "collision", "", {0, 0}}};
  const auto html = toHtml(page);
  EXPECT_THAT(html, HasSubstr("title=\"how far &lt;it&gt; is off\">" + page.tables[0].columns[1].title));
  EXPECT_THAT(html, HasSubstr("<dd>how far &lt;it&gt; is off</dd>"));
  // Of the events those that happen, each once.
  EXPECT_THAT(html, HasSubstr("<dl><dt>lost</dt><dd>knows no more</dd>\n</dl>"));
}

TEST(HtmlReport, APageWithoutRunsIsAPage) {
  ReportPage page;
  page.title = "nothing";
  EXPECT_THAT(toHtml(page), HasSubstr("</html>"));
  EXPECT_THAT(toHtml(page), Not(HasSubstr("id=\"replay-data\"")));
}

TEST(HtmlReport, WhatIsThinnedIsSaid) {
  auto page = smallPage();
  EXPECT_THAT(toHtml(page), Not(HasSubstr("evenly chosen")));
  page.replays[0].scan_count = 100000;
  for (auto& one : page.replays[0].scans) one = scan(one.time_s, 1081);
  const auto html = toHtml(page);
  EXPECT_THAT(html, HasSubstr("Of the log&#39;s 100000 scans the player shows 41, evenly chosen."));
  EXPECT_THAT(html, HasSubstr("Of each scan&#39;s 1081 beams it shows one in 6,"));
  EXPECT_THAT(html, HasSubstr("\"beams\":181,"));
}

TEST(HtmlReport, ManyEventsAreThinnedAndCounted) {
  auto page = smallPage();
  for (int i = 0; i < 1000; ++i)
    page.runs[0].events.push_back(happened(i, 0.04 * i, core::JournalEvent::kResampled));
  page.runs[0].events.push_back(happened(999, 40, core::JournalEvent::kLost));
  const auto html = toHtml(page);
  EXPECT_THAT(html, HasSubstr("1001 events, of which 251 are listed: resampled one in 4"));
  EXPECT_THAT(html, HasSubstr("<td>lost</td>"));
}

TEST(HtmlReport, FilesThatAreTooManyAreNamed) {
  auto page = smallPage();
  page.downloads = {{"a.png", "", "image/png", std::string(kMostDownloadBytes - 10, 'x')},
                    {"b.png", "", "image/png", std::string(100, 'x')},
                    {"c.csv", "", "text/csv", "1"}};
  const auto html = toHtml(page);
  EXPECT_THAT(html, HasSubstr("download=\"a.png\""));
  EXPECT_THAT(html, HasSubstr("download=\"c.csv\""));
  EXPECT_THAT(html, Not(HasSubstr("download=\"b.png\"")));
  EXPECT_THAT(html, HasSubstr("they are in the folder: b.png."));
}

TEST(HtmlReport, ALongPathIsPackedAsGzip) {
  auto page = smallPage();
  page.downloads = {{"path.tum", "", "text/plain", std::string(100000, '1')}};
  const auto html = toHtml(page);
  EXPECT_THAT(html, HasSubstr("download=\"path.tum.gz\" href=\"data:application/gzip;base64,H4sI"));
}

TEST(HtmlReport, ReplaysOnOnePlanShareItsPictureAndOthersHaveTheirOwn) {
  auto page = smallPage();
  page.replays.push_back(page.replays[0]);
  page.runs.push_back(page.runs[0]);
  page.runs[1].replay = 1;
  const auto shared = toHtml(page);
  EXPECT_THAT(shared, HasSubstr("id=\"plan-0\""));
  EXPECT_THAT(shared, Not(HasSubstr("id=\"plan-1\"")));
  page.replays[1].plan->cells[1800] = world::Cell::kOccupied;
  const auto apart = toHtml(page);
  EXPECT_THAT(apart, HasSubstr("id=\"plan-1\""));
  EXPECT_THAT(apart, HasSubstr("data-group=\"1\""));
}

TEST(HtmlReport, EveryRunBelongsToAReplayAndOperationsToScans) {
  auto page = smallPage();
  page.runs[0].replay = 1;
  EXPECT_THROW(toHtml(page), core::ContractError);
  page = smallPage();
  page.replays[0].operations = {"", "t 0.1"};
  EXPECT_THROW(toHtml(page), core::ContractError);
}

TEST(HtmlReport, ThePlayerKnowsOperationsGoalsMomentsAndTheOnlinePath) {
  auto page = smallPage();
  auto& replay = page.replays[0];
  replay.operations.assign(replay.scans.size(), "");
  replay.operations[1] = "t 0.2094";
  replay.goals = {{2, {1.5, 3}}, {4, {kNaN, kNaN}}};
  replay.moments = {{3, "collision", "", {1.25, 3}}};
  page.runs[0].online = page.runs[0].path;
  const auto html = toHtml(page);
  EXPECT_THAT(html, HasSubstr(R"("operations":["","t 0.2094",)"));
  EXPECT_THAT(html, HasSubstr(R"("goals":[[2.0,1.5,3.0],[4.0,null,null]])"));
  EXPECT_THAT(html, HasSubstr(R"("moments":[[3.0,"collision","",1.25,3.0]])"));
  EXPECT_THAT(html, HasSubstr(R"("online":")"));
}

TEST(HtmlReport, ErrorsBelongToPoses) {
  auto page = smallPage();
  page.runs[0].error_m.pop_back();
  EXPECT_THROW(toHtml(page), core::ContractError);
}

TEST(PagePlot, AnOutlineKeepsCornersDropsTheRestAndBreaksAtHoles) {
  EXPECT_EQ(pathOutline({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}}, 0.01), "M0.00 0.00 2.00 0.00 2.00 -2.00");
  EXPECT_EQ(pathOutline({{0, 0}, {1, 0}, {kNaN, 0}, {5, 1}, {6, 1}}, 0.01),
            "M0.00 0.00 1.00 0.00 M5.00 -1.00 6.00 -1.00");
  EXPECT_EQ(pathOutline({}, 0.01), "");
}

TEST(PagePlot, ErrorsAreColouredByClass) {
  const core::Trajectory path = {{0, {0, 0, 0}}, {1, {1, 0, 0}}, {2, {2, 0, 0}}, {3, {3, 0, 0}}};
  const draw::Window window{0, 0, 3, 3};
  const auto elements = errorPathElements(path, {0.001, 0.2, kNaN, 0.2}, window);
  EXPECT_THAT(elements, HasSubstr("d=\"M0.00 0.00 1.00 0.00\" stroke=\"" + draw::cssColour(draw::kBlue)));
  EXPECT_THAT(elements, HasSubstr("d=\"M1.00 0.00 2.00 0.00\" stroke=\"" + draw::cssColour(draw::kOrange)));
  EXPECT_THAT(elements, Not(HasSubstr("3.00 0.00\"")));  // from a pose without truth nothing is known
}

TEST(PagePlot, AChartOfNothingIsNothing) {
  EXPECT_EQ(timeChart({}, "c", "error (m)", 10), "");
  EXPECT_EQ(timeChart({{"a", draw::kBlue, {0, 1}, {kNaN, 0}}}, "c", "error (m)", 10), "");
  EXPECT_THAT(timeChart({{"a", draw::kBlue, {0, 1}, {0.1, 0.2}}}, "c", "error (m)", 10),
              HasSubstr("data-method=\"a\""));
}

PageChart chartOf(const std::vector<core::Point2>& points) {
  return {"c", "A chart.", "x (m)", "y (s)", {{"a", points, {}, {}, {}, ""}}, 0, 0};
}

TEST(PageChart, AChartOfNothingIsNothing) {
  EXPECT_EQ(chartElement(chartOf({})), "");
  EXPECT_EQ(chartElement(chartOf({{kNaN, 1}, {1, kNaN}})), "");
}

// The drawing is 720 by 340, its axes from 78 to 698 and from 290 up to 16.
TEST(PageChart, PointsLieWhereTheAxesSay) {
  const auto html = chartElement(chartOf({{0, 0}, {5, 10}, {10, 5}}));
  EXPECT_THAT(html, HasSubstr("d=\"M78.00 290.00 388.00 16.00 698.00 153.00\""));
  EXPECT_THAT(html, HasSubstr("data-values=\"0 0;5 10;10 5\""));
  EXPECT_THAT(html, HasSubstr("x (m)</text>"));
  EXPECT_THAT(html, Not(HasSubstr("logarithmic")));
}

TEST(PageChart, AnIntervalIsDrawnAndABrokenPointHasACross) {
  auto chart = chartOf({{0, 1}, {10, 2}});
  chart.y_max = 4;
  chart.curves[0].low = {0.5, kNaN};
  chart.curves[0].high = {3, kNaN};
  chart.curves[0].broken = {false, true};
  chart.curves[0].note = "breaks at 10";
  const auto html = chartElement(chart);
  EXPECT_THAT(html, HasSubstr("data-values=\"0 1 0.5 3;10 2\""));
  EXPECT_THAT(html, HasSubstr("class=\"whisker\" d=\"M78.0 255.8V84.5"));
  EXPECT_THAT(html, HasSubstr("class=\"cross\" d=\"M692.0 147.0l12 12"));
  EXPECT_THAT(html, HasSubstr("<span>a</span>: breaks at 10"));
}

TEST(PageChart, WideSpreadsGetALogarithmicAxisThatTheCaptionNames) {
  const auto html = chartElement(chartOf({{0.01, 0.001}, {1, 0.5}}));
  EXPECT_THAT(html, HasSubstr("The lower axis is logarithmic. The left axis is logarithmic."));
  EXPECT_THAT(html, HasSubstr("data-log=\"1\""));
  // 0 has no logarithm.
  EXPECT_THAT(chartElement(chartOf({{0, 0.001}, {1, 0.5}})), Not(HasSubstr("The lower axis is logarithmic")));
}

TEST(PageChart, LinesWithOneLabelShareColourAndLegend) {
  auto chart = chartOf({{0, 1}, {1, 2}});
  chart.curves.push_back(chart.curves[0]);
  chart.curves.push_back({"b", {{0, 1}, {1, 3}}, {}, {}, {}, ""});
  const auto html = chartElement(chart);
  const auto count = [&](const std::string& what) {
    size_t found = 0;
    for (auto at = html.find(what); at != std::string::npos; at = html.find(what, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("<g data-series=\"0\""), 2U);
  EXPECT_EQ(count("<li data-series="), 2U);
}

TEST(PageChart, IntervalsBelongToPoints) {
  auto chart = chartOf({{0, 1}, {1, 2}});
  chart.curves[0].low = {0};
  EXPECT_THROW(chartElement(chart), core::ContractError);
}

}  // namespace
}  // namespace slam::report
