#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "libslam/files/files.h"
#include "tests/apps/bench_fixture.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST_F(Bench, AGateNamesWhatGotWorseAndEndsWithFive) {
  ASSERT_EQ(bench("tiny.ini -o out -q --write-gate gate.json").exit_code, 0);
  const auto same = bench("merge out --gate gate.json");
  EXPECT_EQ(same.exit_code, 0) << same.err;
  EXPECT_THAT(same.out, HasSubstr("gate.json: of 8 figures 8 within their tolerance"));
  // As if the path had been nearer once, and no run known to fail.
  auto gate = nlohmann::json::parse(files::readTextFile(folder_ / "gate.json"));
  for (auto& row : gate["rows"])
    if (row["cell"] == "naive on flat" && row["metric"] == "ate_final_m") row["values"] = {0.001, 0.002};
  write(folder_ / "gate.json", gate.dump());
  const auto worse = bench("tiny.ini -o again -q --gate gate.json --json");
  EXPECT_EQ(worse.exit_code, 5) << worse.err;
  const auto table = nlohmann::json::parse(worse.out)["gate"];
  ASSERT_EQ(table["rows"].size(), 8U);
  for (const auto& row : table["rows"])
    EXPECT_EQ(row["verdict"],
              row["cell"] == "naive on flat" && row["metric"] == "ate_final_m" ? "WORSE" : "ok")
        << row;
  EXPECT_THAT(bench("merge out --gate gate.json").out, HasSubstr("WORSE"));
  EXPECT_THAT(bench("merge out --write-gate gate.json").err, HasSubstr("give --overwrite to replace"));
  EXPECT_EQ(bench("merge out --write-gate gate.json --overwrite").exit_code, 0);
  EXPECT_EQ(bench("merge out --gate gate.json").exit_code, 0);
  // A run that is not there: no baseline can be made, and what was measured before is missed.
  fs::remove_all(cellsOf(folder_ / "out", "run")[0]);
  const auto partly = bench("merge out --gate gate.json");
  EXPECT_EQ(partly.exit_code, 5);
  EXPECT_THAT(partly.out, HasSubstr("MISSING"));
  EXPECT_EQ(bench("merge out --write-gate new.json").exit_code, 3);
  EXPECT_FALSE(fs::exists(folder_ / "new.json"));
}

TEST_F(Bench, AGateThatIsWrongSaysSoBeforeAnythingRuns) {
  write(folder_ / "gate.json",
        R"({"rows": [{"cell": "naive on flt", "metric": "ate_final_m", "better": "smaller", "value": 1}]})");
  const auto result = bench("tiny.ini -o out --gate gate.json");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("gate.json: key 'cell': found none for 'naive_wheel on flat'"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

}  // namespace
}  // namespace slam::apps
