#include "libslam/files/files.h"
#include "libslam/resources/file_hash.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <set>

#include "libslam/core/error.h"
#include "libslam/resources/json_entry.h"
#include "libslam/resources/manifest.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::files {
namespace {
namespace fs = std::filesystem;
using slam::testing::errorOf;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

std::vector<std::string> namesIn(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
  return names;
}

TEST(Files, SaysWhyAFileCannotBeRead) {
  const testing::TempFolder folder;
  EXPECT_EQ(errorOf([&] { readTextFile(folder / "none"); }), folder / "none" + ": no such file");
  EXPECT_EQ(errorOf([&] { requireReadableFile(folder.path()); }),
            folder.path() + ": is a folder, expected a file");
  EXPECT_EQ(errorOf([&] { readTextFile("/dev/zero"); }), "/dev/zero: is a device or a pipe, expected a file");
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(errorOf([&] { resources::fileSha256(folder / "pipe"); }),
            folder / "pipe" + ": is a device or a pipe, expected a file");
}

TEST(Files, AtomicWriteReplacesWholeOrLeavesTheOld) {
  const testing::TempFolder folder;
  const std::string path = folder / "a.txt";
  writeFileAtomically(path, "one");
  writeFileAtomically(path, "two");
  EXPECT_EQ(readTextFile(path), "two");
  EXPECT_THROW(writeFileAtomically(folder / "no/such/folder/a.txt", "x"), core::IoError);
  EXPECT_EQ(namesIn(folder.path()), std::vector<std::string>{"a.txt"});
}

TEST(PendingFile, LeavesNothingWithoutCommit) {
  const testing::TempFolder folder;
  {
    const PendingFile pending(folder / "map.png", true);
    EXPECT_THAT(pending.path(), AllOf(StartsWith(folder / "map.rasterslam-"), EndsWith(".png")));
    std::ofstream(pending.path()) << "half";
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(PendingFile, TouchesNothingOfOthersAndIsReadableAsUsual) {
  const testing::TempFolder folder;
  const std::string path = folder / "a";
  std::ofstream(path + ".tmp") << "thesis";
  const PendingFile one(path), other(path);
  EXPECT_NE(one.path(), other.path());
  EXPECT_EQ(readTextFile(path + ".tmp"), "thesis");
  std::ofstream(folder / "usual") << "x";
  EXPECT_EQ(fs::status(one.path()).permissions(), fs::status(folder / "usual").permissions());
}

/// The number of a process that has ended and was waited for.
pid_t ended(const std::function<void()>& work) {
  const pid_t child = fork();
  if (child == 0) {
    work();
    _exit(0);  // as by kill -9: nothing is cleaned up
  }
  waitpid(child, nullptr, 0);
  return child;
}

TEST(PendingFile, CleansUpWhatAKilledProcessHasLeft) {
  const testing::TempFolder folder;
  const std::string path = folder / "map.png";
  const pid_t dead = ended([&] {
    new PendingFile(path);
    new PendingFile(path, true);
  });
  const auto left = namesIn(folder.path());
  ASSERT_EQ(left.size(), 2U);
  // "map.png.rasterslam-MACHINE-" and "map.rasterslam-MACHINE-", in any order.
  const std::string& long_name = left[left[0].find("map.png.") == 0 ? 0 : 1];
  const std::string begin = "map.png.rasterslam-",
                    mark = long_name.substr(long_name.find(".rasterslam-") + 12, 7);
  const std::string number = std::to_string(dead), end = "-abcdef";
  const std::set<std::string> others = {begin + "backup", begin + mark + number + end + "g",
                                        begin + mark + std::to_string(getpid()) + end,
                                        begin + "000000-" + number + end,  // another machine's
                                        "other.png.rasterslam-" + mark + number + end};
  for (const auto& name : others) std::ofstream(folder / name) << "thesis";
  std::set<std::string> stay = others;
  fs::create_symlink("other", folder / *stay.insert(begin + mark + number + "-linked").first);
  fs::create_directory(folder / *stay.insert(begin + mark + number + "-folder").first);
  { const PendingFile whole(path), with_suffix(path, true); }
  EXPECT_THAT(namesIn(folder.path()), ::testing::UnorderedElementsAreArray(stay));
}

TEST(PendingFile, RefusesWhatIsNoFile) {
  const testing::TempFolder folder;
  EXPECT_EQ(errorOf([&] { PendingFile(folder.path()); }), folder.path() + ": is a folder, expected a file");
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(errorOf([&] { PendingFile(folder / "pipe"); }),
            folder / "pipe" + ": is a device or a pipe, expected a file or folder that can be replaced");
  EXPECT_EQ(errorOf([&] { refuseToOverwrite(folder / "pipe", true); }),
            folder / "pipe" + ": is a device or a pipe, expected a file or folder that can be replaced");
  EXPECT_EQ(namesIn(folder.path()), std::vector<std::string>{"pipe"});
}

TEST(OutputLock, ExcludesEveryOtherWhileItLives) {
  const testing::TempFolder folder;
  const std::string output = folder / "out";
  {
    const OutputLock lock(output + "/");
    EXPECT_EQ(errorOf([&] { OutputLock{output}; }), output + ": another run is writing it");
    EXPECT_EQ(errorOf([&] { PendingFolder(output, true); }), output + ": another run is writing it");
    EXPECT_NO_THROW(OutputLock(folder / "other"));
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
  EXPECT_NO_THROW(OutputLock{output});
}

TEST(OutputLock, IsNoOtherFile) {
  const testing::TempFolder folder;
  std::ofstream(folder / "out.lock") << "dear diary";
  EXPECT_THAT(errorOf([&] { OutputLock(folder / "out"); }), HasSubstr("out.lock: is not a lock of ours"));
  EXPECT_EQ(readTextFile(folder / "out.lock"), "dear diary");
  fs::create_symlink(folder / "target", folder / "b.lock");
  EXPECT_THROW(OutputLock(folder / "b"), core::IoError);
  EXPECT_FALSE(fs::exists(folder / "target"));
}

TEST(FindProgram, FindsWhatTheShellWouldStart) {
  const auto shell = findProgram("sh");
  EXPECT_EQ(fs::path(shell).filename(), "sh");
  EXPECT_TRUE(fs::is_regular_file(shell));
  EXPECT_EQ(findProgram("no-such-program"), "");
  EXPECT_EQ(findProgram("."), "");
}

TEST(ScratchFolder, IsItsOwnAndGoesWithAllInIt) {
  std::string path;
  {
    const ScratchFolder one, other;
    EXPECT_NE(one.path(), other.path());
    path = one.path();
    writeFileAtomically(one / "a", "a");
    EXPECT_EQ(readTextFile(path + "/a"), "a");
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(PendingFolder, LeavesNothingWithoutCommitAndReplacesOnlyResults) {
  const testing::TempFolder folder;
  const std::string path = folder / "out/run";
  {
    const PendingFolder pending(path, false);
    std::ofstream(pending.path() + "/half") << "x";
  }
  EXPECT_TRUE(fs::is_empty(folder / "out"));
  {
    PendingFolder pending(path + "/", false);  // a trailing slash names the same folder
    std::ofstream(pending.path() + "/manifest.json") << "{}";
    pending.commit();
  }
  EXPECT_TRUE(fs::exists(path + "/manifest.json"));
  EXPECT_THAT(errorOf([&] { PendingFolder(path, false); }), HasSubstr("exists; give --overwrite"));
  {
    PendingFolder pending(path, true);
    pending.commit();
  }
  EXPECT_TRUE(fs::is_empty(path));
  std::ofstream(path + "/precious") << "x";
  EXPECT_THAT(errorOf([&] { PendingFolder(path, true); }), HasSubstr("holds other files"));
  EXPECT_TRUE(fs::exists(path + "/precious"));
}

TEST(PendingFolder, LeavesOthersFoldersAloneAndCleansUpItsOwn) {
  const testing::TempFolder folder;
  const std::string path = folder / "out";
  const std::string others[] = {"out.tmp", "out.rasterslam-backup", "outer.rasterslam-abcdef"};
  for (const auto& name : others)
    writeFileAtomically((fs::create_directories(folder / name), folder / name + "/thesis.txt"), "p");
  ended([&] { std::ofstream((new PendingFolder(path, false))->path() + "/half") << "x"; });
  EXPECT_EQ(namesIn(folder.path()).size(), 5U);  // with the lock of the dead
  {
    PendingFolder pending(path, false);
    writeFileAtomically(pending.path() + "/manifest.json", "{}");
    pending.commit();
  }
  EXPECT_THAT(namesIn(folder.path()), UnorderedElementsAre("out", others[0], others[1], others[2]));
  EXPECT_EQ(readTextFile(folder / "out.tmp/thesis.txt"), "p");
}

TEST(Sha256, EqualsThePublishedExample) {
  // FIPS 180-2, appendix B.1
  EXPECT_EQ(resources::sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  const testing::TempFolder folder;
  writeFileAtomically(folder / "abc", "abc");
  EXPECT_EQ(resources::fileSha256(folder / "abc"), resources::sha256("abc"));
}

TEST(Manifest, ReadsBackWhatWasWritten) {
  const testing::TempFolder folder;
  resources::Manifest manifest;
  manifest.command_line = {"rasterslam", "run", "it's here.rawlog", ""};
  manifest.seed = 18446744073709551615ULL;
  manifest.config["mapping.resolution_m"] = "0.05";
  manifest.files["map.png"] = "picture \"quoted\"";
  manifest.times_s["mapping"] = 1.5;
  resources::writeManifest(manifest, folder / "manifest.json");
  const resources::Manifest back = resources::readManifest(folder / "manifest.json");
  EXPECT_EQ(back.command_line, manifest.command_line);
  EXPECT_EQ(back.seed, manifest.seed);
  EXPECT_EQ(back.config, manifest.config);
  EXPECT_EQ(back.files, manifest.files);
  EXPECT_EQ(back.times_s, manifest.times_s);
  writeFileAtomically(folder / "other.json", "{\"a\": 1}");
  EXPECT_THAT(errorOf([&] { resources::readManifest(folder / "other.json"); }), HasSubstr("not a manifest"));
}

TEST(ReadJsonFile, RefusesWhatIsNestedWithoutEnd) {
  const testing::TempFolder folder;
  const std::string path = folder / "deep.json";
  writeFileAtomically(path, std::string(150000, '[') + std::string(150000, ']'));
  EXPECT_EQ(errorOf([&] { resources::readJsonFile(path); }), path + ": values are nested more than 64 deep");
  EXPECT_EQ(errorOf([&] { resources::readManifest(path); }), path + ": values are nested more than 64 deep");
  writeFileAtomically(path, std::string(64, '[') + std::string(64, ']'));
  EXPECT_TRUE(resources::readJsonFile(path).is_array());
  writeFileAtomically(path, "{\"a\":");
  EXPECT_TRUE(resources::readJsonFile(path).is_discarded());
}

TEST(ShellQuoted, SurvivesTheShell) {
  const std::vector<std::string> words = {"a b", "it's", "plain.txt", "$HOME", ""};
  const auto result = testing::runCommand("printf '%s\\n' " + resources::shellQuoted(words));
  EXPECT_EQ(result.out, "a b\nit's\nplain.txt\n$HOME\n\n");
}

TEST(DidYouMean, IsSilentWhenNothingIsNear) {
  EXPECT_EQ(core::didYouMean("rbfp", {"icp", "rbpf"}), "; did you mean 'rbpf'?");
  EXPECT_EQ(core::didYouMean("hector", {"icp", "rbpf"}), "");
  EXPECT_EQ(core::didYouMean("x", {}), "");
}

}  // namespace
}  // namespace slam::files
