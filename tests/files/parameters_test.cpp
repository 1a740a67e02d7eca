#include "libslam/files/parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libslam/core/error.h"
#include "libslam/core/pose2.h"

namespace slam::files {
namespace {

struct Options {
  double range_m, fov_rad;
  int beams;
  bool mirrored;
  std::string kind;
  Options() { table().setDefaults(*this); }
  static const ParameterTable<Options>& table() {
    static const ParameterTable<Options> rows(
        "lidar", {{"range_m", &Options::range_m, 30.0, 0.1, 100.0, "range"},
                  {"fov_deg", &Options::fov_rad, 180.0, 1.0, 360.0, "field of view"},
                  {"beams", &Options::beams, 181, 2, 10000, "beams"},
                  {"mirrored", &Options::mirrored, false, "left to right"},
                  {"kind", &Options::kind, "sick", {"sick", "hokuyo"}, "make"}});
    return rows;
  }
};

std::string errorOf(const std::string& text) {
  try {
    Options options;
    const IniFile ini = IniFile::parse(text, "a.ini");
    rejectUnknownSections(ini, {"lidar"});
    readParameters(ini, Options::table(), options);
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Parameters, ReadsValuesAndKeepsDefaults) {
  Options options;
  readParameters(
      IniFile::parse("# a comment\n[lidar]\nfov_deg = 90 ; half\nmirrored=true\nkind = hokuyo\n", "a.ini"),
      Options::table(), options);
  EXPECT_DOUBLE_EQ(options.fov_rad, core::kPi / 2);
  EXPECT_TRUE(options.mirrored);
  EXPECT_EQ(options.kind, "hokuyo");
  EXPECT_EQ(options.range_m, 30.0);
  EXPECT_EQ(options.beams, 181);
}

TEST(Parameters, EachMistakeGetsItsOwnLine) {
  EXPECT_EQ(errorOf("[lidar]\n\nbeems = 3"),
            "a.ini:3: section [lidar], unknown key 'beems'; did you mean 'beams'?");
  EXPECT_EQ(errorOf("[lidr]\nbeams = 3"), "a.ini:2: unknown section [lidr]; did you mean 'lidar'?");
  EXPECT_EQ(errorOf("[lidar]\nbeams = 3x"),
            "a.ini:2: section [lidar], key 'beams': found '3x', expected a whole number from 2 to 10000");
  EXPECT_EQ(errorOf("[lidar]\nbeams = 2.5"),
            "a.ini:2: section [lidar], key 'beams': found '2.5', expected a whole number from 2 to 10000");
  EXPECT_EQ(errorOf("[lidar]\nrange_m = nan"),
            "a.ini:2: section [lidar], key 'range_m': found 'nan', expected a number from 0.1 to 100");
  EXPECT_EQ(errorOf("[lidar]\nrange_m = inf"),
            "a.ini:2: section [lidar], key 'range_m': found 'inf', expected a number from 0.1 to 100");
  EXPECT_EQ(errorOf("[lidar]\nrange_m = -1"),
            "a.ini:2: section [lidar], key 'range_m': found '-1', expected a number from 0.1 to 100");
  EXPECT_EQ(errorOf("[lidar]\nrange_m ="),
            "a.ini:2: section [lidar], key 'range_m': found '', expected a number from 0.1 to 100");
  EXPECT_EQ(errorOf("[lidar]\nmirrored = yes"),
            "a.ini:2: section [lidar], key 'mirrored': found 'yes', expected true or false");
  EXPECT_EQ(errorOf("[lidar]\nkind = sik"),
            "a.ini:2: section [lidar], key 'kind': found 'sik', expected one of sick, hokuyo; did you mean "
            "'sick'?");
  EXPECT_EQ(errorOf("[lidar]\nbeams = 3\nbeams = 4"),
            "a.ini:3: section [lidar], key 'beams' is given twice, first at a.ini:2");
  EXPECT_EQ(errorOf("[lidar]\nbeams"), "a.ini:2: found 'beams', expected key = value");
  EXPECT_EQ(errorOf("beams = 3"), "a.ini:1: found 'beams = 3' before any section, expected [section] first");
  EXPECT_EQ(errorOf("[lidar\nbeams = 3"), "a.ini:1: found '[lidar', expected [section]");
}

TEST(Parameters, BoundsThemselvesAreAllowed) {
  EXPECT_EQ(errorOf("[lidar]\nbeams = 2\nrange_m = 100\nfov_deg = 360"), "no error");
}

TEST(Parameters, OverridesSayWhereTheyCameFrom) {
  IniFile ini = IniFile::parse("[lidar]\nbeams = 3", "a.ini");
  ini.setFromArgument("lidar.range_m=5.5", "--set");
  Options options;
  std::vector<ParameterReport> report;
  readParameters(ini, Options::table(), options, &report);
  EXPECT_EQ(options.range_m, 5.5);
  ASSERT_EQ(report.size(), 5U);
  EXPECT_EQ(report[0].origin, "--set");
  EXPECT_EQ(report[1].origin, "built-in");
  EXPECT_EQ(report[1].value, "180");
  EXPECT_EQ(report[2].origin, "a.ini:2");
  EXPECT_THROW(ini.setFromArgument("range_m=5", "--set"), core::InputError);
  EXPECT_THROW(ini.setFromArgument("lidar.range_m", "--set"), core::InputError);
  EXPECT_THROW(ini.setFromArgument("lidar.=5", "--set"), core::InputError);
}

TEST(Parameters, WhatIsPrintedReadsBackAsTheSame) {
  IniFile ini = IniFile::parse("[lidar]\nfov_deg = 33.3\nrange_m = 0.1\nkind = hokuyo", "a.ini");
  Options options;
  std::vector<ParameterReport> report;
  readParameters(ini, Options::table(), options, &report);
  Options again;
  readParameters(IniFile::parse(formatParameterReport(report), "printed"), Options::table(), again);
  EXPECT_EQ(again.fov_rad, options.fov_rad);
  EXPECT_EQ(again.range_m, options.range_m);
  EXPECT_EQ(again.kind, options.kind);
}

TEST(FormatNumber, IsShortAndExact) {
  EXPECT_EQ(formatNumber(0.1), "0.1");
  EXPECT_EQ(formatNumber(-2), "-2");
  EXPECT_EQ(formatNumber(100000), "100000");
  EXPECT_EQ(formatNumber(0), "0");
  EXPECT_EQ(formatNumber(-0.0), "-0");
  double back = 0;
  ASSERT_TRUE(parseNumber(formatNumber(1.0 / 3), back));
  EXPECT_EQ(back, 1.0 / 3);
  EXPECT_FALSE(parseNumber("", back));
  EXPECT_FALSE(parseNumber("1 ", back));
  EXPECT_FALSE(parseNumber("0x10", back));
}

}  // namespace
}  // namespace slam::files
