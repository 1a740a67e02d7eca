#include "libslam/learn/template_folder.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/files/ini.h"
#include "libslam/files/word_list.h"
#include "libslam/reach/goal_methods.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/resources/manifest.h"
#include "libslam/resources/resources.h"
#include "libslam/strategies/strategy.h"

namespace slam::learn {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kLongestName = 40;

std::string templatesFolder() {
  return resources::configsFolder() + "/templates";
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string valueOf(const files::IniFile& ini, const std::string& section, const std::string& key) {
  const auto* entry = ini.find(section, key);
  if (!entry)
    throw core::InputError("templates.ini: section [" + section + "]: key '" + key + "' is missing");
  return entry->value;
}

files::IniFile templatesIni() {
  return resources::readConfigFile(templatesFolder() + "/templates.ini");
}

std::vector<TemplateKind> kindsOf(const files::IniFile& ini) {
  std::vector<TemplateKind> kinds;
  for (const auto& [section, entries] : ini.sections())
    if (section != "names")
      kinds.push_back({section, valueOf(ini, section, "meaning"),
                       files::namesIn(valueOf(ini, section, "languages"), ',')});
  return kinds;
}

std::vector<std::string> takenNames(const std::string& what) {
  if (what == "strategies") return strategies::strategyNames();
  if (what == "navigators") return reach::goalMethodNames();
  return resources::namesInFolder(resources::configsFolder() + "/methods", ".ini");
}

void requireName(const files::IniFile& ini, const TemplateRequest& request) {
  const std::string& name = request.name;
  const bool is_name = !name.empty() && name.size() <= kLongestName && name[0] >= 'a' && name[0] <= 'z' &&
                       std::all_of(name.begin(), name.end(), [](char c) {
                         return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
                       });
  if (!is_name)
    throw core::InputError("name: found '" + name +
                           "', expected small letters, digits and _, a letter first, " +
                           std::to_string(kLongestName) + " at most");
  const auto reserved = files::namesIn(valueOf(ini, "names", "reserved"), ' ');
  if (std::find(reserved.begin(), reserved.end(), name) != reserved.end())
    throw core::InputError("name: found '" + name + "', a reserved word, expected another one");
  const auto taken = takenNames(valueOf(ini, request.kind, "taken"));
  if (std::find(taken.begin(), taken.end(), name) != taken.end())
    throw core::InputError("name: found '" + name + "', the name of a built-in " + request.kind +
                           ", expected another one");
}

/// The language asked for, or the usual one.
std::string languageOf(const TemplateKind& kind, const std::string& asked) {
  if (asked.empty()) return kind.languages.front();
  if (std::find(kind.languages.begin(), kind.languages.end(), asked) == kind.languages.end())
    throw core::InputError("--language: found '" + asked + "', expected for a " + kind.name + ": " +
                           listed(kind.languages));
  return asked;
}

using Words = std::map<std::string, std::string>;

std::string filledIn(std::string text, const Words& words) {
  for (const auto& [mark, word] : words)
    for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + word.size()))
      text.replace(at, mark.size(), word);
  return text;
}

void copyFilled(const std::string& from, const std::string& to, const Words& words,
                std::vector<std::string>& files) {
  if (!fs::is_directory(from)) return;
  for (const auto& entry : fs::directory_iterator(from)) {
    const std::string name = filledIn(entry.path().filename().string(), words);
    files::writeFileAtomically(to + "/" + name, filledIn(files::readTextFile(entry.path().string()), words));
    files.push_back(name);
  }
}

}  // namespace

std::vector<TemplateKind> templateKinds() {
  return kindsOf(templatesIni());
}

std::string className(const std::string& name) {
  std::string result;
  for (const auto& part : files::namesIn(name, '_'))
    result += static_cast<char>(std::toupper(static_cast<unsigned char>(part[0]))) + part.substr(1);
  return result;
}

std::string libraryFolder(const resources::DataPlaces& places) {
  const std::string& build = places.build_folder;
  if (!build.empty() && places.code.compare(0, build.size() + 1, build + "/") == 0) return build;
  return fs::path(places.code).parent_path().parent_path().string();
}

MadeFolder makeFromTemplate(const TemplateRequest& request) {
  const auto ini = templatesIni();
  const auto kinds = kindsOf(ini);
  const auto kind = std::find_if(kinds.begin(), kinds.end(),
                                 [&](const TemplateKind& known) { return known.name == request.kind; });
  if (kind == kinds.end()) {
    std::vector<std::string> names;
    names.reserve(kinds.size());
    for (const auto& known : kinds) names.push_back(known.name);
    throw core::InputError("kind: found '" + request.kind + "', expected one of " + listed(names) +
                           core::didYouMean(request.kind, names));
  }
  requireName(ini, request);
  const std::string language = languageOf(*kind, request.language);
  const Words words = {{"@name@", request.name},
                       {"@Name@", className(request.name)},
                       {"@rasterslam@", request.library},
                       {"@version@", resources::versionText()}};
  MadeFolder made;
  made.path = request.output.empty() ? request.name : request.output;
  if (fs::exists(made.path))
    throw core::InputError(made.path + ": exists and may hold somebody's work, expected a new folder");
  files::PendingFolder folder(made.path, false);
  copyFilled(templatesFolder() + "/" + kind->name + "/" + language, folder.path(), words, made.files);
  copyFilled(templatesFolder() + "/shared/" + language, folder.path(), words, made.files);
  std::sort(made.files.begin(), made.files.end());
  folder.commit();
  for (const auto& line : files::namesIn(valueOf(ini, kind->name, "next_" + language), ';')) {
    std::string text = line;
    for (std::size_t at = text.find("@name@"); at != std::string::npos; at = text.find("@name@", at)) {
      const char before = at == 0 ? ' ' : text[at - 1];
      const std::string& word = before == ' ' ? made.path : request.name;  // a path begins a word
      text.replace(at, 6, word);
      at += word.size();
    }
    made.next.push_back(text);
  }
  return made;
}

}  // namespace slam::learn
