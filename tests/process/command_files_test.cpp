#include "libslam/process/command_files.h"

#include <gtest/gtest.h>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/process/exit_code.h"
#include "libslam/testing/temp_folder.h"

namespace slam::process {
namespace {

/// Files of known bytes; what a line names of them.
struct Named {
  testing::TempFolder folder;
  std::string a = folder / "a", b = folder / "with blank", log = folder / "log";
  Named() {
    for (const auto& path : {a, b, log}) files::writeFileAtomically(path, "abc");
  }
  /// The names in the folder, as letters of a, b and l.
  std::string in(const std::string& line) const {
    std::string found;
    const auto files = filesOfCommand(line);
    if (files.count(a) > 0) found += 'a';
    if (files.count(b) > 0) found += 'b';
    if (files.count(log) > 0) found += 'l';
    return found;
  }
};

TEST(CommandFiles, AreWordsThatAreAbsolutePaths) {
  const Named named;
  EXPECT_EQ(named.in(named.a + " --map " + named.log), "al");
  EXPECT_EQ(named.in("x --map=" + named.log), "l");
  EXPECT_EQ(named.in("x " + named.folder.path()), "") << "a folder is no file";
  EXPECT_EQ(named.in("x a log"), "") << "what is relative depends on where it runs";
  EXPECT_EQ(named.in("x " + named.a + ".none"), "");
  EXPECT_EQ(named.in(""), "");
  // SHA-256 of "abc", FIPS 180-2, appendix B.1.
  EXPECT_EQ(filesOfCommand(named.a).at(named.a),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(CommandFiles, QuotesAndBackslashesMakeOneWord) {
  const Named named;
  EXPECT_EQ(named.in("x '" + named.b + "'"), "b");
  EXPECT_EQ(named.in("x \"" + named.b + "\""), "b");
  EXPECT_EQ(named.in("x --in=\"" + named.b + "\";y"), "b");
  std::string escaped = named.b;
  escaped.insert(escaped.find(' '), "\\");
  EXPECT_EQ(named.in("x " + escaped), "b");
  EXPECT_EQ(named.in("x '" + named.a + ";" + named.log + "'"), "") << "one word of two paths is none";
  EXPECT_EQ(named.in("x " + named.b), "");
}

TEST(CommandFiles, WhatIsWrittenToIsNoInput) {
  const Named named;
  EXPECT_EQ(named.in("x " + named.a + " > " + named.log), "a");
  EXPECT_EQ(named.in("x>>" + named.log + " " + named.a), "a");
  EXPECT_EQ(named.in("x 2>" + named.log + " < " + named.a), "a");
  EXPECT_EQ(named.in("x > /dev/null 2>&1; y " + named.log), "l") << "the word behind it is read again";
}

TEST(CommandFiles, TheProgramIsFoundByThePath) {
  const Named named;
  const std::string sh = files::findProgram("sh"), cat = files::findProgram("cat");
  ASSERT_FALSE(sh.empty() || cat.empty());
  const auto programs = [&](const std::string& line) {
    const auto files = filesOfCommand(line);
    return std::string(files.count(sh) > 0 ? "s" : "") + (files.count(cat) > 0 ? "c" : "");
  };
  EXPECT_EQ(programs("sh"), "s");
  EXPECT_EQ(programs("echo sh"), "") << "a word that is no command";
  EXPECT_EQ(programs("X=1 Y=sh cat"), "c") << "variables come before it";
  for (const char* line : {"x; sh", "x && sh", "x | sh", "(sh)", "x\nsh", "x & sh"})
    EXPECT_EQ(programs(line), "s") << line;
  EXPECT_EQ(programs("cat no_such_file | sh -s"), "sc");
  EXPECT_TRUE(filesOfCommand("no_such_program_anywhere").empty());
}

TEST(ExitCode, SaysWhatKindOfErrorItWas) {
  EXPECT_EQ(exitCodeOf(core::InputError("x")), core::ExitCode::kBadInput);
  EXPECT_EQ(exitCodeOf(core::MethodError("x")), core::ExitCode::kMethodFailed);
  EXPECT_EQ(exitCodeOf(core::IoError("x")), core::ExitCode::kFailed);
  EXPECT_EQ(exitCodeOf(core::Interrupted()), core::ExitCode::kInterrupted);
  EXPECT_EQ(exitCodeOf(std::runtime_error("x")), core::ExitCode::kFailed);
}

}  // namespace
}  // namespace slam::process
