#pragma once
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "libslam/core/error.h"
#include "libslam/files/ini.h"
#include "libslam/sweep/suite.h"

namespace slam::sweep {

/// What reads one suite: the file, and which of its sections were named by a list. The checks and the order
/// stand in suite_reader.cpp, what one word of a list means in suite_entries.cpp.
class SuiteReader {
 public:
  SuiteReader(const std::string& path, const std::string& folder);
  SuiteReader(files::IniFile ini, const std::string& path, const std::string& folder);
  Suite read();

 private:
  std::string where(const std::string& key) const;
  core::InputError unknown(const std::string& key, const std::string& word, const std::string& expected,
                           std::vector<std::string> names, const std::string& kind) const;
  std::string resolved(const std::string& path) const;
  std::vector<std::string> words(const std::string& key, const std::string& list) const;

  using Entries = std::map<std::string, files::IniFile::Entry>;
  const Entries* sectionOf(const std::string& kind, const std::string& name);
  static void layOver(files::IniFile& config, const Entries& entries, const std::set<std::string>& own);
  std::vector<SuiteVariant> variants(const std::string& key, const std::string& list,
                                     const std::string& kind);
  SuiteVariant variant(const std::string& key, const std::string& kind, const std::string& word);
  SuiteVariant preset(const std::string& key, const std::string& kind, const std::string& word) const;
  std::uint64_t seed(const std::string& text, const std::string& place) const;
  SuiteWorld generated(const std::string& name, const std::string& kind, const Entries& keys) const;
  SuiteWorld unchecked(const std::string& word);
  SuiteWorld world(const std::string& word);
  SuiteLog log(const std::string& word);
  void addMethods(const std::string& word);
  static std::vector<SuiteMethod> crossed(const std::vector<SuiteMethod>& grid, const std::string& key,
                                          const files::IniFile::Entry& entry);
  void readSeeds();
  void rejectUnknownKinds() const;
  void rejectUnusedSections() const;
  void checkNames() const;
  void checkBaseline();
  void checkCombinations() const;

  Suite suite_;
  files::IniFile ini_;
  std::set<std::string> used_;
};

/// The name of an axis' value that changes nothing.
inline constexpr const char* kBuiltIn = "built-in";

}  // namespace slam::sweep
