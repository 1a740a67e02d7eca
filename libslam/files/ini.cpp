#include "libslam/files/ini.h"

#include <sstream>

#include "libslam/core/error.h"

namespace slam::files {
namespace {

std::string withoutComment(const std::string& line) {
  for (size_t i = 0; i < line.size(); ++i) {
    const bool marks = line[i] == '#' || line[i] == ';';
    if (marks && (i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t')) return line.substr(0, i);
  }
  return line;
}

}  // namespace

std::string trimmed(const std::string& text) {
  constexpr const char* kBlank = " \t\r\n";
  const auto first = text.find_first_not_of(kBlank);
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

IniFile IniFile::parse(const std::string& text, const std::string& name) {
  IniFile ini;
  std::istringstream lines(text);
  std::string line, section;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::string where = name + ":" + std::to_string(number);
    const std::string content = trimmed(withoutComment(line));
    if (content.empty()) continue;
    if (content.front() == '[') {
      if (content.back() != ']' || content.size() < 3)
        throw core::InputError(where + ": found '" + content + "', expected [section]");
      section = trimmed(content.substr(1, content.size() - 2));
      if (section.empty()) throw core::InputError(where + ": found '" + content + "', expected [section]");
      ini.sections_[section];
      continue;
    }
    const auto equals = content.find('=');
    if (equals == std::string::npos || equals == 0)
      throw core::InputError(where + ": found '" + content + "', expected key = value");
    if (section.empty())
      throw core::InputError(where + ": found '" + content +
                             "' before any section, expected [section] first");
    const std::string key = trimmed(content.substr(0, equals));
    auto& entries = ini.sections_[section];
    if (const auto it = entries.find(key); it != entries.end())
      throw core::InputError(where + ": section [" + section + "], key '" + key +
                             "' is given twice, first at " + it->second.origin);
    entries[key] = {trimmed(content.substr(equals + 1)), where};
  }
  return ini;
}

void IniFile::set(const std::string& section, const std::string& key, const std::string& value,
                  const std::string& origin) {
  sections_[section][key] = {value, origin};
}

void IniFile::setFromArgument(const std::string& argument, const std::string& origin) {
  const auto equals = argument.find('=');
  const auto dot = argument.find('.');
  if (equals == std::string::npos || dot == std::string::npos || dot == 0 || dot + 1 >= equals)
    throw core::InputError(origin + ": found '" + argument + "', expected section.key=value");
  set(trimmed(argument.substr(0, dot)), trimmed(argument.substr(dot + 1, equals - dot - 1)),
      trimmed(argument.substr(equals + 1)), origin);
}

void IniFile::overrideWith(const IniFile& over) {
  for (const auto& [section, entries] : over.sections_) {
    auto& mine = sections_[section];
    for (const auto& [key, entry] : entries) mine[key] = entry;
  }
}

const IniFile::Entry* IniFile::find(const std::string& section, const std::string& key) const {
  const auto s = sections_.find(section);
  if (s == sections_.end()) return nullptr;
  const auto k = s->second.find(key);
  return k == s->second.end() ? nullptr : &k->second;
}

}  // namespace slam::files
